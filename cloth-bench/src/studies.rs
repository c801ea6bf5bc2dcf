//! Studies: one question each, answered by measurement on the same scenes for every method.
//!
//! A study is a grid of cases, one measurement, tables and figures over typed rows, and a conclusion:
//!
//! 1. `study.grid(points, name, measure)` measures every point of a grid that is not finished yet, or
//!    `grid_side_by_side` where no times are measured, and gives the points with what was found there. What failed is a
//!    remark already. Points are tuples such as `iproduct!(methods(), sizes)` gives, or structs.
//! 2. What is measured is a serde struct, kept in the journal; behind its point it is a row.
//!    `study.table(name, caption, &rows)` reads the columns from the structs, units included; what a tuple holds is
//!    named by `Table::named`.
//! 3. `curves(&rows, |row| (label, (x, y)))` says which columns go where; `Plot::new(title, x, y).with(curves)` draws.
//! 4. `study.section.verdict` says in words what the rows show: a sentence, and on more lines the numbers.
//!
//! Nothing else has to be told: cases are counted, left out, resumed and joined by the names that the grid gives them.
//! `recovery` and `threads` are short ones to start from.

mod acceleration;
mod bending;
mod cases;
mod collision;
pub mod contact;
pub mod convergence;
pub mod decision;
pub mod energy;
pub mod independence;
pub mod interleaved;
pub mod locking;
pub mod meshes_and_steps;
pub mod newton;
mod pictures;
mod prelude;
pub mod projective;
pub mod recovery;
mod sag;
mod scale;
pub mod sheets;
pub mod skip;
pub mod stability;
pub mod stiffness;
mod study_run;
mod threads;
pub mod variants;
pub mod work_precision;
pub mod xpbd_floor;

pub use cases::{Cases, Progress, Share};
pub use locking::count::Locking;
pub use projective::factor::{constant_matrix, local_bytes, move_bytes};
use study_run::StudyRun;

use crate::error::BenchError;
use crate::journal::Journal;
use crate::names;
use crate::report::html::{Answer, Section};
use crate::report::plot::Plot;
use crate::report::table::{Cell, Table, two};
use cloth_core::math::Real;
use itertools::Itertools;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A question with the means to answer it.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// Its name.
    pub name: &'static str,
    /// The question in one sentence.
    pub question: &'static str,
    /// What would surprise us, and what each table holds.
    pub about: &'static str,
    run: Run,
}

/// Measures case by case, and judges.
type Run = fn(&mut StudyRun<'_>) -> Result<(), BenchError>;

/// Whether a scene file serves for the studies that take one.
pub fn check_scene(path: &Path) -> Result<(), BenchError> {
    sheets::TestSheet::own(path).map(|_| ())
}

/// Whether a method ends with this error wherever it is used, as theory foretells: a finding, but no alarm.
pub fn is_expected(error: &str) -> bool {
    error.contains("no step is stable for this method")
}

/// What a failure is called: those that theory foretells are no alarm.
fn failed(error: &str) -> &'static str {
    match is_expected(error) {
        true => "failed, as expected",
        false => "failed",
    }
}

/// A failure in a row of a table; nothing for what did not fail.
fn remark<T>(outcome: &Result<T, BenchError>) -> String {
    let error = outcome.as_ref().err().map(BenchError::to_string);
    error.map_or(String::new(), |error| {
        format!("{}: {error}", failed(&error))
    })
}

/// How much of a study to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Small sizes.
    Quick,
    /// All sizes.
    Full,
}

impl Scope {
    /// What belongs to this scope.
    pub(crate) fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }

    /// The same of a constant: of small sizes first.
    pub(crate) fn of<T>(self, [quick, full]: [T; 2]) -> T {
        self.pick(quick, full)
    }
}

/// What a study found: a section of the report, and the same as data.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Findings {
    /// The section, complete but for its id, title, question and command.
    pub section: Section,
    /// Tables for `data/NAME.csv`.
    pub data: Vec<(String, Table)>,
    /// Plain answers to questions that people come with: they open the report.
    pub answers: Vec<Answer>,
}

impl Findings {
    /// Adds what another part of the study found.
    fn append(&mut self, part: Self) {
        let section = part.section;
        self.section.plots.extend(section.plots);
        self.section.pictures.extend(section.pictures);
        self.section.playbacks.extend(section.playbacks);
        self.section.tables.extend(section.tables);
        self.section.notes.extend(section.notes);
        self.data.extend(part.data);
        self.answers.extend(part.answers);
    }

    /// Adds a remark below the section.
    pub(crate) fn note(&mut self, note: String) {
        self.section.notes.push(note);
    }

    /// Draws a plot and keeps it under a name.
    pub(crate) fn plot(&mut self, name: &str, plot: &Plot) {
        let svg = plot.draw().svg;
        self.section.plots.push((name.to_owned(), svg));
    }

    /// What a method gave, or `None` and a note that says why it failed: a failure is a finding.
    pub(crate) fn unless_failed<T>(
        &mut self,
        case: &str,
        outcome: Result<T, BenchError>,
    ) -> Option<T> {
        let note = |error: BenchError| {
            let failed = capitalised(failed(&error.to_string()));
            self.note(format!("{failed}: {case}: {error}."));
        };
        outcome.map_err(note).ok()
    }

    /// Answers a question that people come with in a sentence, with a table if there are many numbers, and names the
    /// plot (`figure-NAME`) or table (`table-NAME`) of the section that it rests on.
    pub(crate) fn answer(
        &mut self,
        question: &str,
        answer: String,
        table: Option<Table>,
        figure: &str,
    ) {
        self.answers.push(Answer {
            question: question.to_owned(),
            answer,
            table,
            figure: figure.to_owned(),
            section: String::new(),
        });
    }

    /// Keeps a table as data only.
    pub(crate) fn data(&mut self, name: &str, table: impl Into<Table>) {
        self.data.push((name.to_owned(), table.into()));
    }

    /// Keeps a table as data and shows it with a caption.
    pub(crate) fn table(&mut self, name: &str, caption: &str, table: impl Into<Table>) {
        let table = table.into();
        let shown = (name.to_owned(), caption.to_owned(), table.clone());
        self.section.tables.push(shown);
        self.data(name, table);
    }
}

/// Every study.
pub const STUDIES: [&Study; 20] = [
    &decision::STUDY,
    &convergence::STUDY,
    &work_precision::STUDY,
    &stiffness::STUDY,
    &locking::STUDY,
    &bending::STUDY,
    &acceleration::STUDY,
    &sag::STUDY,
    &xpbd_floor::STUDY,
    &projective::STUDY,
    &contact::STUDY,
    &collision::STUDY,
    &newton::STUDY,
    &energy::STUDY,
    &stability::STUDY,
    &recovery::STUDY,
    &independence::STUDY,
    &threads::STUDY,
    &scale::STUDY,
    &skip::STUDY,
];

impl Study {
    /// The study of that name.
    pub fn find(name: &str) -> Result<&'static Self, BenchError> {
        names::find("study", name, STUDIES.iter().copied(), |study| study.name)
    }

    /// Number of its cases, with the scenes of the program or with a scene file of one's own: those that it asks for
    /// when none is run.
    pub fn cases(&self, scope: Scope, own: Option<&Path>) -> usize {
        let (share, own) = (Share::Nothing, own.map(Path::to_owned));
        let mut progress = |_: Progress<'_>| {};
        let cases = Cases::new(self.name, None, share, &mut progress, own);
        let mut study = StudyRun::new(scope, cases);
        // A study that ends with an error has asked for its cases before.
        let _ = (self.run)(&mut study);
        study.cases.left_out().len()
    }

    /// Whether it can be asked of a scene of one's own.
    pub fn takes_a_scene(&self) -> bool {
        [convergence::STUDY.name, work_precision::STUDY.name].contains(&self.name)
    }

    /// Runs the cases that are not in the journal and that `share` leaves to this run, and draws the conclusions.
    /// `progress` is called before each case. Returns the names of the cases that are still missing as
    /// well: with some, the findings are not to be shown.
    pub fn run(
        &self,
        scope: Scope,
        journal: &mut Journal,
        share: Share,
        progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<(Findings, Vec<String>), BenchError> {
        let own = journal.heading().scene().map(str::to_owned);
        let own = own.map(PathBuf::from);
        let cases = Cases::new(self.name, Some(journal), share, progress, own.clone());
        let mut study = StudyRun::new(scope, cases);
        let outcome = (self.run)(&mut study);
        let missing = study.cases.left_out().to_vec();
        let mut findings = study.findings;
        // A journal that cannot be written has made the cases fail.
        if let Some(error) = journal.broken() {
            return Err(error.clone());
        }
        outcome?;
        let section = &mut findings.section;
        // Its first line is the answer, but where all of it is.
        let told = section
            .verdict
            .as_ref()
            .and_then(|told| told.split_once('\n'));
        if let Some((answer, detail)) = told.filter(|_| !section.leads) {
            let (answer, detail) = (answer.to_owned(), detail.to_owned());
            (section.verdict, section.detail) = (Some(answer), detail);
        }
        section.id = self.name.to_owned();
        section.title = capitalised(self.name);
        section.question = self.question.to_owned();
        let quick = if scope == Scope::Quick {
            " --quick"
        } else {
            ""
        };
        section.command = format!(
            "cargo run --release -p cloth-bench -- study {}{quick}{}",
            self.name,
            own.map_or(String::new(), |path| format!(" --scene {}", path.display()))
        );
        section.notes.push(self.about.to_owned());
        let rests_on = &section.rests_on;
        if missing.is_empty() && !rests_on.is_empty() && !section.shows(rests_on) {
            return Err(BenchError::Failed(format!(
                "the answer of {} rests on `{rests_on}`, which its section does not show",
                self.name
            )));
        }
        for answer in &mut findings.answers {
            self.name.clone_into(&mut answer.section);
            if missing.is_empty() && !section.shows(&answer.figure) {
                return Err(BenchError::Failed(format!(
                    "the answer to \"{}\" rests on `{}`, which its section does not show",
                    answer.question, answer.figure
                )));
            }
        }
        Ok((findings, missing))
    }
}

/// Times that differ by less than this factor may be in another order in another run.
const NOISE: Real = 1.3;

/// Who is the first at an error that is wanted, and when, of labels with an error and a time (ms); all that are too
/// near to the first to tell which is.
fn fastest_to<'a>(wanted: f64, all: impl Iterator<Item = (&'a str, f64, f64)>) -> Cell {
    let there = all.filter(|(_, error, _)| *error <= wanted);
    let there = there.sorted_by(|(.., a), (.., b)| a.total_cmp(b));
    let there = there.unique_by(|(label, ..)| *label).collect_vec();
    let Some(&(_, _, first)) = there.first() else {
        return Cell::said("nobody");
    };
    let near = there.iter().take_while(|(.., ms)| *ms < NOISE * first);
    let said = near.map(|(label, _, ms)| format!("{label}: {} ms", two(*ms)));
    let said = said.collect_vec();
    Cell::said(match said.len() {
        1 => said[0].clone(),
        near @ ..4 => format!("within the noise: {}", said[..near].join(", ")),
        near => {
            let more = near - 3;
            format!("within the noise: {} and {more} more", said[..3].join(", "))
        }
    })
}

fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

//! Studies: one question each, answered by measurement on the same scenes for every method.

mod acceleration;
mod bending;
mod collision;
mod convergence;
mod locking;
mod newton;
mod projective;
mod sag;
mod stiffness;
mod xpbd_floor;

pub use locking::Locking;
pub use projective::{constant_matrix, local_bytes, move_bytes};

use crate::error::BenchError;
use crate::names;
use crate::report::html::Section;
use crate::report::plot::Plot;
use crate::report::table::Table;

/// A question with the means to answer it.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// Its name.
    pub name: &'static str,
    /// The question in one sentence.
    pub question: &'static str,
    /// What would surprise us, and what each table holds.
    pub about: &'static str,
    cases: fn(Scope) -> u64,
    run: Run,
}

/// Measures and judges; calls back with the name of each case before it.
type Run = fn(Scope, &mut dyn FnMut(&str)) -> Result<Findings, BenchError>;

/// How much of a study to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Small sizes.
    Quick,
    /// All sizes.
    Full,
}

/// What a study found: a section of the report, and the same as data.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// The section, complete but for its id, title, question and command.
    pub section: Section,
    /// Tables for `data/NAME.csv`.
    pub data: Vec<(String, Table)>,
    /// Drawings for `plots/NAME.svg`; they are in the section as well.
    pub plots: Vec<(String, String)>,
}

impl Findings {
    /// Draws a plot and keeps it under a name.
    pub(crate) fn plot(&mut self, name: &str, plot: &Plot) {
        let svg = plot.draw().svg;
        self.section.plots.push(svg.clone());
        self.plots.push((name.to_owned(), svg));
    }

    /// What a method gave, or `None` and a note that says why it failed: a failure is a finding.
    pub(crate) fn unless_failed<T>(
        &mut self,
        case: &str,
        outcome: Result<T, BenchError>,
    ) -> Option<T> {
        outcome
            .map_err(|error| self.section.notes.push(format!("Failed: {case}: {error}.")))
            .ok()
    }

    /// Keeps a table as data only.
    pub(crate) fn data(&mut self, name: &str, table: Table) {
        self.data.push((name.to_owned(), table));
    }

    /// Keeps a table as data and shows it with a caption.
    pub(crate) fn table(&mut self, name: &str, caption: &str, table: Table) {
        self.section
            .tables
            .push((caption.to_owned(), table.clone()));
        self.data(name, table);
    }
}

/// Every study.
pub const STUDIES: [&Study; 10] = [
    &convergence::STUDY,
    &stiffness::STUDY,
    &locking::STUDY,
    &bending::STUDY,
    &acceleration::STUDY,
    &sag::STUDY,
    &xpbd_floor::STUDY,
    &projective::STUDY,
    &collision::STUDY,
    &newton::STUDY,
];

impl Study {
    /// The study of that name.
    ///
    /// # Errors
    /// [`BenchError::Usage`] that names the nearest known one.
    pub fn find(name: &str) -> Result<&'static Self, BenchError> {
        STUDIES
            .iter()
            .copied()
            .find(|study| study.name == name)
            .ok_or_else(|| {
                let known: Vec<&str> = STUDIES.iter().map(|s| s.name).collect();
                BenchError::Usage(names::unknown("study", name, &known))
            })
    }

    /// Number of times that [`Study::run`] reports progress.
    #[must_use]
    pub fn cases(&self, scope: Scope) -> u64 {
        (self.cases)(scope)
    }

    /// Runs it. `progress` is called before each case with its name.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if a reference does not converge. A method that fails is a finding, not an error.
    pub fn run(
        &self,
        scope: Scope,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Findings, BenchError> {
        let mut findings = (self.run)(scope, progress)?;
        let section = &mut findings.section;
        section.id = self.name.to_owned();
        section.title = capitalised(self.name);
        section.question = self.question.to_owned();
        let quick = if scope == Scope::Quick {
            " --quick"
        } else {
            ""
        };
        section.command = format!(
            "cargo run --release -p cloth-bench -- study {}{quick}",
            self.name
        );
        section.notes.push(self.about.to_owned());
        Ok(findings)
    }
}

fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

//! Every method on one line: what it costs, how good it is, and where it is not to be used.

pub mod columns;
pub mod measure;
mod shortened;

use super::{capitalised, scale};
use crate::bounds::bounds;
use crate::report::html::Picture;
use crate::report::render::{Surface, View, render};
use crate::report::table::Mark;
use crate::studies::prelude::*;
use columns::{COLUMNS, percent, two};
use measure::{Contact, Cost, Step};

pub(super) const STUDY: Study = Study {
    name: "decision",
    question: "Which method for which purpose?",
    about: "ms a step and memory (peak of the process): the hanging sheet from rest, in a process of its own, median of sixteen \
        steps, or of three where a step takes longer than 0.3 s. Real time: vertices a side at 16.7 ms a step, from the power law \
        through both sizes, with an exponent of 1 in the vertices at least. Every method has the default of `run` throughout, so xpbd as \
        many substeps as the mesh asks for, but for stable up to and fold, where it has the published 20. Error: (G − G*)/(G(x̃) − G*) after the sixteenth step of the hanging sheet, 1 at the inertial \
        prediction, 0 at the minimum; none for methods that solve another step. Stretch: largest strain of an edge after half a \
        second of hanging. Stable up to: springs of so many N/m at Δt = 1/60 s without energy of motion from nowhere; explicit \
        methods take the step in one part there, elsewhere they cut it as finely as they need. Fold: angle over the exact one of a \
        sheet with edges of 1e6 N/m that hangs over an edge (see the study of locking): from 0.8 to 1.25 it folds, below 0.5 it is locked. \
        Contact: the same sheet falls on a sphere, half a second; its time a step over that of hanging, pairs that cross at the \
        end, and energy above what start and gravity gave, over the latter, energy of strained springs included. Best: within a twentieth of the best. Unfit: \
        ten times the time, memory or contact cost of the best, a tenth of its vertices, an error above 0.1, twice the stretch of \
        implicit Euler, unstable with 1e4 N/m, locked, crossings, or more than 1 % of energy above what was given.",
    run,
};

/// The method whose stretch is the right one: it is solved to its end.
const REFERENCE: &str = "implicit-euler";

const DT: Real = 1.0 / 60.0;

/// Energy above what was given, over that, which counts as kept.
const MOST_EXCESS: Real = 0.01;

fn methods() -> impl Iterator<Item = &'static Method> {
    method::all().filter(|method| method.name != scale::WITHOUT)
}

/// A method with all that was found of it.
#[derive(Debug)]
pub struct Row {
    /// Name of the method.
    pub method: &'static str,
    /// What its steps take.
    pub cost: Option<Cost>,
    /// What it makes of single steps.
    pub step: Option<Step>,
    /// What it makes of contact.
    pub contact: Option<Contact>,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    study.findings.section.leads = true;
    let unstable = format!("step of {}", scale::WITHOUT);
    let foretold = study.case(&unstable, || measure::hopeless(scope));
    let every: Vec<&Method> = methods().collect();
    let case_of = |method: &&Method| format!("step of {}", method.name);
    let steps = study
        .cases
        .side_by_side(&every, case_of, |method| Step::measure(scope, method));
    let mut rows = Vec::new();
    for (method, step) in every.into_iter().zip(steps) {
        let name = method.name;
        let step = study.findings.unless_failed(&case_of(&method), step);
        let case = format!("cost of {name}");
        let cost = study.case(&case, || Cost::measure(scope, name));
        let case = format!("contact of {name}");
        let contact = study.case(&case, || Contact::measure(scope, method));
        for reason in step.iter().flat_map(|s| &s.reasons) {
            study
                .findings
                .section
                .notes
                .push(format!("{name}: {reason}."));
        }
        let drapes = contact
            .iter()
            .flat_map(|c| [("1/60", &c.sixtieth), ("1/30", &c.thirtieth)]);
        for (dt, reason) in drapes.filter_map(|(dt, d)| Some((dt, d.reason.as_ref()?))) {
            let note = format!("{name} in contact, steps of {dt} s: {reason}.");
            study.findings.section.notes.push(note);
        }
        rows.push(Row {
            method: name,
            cost,
            step,
            contact,
        });
    }
    study.findings.section.verdict = Some(verdict(&rows));
    study.findings.data("decision", data(&rows));
    let shown = shown(scope, &rows, foretold.as_deref().unwrap_or_default());
    let caption = format!(
        "Every method at its default setting: ★ best, ✗ unfit, – not to be had. Pictures: the same cloth on a sphere after {:.2} s.",
        Real::from(measure::steps(scope)) * DT
    );
    study.findings.section.tables.push((caption, shown));
    study.findings.section.pictures = strip(scope, &rows)?;
    let qualities = method::all().map(Method::qualities);
    study.findings.table(
        "decision-qualities",
        "What no measurement says",
        Table::of(&qualities.collect::<Vec<_>>()),
    );
    answer(scope, &rows, &mut study.findings);
    cuts(study);
    shortened::compare(study)
}

/// The numbers as they are.
fn data(rows: &[Row]) -> Table {
    let names = COLUMNS.iter().map(|c| format!("{} ({})", c.name, c.unit));
    let columns = std::iter::once("method".to_owned()).chain(names).collect();
    let cells = |row: &Row| {
        let values = COLUMNS.iter().map(|column| Cell::from((column.value)(row)));
        std::iter::once(Cell::from(row.method))
            .chain(values)
            .collect()
    };
    Table {
        columns,
        rows: rows.iter().map(cells).collect(),
    }
}

/// The numbers as a reader wants them, judged; a method that `foretold` why it fails has a line of its own.
#[must_use]
pub fn shown(scope: Scope, rows: &[Row], foretold: &str) -> Table {
    let [small, large] = measure::sides(scope).map(|side| format!("{side} × {side}"));
    let names = COLUMNS.iter().map(|column| {
        column
            .name
            .replace("small", &small)
            .replace("large", &large)
    });
    let mut columns = vec!["method".to_owned()];
    columns.extend(names);
    let mut lines: Vec<Vec<Cell>> = rows
        .iter()
        .map(|row| vec![Cell::from(row.method)])
        .collect();
    for column in &COLUMNS {
        let all: Vec<Real> = rows.iter().filter_map(column.value).collect();
        let reference = rows.iter().find(|row| row.method == REFERENCE);
        let reference = reference.and_then(column.value);
        for (line, row) in lines.iter_mut().zip(rows) {
            line.push((column.value)(row).map_or(Cell::Missing, |value| {
                let mark = column.rule.judge(value, &all, reference);
                Cell::Marked((column.say)(value), mark)
            }));
        }
    }
    let mut hopeless = vec![Cell::from(scale::WITHOUT)];
    hopeless.extend(COLUMNS.iter().map(|column| match column.name {
        "stable up to" => Cell::Marked(foretold.to_owned(), Mark::Expected),
        _ => Cell::Missing,
    }));
    lines.push(hopeless);
    Table {
        columns,
        rows: lines,
    }
}

/// The best of the columns that people ask for first.
fn verdict(rows: &[Row]) -> String {
    let best = |value: fn(&Row) -> Option<Real>, sign: Real| {
        let known = rows
            .iter()
            .filter_map(|row| Some((row.method, sign * value(row)?)));
        known
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or("none", |(name, _)| name)
    };
    let clean = clean(rows, |contact| &contact.sixtieth);
    let has_kept_energy = |row: &&Row| {
        let excess = row.contact.as_ref().and_then(|met| met.sixtieth.excess);
        clean.contains(&row.method) && excess.is_some_and(|excess| excess <= MOST_EXCESS)
    };
    let exact = rows.iter().filter(has_kept_energy);
    let exact: Vec<&str> = exact.map(|row| row.method).collect();
    format!(
        "The cheapest step of a large sheet is that of {}; the most accurate, that of {}; the largest cloth in real time, that of {}; contact without a crossing, and with at most 1 % of energy above what was given: {}.",
        best(|row| row.cost.as_ref()?.ms[1], 1.0),
        best(|row| row.step.as_ref()?.error, 1.0),
        best(Row::real_time, -1.0),
        exact.join(", ")
    )
}

/// Methods that came through contact without a crossing, and without moving with energy from nowhere.
fn clean(rows: &[Row], of: impl Fn(&Contact) -> &measure::Drape) -> Vec<&'static str> {
    let is_clean = |row: &&Row| {
        row.contact
            .as_ref()
            .is_some_and(|contact| of(contact).is_clean())
    };
    rows.iter().filter(is_clean).map(|row| row.method).collect()
}

/// The same cloth in contact, by each method.
fn strip(scope: Scope, rows: &[Row]) -> Result<Vec<Picture>, BenchError> {
    let scene = measure::draped(scope)?;
    let Some(mesh) = &scene.mesh else {
        return Ok(Vec::new());
    };
    let seconds = Real::from(measure::steps(scope)) * scene.dt;
    let bodies = scene.obstacle_surfaces(seconds);
    let drapes = rows.iter().filter_map(|row| {
        let drape = &row.contact.as_ref()?.sixtieth;
        let positions: Vec<Vec3> = drape.positions.iter().copied().map(Vec3::from).collect();
        (!positions.is_empty()).then_some((row.method, positions))
    });
    let drapes: Vec<(&str, Vec<Vec3>)> = drapes.collect();
    let of_bodies = bodies.iter().flat_map(|(positions, _)| positions);
    let frame = bounds(of_bodies.chain(&scene.start.positions).copied());
    let view = View {
        width: 300,
        height: 260,
        bounds: Some(frame),
        ..View::default()
    };
    let picture = |(method, positions): &(&str, Vec<Vec3>)| {
        let bodies = bodies
            .iter()
            .map(|(at, triangles)| Surface::obstacle(at, triangles));
        let mut surfaces: Vec<Surface<'_>> = bodies.collect();
        surfaces.push(Surface::cloth(positions, mesh.triangles()));
        Ok(Picture {
            png: render(&surfaces, &view)?,
            caption: (*method).to_owned(),
        })
    };
    drapes.iter().map(picture).collect()
}

/// What contact costs, and what survives longer steps.
fn answer(scope: Scope, rows: &[Row], findings: &mut Findings) {
    let costs = rows.iter().filter_map(|row| {
        let ms = row.contact.as_ref()?.sixtieth.ms?;
        Some(format!(
            "{} × {} ({} ms)",
            row.method,
            two(row.contact_cost()?),
            two(ms)
        ))
    });
    let costs: Vec<String> = costs.collect();
    let told = format!(
        "A step of a sheet on a sphere takes, over one of the same sheet hanging: {}.",
        costs.join(", ")
    );
    findings.answer("What does contact cost?", told);
    let survives = clean(rows, |contact| &contact.thirtieth);
    let others = rows.iter().filter(|row| !survives.contains(&row.method));
    let others = others.filter_map(|row| {
        let drape = &row.contact.as_ref()?.thirtieth;
        let why = match drape.crossings {
            Some(pairs) if pairs > 0.0 => format!("{pairs} crossings"),
            Some(_) => "moves with energy that it was never given".into(),
            None => drape.reason.clone()?,
        };
        Some(format!("{} ({why})", row.method))
    });
    let others: Vec<String> = others.collect();
    let others = match others.is_empty() {
        true => String::new(),
        false => format!(" Not: {}.", others.join(", ")),
    };
    let is_strained = |row: &&Row| {
        let contact = row
            .contact
            .as_ref()
            .filter(|_| survives.contains(&row.method));
        contact.and_then(|contact| contact.thirtieth.excess) > Some(MOST_EXCESS)
    };
    let strained: Vec<&str> = rows
        .iter()
        .filter(is_strained)
        .map(|row| row.method)
        .collect();
    let strained = match strained.is_empty() {
        true => String::new(),
        false => format!(
            " Of these, {} held more than 1 % above it.",
            strained.join(", ")
        ),
    };
    let told = format!(
        "{} steps on the sphere without a crossing, and never in motion with more energy than was given: {}.{strained}{others} {} at no step, as expected.",
        measure::steps(scope) / 2,
        survives.join(", "),
        capitalised(scale::WITHOUT)
    );
    findings.answer("What survives a step of 1/30 s?", told);
}

/// A number of sweeps over the constraints, as iterations and as substeps.
#[derive(Default, Serialize)]
struct Cut {
    method: &'static str,
    substeps: u32,
    iterations: u32,
}

/// How it went under contact.
#[derive(Default, Serialize)]
struct CutRow {
    #[serde(rename = "ms a step")]
    ms: Option<Real>,
    largest_stretch: Option<Real>,
    crossings: Option<Real>,
    energy_above_what_was_given: Option<Real>,
}

/// The same number of sweeps, cut in several ways.
const CUTS: [(u32, u32); 3] = [(1, 20), (4, 5), (20, 1)];

fn cuts(study: &mut StudyRun<'_>) {
    let scope = study.scope;
    let name = |cut: &Cut| {
        let Cut {
            method,
            substeps,
            iterations,
        } = cut;
        format!("{method} in contact, {substeps} substeps of {iterations} iterations")
    };
    let of_method = |method| {
        CUTS.map(move |(substeps, iterations)| Cut {
            method,
            substeps,
            iterations,
        })
    };
    let found = study.grid(
        ["pbd", "xpbd"].into_iter().flat_map(of_method),
        name,
        |cut| {
            let Cut {
                method,
                substeps,
                iterations,
            } = cut;
            let settings = Settings::of(&format!("substeps={substeps} iterations={iterations}"));
            let method = Method::find(method)?;
            let (scene, steps) = (measure::draped(scope)?, measure::steps(scope));
            measure::Drape::measure(&scene, scope, method, &settings, (DT, steps))
        },
    );
    let (mut rows, mut told) = (Vec::new(), Vec::new());
    for (cut, drape) in found {
        if let (Some(ms), Some(stretch)) = (drape.ms, drape.stretch) {
            let Cut {
                method,
                substeps,
                iterations,
            } = cut;
            let (stretch, ms) = (percent(stretch), two(ms));
            told.push(format!(
                "{method} {substeps} × {iterations}: {stretch} of stretch in {ms} ms"
            ));
        }
        let note = drape
            .reason
            .map(|reason| format!("{}: {reason}.", name(&cut)));
        study.findings.section.notes.extend(note);
        let row = CutRow {
            ms: drape.ms,
            largest_stretch: drape.stretch,
            crossings: drape.crossings,
            energy_above_what_was_given: drape.excess,
        };
        rows.push((cut, row));
    }
    let caption = "Twenty sweeps under contact, as substeps × iterations";
    study
        .findings
        .table("decision-substeps", caption, Table::of(&rows));
    let told = told.join("; ");
    let answer = format!("Twenty sweeps a step on the sphere, as substeps × iterations: {told}.");
    study
        .findings
        .answer("Iterations or substeps under contact?", answer);
}

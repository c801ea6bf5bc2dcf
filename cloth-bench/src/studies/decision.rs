//! Every method on one line: what it costs, how good it is, and where it is not to be used.

pub mod columns;
pub mod measure;
mod shortened;

use super::scale;
use crate::bounds::bounds;
use crate::report::html::Picture;
use crate::report::render::{Surface, View, render};
use crate::report::table::Mark;
use crate::studies::prelude::*;
use columns::COLUMNS;
use measure::{Contact, Cost, Step};

pub(super) const STUDY: Study = Study {
    name: "decision",
    question: "Which method for which purpose?",
    about: "ms a step and memory (peak of the process): the hanging sheet from rest, in a process of its own, median of sixteen \
        steps, or of three where a step takes longer than 0.3 s. Real time: vertices a side at 16.7 ms a step, from the power law \
        through both sizes, with an exponent of 1 in the vertices at least. Every method has the default of `run` throughout, so xpbd as \
        many substeps as the mesh asks for, but for locks, where it has the published 20. Error: (G − G*)/(G(x̃) − G*) after the sixteenth step of the hanging sheet, 1 at the inertial \
        prediction, 0 at the minimum; none for methods that solve another step. Stretch: largest strain of an edge after half a \
        second of hanging. Stable up to: springs of so many N/m at Δt = 1/60 s without energy of motion from nowhere, strained from those with which the springs hold more than the fall has given, as a solver does that is cut short; explicit \
        methods take the step in one part there, elsewhere they cut it as finely as they need. Locks: angle over the exact one of a \
        sheet with edges of 1e6 N/m that hangs over an edge, methods that damp next to nothing with air drag (see the study of locking): yes below 0.5, partly below 0.8, too far above 1.25. \
        Contact: the same sheet falls on a sphere, half a second; its time a step over that of hanging, pairs that cross at the \
        end, and energy from nowhere: above what start and gravity gave, over the latter, energy of strained springs included. Best: within a twentieth of the best. Unfit: \
        ten times the time, memory or contact cost of the best, a tenth of its vertices, an error above 0.1, edges longer by 2 % than \
        with implicit Euler, unstable with 1e4 N/m, locked, crossings, or more than 1 % of energy above what was given.",
    run,
};

/// The method whose stretch is the right one: it is solved to its end.
const REFERENCE: &str = "implicit-euler";

const DT: Real = 1.0 / 60.0;

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
        for reason in contact.iter().filter_map(|c| c.drape.reason.as_ref()) {
            let note = format!("{name} in contact: {reason}.");
            study.findings.section.notes.push(note);
        }
        rows.push(Row {
            method: name,
            cost,
            step,
            contact,
        });
    }
    let small = study.scope.pick(
        "Of small sheets (--quick), where the fastest are others than of large ones:\n",
        "",
    );
    study.findings.section.verdict = Some(small.to_owned() + &verdict(&rows));
    study.findings.data("decision", data(&rows));
    let memory = format!("memory of {}", scale::WITHOUT);
    let memory = study.case(&memory, || measure::hopeless_memory(scope));
    let foretold = foretold.as_deref().unwrap_or_default();
    let shown = shown(scope, &rows, foretold, memory.flatten());
    let caption = format!(
        "Every method at its default setting: ★ best, ✗ unfit, n/a for a method of which no step is stable; uncut: in one part, elsewhere a step is cut as finely as it has to be. Another step: one that is not implicit Euler's. Pictures: the same cloth on a sphere after {} s.",
        two(Real::from(measure::steps(scope)) * DT)
    );
    let listed = ("decision".to_owned(), caption, shown);
    study.findings.section.tables.push(listed);
    study.findings.section.pictures = strip(scope, &rows)?;
    let qualities = method::all().map(Method::qualities);
    study.findings.table(
        "decision-qualities",
        "What no measurement says",
        Table::of(&qualities.collect::<Vec<_>>()),
    );
    answer(&rows, &mut study.findings);
    cuts(study);
    shortened::compare(study)
}

/// The numbers as they are.
fn data(rows: &[Row]) -> Table {
    let names = COLUMNS.iter().map(|c| match c.name.contains('(') {
        true => c.name.to_owned(),
        false => format!("{} ({})", c.name, c.unit),
    });
    let mut table = Table::about("method", names);
    for row in rows {
        let values = COLUMNS.iter().map(|column| Cell::from((column.value)(row)));
        table.line(row.method, values);
    }
    table
}

/// The numbers as a reader wants them, judged; a method that `foretold` why it fails has a line of its own, with the
/// memory (B) that it takes.
#[must_use]
pub fn shown(scope: Scope, rows: &[Row], foretold: &str, memory: Option<Real>) -> Table {
    let [small, large] = measure::sides(scope).map(|side| format!("{side} × {side}"));
    let names = COLUMNS.iter().map(|column| {
        column
            .name
            .replace("small", &small)
            .replace("large", &large)
    });
    let mut table = Table::about("method", names);
    for row in rows {
        let cells = COLUMNS.iter().map(|column| match column.judged(row, rows) {
            Some((value, mark)) => Cell::Marked(column.said(row, value), mark),
            None => {
                let (why, mark) = column.absence(row);
                Cell::Marked(why.into(), mark)
            }
        });
        table.line(row.method, cells);
    }
    let hopeless = COLUMNS.iter().map(|column| match (column.name, memory) {
        ("stable up to (N/m)", _) => Cell::Marked(foretold.to_owned(), Mark::Expected),
        ("memory", Some(bytes)) => Cell::said((column.say)(bytes)),
        _ => Cell::Marked("n/a".into(), Mark::Expected),
    });
    table.line(scale::WITHOUT, hopeless);
    table
}

/// Which methods have nothing against them but their cost, which of these is best at what, and what is against the
/// others.
#[must_use]
pub fn verdict(rows: &[Row]) -> String {
    let against = |row: &Row| -> Vec<&str> {
        let unfit = |column: &&columns::Column| {
            let mark = column.judged(row, rows).map(|(_, mark)| mark);
            column.rule.is_of_quality() && mark == Some(Mark::Unfit)
        };
        let names = COLUMNS.iter().filter(unfit).map(|c| c.name);
        names.filter_map(|name| name.split(" (").next()).collect()
    };
    let (fit, unfit): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| against(row).is_empty());
    let best = |purpose: &str, column: &str, sign: Real| {
        let column = COLUMNS.iter().find(|one| one.name == column)?;
        let known = fit
            .iter()
            .filter_map(|row| Some((row.method, (column.value)(row)?)));
        let (method, value) = known.min_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)))?;
        let unit = if column.unit == "ms" { " ms" } else { "" };
        let said = (column.say)(value);
        Some(format!("{purpose}: {method} ({said}{unit}).\n"))
    };
    let best = [
        best("Cheapest step of a large sheet", "ms a step, large", 1.0),
        best("Cheapest step in contact", "ms in contact", 1.0),
        best("Largest in real time", "real time up to about", -1.0),
        best("Most accurate step", "error of a step", 1.0),
    ];
    let best: String = best.into_iter().flatten().collect();
    let names: Vec<&str> = fit.iter().map(|row| row.method).collect();
    let unfit = unfit
        .iter()
        .map(|row| format!("{} ({})", row.method, against(row).join(", ")));
    let unfit: Vec<String> = unfit.collect();
    format!(
        "{best}These are the best of those whose cloth is right: {}.\nNot so, and why: {}.",
        names.join(", "),
        unfit.join("; ")
    )
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
        let drape = &row.contact.as_ref()?.drape;
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
        background: None,
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

/// What contact costs.
fn answer(rows: &[Row], findings: &mut Findings) {
    let costs = rows.iter().filter_map(|row| {
        let ms = row.contact.as_ref()?.drape.ms?;
        Some((row.method, row.contact_cost()?, ms))
    });
    let costs: Vec<(&str, Real, Real)> = costs.collect();
    let by_cost = |a: &&(&str, Real, Real), b: &&(&str, Real, Real)| a.1.total_cmp(&b.1);
    let ends = [costs.iter().min_by(by_cost), costs.iter().max_by(by_cost)];
    let in_time = costs.iter().min_by(|a, b| a.2.total_cmp(&b.2));
    if let ([Some(least), Some(most)], Some(fastest)) = (ends, in_time) {
        let told = format!(
            "A step of a sheet on a sphere takes {} ({}) to {} ({}) times one of the same sheet hanging; the fastest in contact is {} with {} ms.",
            two(least.1),
            least.0,
            two(most.1),
            most.0,
            fastest.0,
            two(fastest.2)
        );
        findings.answer("What does contact cost?", told, None, "table-decision");
    }
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
            measure::Drape::measure(&measure::draped(scope)?, scope, method, &settings)
        },
    );
    let names = CUTS.map(|(substeps, iterations)| format!("{substeps} × {iterations}"));
    let (mut rows, mut told) = (Vec::new(), Table::about("method", names));
    let mut most_substeps = true;
    for of_method in found.chunk_by(|a, b| a.0.method == b.0.method) {
        let say = |(_, drape): &(Cut, measure::Drape)| match (drape.stretch, drape.ms) {
            (Some(stretch), Some(ms)) => {
                Cell::said(format!("{} in {} ms", percent(stretch), two(ms)))
            }
            _ => Cell::Missing,
        };
        told.line(of_method[0].0.method, of_method.iter().map(say));
        let stretches = of_method.iter().map(|(_, drape)| drape.stretch);
        most_substeps &= stretches.is_sorted_by(|a, b| a > b);
    }
    for (cut, drape) in found {
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
    let better = match most_substeps {
        true => "Substeps: the more of them, the less stretch.",
        false => "More substeps do not always leave less stretch.",
    };
    let answer = format!(
        "{better} Largest stretch of twenty sweeps a step on the sphere, as substeps × iterations, and time of a step:"
    );
    let question = "Iterations or substeps under contact?";
    study
        .findings
        .answer(question, answer, Some(told), "table-decision-substeps");
}

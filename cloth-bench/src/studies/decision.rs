//! Every method on one line: what it costs, how good it is, and where it is not to be used.

pub mod columns;
pub mod measure;
mod shortened;

use super::scale;
use crate::report::html::Picture;
use crate::report::render::View;
use crate::studies::pictures::{Shot, pictures};
use crate::studies::prelude::*;
use columns::COLUMNS;
use measure::{Contact, Cost, Step};

pub(super) const STUDY: Study = Study {
    name: "decision",
    question: "Which method for which purpose?",
    about: "ms a step and memory (peak of the process): the hanging sheet from rest, in a process of its own, median of sixteen \
        steps, or of three where a step takes longer than 0.3 s. Real time: vertices a side at 16.7 ms a step, from the power law \
        through both sizes, with an exponent of 1 in the vertices at least. Every method has one setting, but xpbd: it has as \
        many substeps as the mesh asks for, but for locks, where it has the published 20; pbd has its published 20 iterations of one substep, where `run` would give it more substeps. Error: (G − G*)/(G(x̃) − G*) after the sixteenth step of the hanging sheet, 1 at the inertial \
        prediction, 0 at the minimum; none for methods that solve another step. It is no error of the motion: that is in the study of work and precision. Stretch: largest strain of an edge after half a \
        second of hanging. Stable up to: springs of so many N/m at Δt = 1/60 s without energy of motion from nowhere, strained from those with which the springs hold more than the fall has given, as a solver does that is cut short; explicit \
        methods take the step in one part there, elsewhere they cut it as finely as they need. Locks: angle over the exact one of a \
        sheet with alternating diagonals and edges of 1e6 N/m that hangs over an edge (other patterns lock elsewhere), methods that damp next to nothing with air drag (see the study of locking): yes below 0.5, partly below 0.8, too far above 1.25. \
        Contact: the same sheet falls on a sphere, half a second; its time a step over that of hanging, pairs that cross at the \
        end, and spurious energy gain (energy from nowhere): above what start and gravity gave, over the latter, energy of strained springs included. Best: within a factor of 1.3 of the least cost or largest real time, as near as another run may come, or within a twentieth of the best of what depends on no clock, of those that are not unfit. Unfit: \
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
    study.section.leads = true;
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
        let step = study.unless_failed(&case_of(&method), step);
        let case = format!("cost of {name}");
        let cost = study.case(&case, || Cost::measure(scope, name));
        let case = format!("contact of {name}");
        let contact = study.case(&case, || Contact::measure(scope, method));
        for reason in step.iter().flat_map(|s| &s.reasons) {
            study.note(format!("{name}: {reason}."));
        }
        for reason in contact.iter().filter_map(|c| c.drape.reason.as_ref()) {
            study.note(format!("{name} in contact: {reason}."));
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
    study.section.verdict = Some(small.to_owned() + &verdict(&rows));
    study.data("decision", data(&rows));
    let memory = format!("memory of {}", scale::WITHOUT);
    let memory = study.case(&memory, || measure::hopeless_memory(scope));
    let foretold = foretold.as_deref().unwrap_or_default();
    let shown = shown(scope, &rows, foretold, memory.flatten());
    let caption = format!(
        "Every method at its default setting (xpbd: as many substeps as the mesh asks for, but the published 20 in the column of locking; pbd: one substep of 20 iterations in all columns), each column on the sheet that its head names, so a row holds several sheets. ★ best of those with nothing against their cloth, ✗ unfit, n/a for a method of which no step is stable; uncut: in one part, elsewhere a step is cut as finely as it has to be. Another step: one that is not implicit Euler's. Pictures: the same cloth on a sphere after {} s.",
        two(Real::from(measure::steps(scope)) * DT)
    );
    let listed = ("decision".to_owned(), caption, shown);
    study.section.tables.push(listed);
    study.section.pictures = strip(scope, &rows)?;
    let qualities = method::all().map(Method::qualities);
    study.table(
        "decision-qualities",
        "What no measurement says",
        Table::of(&qualities.collect::<Vec<_>>()),
    );
    answer(&rows, study);
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
pub fn shown(scope: Scope, rows: &[Row], foretold: &str, memory: Option<Real>) -> Table {
    let names = COLUMNS.iter().map(|column| column.head(scope));
    let mut table = Table::about("method", names);
    let all = rows.iter().collect_vec();
    let fit = fit(rows);
    for row in rows {
        // What is wrong has no star, however fast it is, and takes none from others.
        let is_right = against(row, &all).is_empty();
        let others = if is_right { &fit } else { &all };
        let cells = COLUMNS
            .iter()
            .map(|column| match column.judged(row, others) {
                Some((value, Mark::Best)) if !is_right => Cell::said(column.said(row, value)),
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

/// The qualities that are against a method: its cost is not.
fn against(row: &Row, rows: &[&Row]) -> Vec<&'static str> {
    let unfit = |column: &&columns::Column| {
        let mark = column.judged(row, rows).map(|(_, mark)| mark);
        column.rule.is_of_quality() && mark == Some(Mark::Unfit)
    };
    let names = COLUMNS.iter().filter(unfit).map(|c| c.name);
    names.filter_map(|name| name.split(" (").next()).collect()
}

/// The methods whose cloth is right.
fn fit(rows: &[Row]) -> Vec<&Row> {
    let all = rows.iter().collect_vec();
    let is_fit = |row: &&Row| against(row, &all).is_empty();
    rows.iter().filter(is_fit).collect()
}

/// Which methods have nothing against them but their cost, which of these is best at what, and what is against the
/// others.
pub fn verdict(rows: &[Row]) -> String {
    let (fit, all) = (fit(rows), rows.iter().collect_vec());
    let unfit = all.iter().map(|row| (row.method, against(row, &all)));
    let unfit = unfit.filter(|(_, against)| !against.is_empty());
    let best = |purpose: &str, column: &str| Some(format!("{purpose}: {}.\n", best(column, &fit)?));
    let best = [
        best("Cheapest step of a large sheet", "ms a step, large"),
        best("Cheapest step in contact", "ms in contact"),
        best("Largest in real time", "real time up to about"),
        best(
            "Nearest to the converged implicit Euler step",
            "error of a step",
        ),
    ];
    let best: String = best.into_iter().flatten().collect();
    let names: Vec<&str> = fit.iter().map(|row| row.method).collect();
    let mut unfit = unfit.map(|(method, against)| format!("{method} ({})", against.join(", ")));
    format!(
        "{best}Which is nearest to the motion in continuous time is another question, that of the study work-precision.\nThese are the best of those whose cloth is right: {}.\nNot so, and why: {}.",
        names.join(", "),
        unfit.join("; ")
    )
}

/// The method that is best in a column, or all that are too near to it to tell which is.
fn best(column: &str, rows: &[&Row]) -> Option<String> {
    let column = COLUMNS.iter().find(|one| one.name == column)?;
    let sign = if matches!(column.rule, columns::Rule::Gain) {
        -1.0
    } else {
        1.0
    };
    let known = rows
        .iter()
        .filter_map(|row| Some((row.method, (column.value)(row)?)));
    let known = known.sorted_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)));
    let known = known.collect_vec();
    let least = known.first()?.1;
    let is_near = |value: Real| (value / least).powf(sign) < column.noise();
    let unit = if column.unit == "ms" { " ms" } else { "" };
    let near = known.iter().take_while(|(_, value)| is_near(*value));
    let near = near.map(|(method, value)| format!("{method} ({}{unit})", (column.say)(*value)));
    let near = near.collect_vec();
    Some(match near.len() {
        0 | 1 => format!("{} ({}{unit})", known[0].0, (column.say)(least)),
        _ => format!("{}, within the noise of each other", near.join(" or ")),
    })
}

/// The same cloth in contact, by each method.
fn strip(scope: Scope, rows: &[Row]) -> Result<Vec<Picture>, BenchError> {
    let scene = measure::draped(scope)?;
    let seconds = Real::from(measure::steps(scope)) * scene.dt;
    let shots = rows.iter().filter_map(|row| {
        let drape = &row.contact.as_ref()?.drape;
        Shot::of(row.method.to_owned(), &drape.positions, seconds)
    });
    let bodies = scene.obstacle_surfaces(seconds);
    let of_bodies = bodies.iter().flat_map(|(positions, _)| positions);
    let view = View {
        width: 300,
        height: 260,
        bounds: Some(bounds(of_bodies.chain(&scene.start.positions).copied())),
        ..View::default()
    };
    pictures(&scene, &shots.collect_vec(), &view)
}

/// What contact costs.
fn answer(rows: &[Row], study: &mut StudyRun<'_>) {
    let costs = rows
        .iter()
        .filter_map(|row| Some((row.method, row.contact_cost()?)));
    let costs: Vec<(&str, Real)> = costs.collect();
    let by_cost = |a: &&(&str, Real), b: &&(&str, Real)| a.1.total_cmp(&b.1);
    let ends = [costs.iter().min_by(by_cost), costs.iter().max_by(by_cost)];
    let in_time = best("ms in contact", &fit(rows));
    if let ([Some(least), Some(most)], Some(fastest)) = (ends, in_time) {
        let told = format!(
            "A step of a sheet on a sphere takes {} ({}) to {} ({}) times one of the same sheet hanging; of those whose cloth is right the fastest in contact is {fastest}.",
            two(least.1),
            least.0,
            two(most.1),
            most.0
        );
        study.answer("What does contact cost?", told, None, "table-decision");
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
        if let Some(reason) = drape.reason {
            study.note(format!("{}: {reason}.", name(&cut)));
        }
        let row = CutRow {
            ms: drape.ms,
            largest_stretch: drape.stretch,
            crossings: drape.crossings,
            energy_above_what_was_given: drape.excess,
        };
        rows.push((cut, row));
    }
    let caption = "Twenty sweeps under contact, as substeps × iterations";
    study.table("decision-substeps", caption, Table::of(&rows));
    let better = match most_substeps {
        true => "Substeps: the more of them, the less stretch.",
        false => "More substeps do not always leave less stretch.",
    };
    let answer = format!(
        "{better} Largest stretch of twenty sweeps a step on the sphere, as substeps × iterations, and time of a step:"
    );
    let question = "Iterations or substeps under contact?";
    study.answer(question, answer, Some(told), "table-decision-substeps");
}

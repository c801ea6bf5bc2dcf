//! Error inside one implicit step, per iteration and per second, for every method.

pub mod variants;

use super::sheets::TestSheet;
use super::{capitalised, remark};
use crate::report::render::View;
use crate::studies::pictures::{Shot, coordinates, pictures};
use crate::studies::prelude::*;
use crate::yardstick::{Sample, StepProblem};
use variants::{cut, iterated};

pub(super) const STUDY: Study = Study {
    name: "convergence",
    question: "How fast does each method approach the implicit Euler step, and what does it give at its default setting?",
    about: "The step is the sixteenth of the hanging sheet, a quarter of a second into its fall. The reference is Newton's \
        method to rounding; the objective error is (G − G*)/(G(x̃) − G*), 1 at the inertial prediction, the gradient error ‖∇G‖/‖∇G(x̃)‖ in the norm of M⁻¹. Implicit Euler by the quasi-Newton method around multigrid and by Newton's method, PD, the sweeps of PBD and XPBD, with and without their \
        accelerations, and XPBD as one system (xpbd-direct) are one run each, measured after every iteration (the clock stands still while we measure); the table of defaults has whole steps, the last one the sheet after half a second. The second-order rules take another step and are compared over half a second only. A method that cuts the step into parts solves another problem, \
        whose solution is nearer to the motion in continuous time than implicit Euler's; its points are whole steps, one per number of parts. \
        XPBD with iterations stops at a floor: it is not a minimiser of G. With one iteration a substep PBD and XPBD are the same method. With several, PBD turns the spring constant into a projection that is right for one constraint \
        alone: where springs share vertices more iterations of one substep do not lead to k, while more substeps do; rigid projections take the edges to their rest lengths and never look at k. What surprises: with the radius that it estimates within a step, Chebyshev does little for PD; with a radius of 0.9995 given, it does much. \
        With `--scene FILE` the same is asked of a scene of your own, without contact, air and moving pins.",
    run,
};

const SIZES: [&[u32]; 2] = [&[9, 13], &[32, 64, 128]];

/// A point of a curve: size, method, what the point is the next value of, and what was reached there.
type SampleRow = (Cell, String, &'static str, Sample);

/// A method at its default setting, by size; a failure is counted, not dropped.
#[derive(Serialize, Default)]
struct DefaultRow {
    n: Cell,
    method: String,
    ms_per_step: Option<Real>,
    iterations: Option<u32>,
    objective_error: Option<Real>,
    gradient_error: Option<Real>,
    remark: String,
}

/// Objective errors that are asked for.
const WANTED: [Real; 4] = [0.1, 1e-2, 1e-3, 1e-6];

/// Columns of a size, a method, and what it takes to each of them.
fn columns(of: &str) -> Vec<String> {
    let taken = WANTED.map(|wanted| format!("{of} to {wanted:e}"));
    ["n", "method"]
        .map(str::to_owned)
        .into_iter()
        .chain(taken)
        .collect()
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let (mut samples, mut defaults) = (Vec::new(), Vec::new());
    let mut fastest = Table::about("at", WANTED.map(|wanted| format!("to {wanted:e}")));
    let (mut times, mut iterations) = (Vec::new(), Vec::new());
    let sheets = TestSheet::of_study(&study.cases, scope.of(SIZES))?;
    for sheet in &sheets {
        let TestSheet {
            name, size, scene, ..
        } = sheet;
        let mut problem = LazyCell::new(|| sheet.sixteenth_step());
        let traces = study.grid(
            iterated(scope),
            |variant| format!("{} at {name}", variant.label),
            |variant| {
                let problem = problem.get()?;
                let method = Method::find(variant.method())?;
                let mut solver = method.build(scene, &variant.settings, scene.dt)?;
                // Once to warm up: memory, and what is factorised once.
                problem.solve(&mut *solver)?;
                Ok(thinned(problem.trace(&mut *solver)?))
            },
        );
        let steps = study.grid(
            cut(scope),
            |(method, substeps)| format!("{method} with {substeps} substeps at {name}"),
            |(method, substeps)| {
                let settings = Settings::of(&format!("substeps={substeps} iterations=1"));
                let mut solver = Method::find(method)?.build(scene, &settings, scene.dt)?;
                repeated(problem.get()?, &mut *solver, 3)
            },
        );
        // After how many iterations a method first has the errors, if it gets there: the same on every machine.
        iterations.extend(traces.iter().map(|(variant, trace)| {
            let first = |wanted| trace.iter().find(|sample| sample.error.objective <= wanted);
            let counts = WANTED.map(|wanted| Some(first(wanted)?.iteration));
            (size.clone(), variant.label.clone(), counts)
        }));
        let row =
            |method: &str, setting, sample| (size.clone(), method.to_owned(), setting, sample);
        let traced = traces.iter().flat_map(|(variant, trace)| {
            trace
                .iter()
                .map(move |sample| row(&variant.label, "iterations", *sample))
        });
        let cut_up = steps
            .iter()
            .map(|((method, _), sample)| row(method, "substeps", *sample));
        let rows: Vec<SampleRow> = traced.chain(cut_up).collect();
        draw(sheet, &rows, study);
        let reached = rows.iter().map(|(_, method, setting, sample)| {
            let by = if *setting == "substeps" {
                " by substeps"
            } else {
                ""
            };
            (format!("{method}{by}"), *sample)
        });
        let mut reached = reached.collect_vec();
        for Variant { label, settings } in Variant::defaults() {
            let method = Method::find(label.split(',').next().unwrap_or_default())?;
            if !method.aims_at_implicit_euler() {
                continue;
            }
            let case = format!("{label} in whole steps, {name}");
            let sample = study.cases.case(&case, || {
                let mut solver = method.build(scene, &settings, scene.dt)?;
                repeated(problem.get()?, &mut *solver, 5)
            });
            let remark = remark(&sample);
            let sample = sample.ok();
            reached.extend(sample.map(|sample| (format!("{label}, whole steps"), sample)));
            defaults.push(DefaultRow {
                n: size.clone(),
                method: label,
                ms_per_step: sample.map(|s| 1e3 * s.seconds),
                iterations: sample.map(|s| s.iteration),
                objective_error: sample.map(|s| s.error.objective),
                gradient_error: sample.map(|s| s.error.gradient),
                remark,
            });
        }
        let points = reached
            .iter()
            .map(|(label, s)| (&**label, s.error.objective, 1e3 * s.seconds));
        let first = WANTED.map(|wanted| fastest_to(wanted, points.clone()));
        fastest.line(Cell::said(name.as_str()), first);
        // How long (ms) each takes to the errors, if it gets there.
        times.extend(reached.iter().map(|(name, _)| name).unique().map(|name| {
            let ms = WANTED.map(|wanted| {
                let own = reached.iter().filter(|(other, _)| other == name);
                let there = own.filter(|(_, sample)| sample.error.objective <= wanted);
                there
                    .map(|(_, sample)| 1e3 * sample.seconds)
                    .min_by(Real::total_cmp)
            });
            (size.clone(), name.clone(), ms)
        }));
        samples.extend(rows);
    }
    let what = sheets[0].what();
    study.answer(
        "Which method at which error and size?",
        format!(
            "The fastest to each error, (G − G*)/(G(x̃) − G*), of one implicit Euler step of {what}:"
        ),
        Some(fastest),
        &format!("figure-convergence-objective-time-{}", sheets[0].file),
    );
    study.section.rests_on = "table-convergence-defaults".into();
    let largest = sheets.last();
    study.section.verdict = largest.and_then(|largest| verdict(&defaults, &sheets, largest));
    study.table(
        "convergence-defaults",
        &format!("Every method at its default setting: one step of {what}"),
        &defaults,
    );
    let ending = format!(
        "each way takes to an objective error, from the inertial prediction: one step of {what}"
    );
    let table = Table::named(&columns("ms"), &times);
    study.table("convergence-times", &format!("How long {ending}"), table);
    let table = Table::named(&columns("iterations"), &iterations);
    study.table(
        "convergence-iterations",
        &format!("How many iterations {ending}"),
        table,
    );
    study.data(
        "convergence",
        Table::named(&["n", "method", "setting"], &samples),
    );
    let is_shown = |sheet: &&TestSheet| sheet.scene.start.positions.len() <= 64 * 64;
    half_a_second(study, sheets.iter().rfind(is_shown).unwrap_or(&sheets[0]))
}

/// Time (s) after which a step is not repeated any more.
const LONG: Real = 5.0;

/// What one whole step reaches, and the median of its times over some repetitions after a warm-up; fewer of them where
/// they take long.
fn repeated(
    problem: &StepProblem,
    solver: &mut dyn Stepper,
    repetitions: usize,
) -> Result<Sample, BenchError> {
    let (error, report, _) = problem.solve(solver)?;
    let mut seconds = Vec::with_capacity(repetitions);
    while seconds.len() < repetitions && seconds.iter().sum::<Real>() < LONG {
        seconds.push(problem.solve(solver)?.2);
    }
    Ok(Sample {
        iteration: report.iterations,
        seconds: median(&mut seconds),
        error,
    })
}

/// About twenty samples per decade of iterations, since a logarithmic axis shows no more, and those that first have the
/// errors of [`WANTED`].
fn thinned(mut trace: Vec<Sample>) -> Vec<Sample> {
    let mut next = 0.0;
    let mut wanted = WANTED.into_iter().peekable();
    trace.retain(|sample| {
        let mut keep = Real::from(sample.iteration) >= next;
        let is_reached = |wanted: &Real| sample.error.objective <= *wanted;
        while wanted.next_if(is_reached).is_some() {
            keep = true;
        }
        if keep {
            next = Real::from(sample.iteration) * 1.12;
        }
        keep
    });
    trace
}

/// Curves of one size: objective and gradient, against iterations and against time.
fn draw(sheet: &TestSheet, rows: &[SampleRow], study: &mut StudyRun<'_>) {
    type Of = fn(&Sample) -> Real;
    let objective: Of = |sample| sample.error.objective;
    let gradient: Of = |sample| sample.error.gradient;
    let iterations: Of = |sample| Real::from(sample.iteration);
    let time: Of = |sample| 1e3 * sample.seconds;
    let errors = [
        (
            "objective",
            "Objective error",
            "(G − G*)/(G(x̃) − G*) (dimensionless)",
            objective,
        ),
        (
            "gradient",
            "Gradient",
            "‖∇G‖/‖∇G(x̃)‖ (dimensionless)",
            gradient,
        ),
    ];
    let efforts = [
        ("iterations", "iterations (dimensionless)", iterations),
        ("time", "time (ms)", time),
    ];
    for ((of, title, y, error), (against, x, effort)) in iproduct!(errors, efforts) {
        let curves = curves(rows, |(_, method, setting, sample)| {
            let label = match *setting {
                "substeps" => format!("{method}, substeps"),
                _ => method.clone(),
            };
            (label, (effort(sample), error(sample)))
        });
        let title = format!("{title} against {against}, {}", sheet.which());
        let plot = Plot::new(title, Axis::log(x), Axis::log(y)).with(curves);
        study.plot(&format!("convergence-{of}-{against}-{}", sheet.file), &plot);
    }
}

/// What the table of defaults says in words: the fastest at every size, and all at the largest.
fn verdict(defaults: &[DefaultRow], sheets: &[TestSheet], sheet: &TestSheet) -> Option<String> {
    let last = &defaults.last()?.n;
    let (mut parts, mut failures) = (Vec::new(), Vec::new());
    for row in defaults.iter().filter(|row| row.n == *last) {
        let method = &row.method;
        match row.ms_per_step.zip(row.objective_error) {
            Some((ms, error)) => {
                let (ms, error) = (two(ms), significant(error, 2));
                parts.push(format!("{method} {ms} ms with an error of {error}"));
            }
            None => {
                let (failed, _) = row.remark.split_once(':').unwrap_or_default();
                failures.push(format!("{method} {failed}"));
            }
        }
    }
    parts.append(&mut failures);
    let mut fastest = sheets.iter().map(|sheet| {
        let times = defaults.iter().filter(|row| row.n == sheet.size);
        let times =
            times.filter_map(|row| Some((&*row.method, row.objective_error?, row.ms_per_step?)));
        let first = match fastest_to(1e-2, times) {
            Cell::Marked(first, _) => first,
            _ => String::new(),
        };
        format!("at {} {first}", sheet.name)
    });
    Some(format!(
        "The fastest to come within an error of 1e-2 of the converged implicit Euler step at its default: {}.\nAt the default settings one step of {} takes {}.",
        fastest.join("; "),
        sheet.which(),
        parts.join("; ")
    ))
}

/// Steps that take half a second with those of the hanging sheet.
const HALF_A_SECOND: u32 = 30;

/// PBD with the sweeps of XPBD's published setting, and XPBD with those of PBD's.
fn pbd_and_xpbd() -> Vec<Variant> {
    Variant::list(&format!(
        "{PBD_SUBSTEPS}: substeps=20 iterations=1\n{XPBD_ITERATIONS}: substeps=1 iterations=20"
    ))
}

const PBD_SUBSTEPS: &str = "pbd, 20 substeps";
const XPBD_ITERATIONS: &str = "xpbd, 20 iterations";

/// A sheet after its fall.
#[derive(Default, Serialize, Deserialize)]
struct Fallen {
    summary: run::Summary,
    /// Positions (m).
    positions: Vec<[Real; 3]>,
}

/// One line of the table.
#[derive(Serialize, Default)]
struct FallenRow {
    method: String,
    ms_per_step: Option<Real>,
    #[serde(rename = "fall of the centre of mass (m)")]
    fall: Option<Real>,
    largest_stretch: Option<Real>,
    rms_strain: Option<Real>,
    crossing_pairs: Option<usize>,
    remark: String,
}

/// Every method on the same sheet from the same start, looked at after half a second.
fn half_a_second(study: &mut StudyRun<'_>, sheet: &TestSheet) -> Result<(), BenchError> {
    let scene = &sheet.scene;
    let (which, duration) = (sheet.which(), Real::from(HALF_A_SECOND) * scene.dt);
    let mut rows: Vec<FallenRow> = Vec::new();
    let mut shots: Vec<Shot> = Vec::new();
    for variant in Variant::defaults().into_iter().chain(pbd_and_xpbd()) {
        let case = format!("{} for half a second", variant.label);
        let outcome = study.cases.case(&case, || {
            let (method, settings) = (Method::find(variant.method())?, &variant.settings);
            let (steps, dt) = (HALF_A_SECOND, scene.dt);
            let (summary, end) = run::simulate(scene, method, settings, dt, steps)?;
            let positions = coordinates(end.positions);
            Ok(Fallen { summary, positions })
        });
        let remark = remark(&outcome);
        let fallen = outcome.ok();
        let of =
            |value: fn(&run::Summary) -> Real| fallen.as_ref().map(|fallen| value(&fallen.summary));
        rows.push(FallenRow {
            method: variant.label.clone(),
            ms_per_step: of(|s| s.ms_per_step_median),
            fall: of(|s| s.center_of_mass_drop),
            largest_stretch: of(|s| s.max_stretch),
            rms_strain: of(|s| s.rms_strain),
            crossing_pairs: fallen.as_ref().and_then(|f| f.summary.intersections),
            remark,
        });
        let caption = format!("{} after {duration:.2} s", variant.label);
        shots.extend(fallen.and_then(|fallen| Shot::of(caption, &fallen.positions, duration)));
    }
    let columns = [
        "method",
        "substeps × iterations",
        "fall",
        "stretch",
        "ms a step",
    ];
    let mut pbd_or_xpbd = Table::new(&columns);
    let mut falls = Vec::new();
    let (once, cut) = ("1 × 20", "20 × 1");
    for (name, setting) in [
        ("pbd", once),
        (XPBD_ITERATIONS, once),
        (PBD_SUBSTEPS, cut),
        ("xpbd, 20 substeps", cut),
        ("implicit-euler", "converged"),
    ] {
        let row = rows.iter().find(|row| row.method == name);
        let all = row.and_then(|row| Some((row.fall?, row.largest_stretch?, row.ms_per_step?)));
        if let Some((fall, stretch, ms)) = all {
            falls.push(fall);
            let fell = format!("{fall:.3} m");
            let cells = [setting.to_owned(), fell, percent(stretch), two(ms)];
            let (method, _) = name.split_once(',').unwrap_or((name, ""));
            pbd_or_xpbd.line(method, cells.map(Cell::said));
        }
    }
    if let [pbd, xpbd, pbd_cut, xpbd_cut, exact] = falls[..] {
        let alike = match (pbd_cut / xpbd_cut - 1.0).abs() < 1e-3 {
            true => "With one iteration a substep they are the same method",
            false => "With one iteration a substep they differ here, which they should not",
        };
        let better = match (xpbd - exact).abs() < (pbd - exact).abs() {
            true => "XPBD",
            false => "PBD",
        };
        study.answer(
            "PBD or XPBD?",
            format!(
                "{alike}; with 20 iterations of one substep {better} is nearer to the converged fall. There XPBD comes to the stiffness of the material as the iterations become more, PBD does not (study of stiffness). {} after {duration:.2} s, with 20 sweeps a step:",
                capitalised(&which)
            ),
            Some(pbd_or_xpbd),
            "table-hang-half-a-second",
        );
    }
    let caption = format!(
        "After {duration:.2} s ({HALF_A_SECOND} steps) of {which}: stretch alone misleads, so the fall stands beside it"
    );
    study.table("hang-half-a-second", &caption, &rows);
    let everything = shots.iter().flat_map(|shot| &shot.positions).copied();
    let view = View {
        width: 330,
        height: 330,
        direction: Vec3::new(-0.5, 0.8, -0.3),
        bounds: Some(bounds(everything)),
        ..View::default()
    };
    let pictures = pictures(scene, &shots, &view)?;
    study.section.pictures.extend(pictures);
    Ok(())
}

//! Error inside one implicit step, per iteration and per second, for every method.

mod variants;

use super::cases::LazyCell;
use super::sheets::TestSheet;
use crate::bounds::bounds;
use crate::report::html::Picture;
use crate::report::render::{Surface, View, render_row};
use crate::run::median;
use crate::studies::prelude::*;
use crate::yardstick::{Sample, StepProblem};
use variants::{cut, iterated};

pub(super) const STUDY: Study = Study {
    name: "convergence",
    question: "How fast does each method approach the implicit Euler step, and what does it give at its default setting?",
    about: "The step is the sixteenth of the hanging sheet, a quarter of a second into its fall. The reference is Newton's \
        method to rounding; the objective error is (G − G*)/(G(x̃) − G*), 1 at the inertial prediction, the gradient error ‖∇G‖/‖∇G(x̃)‖ in the norm of M⁻¹. Implicit Euler by the quasi-Newton method around multigrid and by Newton's method, PD and the sweeps of PBD and XPBD, with and without their \
        accelerations, are one run each, measured after every iteration (the clock stands still while we measure); the table of defaults has whole steps, the last one the sheet after half a second. The second-order rules take another step and are compared over half a second only. A method that cuts the step into parts solves another problem, \
        whose solution is nearer to the motion in continuous time than implicit Euler's; its points are whole steps, one per number of parts. \
        XPBD with iterations stops at a floor: it is not a minimiser of G. PBD turns the spring constant into a projection that is right for one constraint \
        alone: where springs share vertices it is far too soft, and more sweeps do not cure that; rigid projections take the edges to their rest lengths and never look at k. What surprises: with the radius that it estimates within a step, Chebyshev does little for PD; with a radius of 0.9995 given, it does much. \
        With `--scene FILE` the same is asked of a scene of your own, without contact, air and moving pins.",
    run,
};

fn sizes(scope: Scope) -> &'static [u32] {
    scope.pick(&[17, 33], &[32, 64, 128])
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let mut samples = Table::new(&[
        "n",
        "method",
        "setting",
        "iterations",
        "seconds",
        "objective error",
        "gradient error",
    ]);
    let mut defaults = Table::new(&[
        "n",
        "method",
        "ms per step",
        "iterations",
        "objective error",
        "gradient error",
        "remark",
    ]);
    let mut fastest = Vec::new();
    let sheets = TestSheet::of_study(&mut study.cases, sizes(scope))?;
    for sheet in &sheets {
        let TestSheet {
            name, size, scene, ..
        } = sheet;
        let mut problem = LazyCell::new(|| sheet.sixteenth_step());
        let mut curves = Curves::default();
        let mut reached: Vec<(String, Sample)> = Vec::new();
        for variant in iterated(scope) {
            let label = variant.label.as_str();
            let case = format!("{label} at {name}");
            let traced = study.cases.case(&case, || {
                let problem = problem.get()?;
                let method = Method::find(variant.method())?;
                let mut solver = method.build(scene, &variant.settings, scene.dt)?;
                // Once to warm up: memory, and what is factorised once.
                problem.solve(&mut *solver)?;
                Ok(thinned(problem.trace(&mut *solver)?))
            });
            let trace = study
                .findings
                .unless_failed(&case, traced)
                .unwrap_or_default();
            for sample in &trace {
                push_sample(&mut samples, size, label, "iterations", sample);
                reached.push((label.to_owned(), *sample));
            }
            curves.add(label, &trace);
        }
        for (method, parts) in cut(scope) {
            let mut trace = Vec::new();
            for substeps in parts {
                let case = format!("{method} with {substeps} substeps at {name}");
                let sample = study.cases.case(&case, || {
                    let settings = Settings::of(&format!("substeps={substeps} iterations=1"));
                    let mut solver = Method::find(method)?.build(scene, &settings, scene.dt)?;
                    repeated(problem.get()?, &mut *solver, 3)
                });
                trace.extend(study.findings.unless_failed(&case, sample));
            }
            for sample in &trace {
                push_sample(&mut samples, size, method, "substeps", sample);
                reached.push((format!("{method} by substeps"), *sample));
            }
            curves.add(&format!("{method}, substeps"), &trace);
        }
        for method in method::all().filter(|method| method.aims_at_implicit_euler()) {
            let case = format!("{} at its default, {name}", method.name);
            let sample = study.cases.case(&case, || {
                let mut solver = method.build(scene, &Settings::default(), scene.dt)?;
                repeated(problem.get()?, &mut *solver, 5)
            });
            if let Ok(sample) = &sample {
                reached.push((method.name.to_owned(), *sample));
            }
            defaults.push(default_row(size, method, sample));
        }
        curves.draw(sheet, &mut study.findings);
        fastest.push(format!("{name}: {}", fastest_to(&reached)));
    }
    study.findings.answer(
        "Which method at which error and size?",
        format!(
            "For one implicit Euler step of {}, at {}.",
            sheets[0].what(),
            fastest.join("; at ")
        ),
    );
    study.findings.section.verdict = sheets
        .last()
        .and_then(|largest| verdict(&defaults, largest));
    study.findings.table(
        "convergence-defaults",
        &format!(
            "Every method at its default setting: one step of {}",
            sheets[0].what()
        ),
        defaults,
    );
    study.findings.data("convergence", samples);
    let of_fall = sheets
        .iter()
        .rfind(|sheet| sheet.scene.start.positions.len() <= 64 * 64);
    half_a_second(study, of_fall.unwrap_or(&sheets[0]))
}

/// Who is the first at each error, in words.
fn fastest_to(reached: &[(String, Sample)]) -> String {
    let parts = [0.1, 1e-2, 1e-3, 1e-6].map(|wanted| {
        let there = reached.iter().filter(|(_, s)| s.error.objective <= wanted);
        let first = there.min_by(|(_, a), (_, b)| a.seconds.total_cmp(&b.seconds));
        first.map_or(format!("nobody gets to {wanted:e}"), |(label, sample)| {
            format!("{label} to {wanted:e} ({:.3} ms)", 1e3 * sample.seconds)
        })
    });
    parts.join(", ")
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

fn default_row(size: &Cell, method: &Method, outcome: Result<Sample, BenchError>) -> [Cell; 7] {
    // A failure is counted, not dropped.
    let remark = outcome
        .as_ref()
        .err()
        .map_or(String::new(), BenchError::to_string);
    let sample = outcome.ok();
    [
        size.clone(),
        Cell::from(method.name),
        Cell::from(sample.map(|s| 1e3 * s.seconds)),
        Cell::from(sample.map(|s| s.iteration as usize)),
        Cell::from(sample.map(|s| s.error.objective)),
        Cell::from(sample.map(|s| s.error.gradient)),
        Cell::from(remark),
    ]
}

fn push_sample(table: &mut Table, size: &Cell, method: &str, setting: &str, sample: &Sample) {
    table.push([
        size.clone(),
        Cell::from(method),
        Cell::from(setting),
        Cell::from(sample.iteration as usize),
        Cell::from(sample.seconds),
        Cell::from(sample.error.objective),
        Cell::from(sample.error.gradient),
    ]);
}

/// About twenty samples per decade of iterations: a logarithmic axis shows no more.
fn thinned(mut trace: Vec<Sample>) -> Vec<Sample> {
    let mut next = 0.0;
    trace.retain(|sample| {
        let keep = Real::from(sample.iteration) >= next;
        if keep {
            next = Real::from(sample.iteration) * 1.12;
        }
        keep
    });
    trace
}

/// Curves of one size: objective and gradient, against iterations and against time.
#[derive(Debug, Default)]
struct Curves([Vec<Series>; 4]);

impl Curves {
    fn add(&mut self, label: &str, trace: &[Sample]) {
        let points = |x: fn(&Sample) -> Real, y: fn(&Sample) -> Real| {
            trace.iter().map(|s| (x(s), y(s))).collect()
        };
        let iterations = |s: &Sample| Real::from(s.iteration);
        let ms = |s: &Sample| 1e3 * s.seconds;
        self.0[0].push(Series::new(
            label,
            points(iterations, |s| s.error.objective),
        ));
        self.0[1].push(Series::new(label, points(ms, |s| s.error.objective)));
        self.0[2].push(Series::new(label, points(iterations, |s| s.error.gradient)));
        self.0[3].push(Series::new(label, points(ms, |s| s.error.gradient)));
    }

    fn draw(self, sheet: &TestSheet, findings: &mut Findings) {
        let kinds = [
            (
                "objective-iterations",
                "Objective error against iterations",
                "iterations (dimensionless)",
                "(G − G*)/(G(x̃) − G*)",
            ),
            (
                "objective-time",
                "Objective error against time",
                "time (ms)",
                "(G − G*)/(G(x̃) − G*)",
            ),
            (
                "gradient-iterations",
                "Gradient against iterations",
                "iterations (dimensionless)",
                "‖∇G‖/‖∇G(x̃)‖",
            ),
            (
                "gradient-time",
                "Gradient against time",
                "time (ms)",
                "‖∇G‖/‖∇G(x̃)‖",
            ),
        ];
        for ((name, title, x, y), series) in kinds.into_iter().zip(self.0) {
            findings.plot(
                &format!("convergence-{name}-{}", sheet.file),
                &Plot {
                    title: format!("{title}, {}", sheet.which()),
                    x: Axis::log(x),
                    y: Axis::log(&format!("{y} (dimensionless)")),
                    series,
                    note: String::new(),
                },
            );
        }
    }
}

/// What the table of defaults says in words, at the largest size.
fn verdict(defaults: &Table, sheet: &TestSheet) -> Option<String> {
    let last = defaults.rows.last()?.first()?.clone();
    let (mut parts, mut failures) = (Vec::new(), Vec::new());
    for row in defaults
        .rows
        .iter()
        .filter(|row| row.first() == Some(&last))
    {
        match &row[..] {
            [
                _,
                Cell::Text(method),
                Cell::Number(ms),
                _,
                Cell::Number(error),
                ..,
            ] => {
                parts.push(format!("{method} {ms:.3} ms with an error of {error:.1e}"));
            }
            [_, Cell::Text(method), ..] => failures.push(format!("{method} fails")),
            _ => {}
        }
    }
    parts.append(&mut failures);
    Some(format!(
        "At the default settings one step of {} takes {}.",
        sheet.which(),
        parts.join("; ")
    ))
}

/// Steps that take half a second with those of the hanging sheet.
const HALF_A_SECOND: u32 = 30;

/// A sheet after its fall.
#[derive(Default, Serialize, Deserialize)]
struct Fallen {
    summary: run::Summary,
    /// Positions (m).
    positions: Vec<[Real; 3]>,
}

/// Every method on the same sheet from the same start, looked at after half a second.
fn half_a_second(study: &mut StudyRun<'_>, sheet: &TestSheet) -> Result<(), BenchError> {
    let scene = &sheet.scene;
    let (which, duration) = (sheet.which(), Real::from(HALF_A_SECOND) * scene.dt);
    let mut table = Table::new(&[
        "method",
        "ms per step",
        "fall of the centre of mass (m)",
        "largest stretch",
        "rms strain",
        "crossing pairs",
        "remark",
    ]);
    let mut sheets: Vec<(&str, Vec<Vec3>)> = Vec::new();
    let mut falls: Vec<(&str, Real, Real, Real)> = Vec::new();
    for method in method::all() {
        let done = study
            .cases
            .case(&format!("{} for half a second", method.name), || {
                let (summary, end) = run::from_start(
                    scene,
                    method,
                    &Settings::default(),
                    scene.dt,
                    HALF_A_SECOND,
                    |_, _, _| Ok(()),
                )?;
                let positions = end.positions.into_iter().map(Into::into).collect();
                Ok(Fallen { summary, positions })
            });
        let remark = done
            .as_ref()
            .err()
            .map_or(String::new(), BenchError::to_string);
        let summary = done.as_ref().ok().map(|fallen| &fallen.summary);
        table.push([
            Cell::from(method.name),
            Cell::from(summary.map(|s| s.ms_per_step_median)),
            Cell::from(summary.map(|s| s.center_of_mass_drop)),
            Cell::from(summary.map(|s| s.max_stretch)),
            Cell::from(summary.map(|s| s.rms_strain)),
            Cell::from(summary.and_then(|s| s.intersections)),
            Cell::from(remark),
        ]);
        if let Some(s) = summary {
            falls.push((
                method.name,
                s.center_of_mass_drop,
                s.max_stretch,
                s.ms_per_step_median,
            ));
        }
        if let Ok(fallen) = done
            && !fallen.positions.is_empty()
        {
            sheets.push((
                method.name,
                fallen.positions.into_iter().map(Vec3::from).collect(),
            ));
        }
    }
    let of = |name: &str| {
        let fall = falls.iter().find(|(known, ..)| *known == name)?;
        Some(format!(
            "{name} {:.3} m with {:.1} % of stretch ({:.2} ms a step)",
            fall.1,
            100.0 * fall.2,
            fall.3
        ))
    };
    if let (Some(pbd), Some(xpbd), Some(exact)) = (of("pbd"), of("xpbd"), of("implicit-euler")) {
        study.findings.answer(
            "PBD or XPBD?",
            format!(
                "Both at their default of 20 sweeps, {which} falls in {duration:.2} s: {pbd}, {xpbd}; converged, {exact}. PBD's stiffness is not the one asked for (see the study of stiffness), XPBD's is as soon as the sweeps suffice."
            ),
        );
    }
    let caption = format!(
        "After {duration:.2} s ({HALF_A_SECOND} steps) of {which}: stretch alone misleads, so the fall stands beside it"
    );
    study.findings.table("hang-half-a-second", &caption, table);
    if let Some(mesh) = &scene.mesh {
        // Four to a row, all seen by one camera.
        let everything = sheets.iter().flat_map(|(_, positions)| positions).copied();
        for row in sheets.chunks(4) {
            let picture = picture(
                row,
                mesh.triangles(),
                &format!("{which} after {duration:.2} s"),
                bounds(everything.clone()),
            )?;
            study.findings.section.pictures.push(picture);
        }
    }
    Ok(())
}

fn picture(
    sheets: &[(&str, Vec<Vec3>)],
    triangles: &[[u32; 3]],
    when: &str,
    bounds: [Vec3; 2],
) -> Result<Picture, BenchError> {
    let surfaces: Vec<[Surface<'_>; 1]> = sheets
        .iter()
        .map(|(_, positions)| [Surface::cloth(positions, triangles)])
        .collect();
    let tiles: Vec<&[Surface<'_>]> = surfaces.iter().map(|s| &s[..]).collect();
    let view = View {
        width: 330,
        height: 330,
        direction: Vec3::new(-0.5, 0.8, -0.3),
        bounds: Some(bounds),
        ..View::default()
    };
    let names: Vec<&str> = sheets.iter().map(|(name, _)| *name).collect();
    Ok(Picture {
        png: render_row(&tiles, &view)?,
        caption: format!("From left to right, {when}: {}.", names.join(", ")),
    })
}

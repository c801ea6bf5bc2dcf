//! What an error in the motion costs: run time against the distance from the trajectory in continuous time.

use super::sheets::TestSheet;
use crate::report::player::{Film, Playback, Track};
use crate::studies::prelude::*;
use std::time::Instant;

pub(super) const STUDY: Study = Study {
    name: "work-precision",
    question: "What does an error in the motion cost with each method, and what does the motion look like?",
    about: "The hanging sheet for three tenths of a second from rest, with steps of 1/30 s and finer, every method at its default setting, and every acceleration, linear solver by iterations, precision and shortened solve that it has; `to 1e-1` and `10 iterations` are implicit steps cut short, by the tolerance or the number of quasi-Newton iterations. The reference is symplectic Euler with two very small steps, extrapolated; \
        the error is ‖x(T) − x_ref(T)‖_M/(√Σm · L), L the longest side of the box around the sheet at the start, 1 m. Times are of the whole fall, where that is short the median of three runs after one to warm up. Work is iterations: Newton iterations, sweeps, \
        local and global steps, or explicit substeps. Order is that of the line above it to this one. Expect first order from implicit Euler, less than second from BDF2 and the midpoint rule as long as steps do not resolve the stiff modes of the springs, a floor from methods that stop iterating before they have converged, \
        and an explicit method that is exact as soon as it is stable: its steps are short. The error against the minimiser of one step is in the studies `convergence` (every method, and the accelerations), `acceleration` (sweeps in detail), `projective` and `newton`. With `--scene FILE` the same is asked of a scene of your own, without contact, air and moving pins.",
    run,
};

/// Time of the comparison (s).
const HORIZON: Real = 0.3;
/// Steps of the reference in 1/60 s, the coarser of two.
const REFERENCE: u32 = 4096;
/// Errors that the verdict asks for (dimensionless).
const WANTED: [Real; 2] = [1e-2, 1e-3];

/// Vertices a side.
const SIDE: [u32; 2] = [9, 33];
/// Time that is played back (s).
const SHOWN: [Real; 2] = [1.0, 3.0];

/// Steps per second. The direct solver of XPBD ends where implicit Euler does, at fifty times the price: coarse steps
/// show it.
fn rates(scope: Scope, label: &str) -> &'static [u32] {
    match (scope, label) {
        (Scope::Quick, "xpbd-direct") => &[60, 120],
        (Scope::Quick, _) => &[60, 120, 240],
        (Scope::Full, "xpbd-direct") => &[30, 60, 120],
        (Scope::Full, _) => &[30, 60, 120, 240, 480, 960],
    }
}

/// What is compared: every method at its default, and what is cut short, accelerated or less precise.
fn variants() -> Vec<Variant> {
    let mut variants = Variant::defaults();
    variants.extend(Variant::list(
        "implicit-euler, to 1e-1: tolerance=1e-1
        implicit-euler, to 1e-4: tolerance=1e-4
        implicit-euler, 10 iterations: iterations=10
        bdf2, to 1e-4: tolerance=1e-4
        implicit-euler, Newton by Cholesky: linear=cholesky
        implicit-euler, conjugate gradients: linear=conjugate-gradients
        linear-implicit, conjugate gradients: linear=conjugate-gradients
        bdf2, conjugate gradients: linear=conjugate-gradients
        pbd, Chebyshev: chebyshev=auto
        pbd, SOR: relaxation=1.5
        pbd, Jacobi, Chebyshev: sweep=jacobi chebyshev=auto
        pbd, rigid: projection=1
        pbd, rigid, coarse levels: projection=1 hierarchy=10
        xpbd, 20 iterations: substeps=1 iterations=20
        xpbd, 20 iterations, SOR: substeps=1 iterations=20 relaxation=1.5
        xpbd, 20 iterations, Chebyshev: substeps=1 iterations=20 chebyshev=auto
        xpbd, 20 iterations, Jacobi, Chebyshev: substeps=1 iterations=20 sweep=jacobi chebyshev=auto
        xpbd, single precision: precision=single
        xpbd-direct, one solve: mode=stable
        pd, plain: acceleration=none
        pd, Chebyshev: acceleration=chebyshev
        pd, no coarse grid: coarse=0",
    ));
    variants
}

/// Curves are drawn in groups: methods at their defaults; accelerations and precisions of the others; implicit steps.
/// Each has a part of a name and of a title.
const GROUPS: [(&str, &str); 3] = [
    ("", "Error of the motion"),
    ("ways-", "Accelerations and precision: error"),
    (
        "implicit-",
        "Implicit steps converged and cut short, beside PD and XPBD: error",
    ),
];

/// One line of the table.
#[derive(Default, Serialize)]
struct Row {
    method: String,
    steps_per_second: u32,
    #[serde(rename = "time (ms)")]
    ms: Option<Real>,
    iterations: Option<u64>,
    error: Option<Real>,
    order: Option<Real>,
    remark: String,
}

impl Row {
    /// The groups that it belongs to.
    fn groups(&self) -> [bool; 3] {
        let name = self.method.split(',').next().unwrap_or_default();
        let is_default = name == self.method;
        let is_implicit = ["implicit-euler", "linear-implicit", "bdf2"].contains(&name);
        let is_beside = is_default && ["pd", "xpbd"].contains(&name);
        [
            is_default,
            !is_default && !is_implicit,
            is_implicit || is_beside,
        ]
    }
}

/// One run to the horizon.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Outcome {
    seconds: Real,
    iterations: u64,
    error: Real,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let sheets = TestSheet::of_study(&study.cases, &[scope.of(SIDE)])?;
    let sheet = &sheets[0];
    let scene = &sheet.scene;
    let mut reference = LazyCell::new(|| Reference::of(scene));
    let doubt = study.cases.case("reference", || Ok(reference.get()?.doubt));
    // Everything else is compared with it.
    let Some(doubt) = study.unless_failed("reference", doubt) else {
        return Ok(());
    };
    let mut rows: Vec<Row> = Vec::new();
    for variant in variants() {
        let mut before: Option<(u32, Real)> = None;
        for &rate in rates(scope, &variant.label) {
            let case = format!("{}, 1/{rate} s", variant.label);
            let outcome = study.cases.case(&case, || {
                let method = Method::find(variant.method())?;
                fall(scene, method, &variant.settings, rate, reference.get()?)
            });
            let remark = super::remark(&outcome);
            let outcome = outcome.ok();
            let order = before.zip(outcome).map(|((coarser, error), now)| {
                (error / now.error).ln() / (Real::from(rate) / Real::from(coarser)).ln()
            });
            before = outcome.map(|outcome| (rate, outcome.error));
            rows.push(Row {
                method: variant.label.clone(),
                steps_per_second: rate,
                ms: outcome.map(|o| 1e3 * o.seconds),
                iterations: outcome.map(|o| o.iterations),
                error: outcome.map(|o| o.error),
                order,
                remark,
            });
        }
    }
    for (number, (name, title)) in GROUPS.into_iter().enumerate() {
        let of_group = || rows.iter().filter(|row| row.groups()[number]);
        let step = |row: &Row| 1.0 / Real::from(row.steps_per_second);
        let by_time = of_group().filter_map(|row| Some((row, (row.ms?, row.error?))));
        let by_step = of_group().filter_map(|row| Some((row, (step(row), row.error?))));
        let of = |(row, point): (&Row, (Real, Real))| (row.method.clone(), point);
        for (against, words, x, series) in [
            ("time", "run time", "time (ms)", curves(by_time, of)),
            ("step", "the step", "step size (s)", curves(by_step, of)),
        ] {
            let y = Axis::log("error (dimensionless)").within(1e-5, 1.0);
            let title = format!("{title} against {words}, {}", sheet.which());
            let plot = Plot::new(title, Axis::log(x), y).with(series);
            study.plot(&format!("work-precision-{name}{against}"), &plot);
        }
    }
    study.table(
        "work-precision",
        &format!("Three tenths of a second of {}", sheet.what()),
        &rows,
    );
    study.note(format!(
        "The reference is known to {doubt:.1e}: the distance between its two extrapolations."
    ));
    study.section.verdict = Some(verdict(sheet, &rows));
    let at_default = rows.iter().filter(|row| row.groups()[0]);
    let of_rate = at_default.filter(|row| row.steps_per_second == 60);
    let known = of_rate.filter_map(|row| Some((row, row.error?, row.ms?)));
    let mut errors = Table::new(&["method", "error of the motion", "ms"]);
    for (row, error, ms) in known.sorted_by(|a, b| a.1.total_cmp(&b.1)) {
        let cells = [significant(error, 1), two(ms)].map(Cell::said);
        errors.line(row.method.as_str(), cells);
    }
    study.answer(
        "How far is each method from the motion in continuous time?",
        format!(
            "In the first 0.3 s of {}, every method at its default with steps of 1/60 s, which is another question than that for the implicit Euler step; distances over the size of the cloth, known to {doubt:.0e}:",
            sheet.which()
        ),
        Some(errors),
        "figure-work-precision-step",
    );
    play(study, sheet);
    Ok(())
}

/// The fastest to each error, in words.
fn verdict(sheet: &TestSheet, rows: &[Row]) -> String {
    let parts = WANTED.map(|wanted| {
        let is_good = |row: &&Row| row.error.is_some_and(|error| error <= wanted);
        let good = rows
            .iter()
            .filter(is_good)
            .filter_map(|row| Some((row, row.ms?)));
        let good = good.sorted_by(|a, b| a.1.total_cmp(&b.1));
        // Each method once.
        let fastest = good.unique_by(|(row, _)| row.method.as_str()).collect_vec();
        let Some(&(_, first)) = fastest.first() else {
            return format!("to {wanted} of the size nobody gets");
        };
        let near = fastest.iter().take_while(|(_, ms)| *ms < NOISE * first);
        let near = near.count();
        let mut named = fastest.iter().take(near.max(3)).map(|(row, ms)| {
            let rate = row.steps_per_second;
            format!("{} with 1/{rate} s ({ms:.1} ms)", row.method)
        });
        let noise = match near {
            1 => String::new(),
            _ => format!(" (the first {near} within the noise of each other)"),
        };
        format!(
            "to {wanted} of the size the fastest are {}{noise}",
            named.join(", ")
        )
    });
    format!(
        "In the first 0.3 s of {} {}.",
        sheet.which(),
        parts.join("; ")
    )
}

/// Where the sheet is at the horizon, in continuous time.
struct Reference {
    positions: Vec<Vec3>,
    /// How well that is known (dimensionless).
    doubt: Real,
}

impl Reference {
    /// Symplectic Euler with steps h, h/2 and h/4; its error is ∝ h, so 2x(h/2) − x(h) is of second order.
    fn of(scene: &Scene) -> Result<Self, BenchError> {
        let steps = (HORIZON / scene.dt).round() as u32;
        let at = |substeps: u32| {
            let settings = Settings::default().with("substeps", substeps);
            let method = Method::find("symplectic-euler")?;
            let (_, end) = run::simulate(scene, method, &settings, scene.dt, steps)?;
            Ok::<_, BenchError>(end.positions)
        };
        let [coarse, middle, fine] = [at(REFERENCE)?, at(2 * REFERENCE)?, at(4 * REFERENCE)?];
        let extrapolated = |coarse: &[Vec3], fine: &[Vec3]| -> Vec<Vec3> {
            let pairs = coarse.iter().zip(fine);
            pairs.map(|(coarse, fine)| 2.0 * fine - coarse).collect()
        };
        let (first, second) = (extrapolated(&coarse, &middle), extrapolated(&middle, &fine));
        Ok(Self {
            doubt: distance(scene, &first, &second),
            positions: second,
        })
    }
}

/// ‖x − y‖_M/(√Σm · L) with the longest side L of the box around the start.
pub fn distance(scene: &Scene, x: &[Vec3], y: &[Vec3]) -> Real {
    let masses = scene.model.particles.mass();
    let (mut squares, mut mass) = (0.0, 0.0);
    for ((x, y), m) in x.iter().zip(y).zip(masses) {
        squares += m * (x - y).norm_squared();
        mass += m;
    }
    let [low, high] = bounds(scene.start.positions.iter().copied());
    (squares / mass).sqrt() / (high - low).max()
}

fn fall(
    scene: &Scene,
    method: &Method,
    settings: &Settings,
    rate: u32,
    reference: &Reference,
) -> Result<Outcome, BenchError> {
    let dt = 1.0 / Real::from(rate);
    let steps = (HORIZON / dt).round() as u32;
    let mut times = Vec::new();
    let mut solver = method.build(scene, settings, dt)?;
    loop {
        let mut state = scene.start.clone();
        let started = Instant::now();
        let summary = run::run(scene, &mut *solver, &mut state, dt, steps, |_, _, _| Ok(()))?;
        times.push(started.elapsed().as_secs_f64());
        // The first run warms up, where there are others.
        if times.len() == 4 || times[0] > 1.0 {
            let warm = times.len().min(2) - 1;
            return Ok(Outcome {
                seconds: median(&mut times[warm..]),
                iterations: summary.iterations,
                error: distance(scene, &state.positions, &reference.positions),
            });
        }
    }
}

/// Every method at its default setting, on film.
fn play(study: &mut StudyRun<'_>, sheet: &TestSheet) {
    let scene = &sheet.scene;
    let Some(mesh) = &scene.mesh else {
        return;
    };
    let seconds = study.scope.of(SHOWN);
    let steps = (seconds / scene.dt).round() as u32;
    let mut tracks = Vec::new();
    let methods = method::all().collect_vec();
    let case_of = |method: &&Method| format!("{} on film", method.name);
    let films = study.cases.side_by_side(&methods, case_of, |method| {
        let settings = method.by_default(Settings::default());
        let mut frames = vec![scene.start.positions.clone()];
        let keep = |step: u32, state: &State, _: &_| {
            frames.extend(step.is_multiple_of(2).then(|| state.positions.clone()));
            Ok(())
        };
        run::from_start(scene, method, &settings, scene.dt, steps, keep)?;
        Ok(Film::of_cloth(mesh.triangles(), &frames))
    });
    for (method, film) in methods.iter().zip(films) {
        if let Some(film) = study.unless_failed(&case_of(method), film) {
            tracks.push(Track {
                name: method.name.to_owned(),
                surfaces: vec![film],
            });
        }
    }
    study.section.playbacks.push(Playback {
        caption: format!(
            "{} for {seconds} s, every method at its default setting with steps of {:.4} s.",
            sheet.which(),
            scene.dt
        ),
        seconds_per_frame: 2.0 * scene.dt,
        tracks,
    });
}

//! What an error in the motion costs: run time against the distance from the trajectory in continuous time.

use super::cases::LazyCell;
use super::sheets::TestSheet;
use super::{Cases, Findings, Scope, Study, StudyRun};
use crate::error::BenchError;
use crate::method::{self, Method};
use crate::report::player::{Film, Playback, Track};
use crate::report::plot::{Axis, Plot, Series};
use crate::report::table::{Cell, Table};
use crate::run::{self, median};
use crate::scene::Scene;
use crate::settings::Settings;
use cloth_core::math::{Real, Vec3};
use serde::{Deserialize, Serialize};
use std::time::Instant;

pub(super) const STUDY: Study = Study {
    name: "work-precision",
    question: "What does an error in the motion cost with each method, and what does the motion look like?",
    about: "The hanging sheet for three tenths of a second from rest, with steps of 1/30 s and finer, every method at its default setting, and every acceleration, linear solver by iterations, precision and shortened solve that it has; `to 1e-1` and `10 iterations` are implicit steps cut short, by the tolerance or the number of quasi-Newton iterations. The reference is symplectic Euler with two very small steps, extrapolated; \
        the error is ‖x(T) − x_ref(T)‖_M/(√Σm · 1 m). Times are of the whole fall, the median of three runs where these are short. Work is iterations: Newton iterations, sweeps, \
        local and global steps, or explicit substeps. Order is that of the line above it to this one. Expect first order from implicit Euler, a floor from methods that stop iterating before they have converged, \
        and an explicit method that is exact as soon as it is stable: its steps are short. The error against the minimiser of one step is in the studies `convergence` (every method, and the accelerations), `acceleration` (sweeps in detail), `projective` and `newton`. With `--scene FILE` the same is asked of a scene of your own, without contact, air and moving pins.",
    run,
};

/// Time of the comparison (s).
const HORIZON: Real = 0.3;
/// Steps of the reference in 1/60 s, the coarser of two.
const REFERENCE: u32 = 4096;
/// What the plots have along.
const TIME: &str = "time (ms)";
const STEP: &str = "step size (s)";
/// Errors that the verdict asks for (dimensionless).
const WANTED: [Real; 2] = [1e-2, 1e-3];

fn side(scope: Scope) -> u32 {
    scope.pick(13, 33)
}

/// Steps per second. The direct solver of XPBD ends where implicit Euler does, at fifty times the price: coarse steps
/// show it.
fn rates(scope: Scope, label: &str) -> &'static [u32] {
    match (scope, label) {
        (Scope::Quick, _) => &[60, 120, 240],
        (Scope::Full, "xpbd-direct") => &[30, 60, 120],
        (Scope::Full, _) => &[30, 60, 120, 240, 480, 960],
    }
}

/// Time that is played back (s).
fn shown(scope: Scope) -> Real {
    scope.pick(1.0, 3.0)
}

/// What is compared: label, method, and what is not its default.
fn variants() -> Vec<(String, &'static str, Settings)> {
    let default =
        method::all().map(|method| (method.name.to_owned(), method.name, Settings::default()));
    let set = |key: &str, value: &str| Settings::default().with(key, value);
    let iterations = set("substeps", "1").with("iterations", "20");
    let accelerated = [
        (
            "implicit-euler, to 1e-1",
            "implicit-euler",
            set("tolerance", "1e-1"),
        ),
        (
            "implicit-euler, to 1e-4",
            "implicit-euler",
            set("tolerance", "1e-4"),
        ),
        (
            "implicit-euler, 10 iterations",
            "implicit-euler",
            set("iterations", "10"),
        ),
        ("bdf2, to 1e-4", "bdf2", set("tolerance", "1e-4")),
        (
            "implicit-euler, Newton by Cholesky",
            "implicit-euler",
            set("linear", "cholesky"),
        ),
        (
            "implicit-euler, conjugate gradients",
            "implicit-euler",
            set("linear", "conjugate-gradients"),
        ),
        (
            "linear-implicit, conjugate gradients",
            "linear-implicit",
            set("linear", "conjugate-gradients"),
        ),
        (
            "bdf2, conjugate gradients",
            "bdf2",
            set("linear", "conjugate-gradients"),
        ),
        ("pbd, Chebyshev", "pbd", set("chebyshev", "auto")),
        ("pbd, SOR", "pbd", set("relaxation", "1.5")),
        (
            "pbd, Jacobi, Chebyshev",
            "pbd",
            set("sweep", "jacobi").with("chebyshev", "auto"),
        ),
        ("pbd, rigid", "pbd", set("projection", "1")),
        (
            "pbd, rigid, coarse levels",
            "pbd",
            set("projection", "1").with("hierarchy", "10"),
        ),
        ("xpbd, 20 iterations", "xpbd", iterations.clone()),
        (
            "xpbd, 20 iterations, SOR",
            "xpbd",
            iterations.clone().with("relaxation", "1.5"),
        ),
        (
            "xpbd, 20 iterations, Chebyshev",
            "xpbd",
            iterations.clone().with("chebyshev", "auto"),
        ),
        (
            "xpbd, 20 iterations, Jacobi, Chebyshev",
            "xpbd",
            iterations.with("sweep", "jacobi").with("chebyshev", "auto"),
        ),
        ("xpbd, single precision", "xpbd", set("precision", "single")),
        (
            "xpbd-direct, one solve",
            "xpbd-direct",
            set("mode", "stable"),
        ),
        ("pd, plain", "pd", set("acceleration", "none")),
        ("pd, Chebyshev", "pd", set("acceleration", "chebyshev")),
        ("pd, no coarse grid", "pd", set("coarse", "0")),
    ];
    let accelerated = accelerated.map(|(label, name, settings)| (label.to_owned(), name, settings));
    default.chain(accelerated).collect()
}

/// Curves are drawn in groups: methods at their defaults; accelerations and precisions of the others; implicit steps.
const GROUPS: usize = 3;

/// The groups of a curve.
fn groups(label: &str, is_default: bool) -> impl Iterator<Item = usize> {
    let is_of = |name: &&str| label == *name || label.starts_with(&format!("{name},"));
    let is_implicit = ["implicit-euler", "linear-implicit", "bdf2"]
        .iter()
        .any(is_of);
    let is_beside = is_default && ["pd", "xpbd"].contains(&label);
    let in_group = [
        is_default,
        !is_default && !is_implicit,
        is_implicit || is_beside,
    ];
    (0..GROUPS).filter(move |&group| in_group[group])
}

/// One run to the horizon.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Outcome {
    seconds: Real,
    iterations: u64,
    error: Real,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let StudyRun {
        scope,
        cases,
        findings,
    } = study;
    let scope = *scope;
    let sheets = TestSheet::of_study(cases, &[side(scope)])?;
    let sheet = &sheets[0];
    let scene = &sheet.scene;
    let mut reference = LazyCell::new(|| Reference::of(scene));
    let doubt = cases.case("reference", || Ok(reference.get()?.doubt));
    // Everything else is compared with it.
    let Some(doubt) = findings.unless_failed("reference", doubt) else {
        return Ok(());
    };
    let mut table = Table::new(&[
        "method",
        "steps per second",
        "time (ms)",
        "iterations",
        "error",
        "order",
        "remark",
    ]);
    // By time and by step, of each group.
    let mut series: [[Vec<Series>; 2]; GROUPS] = Default::default();
    let mut all: Vec<(String, u32, Outcome)> = Vec::new();
    let defaults = method::all().count();
    for (number, (label, name, settings)) in variants().into_iter().enumerate() {
        let mut curves = [Vec::new(), Vec::new()];
        let mut before: Option<(u32, Real)> = None;
        for &rate in rates(scope, &label) {
            let case = format!("{label}, 1/{rate} s");
            let outcome = cases.case(&case, || {
                let method = Method::find(name)?;
                fall(scene, method, &settings, rate, reference.get()?)
            });
            let remark = outcome
                .as_ref()
                .err()
                .map_or(String::new(), BenchError::to_string);
            let outcome = outcome.ok();
            let order = before.zip(outcome).map(|((coarser, error), now)| {
                (error / now.error).ln() / (Real::from(rate) / Real::from(coarser)).ln()
            });
            before = outcome.map(|outcome| (rate, outcome.error));
            table.push([
                Cell::from(label.as_str()),
                Cell::from(rate as usize),
                Cell::from(outcome.map(|o| 1e3 * o.seconds)),
                Cell::from(outcome.map(|o| o.iterations as usize)),
                Cell::from(outcome.map(|o| o.error)),
                Cell::from(order),
                Cell::from(remark),
            ]);
            if let Some(outcome) = outcome {
                curves[0].push((1e3 * outcome.seconds, outcome.error));
                curves[1].push((1.0 / Real::from(rate), outcome.error));
                all.push((label.clone(), rate, outcome));
            }
        }
        for group in groups(&label, number < defaults) {
            for (series, curve) in series[group].iter_mut().zip(&curves) {
                series.push(Series::new(&label, curve.clone()));
            }
        }
    }
    let [
        [by_time, by_step],
        [other_by_time, other_by_step],
        [implicit_by_time, implicit_by_step],
    ] = series;
    let plot = |title: &str, x: &str, series| Plot {
        title: format!("{title}, {}", sheet.which()),
        x: Axis::log(x),
        y: Axis::log("error (dimensionless)").within(1e-5, 1.0),
        series,
        note: String::new(),
    };
    for (name, title, x, series) in [
        (
            "time",
            "Error of the motion against run time",
            TIME,
            by_time,
        ),
        (
            "step",
            "Error of the motion against the step",
            STEP,
            by_step,
        ),
        (
            "ways-time",
            "Accelerations and precision: error against run time",
            TIME,
            other_by_time,
        ),
        (
            "ways-step",
            "Accelerations and precision: error against the step",
            STEP,
            other_by_step,
        ),
        (
            "implicit-time",
            "Implicit steps converged and cut short, beside PD and XPBD: error against run time",
            TIME,
            implicit_by_time,
        ),
        (
            "implicit-step",
            "Implicit steps converged and cut short, beside PD and XPBD: error against the step",
            STEP,
            implicit_by_step,
        ),
    ] {
        findings.plot(&format!("work-precision-{name}"), &plot(title, x, series));
    }
    findings.table(
        "work-precision",
        &format!("Three tenths of a second of {}", sheet.what()),
        table,
    );
    findings.section.notes.push(format!(
        "The reference is known to {doubt:.1e}: the distance between its two extrapolations."
    ));
    findings.section.verdict = Some(verdict(sheet, &all));
    play(scope, sheet, findings, cases);
    Ok(())
}

/// The fastest to each error, in words.
fn verdict(sheet: &TestSheet, all: &[(String, u32, Outcome)]) -> String {
    let parts = WANTED.map(|wanted| {
        let mut good: Vec<_> = all.iter().filter(|(.., o)| o.error <= wanted).collect();
        good.sort_by(|(.., a), (.., b)| a.seconds.total_cmp(&b.seconds));
        // Each method once.
        let mut fastest: Vec<&(String, u32, Outcome)> = Vec::new();
        for one in good {
            if fastest.len() < 3 && fastest.iter().all(|(label, ..)| *label != one.0) {
                fastest.push(one);
            }
        }
        let named = fastest.iter().map(|(label, rate, outcome)| {
            format!("{label} with 1/{rate} s ({:.1} ms)", 1e3 * outcome.seconds)
        });
        match named.collect::<Vec<_>>() {
            named if named.is_empty() => format!("to {wanted} of the size nobody gets"),
            named => format!(
                "to {wanted} of the size the fastest are {}",
                named.join(", ")
            ),
        }
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
            let (_, end) =
                run::from_start(scene, method, &settings, scene.dt, steps, |_, _, _| Ok(()))?;
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

/// ‖x − y‖_M/(√Σm · 1 m).
fn distance(scene: &Scene, x: &[Vec3], y: &[Vec3]) -> Real {
    let masses = scene.model.particles.mass();
    let (mut squares, mut mass) = (0.0, 0.0);
    for ((x, y), m) in x.iter().zip(y).zip(masses) {
        squares += m * (x - y).norm_squared();
        mass += m;
    }
    (squares / mass).sqrt()
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
        if times.len() == 3 || times[0] > 1.0 {
            return Ok(Outcome {
                seconds: median(&mut times),
                iterations: summary.iterations,
                error: distance(scene, &state.positions, &reference.positions),
            });
        }
    }
}

/// Every method at its default setting, on film.
fn play(scope: Scope, sheet: &TestSheet, findings: &mut Findings, cases: &mut Cases<'_>) {
    let scene = &sheet.scene;
    let Some(mesh) = &scene.mesh else {
        return;
    };
    let steps = (shown(scope) / scene.dt).round() as u32;
    let mut tracks = Vec::new();
    let methods: Vec<&Method> = method::all().collect();
    let case_of = |method: &&Method| format!("{} on film", method.name);
    let films = cases.side_by_side(&methods, case_of, |method| {
        let settings = Settings::default();
        let mut frames = vec![scene.start.positions.clone()];
        run::from_start(
            scene,
            method,
            &settings,
            scene.dt,
            steps,
            |step, state, _| {
                if step % 2 == 0 {
                    frames.push(state.positions.clone());
                }
                Ok(())
            },
        )?;
        Ok(Film::of_cloth(mesh.triangles(), &frames))
    });
    for (method, film) in methods.iter().zip(films) {
        if let Some(film) = findings.unless_failed(&case_of(method), film) {
            tracks.push(Track {
                name: method.name.to_owned(),
                surfaces: vec![film],
            });
        }
    }
    findings.section.playbacks.push(Playback {
        caption: format!(
            "{} for {} s, every method at its default setting with steps of {:.4} s.",
            sheet.which(),
            shown(scope),
            scene.dt
        ),
        seconds_per_frame: 2.0 * scene.dt,
        tracks,
    });
}

//! What Chebyshev extrapolation, over-relaxation and a hierarchy save, in sweeps and in time.

mod chains;
mod needed;

use super::sheets;
use crate::studies::prelude::*;
use needed::{Needed, Target, Time};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

pub(super) const STUDY: Study = Study {
    name: "acceleration",
    question: "How many sweeps, and how many milliseconds, do the accelerations save on the way to an error of 1 %?",
    about: "Three steps of 1/60 s of a sheet of 1 m × 1 m. `edge` and `corners`: rigid springs, hanging at rest by the upper edge or the two upper corners; gravity takes every vertex down by g h², the exact \
        answer is the place at rest, and the error is the root mean square of the distances to it over g h². `falling`: the scene `hang`, springs of 1e4 N/m and bending, sixteenth step; the error is \
        (G − G*)/(G(x̃) − G*) against the implicit Euler step by Newton's method. Where the sweeps allowed do not suffice, or a quarter of them shows that four times as many would not, the count goes on at the rate of the second half of those made and is \
        marked `at least`: errors fall more slowly the longer it takes. With Chebyshev a Gauss–Seidel sweep of pbd and xpbd goes there and back, counted as one. Times are the smallest of several repetitions, all methods in turn, one process; \
        beyond 200 sweeps a further sweep costs what it does on the mean of 200. The plot has chains, whose rates are known. Expect coarse levels to bring the sheet that hangs by its edge there almost at once; what surprises is that they do nothing for the one that hangs \
        by two corners, where Chebyshev helps most.",
    run,
};

/// Vertices a side.
const SIDES: [&[u32]; 2] = [&[17], &[32, 64]];
/// Sweeps before a count is extrapolated.
const MOST_SWEEPS: [u32; 2] = [4_000, 16_000];

const PROBLEMS: [&str; 3] = ["edge", "corners", "falling"];

/// The variants of solving one problem on a sheet of `n` vertices a side; the first is what the others are compared
/// with.
fn variants(problem: &str, n: u32) -> Vec<Variant> {
    let angle = FRAC_PI_2 / Real::from(n - 1);
    let relaxation = 2.0 / (1.0 + angle.sin());
    let radius = 1.0 - 2.5 / Real::from(n * n);
    let mut variants = Variant::list(&format!(
        "xpbd, coloured: substeps=1
        xpbd, in the order given: substeps=1 sweep=sequential
        xpbd, coloured, SOR: substeps=1 relaxation={relaxation}
        xpbd, coloured, Chebyshev: substeps=1 chebyshev=auto
        xpbd, coloured, Chebyshev, ρ given: substeps=1 chebyshev={radius}
        xpbd, Jacobi: substeps=1 sweep=jacobi
        xpbd, Jacobi, Chebyshev: substeps=1 sweep=jacobi chebyshev=auto"
    ));
    // Rigid projections do not look at k; PBD's and XPBD's sweeps are then the same, and the first line shows what λ
    // costs.
    if problem == "falling" {
        variants.extend(Variant::of_own());
    } else {
        variants.extend(Variant::list(&format!(
            "pbd, coloured: substeps=1 projection=1
            pbd, coloured, SOR: substeps=1 projection=1 relaxation={relaxation}
            pbd, coloured, Chebyshev: substeps=1 projection=1 chebyshev=auto
            pbd, coloured, Chebyshev, ρ given: substeps=1 projection=1 chebyshev={radius}
            pbd, Jacobi: substeps=1 projection=1 sweep=jacobi
            pbd, Jacobi, Chebyshev: substeps=1 projection=1 sweep=jacobi chebyshev=auto
            pbd, hierarchy once: substeps=1 projection=1 hierarchy=once
            pbd, hierarchy every 10: substeps=1 projection=1 hierarchy=10
            pbd, hierarchy every 40, Chebyshev: substeps=1 projection=1 hierarchy=40 chebyshev=auto"
        )));
    }
    variants
}

/// What a variant takes for a problem; the last two over the first variant.
#[derive(Clone, Default, Serialize, Deserialize)]
struct Row {
    method: String,
    sweeps: String,
    needs_sweeps: u64,
    /// Whether so many were made; else it is what the rate so far leads to.
    count: String,
    /// Time of all sweeps and of one (ms).
    ms: Real,
    ms_per_sweep: Real,
    times_fewer_sweeps: Real,
    times_faster: Real,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let points = iproduct!(scope.of(SIDES), PROBLEMS);
    let found = study.grid(
        points.map(|(&n, problem)| (problem, n)),
        |(problem, n)| format!("{problem} at {n} × {n}"),
        |&(problem, n)| measure(scope, problem, n),
    );
    let mut rows = Vec::new();
    for ((problem, n), (reached, failed)) in found {
        rows.extend(reached.into_iter().map(|row| ((problem, n), row)));
        for (variant, reason) in failed {
            let case = format!("{variant}, {problem} at {n} × {n}");
            let failed: Result<(), _> = Err(BenchError::Failed(reason));
            study.unless_failed(&case, failed);
        }
    }
    chains::run(study);
    study.section.rests_on = "table-acceleration".into();
    study.section.verdict = verdict(&rows);
    study.table(
        "acceleration",
        "Sweeps and time until a hundredth of the error of the prediction is left",
        Table::named(&["problem", "n"], &rows),
    );
    Ok(())
}

/// Those who get there, and the others with the reason.
type Counted = (Vec<Row>, Vec<(String, String)>);

/// All variants on one problem: their sweeps are counted side by side, their times interleaved.
fn measure(scope: Scope, problem: &'static str, n: u32) -> Result<Counted, BenchError> {
    let (hard, state, target) = target(problem, n)?;
    let soft = with_stiffness(&hard, sheets::STIFFNESS);
    // Hard constraints are XPBD's alone; rigid projections of PBD do not look at k.
    let scene = |variant: &Variant| match variant.method() {
        "pbd" => &soft,
        _ => &hard,
    };
    let variants = variants(problem, n);
    let most = scope.of(MOST_SWEEPS);
    let count = |variant: &Variant| needed::sweeps(scene(variant), &state, &target, variant, most);
    let counted: Vec<Result<Needed, BenchError>> = variants.par_iter().map(count).collect();
    let (mut reached, mut failed) = (Vec::new(), Vec::new());
    for (variant, needed) in variants.iter().zip(counted) {
        match needed {
            Ok(needed) => reached.push((variant, needed)),
            Err(error) => failed.push((variant.label.replacen(", ", " ", 1), error.to_string())),
        }
    }
    let times = needed::times(scene, &state, &reached)?;
    let first = reached.first().zip(times.first());
    let row = |((variant, needed), time): (&(&Variant, Needed), &Time)| {
        let (plain, plain_time) =
            first.map_or((needed, time), |((_, needed), time)| (needed, time));
        let count = ["at least", "measured"][usize::from(needed.measured)];
        Row {
            method: variant.method().to_owned(),
            sweeps: variant.what().to_owned(),
            needs_sweeps: needed.sweeps.round() as u64,
            count: count.to_owned(),
            ms: 1e3 * time.seconds,
            ms_per_sweep: 1e3 * time.per_sweep,
            times_fewer_sweeps: plain.sweeps / needed.sweeps,
            times_faster: plain_time.seconds / time.seconds,
        }
    };
    Ok((reached.iter().zip(&times).map(row).collect(), failed))
}

/// The scene, the state that the step starts from, and how far from its end some positions are.
fn target(problem: &str, n: u32) -> Result<(Scene, State, Target), BenchError> {
    if problem == "falling" {
        let settings = sheets::hanging(n, sheets::STIFFNESS);
        let scene = scene::build("hang", None, &settings)?;
        let step = sheets::sixteenth_step(&settings)?;
        let state = step.state().clone();
        return Ok((scene, state, Target::ImplicitEuler(step)));
    }
    let pins = if problem == "edge" { "none" } else { "corners" };
    let settings = Settings::of(&format!("n={n} up=y pins={pins} bending=none"));
    let mut scene = scene::build("hang", None, &settings)?;
    if problem == "edge" {
        hold_upper_row(&mut scene)?;
    }
    let scene = with_stiffness(&scene, Real::INFINITY);
    let state = scene.start.clone();
    let places: Vec<Vec3> = state.positions.clone();
    let fallen = scene.gravity.norm() * scene.dt * scene.dt;
    Ok((scene, state, Target::Places { places, fallen }))
}

/// The same scene with other springs (N/m).
fn with_stiffness(scene: &Scene, stiffness: Real) -> Scene {
    let mut scene = scene.clone();
    let springs = scene.model.springs.iter_mut();
    springs.for_each(|spring| spring.stiffness = stiffness);
    scene
}

/// Exactly one row of vertices, whatever the size.
fn hold_upper_row(scene: &mut Scene) -> Result<(), BenchError> {
    let heights = scene.start.positions.iter().map(|x| x.y);
    let top = heights.fold(Real::NEG_INFINITY, Real::max);
    for (v, x) in scene.start.positions.iter().enumerate() {
        if x.y == top {
            scene.model.particles.prescribe(v)?;
        }
    }
    Ok(())
}

/// What the table says in words, at the largest size.
fn verdict(rows: &[((&str, u32), Row)]) -> Option<String> {
    let ((_, n), _) = rows.last()?;
    let say = |row: &Row| {
        let bound = if row.count == "measured" {
            ""
        } else {
            "at least "
        };
        let Row {
            method,
            sweeps,
            needs_sweeps,
            ms,
            ..
        } = row;
        format!("{method} {sweeps} {bound}{needs_sweeps} sweeps and {ms:.1} ms")
    };
    let of_problem = |problem| {
        let rows = || {
            rows.iter()
                .filter(|(at, _)| *at == (problem, *n))
                .map(|(_, row)| row)
        };
        let best = rows().min_by(|a, b| a.ms.total_cmp(&b.ms))?;
        let plain = rows().next()?;
        let told = format!("{problem}: {}, {}", say(plain), say(best));
        Some((plain.ms / best.ms, told))
    };
    let parts: Option<Vec<_>> = PROBLEMS.into_iter().map(of_problem).collect();
    let (gains, told): (Vec<Real>, Vec<String>) = parts?.into_iter().unzip();
    let least = gains.iter().copied().fold(Real::INFINITY, Real::min);
    let most = gains.iter().copied().fold(0.0, Real::max);
    Some(format!(
        "The fastest variants come to a hundredth of the error of a sheet of {n} × {n} vertices {} to {} times as fast as plain sweeps.\nPlain sweeps and the fastest variant: {}.",
        two(least),
        two(most),
        told.join("; ")
    ))
}

//! Projective dynamics by acceleration, resolution and stiffness.

pub(super) mod factor;
pub mod swing;

use super::{capitalised, sheets};
use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "projective",
    question: "How many iterations does projective dynamics need, does their number depend on resolution and stiffness, and what do the accelerations save?",
    about: "Iterations: the step is the sixteenth of the hanging sheet, with Newton's method to rounding as the reference; the error is (G − G*)/(G(x̃) − G*), and all variants start at x̃ \
        here. The constant matrix is as stiff across a spring as along it, so what turns springs without stretching them converges slowly, and the more so the stiffer the \
        springs. Race: the same step from where each method starts by default. Fall: half a second at the default setting and at others. Swing: five seconds, after which it tells how much energy unfinished \
        iterations have lost. In both, what stands behind a number as `relative` is the number over that of converged implicit Euler in the same process, less one. \
        Factor: `fill` is numbers in the factor over numbers in the lower half of the matrix; a solve has three right-hand sides and reads the factor twice, so its limit is how long that takes at \
        the bandwidth of a triad; from the last column's number of changed rows on it is dearer to correct the factor than to make it anew. Local step: the limit is moving its bytes. \
        Iterations may be counted on any machine; times are those of this one, of a solver that has taken a step before, so that the matrix is factorised. Expect both accelerations to be many times \
        faster than the plain iteration. One reads that projective dynamics takes ten iterations whatever the mesh. That is so to an error of 1e-2; what surprises is that 1e-4 takes hundreds, and more on coarse sheets than on fine ones.",
    run,
};

/// Label and settings of each variant.
const VARIANTS: [(&str, &str); 4] = [
    ("plain", "acceleration=none"),
    ("chebyshev", "acceleration=chebyshev spectral_radius=0.9995"),
    ("quasi-newton", "coarse=0"),
    ("quasi-newton, coarse grid", ""),
];

/// Errors that are waited for.
const GOALS: [Real; 3] = [1e-2, 1e-4, 1e-6];

/// Settings of the whole fall.
const FALLS: [(&str, &str); 5] = [
    (
        "plain, 10 iterations from x̃",
        "acceleration=none iterations=10 start=predicted",
    ),
    ("no coarse grid", "coarse=0"),
    ("default", ""),
    SHORT,
    LONG,
];

/// For half a second: what falling takes.
const SHORT: (&str, &str) = (
    "6 iterations, 8 cells, 5 pairs",
    "iterations=6 coarse=8 history=5",
);

/// For seconds of motion: at 64 vertices a side within 4 % of converged implicit Euler in the largest stretch on
/// average, 1 % at the end.
const LONG: (&str, &str) = (
    "18 iterations, 16 cells, 2 pairs",
    "iterations=18 coarse=16 history=2",
);

fn sizes(scope: Scope) -> &'static [u32] {
    scope.pick(&[9, 17], &[32, 64, 128])
}

fn stiffnesses(scope: Scope) -> &'static [Real] {
    scope.pick(&[1e2, 1e4], &[1e2, 1e3, 1e4, 1e5])
}

fn most(scope: Scope) -> u32 {
    scope.pick(2_000, 3_000)
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let verdict = study.chapter("one step", |own, now| steps(scope, own, now));
    let verdict = verdict.flatten();
    study.chapter("race", |own, now| race(scope, own, now));
    study.chapter("falls", |own, now| falls(scope, own, now));
    study.chapter("swings", |own, now| swing::swings(scope, own, now));
    study.chapter("factor", |own, now| factor::costs(scope, own, now));
    study.chapter("local step", |own, now| {
        factor::local_steps(scope, own, now)
    });
    if let Some(verdict) = &verdict {
        study.answer(
            "Does the convergence of projective dynamics depend on resolution?",
            verdict.0.clone(),
            Some(verdict.1.clone()),
            "figure-projective-size",
        );
    }
    study.section.verdict = verdict.map(|(told, _)| told);
    Ok(())
}

/// A variant on one step: iterations and times to three errors, where the budget reached them.
#[derive(Default, Serialize)]
struct StepRow {
    n: u32,
    /// As it is set.
    #[serde(rename = "stiffness (N/m)")]
    stiffness: String,
    variant: &'static str,
    #[serde(rename = "iterations to 1e-2")]
    coarse: Option<u32>,
    #[serde(rename = "to 1e-4")]
    iterations: Option<u32>,
    #[serde(rename = "to 1e-6")]
    sharp: Option<u32>,
    #[serde(rename = "ms to 1e-2")]
    coarse_ms: Option<Real>,
    #[serde(rename = "ms to 1e-4")]
    ms: Option<Real>,
    #[serde(rename = "ms to 1e-6")]
    sharp_ms: Option<Real>,
    /// What it is drawn against.
    #[serde(skip)]
    x: Real,
}

/// Iterations of one step against resolution and stiffness; what they say.
fn steps(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<Option<(String, Table)>, BenchError> {
    let (mut by_size, mut by_stiffness) = (Vec::new(), Vec::new());
    for &n in sizes(scope) {
        let at = (n, sheets::STIFFNESS, Real::from(n));
        by_size.extend(one_step(scope, at, findings, progress)?);
    }
    for &k in stiffnesses(scope) {
        let at = (sizes(scope)[0], k, k);
        by_stiffness.extend(one_step(scope, at, findings, progress)?);
    }
    for (name, title, x, rows) in [
        (
            "projective-size",
            "Iterations to an error of 1e-4 against resolution, k = 1e4 N/m",
            "vertices a side (dimensionless)",
            &by_size,
        ),
        (
            "projective-stiffness",
            "Iterations to an error of 1e-4 against stiffness",
            "spring stiffness k (N/m)",
            &by_stiffness,
        ),
    ] {
        let there = rows.iter().filter_map(|row| Some((row, row.iterations?)));
        let series = curves(there, |(row, count)| {
            (row.variant, (row.x, Real::from(count)))
        });
        let iterations = Axis::log("iterations (dimensionless)");
        let plot = Plot::new(title, Axis::log(x), iterations).with(series);
        findings.plot(name, &plot);
    }
    let verdict = verdict(&by_size, &by_stiffness);
    by_size.extend(by_stiffness);
    findings.table(
        "projective-iterations",
        "Iterations of one step to three errors; empty where the budget did not reach it",
        &by_size,
    );
    Ok(verdict)
}

/// Traces every variant on one step, at so many vertices a side and N/m, drawn at `x`.
fn one_step(
    scope: Scope,
    (n, k, x): (u32, Real, Real),
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<Vec<StepRow>, BenchError> {
    let sheet = sheets::hanging(n, k);
    let scene = scene::build("hang", None, &sheet)?;
    let problem = sheets::sixteenth_step(&sheet)?;
    let mut rows = Vec::new();
    for (variant, settings) in VARIANTS {
        let case = format!("{variant}, n {n}, k {k}");
        progress(&format!("projective: {case}"));
        let most = most(scope);
        let settings = format!("{settings} iterations={most} start=predicted tolerance=1e-9");
        let settings = Settings::of(&settings);
        let mut solver = Method::find("pd")?.build(&scene, &settings, scene.dt)?;
        let traced = sheets::trace_warm(&scene, Vec3::zeros(), &problem, &mut *solver);
        let trace = findings.unless_failed(&case, traced).unwrap_or_default();
        let first = |goal: Real| trace.iter().find(|sample| sample.error.objective <= goal);
        let reached = GOALS.map(first);
        let [coarse, iterations, sharp] = reached.map(|sample| Some(sample?.iteration));
        let [coarse_ms, ms, sharp_ms] = reached.map(|sample| Some(1e3 * sample?.seconds));
        rows.push(StepRow {
            n,
            stiffness: k.to_string(),
            variant,
            coarse,
            iterations,
            sharp,
            coarse_ms,
            ms,
            sharp_ms,
            x,
        });
    }
    Ok(rows)
}

/// The error that the methods race to.
const RACE_GOAL: Real = 1e-3;

/// Label, method and settings of those who race, each from where it starts by default.
const RACERS: [(&str, &str, &str); 4] = [
    (
        "projective dynamics",
        "pd",
        "iterations=2000 tolerance=1e-9",
    ),
    (
        "quasi-Newton, multigrid",
        "implicit-euler",
        "tolerance=1e-9",
    ),
    (
        "Newton, Cholesky",
        "implicit-euler",
        "tolerance=1e-9 linear=cholesky",
    ),
    ("XPBD, one step", "xpbd", "substeps=1 iterations=2000"),
];

fn race_sizes(scope: Scope) -> &'static [u32] {
    scope.pick(&[9, 17], &[64, 128])
}

/// How one of them got there, if it did.
#[derive(Default, Serialize)]
struct RaceRow {
    n: u32,
    method: &'static str,
    #[serde(rename = "iterations to 1e-3")]
    iterations: Option<u32>,
    #[serde(rename = "ms to 1e-3")]
    ms: Option<Real>,
    times_as_long_as_projective_dynamics: Option<Real>,
}

/// Time to one error, beside implicit Euler by minimisation and XPBD.
fn race(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut rows = Vec::new();
    for &n in race_sizes(scope) {
        let settings = sheets::hanging(n, sheets::STIFFNESS);
        let scene = scene::build("hang", None, &settings)?;
        progress(&format!("projective: reference for the race, {n} × {n}"));
        let problem = sheets::sixteenth_step(&settings)?;
        let mut first = None;
        for (label, method, settings) in RACERS {
            progress(&format!("projective: {label} races, {n} × {n}"));
            let mut solver =
                Method::find(method)?.build(&scene, &Settings::of(settings), scene.dt)?;
            let traced = sheets::trace_warm(&scene, scene.gravity, &problem, &mut *solver);
            let trace = findings.unless_failed(label, traced).unwrap_or_default();
            let reached = trace.iter().find(|s| s.error.objective <= RACE_GOAL);
            let ms = reached.map(|sample| 1e3 * sample.seconds);
            first = first.or(ms);
            rows.push(RaceRow {
                n,
                method: label,
                iterations: reached.map(|sample| sample.iteration),
                ms,
                times_as_long_as_projective_dynamics: ms.zip(first).map(|(own, first)| own / first),
            });
        }
    }
    findings.table(
        "projective-race",
        "Time to (G − G*)/(G(x̃) − G*) ≤ 1e-3 in the sixteenth step of the hanging sheet; empty where a method did not get there",
        &rows,
    );
    Ok(())
}

/// Whether each variant needs as many iterations at the largest as at the smallest, in words and in numbers.
fn verdict(by_size: &[StepRow], by_stiffness: &[StepRow]) -> Option<(String, Table)> {
    let (coarse, fine) = (by_size.first()?.n, by_size.last()?.n);
    let (soft, stiff) = (by_stiffness.first()?.x, by_stiffness.last()?.x);
    let columns = [
        format!("{coarse} × {coarse}"),
        format!("{fine} × {fine}"),
        format!("{soft} N/m"),
        format!("{stiff} N/m"),
    ];
    let mut table = Table::about("variant", columns);
    for (variant, _) in VARIANTS {
        let ends = |rows: &[StepRow]| {
            let ours: Vec<&StepRow> = rows.iter().filter(|row| row.variant == variant).collect();
            [ours.first(), ours.last()].map(|row| {
                let count = row.and_then(|row| row.iterations);
                count.map_or(Cell::said("too many"), |count| {
                    Cell::said(count.to_string())
                })
            })
        };
        let cells = [ends(by_size), ends(by_stiffness)].into_iter().flatten();
        table.line(variant, cells);
    }
    let told = format!(
        "Iterations of one step to an error of 1e-4. {}.",
        independence(by_size)
    );
    Some((told, table))
}

/// Counts that differ by less than this factor from sheet to sheet do not depend on the resolution.
const SAME: Real = 1.5;

/// What the counts by size say of each variant.
fn independence(by_size: &[StepRow]) -> String {
    let judge = |variant: &str| {
        let ours = by_size.iter().filter(|row| row.variant == variant);
        let Some(counts) = ours.map(|row| row.iterations).collect::<Option<Vec<u32>>>() else {
            return "more than were tried";
        };
        let ratio = |a: Option<&u32>, b: Option<&u32>| Some(Real::from(*a?) / Real::from(*b?));
        let spread = ratio(counts.iter().max(), counts.iter().min());
        let growth = ratio(counts.last(), counts.first());
        match (spread, growth) {
            (Some(spread), _) if spread <= SAME => "independent of it",
            (_, Some(growth)) if growth > 1.0 => "more on finer sheets",
            _ => "fewer on finer sheets",
        }
    };
    let each = VARIANTS.map(|(label, _)| format!("{label}: {}", judge(label)));
    capitalised(&each.join("; "))
}

/// A fall; relative is to converged implicit Euler.
#[derive(Default, Serialize)]
struct FallRow {
    n: u32,
    setting: &'static str,
    #[serde(rename = "fall of the centre of mass (m)")]
    fall: Real,
    #[serde(rename = "relative to implicit Euler")]
    relative_fall: Real,
    largest_stretch: Real,
    #[serde(rename = "relative to implicit Euler")]
    relative_stretch: Real,
    ms_per_step: Real,
    #[serde(rename = "times faster than implicit Euler, converged")]
    times_faster: Real,
}

/// Half a second of the hanging sheet: fall and stretch beside those of converged implicit Euler.
fn falls(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut rows = Vec::new();
    for &n in sizes(scope) {
        let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
        let simulate = |method: &str, settings: &Settings| {
            let mut solver = Method::find(method)?.build(&scene, settings, scene.dt)?;
            let (mut state, dt) = (scene.start.clone(), scene.dt);
            run::run(&scene, &mut *solver, &mut state, dt, 30, |_, _, _| Ok(()))
        };
        progress(&format!(
            "projective: implicit Euler for half a second, {n} × {n}"
        ));
        let converged = simulate("implicit-euler", &Settings::default())?;
        let row = |setting, summary: &run::Summary| FallRow {
            n,
            setting,
            fall: summary.center_of_mass_drop,
            relative_fall: summary.center_of_mass_drop / converged.center_of_mass_drop - 1.0,
            largest_stretch: summary.max_stretch,
            relative_stretch: summary.max_stretch / converged.max_stretch - 1.0,
            ms_per_step: summary.ms_per_step_median,
            times_faster: converged.ms_per_step_median / summary.ms_per_step_median,
        };
        rows.push(row("implicit Euler, converged", &converged));
        for (label, settings) in FALLS {
            progress(&format!("projective: {label} for half a second, {n} × {n}"));
            let outcome = simulate("pd", &Settings::of(settings));
            let summary = findings.unless_failed(label, outcome);
            rows.extend(summary.map(|summary| row(label, &summary)));
        }
    }
    findings.table(
        "projective-fall",
        "The hanging sheet after 0.5 s (30 steps), starting horizontal, k = 1e4 N/m",
        &rows,
    );
    Ok(())
}

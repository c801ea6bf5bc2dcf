//! Projective dynamics by acceleration, resolution and stiffness.

mod factor;
mod swing;

pub use factor::{constant_matrix, local_bytes, move_bytes};

use super::sheets;
use crate::studies::prelude::*;
use crate::yardstick::Sample;

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
    scope.pick(&[17, 33], &[32, 64, 128])
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
        study.findings.answer(
            "Does the convergence of projective dynamics depend on resolution?",
            verdict.clone(),
        );
    }
    study.findings.section.verdict = verdict;
    Ok(())
}

/// Iterations of one step against resolution and stiffness; what they say.
fn steps(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<Option<String>, BenchError> {
    let mut table = Table::new(&[
        "n",
        "stiffness (N/m)",
        "variant",
        "iterations to 1e-2",
        "to 1e-4",
        "to 1e-6",
        "ms to 1e-2",
        "ms to 1e-4",
        "ms to 1e-6",
    ]);
    let mut by_size = Vec::new();
    for &n in sizes(scope) {
        let settings = sheets::hanging(n, sheets::STIFFNESS);
        let counts = one_step(scope, &settings, &mut table, findings, progress)?;
        by_size.push((Real::from(n), counts));
    }
    let mut by_stiffness = Vec::new();
    let n = sizes(scope)[0];
    for &k in stiffnesses(scope) {
        let settings = sheets::hanging(n, k);
        let counts = one_step(scope, &settings, &mut table, findings, progress)?;
        by_stiffness.push((k, counts));
    }
    findings.table(
        "projective-iterations",
        "Iterations of one step to three errors; empty where the budget did not reach it",
        table,
    );
    for (name, title, x, counts) in [
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
        let series = VARIANTS.iter().enumerate().map(|(index, (label, _))| {
            let points = counts
                .iter()
                .filter_map(|(x, counts): &(Real, [Option<u32>; 4])| {
                    counts[index].map(|count| (*x, Real::from(count)))
                });
            Series::new(label, points.collect())
        });
        findings.plot(
            name,
            &Plot {
                title: title.into(),
                x: Axis::log(x),
                y: Axis::log("iterations (dimensionless)"),
                series: series.collect(),
                note: String::new(),
            },
        );
    }
    Ok(verdict(&by_size, &by_stiffness))
}

/// Traces every variant on one step; returns the iterations of each to the second goal.
fn one_step(
    scope: Scope,
    settings: &Settings,
    table: &mut Table,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<[Option<u32>; 4], BenchError> {
    let scene = scene::build("hang", None, settings)?;
    let problem = sheets::sixteenth_step(settings)?;
    let mut counts = [None; 4];
    let (n, k) = (settings.get("n"), settings.get("stiffness"));
    for (index, (label, settings)) in VARIANTS.into_iter().enumerate() {
        let case = format!("{label}, n {}, k {}", n.unwrap_or(""), k.unwrap_or(""));
        progress(&format!("projective: {case}"));
        let most = most(scope);
        let settings = format!("{settings} iterations={most} start=predicted tolerance=1e-9");
        let settings = Settings::of(&settings);
        let mut solver = Method::find("pd")?.build(&scene, &settings, scene.dt)?;
        let traced = sheets::trace_warm(&scene, Vec3::zeros(), &problem, &mut *solver);
        let trace = findings.unless_failed(&case, traced).unwrap_or_default();
        let first = |goal: Real| trace.iter().find(|sample| sample.error.objective <= goal);
        let reached: [Option<&Sample>; 3] = GOALS.map(first);
        counts[index] = reached[1].map(|sample| sample.iteration);
        let count = |sample: Option<&Sample>| Cell::from(sample.map(|s| s.iteration as usize));
        table.push([
            Cell::from(n.unwrap_or("")),
            Cell::from(k.unwrap_or("")),
            Cell::from(label),
            count(reached[0]),
            count(reached[1]),
            count(reached[2]),
            milliseconds(reached[0]),
            milliseconds(reached[1]),
            milliseconds(reached[2]),
        ]);
    }
    Ok(counts)
}

fn milliseconds(sample: Option<&Sample>) -> Cell {
    Cell::from(sample.map(|sample| 1e3 * sample.seconds))
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
    scope.pick(&[17, 33], &[64, 128])
}

/// Time to one error, beside implicit Euler by minimisation and XPBD.
fn race(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut table = Table::new(&[
        "n",
        "method",
        "iterations to 1e-3",
        "ms to 1e-3",
        "times as long as projective dynamics",
    ]);
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
            let seconds = reached.map(|sample| sample.seconds);
            first = first.or(seconds);
            table.push([
                Cell::from(n as usize),
                Cell::from(label),
                Cell::from(reached.map(|sample| sample.iteration as usize)),
                milliseconds(reached),
                Cell::from(seconds.zip(first).map(|(own, first)| own / first)),
            ]);
        }
    }
    findings.table(
        "projective-race",
        "Time to (G − G*)/(G(x̃) − G*) ≤ 1e-3 in the sixteenth step of the hanging sheet; empty where a method did not get there",
        table,
    );
    Ok(())
}

/// Whether the plain iteration, and the default, need as many iterations at the largest as at the smallest.
fn verdict(
    by_size: &[(Real, [Option<u32>; 4])],
    by_stiffness: &[(Real, [Option<u32>; 4])],
) -> Option<String> {
    let ends = |counts: &[(Real, [Option<u32>; 4])], index: usize| {
        let (first, last) = (counts.first()?, counts.last()?);
        let show =
            |count: Option<u32>| count.map_or("not within the budget".into(), |c| c.to_string());
        Some([show(first.1[index]), show(last.1[index])])
    };
    let (sizes, stiffness) = (ends(by_size, 0)?, ends(by_stiffness, 0)?);
    let (coarse, coarse_stiffness) = (ends(by_size, 3)?, ends(by_stiffness, 3)?);
    let (from, to) = (by_size.first()?.0, by_size.last()?.0);
    let (soft, stiff) = (by_stiffness.first()?.0, by_stiffness.last()?.0);
    Some(format!(
        "Is the convergence independent of the resolution? {}. Iterations to an error of 1e-4, at {from} and at {to} vertices a side: {} and {} plain, {} and {} with the coarse grid. At {soft:e} and at {stiff:e} N/m: {} and \
         {} plain, {} and {} with the coarse grid.",
        independence(by_size),
        sizes[0],
        sizes[1],
        coarse[0],
        coarse[1],
        stiffness[0],
        stiffness[1],
        coarse_stiffness[0],
        coarse_stiffness[1],
    ))
}

/// Counts that differ by less than this factor from sheet to sheet do not depend on the resolution.
const SAME: Real = 1.5;

/// What the counts by size say of each variant.
fn independence(by_size: &[(Real, [Option<u32>; 4])]) -> String {
    let judge = |index: usize| {
        let counts: Option<Vec<u32>> = by_size.iter().map(|row| row.1[index]).collect();
        let Some(counts) = counts else {
            return "not seen within the budget";
        };
        let ratio = |a: Option<&u32>, b: Option<&u32>| Some(Real::from(*a?) / Real::from(*b?));
        let spread = ratio(counts.iter().max(), counts.iter().min());
        let growth = ratio(counts.last(), counts.first());
        match (spread, growth) {
            (Some(spread), _) if spread <= SAME => "yes",
            (_, Some(growth)) if growth > 1.0 => "no, the finest sheet takes more",
            _ => "no, the finest sheet takes fewer",
        }
    };
    let each = VARIANTS.iter().enumerate();
    let each = each.map(|(index, (label, _))| format!("{label}: {}", judge(index)));
    each.collect::<Vec<_>>().join("; ")
}

/// Half a second of the hanging sheet: fall and stretch beside those of converged implicit Euler.
fn falls(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut table = Table::new(&[
        "n",
        "setting",
        "fall of the centre of mass (m)",
        "relative to implicit Euler",
        "largest stretch",
        "relative to implicit Euler",
        "ms per step",
        "times faster than implicit Euler, converged",
    ]);
    for &n in sizes(scope) {
        let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
        let simulate = |method: &str, settings: &Settings| {
            let mut solver = Method::find(method)?.build(&scene, settings, scene.dt)?;
            let mut state = scene.start.clone();
            run::run(&scene, &mut *solver, &mut state, scene.dt, 30, |_, _, _| {
                Ok(())
            })
        };
        progress(&format!(
            "projective: implicit Euler for half a second, {n} × {n}"
        ));
        let converged = simulate("implicit-euler", &Settings::default())?;
        let mut push = |label: &str, summary: &run::Summary| {
            let fall = summary.center_of_mass_drop;
            table.push([
                Cell::from(n as usize),
                Cell::from(label),
                Cell::from(fall),
                Cell::from(fall / converged.center_of_mass_drop - 1.0),
                Cell::from(summary.max_stretch),
                Cell::from(summary.max_stretch / converged.max_stretch - 1.0),
                Cell::from(summary.ms_per_step_median),
                Cell::from(converged.ms_per_step_median / summary.ms_per_step_median),
            ]);
        };
        push("implicit Euler, converged", &converged);
        for (label, settings) in FALLS {
            progress(&format!("projective: {label} for half a second, {n} × {n}"));
            let outcome = simulate("pd", &Settings::of(settings));
            if let Some(summary) = findings.unless_failed(label, outcome) {
                push(label, &summary);
            }
        }
    }
    findings.table(
        "projective-fall",
        "The hanging sheet after 0.5 s (30 steps), starting horizontal, k = 1e4 N/m",
        table,
    );
    Ok(())
}

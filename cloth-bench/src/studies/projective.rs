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
        springs. Fall: half a second at the default setting and at others. Swing: five seconds, after which it tells how much energy unfinished \
        iterations have lost. In both, what stands behind a number as `relative` is the number over that of converged implicit Euler in the same process, less one. \
        Factor: `fill` is numbers in the factor over numbers in the lower half of the matrix; a solve has three right-hand sides and reads the factor twice, so its limit is how long that takes at \
        the bandwidth of a triad; from the last column's number of changed rows on it is dearer to correct the factor than to make it anew. Local step: the limit is moving its bytes. \
        Iterations may be counted on any machine; times are those of this one, of a solver that has taken a step before, so that the matrix is factorised. Expect both accelerations to be many times \
        faster than the plain iteration. One reads that projective dynamics takes ten iterations whatever the mesh. That is to an error of 1e-2; the table tells what 1e-4 takes, and on which sheets more.",
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

const SIZES: [&[u32]; 2] = [&[9, 17], &[32, 64, 128]];
const STIFFNESSES: [&[Real]; 2] = [&[1e2, 1e4], &[1e2, 1e3, 1e4, 1e5]];
/// Iterations of a step that is traced.
const MOST: [u32; 2] = [2_000, 3_000];

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    steps(study);
    falls(study);
    swing::swings(study);
    factor::costs(study);
    factor::local_steps(study);
    Ok(())
}

/// Iterations and times of a step to three errors, where the budget reached them.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
struct Reached {
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
}

/// Vertices a side, stiffness (N/m) and variant of a step, and how it went.
type Traced = ((u32, Real, &'static str), Reached);

/// Iterations of one step against resolution and stiffness; what they say.
fn steps(study: &mut StudyRun<'_>) {
    let (sizes, stiffnesses) = (study.scope.of(SIZES), study.scope.of(STIFFNESSES));
    let of_size = sizes.iter().map(|&n| (n, sheets::STIFFNESS));
    let by_size = traced(study, "size", of_size);
    let of_stiffness = stiffnesses.iter().map(|&k| (sizes[0], k));
    let by_stiffness = traced(study, "stiffness", of_stiffness);
    let draw = |title: &str, x: &str, rows: &[Traced], of: fn(u32, Real) -> Real| {
        let there = rows
            .iter()
            .filter_map(|(at, reached)| Some((at, reached.iterations?)));
        let series = curves(there, |(&(n, k, variant), count)| {
            (variant, (of(n, k), Real::from(count)))
        });
        let title = format!("Iterations to an error of 1e-4 against {title}");
        Plot::new(title, Axis::log(x), Axis::log("iterations (dimensionless)")).with(series)
    };
    let size = "vertices a side (dimensionless)";
    let plot = draw("resolution, k = 1e4 N/m", size, &by_size, |n, _| {
        Real::from(n)
    });
    study.plot("projective-size", &plot);
    let plot = draw(
        "stiffness",
        "spring stiffness k (N/m)",
        &by_stiffness,
        |_, k| k,
    );
    study.plot("projective-stiffness", &plot);
    if let Some((told, table)) = verdict(&by_size, &by_stiffness) {
        let question = "Does the convergence of projective dynamics depend on resolution?";
        study.section.verdict = Some(told.clone());
        study.answer(question, told, Some(table), "figure-projective-size");
    }
    let rows = by_size.into_iter().chain(by_stiffness);
    // The stiffness as it is set.
    let rows = rows.map(|((n, k, variant), reached)| ((n, k.to_string(), variant), reached));
    study.table(
        "projective-iterations",
        "Iterations of one step to three errors; empty where the budget did not reach it",
        Table::named(&["n", "stiffness (N/m)", "variant"], &rows.collect_vec()),
    );
}

/// Traces every variant on a step of some sheets, given by vertices a side and N/m.
fn traced(
    study: &mut StudyRun<'_>,
    against: &str,
    sheets: impl Iterator<Item = (u32, Real)>,
) -> Vec<Traced> {
    let most = study.scope.of(MOST);
    let points = iproduct!(sheets, VARIANTS);
    let found = study.grid(
        points.map(|((n, k), (variant, settings))| (n, k, variant, settings)),
        |(n, k, variant, _)| format!("one step by {against}: {variant}, n {n}, k {k}"),
        |&(n, k, _, settings)| {
            let sheet = sheets::hanging(n, k);
            let scene = scene::build("hang", None, &sheet)?;
            let problem = sheets::sixteenth_step(&sheet)?;
            let settings = format!("{settings} iterations={most} start=predicted tolerance=1e-9");
            let settings = Settings::of(&settings);
            let mut solver = Method::find("pd")?.build(&scene, &settings, scene.dt)?;
            let trace = sheets::trace_warm(&scene, Vec3::zeros(), &problem, &mut *solver)?;
            let first = |goal: Real| trace.iter().find(|sample| sample.error.objective <= goal);
            let reached = GOALS.map(first);
            let [coarse, iterations, sharp] = reached.map(|sample| Some(sample?.iteration));
            let [coarse_ms, ms, sharp_ms] = reached.map(|sample| Some(1e3 * sample?.seconds));
            Ok(Reached {
                coarse,
                iterations,
                sharp,
                coarse_ms,
                ms,
                sharp_ms,
            })
        },
    );
    let traced = found
        .into_iter()
        .map(|((n, k, variant, _), reached)| ((n, k, variant), reached));
    traced.collect()
}

/// Whether each variant needs as many iterations at the largest as at the smallest, in words and in numbers.
fn verdict(by_size: &[Traced], by_stiffness: &[Traced]) -> Option<(String, Table)> {
    let [coarse, fine] = [by_size.first()?, by_size.last()?].map(|((n, ..), _)| n);
    let [soft, stiff] = [by_stiffness.first()?, by_stiffness.last()?].map(|((_, k, _), _)| k);
    let columns = [
        format!("{coarse} × {coarse}"),
        format!("{fine} × {fine}"),
        format!("{soft} N/m"),
        format!("{stiff} N/m"),
    ];
    let mut table = Table::about("variant", columns);
    for (variant, _) in VARIANTS {
        let ends = |rows: &[Traced]| {
            let ours = rows
                .iter()
                .filter(|((.., of), _)| *of == variant)
                .collect_vec();
            [ours.first(), ours.last()].map(|row| {
                let count = row.and_then(|(_, reached)| reached.iterations);
                Cell::said(count.map_or("too many".into(), |count| count.to_string()))
            })
        };
        let cells = [ends(by_size), ends(by_stiffness)].into_iter().flatten();
        table.line(variant, cells);
    }
    let told = independence(by_size);
    let told = format!("Iterations of one step to an error of 1e-4. {told}.");
    Some((told, table))
}

/// Counts that differ by less than this factor from sheet to sheet are about the same.
const SAME: Real = 1.5;

/// What the counts by size say of each variant.
fn independence(by_size: &[Traced]) -> String {
    let judge = |variant: &str| {
        let ours = by_size.iter().filter(|((.., of), _)| *of == variant);
        let counts = ours.map(|(_, reached)| Some(Real::from(reached.iterations?)));
        let Some(counts) = counts.collect::<Option<Vec<Real>>>() else {
            return "more than were tried".to_owned();
        };
        let spread = counts
            .iter()
            .copied()
            .minmax_by(Real::total_cmp)
            .into_option();
        let growth = counts
            .first()
            .zip(counts.last())
            .map(|(first, last)| last / first);
        match (spread, growth) {
            (Some((least, most)), _) if most / least <= SAME => {
                format!("about as many on every sheet ({least} to {most})")
            }
            (_, Some(growth)) if growth > 1.0 => "more on finer sheets".to_owned(),
            _ => "fewer on finer sheets".to_owned(),
        }
    };
    let each = VARIANTS.map(|(label, _)| format!("{label}: {}", judge(label)));
    capitalised(&each.join("; "))
}

/// What is told of a fall; relative is to converged implicit Euler.
const FALL: [&str; 8] = [
    "n",
    "setting",
    "fall of the centre of mass (m)",
    "relative to implicit Euler",
    "largest stretch",
    "relative to implicit Euler",
    "ms per step",
    "times faster than implicit Euler, converged",
];

/// Half a second of the hanging sheet: fall and stretch beside those of converged implicit Euler.
fn falls(study: &mut StudyRun<'_>) {
    let converged = ("implicit Euler, converged", "implicit-euler", "");
    let settings = FALLS.map(|(label, settings)| (label, "pd", settings));
    let settings = [converged].into_iter().chain(settings);
    let found = study.grid(
        iproduct!(study.scope.of(SIZES).iter().copied(), settings),
        |(n, (label, ..))| format!("{label} for half a second, {n} × {n}"),
        |&(n, (_, method, settings))| {
            let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
            let (method, settings) = (Method::find(method)?, Settings::of(settings));
            let (end, _) = run::simulate(&scene, method, &settings, scene.dt, 30)?;
            Ok([
                end.center_of_mass_drop,
                end.max_stretch,
                end.ms_per_step_median,
            ])
        },
    );
    let mut rows = Vec::new();
    for of_size in found.chunk_by(|((n, _), _), ((other, _), _)| n == other) {
        let ((_, first), [right_fall, right_stretch, right_ms]) = of_size[0];
        if first != converged {
            continue; // it failed, which is a remark already
        }
        rows.extend(of_size.iter().map(|&((n, (label, ..)), found)| {
            let [fall, stretch, ms] = found;
            let fall = [fall, fall / right_fall - 1.0];
            let stretch = [stretch, stretch / right_stretch - 1.0];
            (n, label, fall, stretch, [ms, right_ms / ms])
        }));
    }
    study.table(
        "projective-fall",
        "The hanging sheet after 0.5 s (30 steps), starting horizontal, k = 1e4 N/m",
        Table::named(&FALL, &rows),
    );
}

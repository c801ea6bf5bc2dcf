//! What Chebyshev extrapolation, over-relaxation and a hierarchy save, in sweeps and in time.

mod chains;
mod needed;

use super::sheets;
use crate::studies::prelude::*;
use needed::Target;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

pub(super) const STUDY: Study = Study {
    name: "acceleration",
    question: "How many sweeps, and how many milliseconds, do the accelerations save on the way to an error of 1 %?",
    about: "Three steps of 1/60 s of a sheet of 1 m × 1 m. `edge` and `corners`: rigid springs, hanging at rest by the upper edge or the two upper corners; gravity takes every vertex down by g h², the exact \
        answer is the place at rest, and the error is the root mean square of the distances to it over g h². `falling`: the scene `hang`, springs of 1e4 N/m and bending, sixteenth step; the error is \
        (G − G*)/(G(x̃) − G*) against the implicit Euler step by Newton's method. Where the sweeps allowed do not suffice, or a quarter of them shows that four times as many would not, the count goes on at the rate of the second half of those made and is \
        marked `at least`: errors fall more slowly the longer it takes. With Chebyshev a Gauss–Seidel sweep goes there and back, counted as one. Times are the smallest of several repetitions, all methods in turn, one process; \
        beyond 200 sweeps a further sweep costs what it does on the mean of 200. The plot has chains, whose rates are known. Expect coarse levels to bring the sheet that hangs by its edge there almost at once; what surprises is that they do nothing for the one that hangs \
        by two corners, where Chebyshev helps most.",
    run,
};

/// Vertices a side.
fn sides(scope: Scope) -> &'static [u32] {
    scope.pick(&[24], &[32, 64, 128])
}

/// Sweeps before a count is extrapolated.
fn most_sweeps(scope: Scope) -> u32 {
    scope.pick(4_000, 16_000)
}

const PROBLEMS: [&str; 3] = ["edge", "corners", "falling"];

/// What to sweep with: the name in the table, the method, and what is set of it.
struct Variant {
    name: &'static str,
    method: &'static str,
    settings: Settings,
}

/// The variants of solving one problem on a sheet of `n` vertices a side; the first is what the others are compared
/// with.
fn variants(problem: &str, n: u32) -> Vec<Variant> {
    let angle = FRAC_PI_2 / Real::from(n - 1);
    let relaxation = 2.0 / (1.0 + angle.sin());
    let radius = 1.0 - 2.5 / Real::from(n * n);
    let set = |pairs: &[(&str, String)]| {
        let one_substep = Settings::default().with("substeps", 1);
        pairs
            .iter()
            .fold(one_substep, |all, (key, value)| all.with(key, value))
    };
    let jacobi = ("sweep", "jacobi".to_owned());
    let sequential = ("sweep", "sequential".to_owned());
    let auto = ("chebyshev", "auto".to_owned());
    let given = ("chebyshev", radius.to_string());
    let sor = ("relaxation", relaxation.to_string());
    let rigid = ("projection", "1".to_owned());
    let levels = |every: &str| ("hierarchy", every.to_owned());
    let of = |method, name, pairs: &[(&str, String)]| Variant {
        name,
        method,
        settings: set(pairs),
    };
    let mut variants = vec![
        of("xpbd", "coloured", &[]),
        of("xpbd", "in the order given", &[sequential]),
        of("xpbd", "coloured, SOR", std::slice::from_ref(&sor)),
        of("xpbd", "coloured, Chebyshev", std::slice::from_ref(&auto)),
        of(
            "xpbd",
            "coloured, Chebyshev, ρ given",
            std::slice::from_ref(&given),
        ),
        of("xpbd", "Jacobi", std::slice::from_ref(&jacobi)),
        of("xpbd", "Jacobi, Chebyshev", &[jacobi.clone(), auto.clone()]),
    ];
    if problem == "falling" {
        return variants;
    }
    // Rigid projections do not look at k; PBD's and XPBD's sweeps are then the same, and the first line shows what λ
    // costs.
    variants.extend([
        of("pbd", "coloured", std::slice::from_ref(&rigid)),
        of("pbd", "coloured, SOR", &[rigid.clone(), sor]),
        of("pbd", "coloured, Chebyshev", &[rigid.clone(), auto.clone()]),
        of(
            "pbd",
            "coloured, Chebyshev, ρ given",
            &[rigid.clone(), given],
        ),
        of("pbd", "Jacobi", &[rigid.clone(), jacobi.clone()]),
        of(
            "pbd",
            "Jacobi, Chebyshev",
            &[rigid.clone(), jacobi, auto.clone()],
        ),
        of("pbd", "hierarchy once", &[rigid.clone(), levels("once")]),
        of("pbd", "hierarchy every 10", &[rigid.clone(), levels("10")]),
        of(
            "pbd",
            "hierarchy every 40, Chebyshev",
            &[rigid, levels("40"), auto],
        ),
    ]);
    variants
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let StudyRun {
        scope,
        cases,
        findings,
    } = study;
    let scope = *scope;
    let mut table = Table::new(&[
        "problem",
        "n",
        "method",
        "sweeps",
        "needs sweeps",
        "count",
        "ms",
        "ms per sweep",
        "times fewer sweeps",
        "times faster",
    ]);
    for &n in sides(scope) {
        for problem in PROBLEMS {
            let name = format!("{problem} at {n} × {n}");
            let counted = cases.case(&name, || measure(scope, problem, n));
            if let Some(counted) = findings.unless_failed(&name, counted) {
                add(problem, n, &counted, &mut table, findings);
            }
        }
    }
    chains::run(scope, findings, cases);
    findings.section.verdict = verdict(&table);
    findings.table(
        "acceleration",
        "Sweeps and time until a hundredth of the error of the prediction is left",
        table,
    );
    Ok(())
}

/// What one variant takes for a problem, or why it does not get there.
#[derive(Serialize, Deserialize)]
struct Counted {
    method: String,
    name: String,
    outcome: Result<Effort, String>,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
struct Effort {
    sweeps: Real,
    /// Whether so many were made; else it is what the rate so far leads to.
    measured: bool,
    /// Time of all sweeps and of one (s).
    seconds: Real,
    per_sweep: Real,
}

/// All variants on one problem: their sweeps are counted side by side, their times interleaved.
fn measure(scope: Scope, problem: &'static str, n: u32) -> Result<Vec<Counted>, BenchError> {
    let (scene, state, target) = target(problem, n)?;
    let variants = variants(problem, n);
    let most = most_sweeps(scope);
    let count = |variant: &Variant| {
        needed::sweeps(
            &scene,
            &state,
            &target,
            variant.method,
            &variant.settings,
            most,
        )
    };
    let counted: Vec<Result<needed::Needed, BenchError>> = variants.par_iter().map(count).collect();
    let reached = variants.iter().zip(&counted);
    let runs: Vec<(&str, &Settings, u32)> = reached
        .filter_map(|(variant, needed)| {
            let sweeps = needed.as_ref().ok()?.sweeps.ceil() as u32;
            Some((variant.method, &variant.settings, sweeps))
        })
        .collect();
    let mut times = needed::times(&scene, &state, &runs)?.into_iter();
    let with_time = |needed: Result<needed::Needed, BenchError>| {
        let needed = needed.map_err(|error| error.to_string())?;
        let time = times.next().ok_or("it was not timed")?;
        Ok(Effort {
            sweeps: needed.sweeps,
            measured: needed.measured,
            seconds: time.seconds,
            per_sweep: time.per_sweep,
        })
    };
    let outcomes = counted.into_iter().map(with_time);
    Ok(variants
        .iter()
        .zip(outcomes.collect::<Vec<_>>())
        .map(|(variant, outcome)| Counted {
            method: variant.method.to_owned(),
            name: variant.name.to_owned(),
            outcome,
        })
        .collect())
}

fn add(problem: &str, n: u32, counted: &[Counted], table: &mut Table, findings: &mut Findings) {
    let mut plain = None;
    for Counted {
        method,
        name,
        outcome,
    } in counted
    {
        let case = format!("{method} {name}, {problem} at {n} × {n}");
        let outcome = outcome.clone().map_err(BenchError::Failed);
        let Some(effort) = findings.unless_failed(&case, outcome) else {
            continue;
        };
        let plain: Effort = *plain.get_or_insert(effort);
        let count = if effort.measured {
            "measured"
        } else {
            "at least"
        };
        table.push([
            Cell::from(problem),
            Cell::from(n as usize),
            Cell::from(method.as_str()),
            Cell::from(name.as_str()),
            Cell::from(effort.sweeps.round() as usize),
            Cell::from(count),
            Cell::from(1e3 * effort.seconds),
            Cell::from(1e3 * effort.per_sweep),
            Cell::from(plain.sweeps / effort.sweeps),
            Cell::from(plain.seconds / effort.seconds),
        ]);
    }
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
    for spring in &mut scene.model.springs {
        spring.stiffness = Real::INFINITY;
    }
    let state = scene.start.clone();
    let places: Vec<Vec3> = state.positions.clone();
    let fallen = scene.gravity.norm() * scene.dt * scene.dt;
    Ok((scene, state, Target::Places { places, fallen }))
}

/// Exactly one row of vertices, whatever the size.
fn hold_upper_row(scene: &mut Scene) -> Result<(), BenchError> {
    let heights = scene.start.positions.iter().map(|x| x.y);
    let top = heights.fold(Real::NEG_INFINITY, Real::max);
    for (v, x) in scene.start.positions.iter().enumerate() {
        if x.y == top {
            let held = scene.model.particles.prescribe(v);
            held?;
        }
    }
    Ok(())
}

/// What the table says in words, at the largest size.
fn verdict(table: &Table) -> Option<String> {
    let Cell::Int(n) = *table.rows.last()?.get(1)? else {
        return None;
    };
    let mut parts = Vec::new();
    for problem in PROBLEMS {
        let rows = table
            .rows
            .iter()
            .filter(|row| row[0] == Cell::from(problem) && row[1] == Cell::Int(n));
        let best = rows
            .clone()
            .min_by(|a, b| number(&a[6]).total_cmp(&number(&b[6])))?;
        let plain = rows.clone().next()?;
        let text = |cell: &Cell| match cell {
            Cell::Text(text) => text.clone(),
            _ => String::new(),
        };
        let count = |row: &[Cell]| {
            let bound = if text(&row[5]) == "measured" {
                ""
            } else {
                "at least "
            };
            format!("{bound}{} sweeps", number(&row[4]))
        };
        parts.push(format!(
            "{problem}: {} {} {} and {:.1} ms, {} {} {} and {:.1} ms",
            text(&plain[2]),
            text(&plain[3]),
            count(plain),
            number(&plain[6]),
            text(&best[2]),
            text(&best[3]),
            count(best),
            number(&best[6]),
        ));
    }
    Some(format!(
        "To a hundredth of the error, {n} × {n} vertices, plain sweeps and the fastest variant. {}.",
        parts.join("; ")
    ))
}

fn number(cell: &Cell) -> Real {
    match *cell {
        Cell::Number(number) => number,
        Cell::Int(count) => count as Real,
        _ => Real::INFINITY,
    }
}

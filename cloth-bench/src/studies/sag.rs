//! What a setting of XPBD leaves, and whether the settings guide of its chapter is right.

use crate::laws::{Evaluation, Law};
use crate::studies::prelude::*;
use cloth_core::measure::Strain;

pub(super) const STUDY: Study = Study {
    name: "sag",
    question: "How far does a rigid cloth sag under a setting of XPBD, and how many substeps does a wanted strain take?",
    about: "Table sag-chain: a chain of 20 rigid links of 1 m, masses of 1 kg and a tip of up to 1e5 kg, at rest, sequential sweeps from the support, Δt = 1/60 s split into substeps or swept again and again; \
        expected is g h² (N(N − 1)/2 + (N − 1)(M/m − 1)) for one sweep, else the fixed point of the sweeps as a matrix. Table sag-substeps: the guide, s = Δt √(g (N − 1)/(2 l ε)) rounded up, \
        for N = 24 edges of 1/24 m in a row: a chain, and a sheet of 1 m × 1 m hung by one edge or by two corners, rigid springs, with hinges of 1e-5 N·m; mean strain is the fall of the lowest vertex over 1 m. Table sag-iterations: \
        as many sweeps as the mesh has edges across, as iterations of one substep and as substeps. Expect n iterations to divide the sag by about n, n substeps by n²; what surprises is how far the worst edge of a sheet held by two corners lies above the mean that the guide promises. The state of rest is found by taking the velocities away whenever the kinetic energy has passed a maximum.",
    run,
};

/// Links of the first table.
const LINKS: u32 = 20;
/// Edges in a row of the others; each is 1/N m long.
const ROW: u32 = 24;
const SUPPORTS: [&str; 3] = ["chain", "edge", "corners"];
const SWEEPS: [&str; 2] = ["colored", "sequential"];
const GRAVITY: Real = 9.81;
const STEP: Real = 1.0 / 60.0;
/// When nothing is faster than this (m/s), it is at rest.
const STILL: Real = 1e-6;

fn tips(scope: Scope) -> &'static [Real] {
    scope.pick(&[1.0, 1e2], &[1.0, 10.0, 1e2, 1e3, 1e4, 1e5])
}

fn efforts(scope: Scope) -> &'static [u32] {
    scope.pick(&[1, 8, 64], &[1, 2, 4, 8, 16, 32, 64, 128, 256])
}

fn wanted(scope: Scope) -> &'static [Real] {
    scope.pick(&[1e-2], &[3e-2, 1e-2, 3e-3, 1e-3])
}

fn most_steps(scope: Scope) -> u32 {
    scope.pick(300, 3000)
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let holds = chains(study)?;
    let guide = substeps(study)?;
    let diameter = iterations(study)?;
    study.findings.section.verdict = Some(format!(
        "The chain sags by its law {holds}. {guide} {diameter}"
    ));
    Ok(())
}

/// The law `sag` over its parameters; how well it holds.
fn chains(study: &mut StudyRun<'_>) -> Result<String, BenchError> {
    let scope = study.scope;
    let law = Law::find("sag")?;
    let mut table = Table::new(&[
        "tip mass (kg)",
        "spent on",
        "count",
        "sag (m)",
        "expected (m)",
        "relative error",
        "by rounding",
        "mean strain",
    ]);
    let (mut worst, mut broken): (Real, u32) = (0.0, 0);
    let mut series = Vec::new();
    for spent in ["substeps", "iterations"] {
        let other = if spent == "substeps" {
            "iterations"
        } else {
            "substeps"
        };
        for &tip in tips(scope) {
            let mut curve = Vec::new();
            for &count in efforts(scope) {
                let settings = Settings::default()
                    .with("links", LINKS)
                    .with("tip_mass", tip)
                    .with(spent, count)
                    .with(other, 1);
                let case = format!("tip of {tip} kg, {count} {spent}");
                let numbers = study.cases.case(&case, || {
                    let evaluation = law.evaluate(&settings)?;
                    Ok([
                        evaluation.expected,
                        evaluation.measured,
                        evaluation.rounding,
                    ])
                });
                let Some([expected, measured, rounding]) =
                    study.findings.unless_failed(&case, numbers)
                else {
                    continue;
                };
                let evaluation = Evaluation::new(expected, measured).rounding(rounding);
                if !law.holds(&evaluation) {
                    broken += 1;
                }
                if evaluation.rounding < law.tolerance {
                    worst = worst.max(evaluation.error());
                }
                table.push([
                    Cell::from(tip),
                    Cell::from(spent),
                    Cell::from(count as usize),
                    Cell::from(evaluation.measured),
                    Cell::from(evaluation.expected),
                    Cell::from(evaluation.error()),
                    Cell::from(evaluation.rounding),
                    Cell::from(evaluation.measured / Real::from(LINKS)),
                ]);
                curve.push((Real::from(count), evaluation.measured));
            }
            series.push(Series::new(&format!("{spent}, tip of {tip} kg"), curve));
        }
    }
    let law = |&s: &u32| {
        let h = STEP / Real::from(s);
        let n = Real::from(LINKS);
        (Real::from(s), GRAVITY * h * h * n * (n - 1.0) / 2.0)
    };
    let exact = efforts(scope).iter().map(law).collect();
    series.push(Series::new("g h² N(N − 1)/2", exact).styled(Style::ExactCurve));
    study.findings.table(
        "sag-chain",
        "Sag of a hanging chain of 20 rigid links of 1 m at rest",
        table,
    );
    study.findings.plot(
        "sag-chain",
        &Plot {
            title: "Sag of a hanging chain of 20 rigid links of 1 m, Δt = 1/60 s".into(),
            x: Axis::log("sweeps per step (dimensionless)"),
            y: Axis::log("sag (m)"),
            series,
            note: "Dashed: the law for one sweep per substep and equal masses.".into(),
        },
    );
    Ok(match broken {
        0 => format!("to {worst:.1e}, or to rounding where that is more"),
        _ => format!("but in {broken} cases"),
    })
}

/// Something rigid of N edges in a row that hangs at rest, stretched out.
fn hanging(support: &str) -> Result<Scene, BenchError> {
    let mut scene = if support == "chain" {
        let settings = Settings::default()
            .with("n", ROW)
            .with("link", 1.0 / Real::from(ROW))
            .with("mass", 0.01)
            .with("tip_mass", 0.01);
        let mut scene = scene::build("chain", None, &settings)?;
        for p in &mut scene.start.positions {
            *p = Vec3::new(0.0, 0.0, -p.x);
        }
        scene
    } else {
        let pins = if support == "edge" {
            "highest"
        } else {
            "corners"
        };
        let settings = Settings::default()
            .with("n", ROW + 1)
            .with("up", "y")
            .with("pins", pins);
        scene::build("hang", None, &settings)?
    };
    for spring in &mut scene.model.springs {
        spring.stiffness = Real::INFINITY;
    }
    Ok(scene)
}

/// A hanging cloth at rest.
#[derive(Default, Serialize, Deserialize)]
struct Rest {
    /// Fall of the lowest vertex over 1 m (dimensionless).
    mean: Real,
    /// Root mean square and largest strain of the edges.
    rms: Real,
    largest: Real,
    still: bool,
}

fn rest(scope: Scope, support: &str, settings: &Settings) -> Result<Rest, BenchError> {
    let scene = hanging(support)?;
    let mut solver = Method::find("xpbd")?.build(&scene, settings, STEP)?;
    let mut state = scene.start.clone();
    let still = run::to_rest(
        &scene,
        &mut *solver,
        &mut state,
        STEP,
        most_steps(scope),
        STILL,
    )?;
    let down = scene.gravity.normalize();
    let lowest = |x: &[Vec3]| {
        x.iter()
            .map(|x| x.dot(&down))
            .fold(Real::NEG_INFINITY, Real::max)
    };
    let strain = Strain::of(&scene.model.springs, &state.positions);
    Ok(Rest {
        mean: lowest(&state.positions) - lowest(&scene.start.positions),
        rms: strain.rms,
        largest: strain.max,
        still: still.is_some(),
    })
}

/// Mean strain (dimensionless) of N links of 1/N m swept once per substep: `g h² (N − 1)/(2 l)`.
fn law(substeps: u32) -> Real {
    let h = STEP / Real::from(substeps);
    let n = Real::from(ROW);
    GRAVITY * h * h * (n - 1.0) * n / 2.0
}

fn substeps(study: &mut StudyRun<'_>) -> Result<String, BenchError> {
    let scope = study.scope;
    let mut table = Table::new(&[
        "hung by",
        "sweep",
        "wanted strain",
        "substeps",
        "law: mean strain",
        "mean strain",
        "rms strain",
        "largest strain",
        "at rest",
    ]);
    let mut largest: Vec<(&str, Real, Real)> = SUPPORTS.map(|s| (s, 0.0, 0.0)).to_vec();
    for (support, worst) in SUPPORTS.into_iter().zip(&mut largest) {
        for sweep in SWEEPS {
            for &wanted in wanted(scope) {
                // √(law at one substep/ε).
                let substeps = (law(1) / wanted).sqrt().ceil() as u32;
                let settings =
                    Settings::of(&format!("substeps={substeps} iterations=1 sweep={sweep}"));
                let case = format!("{support}, {sweep}, strain {wanted}");
                let Some(rest) = study.case(&case, || rest(scope, support, &settings)) else {
                    continue;
                };
                let expected = law(substeps);
                worst.1 = worst.1.max(rest.mean / expected);
                worst.2 = worst.2.max(rest.largest / expected);
                table.push([
                    Cell::from(support),
                    Cell::from(sweep),
                    Cell::from(wanted),
                    Cell::from(substeps as usize),
                    Cell::from(expected),
                    Cell::from(rest.mean),
                    Cell::from(rest.rms),
                    Cell::from(rest.largest),
                    Cell::from(if rest.still { "yes" } else { "no" }),
                ]);
            }
        }
    }
    study.findings.table(
        "sag-substeps",
        "The substeps that the guide gives for a wanted mean strain, and what they leave",
        table,
    );
    let parts: Vec<String> = largest
        .iter()
        .map(|(support, mean, max)| {
            format!("{support} {mean:.2} times its mean and {max:.1} times it in the worst edge")
        })
        .collect();
    Ok(format!(
        "With the substeps of the guide, at most, relative to the strain it predicts: {}.",
        parts.join(", ")
    ))
}

fn iterations(study: &mut StudyRun<'_>) -> Result<String, BenchError> {
    let scope = study.scope;
    let mut table = Table::new(&[
        "hung by",
        "sweep",
        "24 sweeps as",
        "mean strain",
        "rms strain",
        "largest strain",
        "at rest",
    ]);
    let mut of_edge = [None; 2];
    for support in SUPPORTS {
        for sweep in SWEEPS {
            let exchanges = [("iterations", "substeps"), ("substeps", "iterations")];
            for (exchange, (spent, other)) in exchanges.into_iter().enumerate() {
                let settings = Settings::default()
                    .with(spent, ROW)
                    .with(other, 1)
                    .with("sweep", sweep);
                let case = format!("{support}, {sweep}, {ROW} {spent}");
                let Some(rest) = study.case(&case, || rest(scope, support, &settings)) else {
                    continue;
                };
                if support == "edge" && sweep == "colored" {
                    of_edge[exchange] = Some(rest.mean);
                }
                table.push([
                    Cell::from(support),
                    Cell::from(sweep),
                    Cell::from(spent),
                    Cell::from(rest.mean),
                    Cell::from(rest.rms),
                    Cell::from(rest.largest),
                    Cell::from(if rest.still { "yes" } else { "no" }),
                ]);
            }
        }
    }
    study.findings.table(
        "sag-iterations",
        "As many sweeps a step as the mesh has edges across: what they leave as iterations and as substeps",
        table,
    );
    let [Some(iterations), Some(substeps)] = of_edge else {
        return Ok(String::new());
    };
    let enough = if iterations < 0.01 { "Yes" } else { "No" };
    study.findings.answer(
        "Is \"iterations = mesh diameter\" enough?",
        format!(
            "{enough}. A rigid sheet of {ROW} edges across, hung by its upper edge, is {:.2} % longer than it should be after {ROW} iterations a step of 1/60 s.",
            100.0 * iterations
        ),
    );
    let better = if substeps < iterations {
        "Substeps"
    } else {
        "Iterations"
    };
    study.findings.answer(
        "Substeps or iterations?",
        format!(
            "{better}. {ROW} sweeps a step leave {:.2} % of stretch on that sheet as iterations and {:.3} % as substeps; for one sweep a substep there is a law, so the number that a wanted strain takes can be computed beforehand.",
            100.0 * iterations,
            100.0 * substeps
        ),
    );
    Ok(format!(
        "\"Iterations = mesh diameter\" leaves a mean strain of {iterations:.2e} on the sheet hung by an edge, the same sweeps as substeps {substeps:.2e}."
    ))
}

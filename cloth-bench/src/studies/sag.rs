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
    let guide = substeps(study);
    let diameter = iterations(study);
    study.findings.section.verdict = Some(format!(
        "The chain sags by its law {holds}.\n{guide} {diameter}"
    ));
    Ok(())
}

/// What sweeps are spent on, and what the other number is one of.
const SPENT: [(&str, &str); 2] = [("substeps", "iterations"), ("iterations", "substeps")];

#[derive(Default, Serialize, Deserialize)]
struct ChainRow {
    #[serde(rename = "tip mass (kg)")]
    tip: Real,
    spent_on: String,
    count: u32,
    #[serde(rename = "sag (m)")]
    sag: Real,
    #[serde(rename = "expected (m)")]
    expected: Real,
    relative_error: Real,
    by_rounding: Real,
    mean_strain: Real,
}

/// The law `sag` over its parameters; how well it holds.
fn chains(study: &mut StudyRun<'_>) -> Result<String, BenchError> {
    let law = Law::find("sag")?;
    let (tips, efforts) = (tips(study.scope), efforts(study.scope));
    let of_effort = |(spent, tip)| efforts.iter().map(move |&count| (spent, tip, count));
    let of_spent = |spent| tips.iter().map(move |&tip| (spent, tip));
    let found = study.grid_side_by_side(
        SPENT.into_iter().flat_map(of_spent).flat_map(of_effort),
        |((spent, _), tip, count)| format!("tip of {tip} kg, {count} {spent}"),
        |&((spent, other), tip, count)| {
            let settings = format!("links={LINKS} tip_mass={tip} {spent}={count} {other}=1");
            let evaluation = law.evaluate(&Settings::of(&settings))?;
            Ok(ChainRow {
                tip,
                spent_on: spent.to_owned(),
                count,
                sag: evaluation.measured,
                expected: evaluation.expected,
                relative_error: evaluation.error(),
                by_rounding: evaluation.rounding,
                mean_strain: evaluation.measured / Real::from(LINKS),
            })
        },
    );
    let rows: Vec<ChainRow> = found.into_iter().map(|(_, row)| row).collect();
    let plot = Plot::new(
        "Sag of a hanging chain of 20 rigid links of 1 m, Δt = 1/60 s",
        Axis::log("sweeps per step (dimensionless)"),
        Axis::log("sag (m)"),
    );
    let measured = curves(&rows, |row| {
        let label = format!("{}, tip of {} kg", row.spent_on, row.tip);
        (label, (Real::from(row.count), row.sag))
    });
    let exact = |&s: &u32| {
        let h = STEP / Real::from(s);
        let n = Real::from(LINKS);
        (Real::from(s), GRAVITY * h * h * n * (n - 1.0) / 2.0)
    };
    let plot = plot
        .with(measured)
        .exact("g h² N(N − 1)/2", efforts.iter().map(exact));
    let plot = plot.note("Dashed: the law for one sweep per substep and equal masses.");
    study.findings.plot("sag-chain", &plot);
    let caption = "Sag of a hanging chain of 20 rigid links of 1 m at rest";
    study.findings.table("sag-chain", caption, Table::of(&rows));
    let evaluation =
        |row: &ChainRow| Evaluation::new(row.expected, row.sag).rounding(row.by_rounding);
    let broken = rows
        .iter()
        .filter(|row| !law.holds(&evaluation(row)))
        .count();
    let exact = rows.iter().filter(|row| row.by_rounding < law.tolerance);
    let worst = exact.map(|row| row.relative_error).fold(0.0, Real::max);
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
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
struct Rest {
    /// Fall of the lowest vertex over 1 m (dimensionless).
    mean_strain: Real,
    rms_strain: Real,
    /// Of an edge.
    largest_strain: Real,
    at_rest: bool,
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
        mean_strain: lowest(&state.positions) - lowest(&scene.start.positions),
        rms_strain: strain.rms,
        largest_strain: strain.max,
        at_rest: still.is_some(),
    })
}

/// Mean strain (dimensionless) of N links of 1/N m swept once per substep: `g h² (N − 1)/(2 l)`.
fn law(substeps: u32) -> Real {
    let h = STEP / Real::from(substeps);
    let n = Real::from(ROW);
    GRAVITY * h * h * (n - 1.0) * n / 2.0
}

/// What hangs, and how it is swept.
fn hung() -> impl Iterator<Item = (&'static str, &'static str)> {
    SUPPORTS
        .into_iter()
        .flat_map(|support| SWEEPS.map(|sweep| (support, sweep)))
}

#[derive(Default, Serialize)]
struct Guided {
    hung_by: &'static str,
    sweep: &'static str,
    wanted_strain: Real,
    substeps: u32,
    #[serde(rename = "law: mean strain")]
    expected: Real,
}

fn substeps(study: &mut StudyRun<'_>) -> String {
    let scope = study.scope;
    let guided = |(hung_by, sweep), wanted_strain: Real| {
        // √(law at one substep/ε).
        let substeps = (law(1) / wanted_strain).sqrt().ceil() as u32;
        let expected = law(substeps);
        Guided {
            hung_by,
            sweep,
            wanted_strain,
            substeps,
            expected,
        }
    };
    let rows = study.grid_side_by_side(
        hung().flat_map(|hung| {
            wanted(scope)
                .iter()
                .map(move |&wanted| guided(hung, wanted))
        }),
        |p| format!("{}, {}, strain {}", p.hung_by, p.sweep, p.wanted_strain),
        |Guided {
             hung_by,
             sweep,
             substeps,
             ..
         }| {
            let settings = format!("substeps={substeps} iterations=1 sweep={sweep}");
            rest(scope, hung_by, &Settings::of(&settings))
        },
    );
    study.findings.table(
        "sag-substeps",
        "The substeps that the guide gives for a wanted mean strain, and what they leave",
        Table::of(&rows),
    );
    let parts = SUPPORTS.map(|support| {
        let most = |strain: fn(&Rest) -> Real| {
            let ours = rows.iter().filter(|(guided, _)| guided.hung_by == support);
            ours.map(|(guided, rest)| strain(rest) / guided.expected)
                .fold(0.0, Real::max)
        };
        let (mean, max) = (
            most(|rest| rest.mean_strain),
            most(|rest| rest.largest_strain),
        );
        format!("{support} {mean:.2} times its mean and {max:.1} times it in the worst edge")
    });
    format!(
        "With the substeps of the guide, at most, relative to the strain it predicts: {}.",
        parts.join(", ")
    )
}

#[derive(Default, Serialize)]
struct Exchanged {
    hung_by: &'static str,
    sweep: &'static str,
    #[serde(rename = "24 sweeps as")]
    spent: &'static str,
    #[serde(skip)]
    other: &'static str,
}

fn iterations(study: &mut StudyRun<'_>) -> String {
    let scope = study.scope;
    let exchanged = |(hung_by, sweep)| {
        let exchanges = SPENT.into_iter().rev();
        exchanges.map(move |(spent, other)| Exchanged {
            hung_by,
            sweep,
            spent,
            other,
        })
    };
    let rows = study.grid_side_by_side(
        hung().flat_map(exchanged),
        |p| format!("{}, {}, {ROW} {}", p.hung_by, p.sweep, p.spent),
        |Exchanged {
             hung_by,
             sweep,
             spent,
             other,
         }| {
            let settings = format!("{spent}={ROW} {other}=1 sweep={sweep}");
            rest(scope, hung_by, &Settings::of(&settings))
        },
    );
    study.findings.table(
        "sag-iterations",
        "As many sweeps a step as the mesh has edges across: what they leave as iterations and as substeps",
        Table::of(&rows),
    );
    let of_edge = |spent: &str| {
        let wanted = ("edge", "colored", spent);
        let found = rows
            .iter()
            .find(|(p, _)| (p.hung_by, p.sweep, p.spent) == wanted);
        found.map(|(_, rest)| rest.mean_strain)
    };
    let (Some(iterations), Some(substeps)) = (of_edge("iterations"), of_edge("substeps")) else {
        return String::new();
    };
    let enough = if iterations < 0.01 { "Yes" } else { "No" };
    let [of_iterations, of_substeps] = [iterations, substeps].map(percent);
    study.findings.answer(
        "Is \"iterations = mesh diameter\" enough?",
        format!(
            "{enough}. A rigid sheet of {ROW} edges across, hung by its upper edge, is {of_iterations} longer than it should be after {ROW} iterations a step of 1/60 s."
        ),
        None,
        "table-sag-iterations",
    );
    let better = if substeps < iterations {
        "Substeps"
    } else {
        "Iterations"
    };
    study.findings.answer(
        "Substeps or iterations?",
        format!(
            "{better}. {ROW} sweeps a step leave {of_iterations} of stretch on that sheet as iterations and {of_substeps} as substeps; for one sweep a substep there is a law, so the number that a wanted strain takes can be computed beforehand."
        ),
        None,
        "table-sag-iterations",
    );
    format!(
        "\"Iterations = mesh diameter\" leaves a mean strain of {iterations:.2e} on the sheet hung by an edge, the same sweeps as substeps {substeps:.2e}."
    )
}

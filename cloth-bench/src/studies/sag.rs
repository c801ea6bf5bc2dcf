//! What a setting of XPBD leaves, and whether the settings guide of its chapter is right.

use crate::laws::{Evaluation, Law};
use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "sag",
    question: "How far does a rigid cloth sag under a setting of XPBD, and how many substeps does a wanted strain take?",
    about: "Table sag-chain: a chain of 20 rigid links of 1 m, masses of 1 kg and a tip of up to 1e5 kg, at rest, sequential sweeps from the support, Δt = 1/60 s split into substeps or swept again and again; \
        expected is g h² (N(N − 1)/2 + (N − 1)(M/m − 1)) for one sweep, else the fixed point of the sweeps as a matrix. Table sag-substeps: the guide, s = Δt √(g (N − 1)/(2 l ε)) rounded up, \
        for N = 24 edges of 1/24 m in a row: a chain, and a sheet of 1 m × 1 m hung by one edge or by two corners, rigid springs, with hinges of 1e-5 N·m; mean strain is the fall of the lowest vertex over 1 m. Table sag-iterations: \
        as many sweeps as the mesh has edges across, as iterations of one substep and as substeps. Expect n iterations to divide the sag by about n, n substeps by n²; what surprises is how far the worst edge of a sheet held by two corners lies above the mean, which the guide is for. The state of rest is found by taking the velocities away whenever the kinetic energy has passed a maximum.",
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

const TIPS: [&[Real]; 2] = [&[1.0, 1e2], &[1.0, 10.0, 1e2, 1e3, 1e4, 1e5]];
const EFFORTS: [&[u32]; 2] = [&[1, 8, 64], &[1, 2, 4, 8, 16, 32, 64, 128, 256]];
const WANTED: [&[Real]; 2] = [&[1e-2], &[3e-2, 1e-2, 3e-3, 1e-3]];
const MOST_STEPS: [u32; 2] = [300, 3000];

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let holds = chains(study)?;
    let (guide, of_corners) = substeps(study);
    let diameter = iterations(study, &of_corners);
    study.section.verdict = Some(format!(
        "The chain sags by its law {holds}.\n{guide} {diameter}"
    ));
    Ok(())
}

/// What sweeps are spent on.
const SPENT: [&str; 2] = ["substeps", "iterations"];

/// Of what there is one then.
fn other_than(spent: &str) -> &'static str {
    SPENT[usize::from(spent == SPENT[0])]
}

#[derive(Default, Serialize, Deserialize)]
struct Chain {
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
    let (tips, efforts) = (study.scope.of(TIPS).iter(), study.scope.of(EFFORTS).iter());
    let points = iproduct!(SPENT, tips, efforts.clone());
    let rows = study.grid_side_by_side(
        points.map(|(spent, &tip, &count)| (tip, spent, count)),
        |(tip, spent, count)| format!("tip of {tip} kg, {count} {spent}"),
        |&(tip, spent, count)| {
            let other = other_than(spent);
            let settings = format!("links={LINKS} tip_mass={tip} {spent}={count} {other}=1");
            let evaluation = law.evaluate(&Settings::of(&settings))?;
            Ok(Chain {
                sag: evaluation.measured,
                expected: evaluation.expected,
                relative_error: evaluation.error(),
                by_rounding: evaluation.rounding,
                mean_strain: evaluation.measured / Real::from(LINKS),
            })
        },
    );
    let measured = curves(&rows, |((tip, spent, count), chain)| {
        (
            format!("{spent}, tip of {tip} kg"),
            (Real::from(*count), chain.sag),
        )
    });
    let exact = |&s: &u32| {
        let h = STEP / Real::from(s);
        let n = Real::from(LINKS);
        (Real::from(s), GRAVITY * h * h * n * (n - 1.0) / 2.0)
    };
    let plot = Plot::new(
        "Sag of a hanging chain of 20 rigid links of 1 m, Δt = 1/60 s",
        Axis::log("sweeps per step (dimensionless)"),
        Axis::log("sag (m)"),
    )
    .with(measured)
    .exact("g h² N(N − 1)/2", efforts.map(exact))
    .note("Dashed: the law for one sweep per substep and equal masses.");
    study.plot("sag-chain", &plot);
    study.table(
        "sag-chain",
        "Sag of a hanging chain of 20 rigid links of 1 m at rest",
        Table::named(&["tip mass (kg)", "spent on", "count"], &rows),
    );
    let chains = || rows.iter().map(|(_, chain)| chain);
    let is_broken = |chain: &&Chain| {
        let evaluation = Evaluation::new(chain.expected, chain.sag).rounding(chain.by_rounding);
        !law.holds(&evaluation)
    };
    let exact = chains().filter(|chain| chain.by_rounding < law.tolerance);
    let worst = exact.map(|chain| chain.relative_error).fold(0.0, Real::max);
    Ok(match chains().filter(is_broken).count() {
        0 => format!("to {worst:.1e}, or to rounding where that is more"),
        broken => format!("but in {broken} cases"),
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
    let most = scope.of(MOST_STEPS);
    let still = run::to_rest(&scene, &mut *solver, &mut state, STEP, most, STILL)?;
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

#[derive(Default, Serialize)]
struct Guided {
    hung_by: &'static str,
    sweep: &'static str,
    wanted_strain: Real,
    substeps: u32,
    #[serde(rename = "law: mean strain")]
    expected: Real,
}

fn substeps(study: &mut StudyRun<'_>) -> (String, String) {
    let scope = study.scope;
    let guided = |(hung_by, sweep, &wanted_strain): (_, _, &Real)| {
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
        iproduct!(SUPPORTS, SWEEPS, scope.of(WANTED)).map(guided),
        |p| format!("{}, {}, strain {}", p.hung_by, p.sweep, p.wanted_strain),
        |p| {
            let settings = format!("substeps={} iterations=1 sweep={}", p.substeps, p.sweep);
            rest(scope, p.hung_by, &Settings::of(&settings))
        },
    );
    study.table(
        "sag-substeps",
        "The substeps that the guide gives for a wanted mean strain, and what they leave",
        &rows,
    );
    let found = SUPPORTS.map(|support| {
        let most = |strain: fn(&Rest) -> Real| {
            let ours = rows.iter().filter(|(guided, _)| guided.hung_by == support);
            ours.map(|(guided, rest)| strain(rest) / guided.expected)
                .fold(0.0, Real::max)
        };
        [
            most(|rest| rest.mean_strain),
            most(|rest| rest.largest_strain),
        ]
    });
    let mut parts = SUPPORTS.iter().zip(found).map(|(support, [mean, max])| {
        format!("{support} {mean:.2} times its mean and {max:.1} times it in the worst edge")
    });
    let guide = format!(
        "With the substeps of the guide, at most, relative to the strain it predicts: {}.",
        parts.join(", ")
    );
    let [.., of_corners] = found;
    let [mean, worst] = of_corners.map(two);
    let of_corners = format!(
        "; hung by two corners a sheet has up to {mean} times that strain, and {worst} times in its worst edge"
    );
    (guide, of_corners)
}

fn iterations(study: &mut StudyRun<'_>, of_corners: &str) -> String {
    let scope = study.scope;
    let rows = study.grid_side_by_side(
        iproduct!(SUPPORTS, SWEEPS, SPENT.into_iter().rev()),
        |(hung_by, sweep, spent)| format!("{hung_by}, {sweep}, {ROW} {spent}"),
        |(hung_by, sweep, spent)| {
            let other = other_than(spent);
            let settings = format!("{spent}={ROW} {other}=1 sweep={sweep}");
            rest(scope, hung_by, &Settings::of(&settings))
        },
    );
    study.table(
        "sag-iterations",
        "As many sweeps a step as the mesh has edges across: what they leave as iterations and as substeps",
        Table::named(&["hung by", "sweep", "24 sweeps as"], &rows),
    );
    let of_edge = |spent: &str| {
        let found = rows
            .iter()
            .find(|(at, _)| *at == ("edge", "colored", spent));
        found.map(|(_, rest)| rest.mean_strain)
    };
    let (Some(iterations), Some(substeps)) = (of_edge("iterations"), of_edge("substeps")) else {
        return String::new();
    };
    let enough = if iterations < 0.01 { "Yes" } else { "No" };
    let [of_iterations, of_substeps] = [iterations, substeps].map(percent);
    study.answer(
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
    study.answer(
        "Substeps or iterations?",
        format!(
            "{better}. {ROW} sweeps a step leave {of_iterations} of stretch on that sheet as iterations and {of_substeps} as substeps; for one sweep a substep there is a law, so the number that a wanted strain takes can be computed beforehand: that of chains and of sheets hung by an edge{of_corners}."
        ),
        None,
        "table-sag-iterations",
    );
    format!(
        "\"Iterations = mesh diameter\" leaves a mean strain of {iterations:.2e} on the sheet hung by an edge, the same sweeps as substeps {substeps:.2e}."
    )
}

//! How stiff a material is as simulated, against iterations and step size.

use crate::laws::{Stretched, fixed_projection};
use crate::studies::prelude::*;
use cloth_core::cloth::ClothModel;

pub(super) const STUDY: Study = Study {
    name: "stiffness",
    question: "Is the stiffness that a method shows the one that was asked for, or does it depend on iterations and step size?",
    about: "One constraint: a mass of 1 kg on a spring of 100 N/m, one step; the stiffness follows from how much of the stretch is left. \
        The dashed curves are ((1 − s)⁻ⁿ − 1)/(Δt² w) for PBD with a fixed projection s, and k. The chain: 20 links of 1 kg and 1e4 N/m hang at rest, and the stretch \
        of the whole chain is compared with n(n + 1)mg/2k. There the methods that are exact for one constraint part company: a sweep \
        carries a force one link further, so few iterations leave the chain soft. PBD from the material stays soft however many there are: each projection is stiff \
        against a mass that moves alone, not against one that its neighbours hold.",
    run,
};

/// Stiffness of the spring (N/m) in the one-constraint measurements.
const STIFFNESS: Real = 100.0;
const FIXED: [Real; 3] = [0.1, 0.5, 0.9];
/// Methods on the chain, and what their effort is called.
const ON_CHAIN: [(&str, &str); 4] = [
    ("pbd", "iterations"),
    ("xpbd", "iterations"),
    ("xpbd", "substeps"),
    ("pd", "iterations"),
];

fn efforts(scope: Scope) -> &'static [u32] {
    scope.pick(
        &[1, 2, 4, 8, 16, 32, 64, 128],
        &[
            1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 256, 512, 1024,
        ],
    )
}

const STEP_SIZES: [Real; 7] = [1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 1e-1];

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let mut table = Table::new(&[
        "method",
        "iterations",
        "dt (s)",
        "effective stiffness (N/m)",
        "closed form (N/m)",
    ]);
    let dt = 1e-2;
    let by_iterations: Vec<(Real, u32, Real)> = efforts(scope)[..8]
        .iter()
        .map(|&n| (Real::from(n), n, dt))
        .collect();
    let case = "one constraint against iterations";
    let measured = study
        .case(case, || one_constraint(&by_iterations))
        .unwrap_or_default();
    let (series, first) = curves(&by_iterations, &measured, &mut table);
    study.findings.plot("stiffness-iterations", &Plot {
        title: "Stiffness of one constraint against iterations, Δt = 0.01 s".into(),
        x: Axis::log("iterations per step (dimensionless)"),
        y: Axis::log("effective stiffness (N/m)").within(1.0, 1e10),
        series,
        note: "Dashed: the closed forms. PBD with a fixed projection s has no stiffness of its own.".into(),
    });
    let by_step: Vec<(Real, u32, Real)> = STEP_SIZES.iter().map(|&dt| (dt, 4, dt)).collect();
    let case = "one constraint against step size";
    let measured = study
        .case(case, || one_constraint(&by_step))
        .unwrap_or_default();
    let (series, second) = curves(&by_step, &measured, &mut table);
    study.findings.plot(
        "stiffness-dt",
        &Plot {
            title: "Stiffness of one constraint against step size, 4 iterations".into(),
            x: Axis::log("Δt (s)"),
            y: Axis::log("effective stiffness (N/m)").within(1.0, 1e10),
            series,
            note: String::new(),
        },
    );
    study.findings.data("stiffness-one-constraint", table);
    chain(study, first.max(second))
}

/// What is measured on one constraint: label, method, settings, and s where the projection is fixed.
fn on_one_constraint() -> Vec<(String, &'static str, Settings, Option<Real>)> {
    let fixed = FIXED.map(|s| {
        let settings = Settings::default().with("projection", s);
        (format!("pbd, s = {s}"), "pbd", settings, Some(s))
    });
    let exact = ["pbd", "xpbd", "pd", "implicit-euler"].map(|name| {
        let settings = match name {
            "implicit-euler" => Settings::default().with("tolerance", 0),
            "xpbd" => Settings::default().with("substeps", 1),
            _ => Settings::default(),
        };
        (name.to_owned(), name, settings, None)
    });
    fixed.into_iter().chain(exact).collect()
}

/// Stiffness (N/m) that every method shows at some points `(x, iterations, Δt)`, in the order of [`on_one_constraint`].
fn one_constraint(points: &[(Real, u32, Real)]) -> Result<Vec<Vec<Number>>, BenchError> {
    let stretched = Stretched::new(STIFFNESS)?;
    let scene = Scene {
        name: "chain",
        model: ClothModel {
            particles: stretched.particles.clone(),
            springs: vec![stretched.spring],
            hinges: Vec::new(),
            others: Vec::new(),
        },
        start: State::at_rest(vec![Vec3::zeros(), Vec3::x()]),
        mesh: None,
        gravity: Vec3::zeros(),
        dt: 1e-2,
        steps: 1,
        pins: None,
        touch: None,
        air: None,
        gases: Vec::new(),
        changes: Vec::new(),
        order: None,
    };
    let measure = |(_, name, settings, _): (String, &str, Settings, Option<Real>)| {
        let at = |&(_, iterations, dt): &(Real, u32, Real)| {
            let settings = settings.clone().with("iterations", iterations);
            let mut solver = Method::find(name)?.build(&scene, &settings, dt)?;
            stretched.effective_stiffness(&mut *solver, dt).map(Number)
        };
        points.iter().map(at).collect()
    };
    on_one_constraint().into_iter().map(measure).collect()
}

/// What was measured, and the closed forms, as curves; and the largest relative distance between them among the points
/// where rounding leaves six digits.
fn curves(
    points: &[(Real, u32, Real)],
    measured: &[Vec<Number>],
    table: &mut Table,
) -> (Vec<Series>, Real) {
    let (mut shown, mut exact) = (Vec::new(), Vec::new());
    let mut worst: Real = 0.0;
    for ((label, _, _, fixed), measured) in on_one_constraint().into_iter().zip(measured) {
        let law = |n: u32, dt: Real| match fixed {
            Some(s) => fixed_projection(s, n, dt),
            None => STIFFNESS,
        };
        let mut curve = Vec::new();
        for (&(x, iterations, dt), &Number(k)) in points.iter().zip(measured) {
            let closed_form = law(iterations, dt);
            if Stretched::rounding(closed_form, dt) < 1e-6 {
                worst = worst.max((k / closed_form - 1.0).abs());
            }
            table.push([
                Cell::from(label.as_str()),
                Cell::from(iterations as usize),
                Cell::from(dt),
                Cell::from(k),
                Cell::from(closed_form),
            ]);
            curve.push((x, k));
        }
        shown.push(Series::new(&label, curve).styled(Style::Points));
        if let Some(s) = fixed {
            let curve = points.iter().map(|&(x, n, dt)| (x, law(n, dt))).collect();
            exact.push(
                Series::new(&format!("pbd, s = {s}, exact"), curve).styled(Style::ExactCurve),
            );
        }
    }
    let k = points.iter().map(|&(x, ..)| (x, STIFFNESS)).collect();
    exact.push(Series::new("k, exact", k).styled(Style::ExactCurve));
    shown.extend(exact);
    (shown, worst)
}

const LINKS: u32 = 20;
const CHAIN_STIFFNESS: Real = 1e4;

fn chain(study: &mut StudyRun<'_>, worst: Real) -> Result<(), BenchError> {
    let scope = study.scope;
    let settings = Settings::of(&format!(
        "n={LINKS} link=1 mass=1 tip_mass=1 stiffness={CHAIN_STIFFNESS}"
    ));
    let mut scene = scene::build("chain", None, &settings)?;
    for p in &mut scene.start.positions {
        *p = Vec3::new(0.0, 0.0, -p.x);
    }
    let n = Real::from(LINKS);
    let exact = n * (n + 1.0) * 9.81 / (2.0 * CHAIN_STIFFNESS);
    let mut table = Table::new(&[
        "method",
        "effort",
        "count",
        "stretch of the chain (m)",
        "exact (m)",
        "stiffness / k",
        "steps to rest",
    ]);
    let mut series = Vec::new();
    let mut shown = Vec::new();
    for (name, effort) in ON_CHAIN {
        let mut curve = Vec::new();
        for &count in efforts(scope) {
            let settings = match effort {
                "substeps" => Settings::of(&format!("substeps={count} iterations=1")),
                _ if name == "pd" => Settings::default().with("iterations", count),
                _ => Settings::of(&format!("substeps=1 iterations={count}")),
            };
            let case = format!("chain, {name} with {count} {effort}");
            let rest = study.cases.case(&case, || {
                let mut solver = Method::find(name)?.build(&scene, &settings, scene.dt)?;
                at_rest(&scene, &mut *solver)
            });
            let Some((stretch, steps)) = study.findings.unless_failed(&case, rest) else {
                continue;
            };
            table.push([
                Cell::from(name),
                Cell::from(effort),
                Cell::from(count as usize),
                Cell::from(stretch),
                Cell::from(exact),
                Cell::from(exact / stretch),
                steps.map_or(Cell::from("not at rest"), Cell::from),
            ]);
            if steps.is_some() {
                curve.push((Real::from(count), exact / stretch));
            }
        }
        if let Some((_, share)) = curve.iter().find(|(count, _)| *count == 16.0) {
            shown.push(format!("{name} with 16 {effort} shows {share:.3} of k"));
        }
        series.push(Series::new(&format!("{name}, {effort}"), curve));
    }
    let reference = efforts(scope)
        .iter()
        .map(|&count| (Real::from(count), 1.0))
        .collect();
    series.push(Series::new("asked for", reference).styled(Style::ExactCurve));
    study.findings.plot(
        "stiffness-chain",
        &Plot {
            title: "Stiffness of a hanging chain of 20 links against effort, Δt = 1/60 s".into(),
            x: Axis::log("iterations or substeps per step (dimensionless)"),
            y: Axis::log("stiffness shown / k (dimensionless)"),
            series,
            note: "Implicit Euler solved to tolerance lies on the dashed line (law hanging-chain)."
                .into(),
        },
    );
    study
        .findings
        .table("stiffness-chain", "A hanging chain at rest", table);
    let single = if worst < 1e-6 {
        "One constraint alone follows its closed form"
    } else {
        "One constraint alone does NOT follow its closed form everywhere"
    };
    study.findings.section.verdict = Some(format!(
        "{single} (largest distance {worst:.1e}): k at any iteration count and step size for XPBD, PD, implicit Euler, and PBD with the projection made from \
         the material; for PBD with a fixed projection a stiffness that grows by orders of magnitude with iterations and with smaller steps. A chain \
         of 20 links at rest: {}.",
        shown.join("; ")
    ));
    Ok(())
}

/// Stretch (m) of the chain when nothing moves any more, and the steps that took; `None` if it still moved after the
/// last.
fn at_rest(scene: &Scene, solver: &mut dyn Stepper) -> Result<(Real, Option<usize>), BenchError> {
    let mut state = scene.start.clone();
    let steps = run::to_rest(scene, solver, &mut state, scene.dt, 6000, 1e-8)?;
    let last = state.positions.len() - 1;
    let stretch = -state.positions[last].z - Real::from(LINKS);
    Ok((stretch, steps.map(|steps| steps as usize)))
}

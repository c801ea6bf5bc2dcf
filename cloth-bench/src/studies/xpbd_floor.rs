//! How far converged XPBD is from the implicit Euler step, against the step size.

use crate::studies::prelude::*;
use crate::yardstick::StepProblem;
use cloth_core::cloth::Elements;
use cloth_core::method::position_based::Sweep;
use cloth_xpbd::direct::{DirectConfig, DirectXpbd};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

pub(super) const STUDY: Study = Study {
    name: "xpbd-floor",
    question: "How far from the implicit Euler step does XPBD end when its sweeps have converged, and how does that depend on the step size?",
    about: "A chain of ten links of 0.1 m and 0.1 kg, let go sideways; the step is the one after 0.3 s of implicit Euler with the same step size. The reference is Newton's \
        method to rounding; the error is (G − G*)/(G(x̃) − G*) and ‖∇G‖/‖∇G(x̃)‖. The sweeps make C + α̃λ zero, with the gradients of the places where each correction \
        was made, so what they leave is the momentum residual ‖M(x − x̃) − ∇Cᵀλ‖, over ‖Δt² ∇G(x̃)‖; the direct solver keeps the equation of the positions and ends at the reference. With 1/60 s the same is told after every so many sweeps. Expect the floor to fall with the step and no number of sweeps to change it; what surprises is that with long steps the stiffer chain has the lower floor. `order` is that of the line above it to this one.",
    run,
};

/// Links of the chain, and sweeps: a stiff chain of N links keeps cos²(π/2N) of its error per sweep, so this leaves
/// rounding.
const LINKS: u32 = 10;
/// Length of a link (m).
const LINK: Real = 0.1;
const SWEEPS: u32 = 8000;
/// When the step is taken (s).
const TIME: Real = 0.3;

/// Sweeps after which a step is looked at, and its steps per second.
const COUNTS: [&[u32]; 2] = [&[1, 10, 100, 1000], &[1, 3, 10, 30, 100, 300, 1000, 3000]];
const RATE: u32 = 60;

/// Steps per second.
const RATES: [&[u32]; 2] = [&[30, 60, 120, 240], &[30, 60, 120, 240, 480, 960, 1920]];

/// Stiffness of the links (N/m).
const STIFFNESSES: [Real; 2] = [200.0, 1e4];

/// What so many sweeps leave.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Swept {
    /// Of the objective.
    #[serde(rename = "objective error")]
    pub objective: Real,
    /// ‖∇G‖/‖∇G(x̃)‖ (dimensionless).
    #[serde(rename = "gradient error")]
    pub gradient: Real,
    /// [`XpbdSolver::compliance_residual`].
    #[serde(rename = "largest C + α̃λ (m)")]
    pub residual: Real,
    /// [`StepProblem::momentum_residual`].
    #[serde(rename = "momentum residual")]
    pub momentum: Real,
}

/// What the sweeps leave, and the direct solver.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Floor {
    #[serde(rename = "sweeps: objective error")]
    objective: Real,
    /// Found when the line above is known.
    order: Option<Real>,
    /// ‖∇G‖/‖∇G(x̃)‖ of the sweeps (dimensionless).
    #[serde(rename = "sweeps: gradient error")]
    pub gradient: Real,
    #[serde(rename = "sweeps: largest C + α̃λ (m)")]
    residual: Real,
    /// [`StepProblem::momentum_residual`] of the sweeps.
    #[serde(rename = "sweeps: momentum residual")]
    pub momentum: Real,
    #[serde(rename = "direct: objective error")]
    direct_objective: Real,
    #[serde(rename = "direct: gradient error")]
    direct_gradient: Real,
    /// The same of the direct solver.
    #[serde(rename = "direct: momentum residual")]
    pub direct_momentum: Real,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let rates = study.scope.of(RATES);
    let step = |rate: u32| 1.0 / Real::from(rate);
    let mut rows = study.grid(
        iproduct!(STIFFNESSES, rates.iter().copied()),
        |(k, rate)| format!("k = {k} N/m, 1/{rate} s"),
        |&(k, rate)| floor(&chain(k)?, step(rate)),
    );
    for line in 1..rows.len() {
        let [((before, coarse), above), ((k, fine), floor)] = &rows[line - 1..=line] else {
            continue;
        };
        if before == k {
            let shorter = step(*coarse) / step(*fine);
            rows[line].1.order = Some((above.objective / floor.objective).ln() / shorter.ln());
        }
    }
    by_sweeps(study);
    let [first, .., last] = rates else {
        return Ok(());
    };
    let steps = [first, last].map(|rate| format!("steps of 1/{rate} s"));
    let mut falls = Table::about("stiffness", steps);
    for k in STIFFNESSES {
        let left = [first, last].map(|&rate| {
            let row = rows.iter().find(|(at, _)| *at == (k, rate));
            row.map_or(Cell::Missing, |(_, floor)| {
                Cell::said(significant(floor.objective, 2))
            })
        });
        falls.line(Cell::said(format!("{} N/m", two(k))), left);
    }
    let told = "Converged sweeps of XPBD do not end at the implicit Euler step; the table has what is left of the objective, (G − G*)/(G(x̃) − G*).";
    study.answer(
        "What does XPBD's floor cost?",
        told.into(),
        Some(falls),
        "table-xpbd-floor",
    );
    study.section.verdict = Some(
        "Converged sweeps of XPBD do not end at the implicit Euler step, and come nearer with shorter steps; the direct solver of the same constraints ends there."
            .into(),
    );
    study.table(
        "xpbd-floor",
        "Converged sweeps of XPBD and the direct solver beside the implicit Euler step",
        Table::named(&["stiffness (N/m)", "steps per second"], &rows),
    );
    let both = rows.iter().flat_map(|&((k, rate), ref floor)| {
        [("objective", floor.objective), ("gradient", floor.gradient)]
            .map(|(name, error)| (format!("{name}, k = {k}"), (step(rate), error)))
    });
    let title = "What converged sweeps leave of the implicit Euler step";
    let error = Axis::log("relative error (dimensionless)");
    let plot = Plot::new(title, Axis::log("step size (s)"), error);
    study.plot("xpbd-floor", &plot.with(curves(both, |point| point)));
    Ok(())
}

/// The chain, with links of stiffness `k` (N/m).
pub fn chain(k: Real) -> Result<Scene, BenchError> {
    let settings = format!("n={LINKS} link={LINK} mass=0.1 tip_mass=0.1 stiffness={k}");
    scene::build("chain", None, &Settings::of(&settings))
}

/// What is left of both equations after so many sweeps.
fn by_sweeps(study: &mut StudyRun<'_>) {
    let counts = study.scope.of(COUNTS);
    let rows = study.grid(
        iproduct!(STIFFNESSES, counts.iter().copied()),
        |(k, sweeps)| format!("k = {k} N/m, {sweeps} sweeps"),
        |&(k, sweeps)| {
            let scene = chain(k)?;
            let dt = 1.0 / Real::from(RATE);
            let problem = StepProblem::after(&scene, (TIME / dt).round() as u32, dt)?;
            sweep(&problem, &scene, dt, sweeps)
        },
    );
    let both = rows.iter().flat_map(|&((k, sweeps), swept)| {
        [
            ("|C + α̃λ| over the length", swept.residual / LINK),
            ("momentum residual", swept.momentum),
        ]
        .map(|(name, left)| (format!("{name}, k = {k}"), (Real::from(sweeps), left)))
    });
    let plot = Plot::new(
        format!("What sweeps leave of the two equations of a step, 1/{RATE} s"),
        Axis::log("sweeps (dimensionless)"),
        Axis::log("residual (dimensionless)"),
    );
    study.plot("xpbd-floor-sweeps", &plot.with(curves(both, |point| point)));
    study.table(
        "xpbd-floor-sweeps",
        "What so many sweeps leave of a step: they bring C + α̃λ to rounding, and not the momentum residual",
        Table::named(&["stiffness (N/m)", "sweeps"], &rows),
    );
}

/// A step by so many sweeps, from where the problem starts.
pub fn sweep(
    problem: &StepProblem,
    scene: &Scene,
    dt: Real,
    iterations: u32,
) -> Result<Swept, BenchError> {
    let model = &scene.model;
    let mut sweeps = XpbdSolver::builder(&model.particles)
        .elements(vec![Elements::Springs(model.springs.clone())])
        .config(XpbdConfig {
            iterations,
            substeps: 1,
            sweep: Sweep::Sequential,
            ..XpbdConfig::default()
        })
        .build()?;
    let mut state = problem.state().clone();
    let input = StepInput::new(dt).gravity(scene.gravity);
    sweeps.step(&mut state, input)?;
    let error = problem.error(&state.positions);
    let mut multipliers = Vec::new();
    sweeps.multipliers_into(0, &mut multipliers);
    Ok(Swept {
        objective: error.objective,
        gradient: error.gradient,
        residual: sweeps.compliance_residual(&state.positions),
        momentum: problem.momentum_residual(&state.positions, &multipliers),
    })
}

/// Steps by converged sweeps and by the direct solver on a scene of springs, with steps of `dt` (s).
pub fn floor(scene: &Scene, dt: Real) -> Result<Floor, BenchError> {
    let problem = StepProblem::after(scene, (TIME / dt).round() as u32, dt)?;
    let swept = sweep(&problem, scene, dt, SWEEPS)?;
    let model = &scene.model;
    let mut direct = DirectXpbd::builder(&model.particles)
        .elements(vec![Elements::Springs(model.springs.clone())])
        .config(DirectConfig {
            tolerance: 1e-13,
            ..DirectConfig::default()
        })
        .build()?;
    let mut end = problem.state().clone();
    direct.step(&mut end, StepInput::new(dt).gravity(scene.gravity))?;
    let mut multipliers = Vec::new();
    direct.multipliers_into(0, &mut multipliers);
    let by_direct = problem.error(&end.positions);
    Ok(Floor {
        momentum: swept.momentum,
        direct_momentum: problem.momentum_residual(&end.positions, &multipliers),
        objective: swept.objective,
        order: None,
        gradient: swept.gradient,
        residual: swept.residual,
        direct_objective: by_direct.objective,
        direct_gradient: by_direct.gradient,
    })
}

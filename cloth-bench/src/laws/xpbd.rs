//! What the multipliers of XPBD obey.

use super::chains::{GRAVITY, chain};
use super::prelude::*;
use super::within_reach;
use crate::scene;
use crate::yardstick::StepProblem;
use cloth_xpbd::direct::{DirectConfig, DirectXpbd, System};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

const ITERATIONS: Parameter = parameter("iterations", "3", "sweeps of the one step");
const STIFFNESS: Parameter = parameter("stiffness", "100", "stiffness k of the spring (N/m)");
const DAMPING: Parameter = parameter("damping", "0.02", "stiffness-proportional damping β (s)");
const DT: Parameter = parameter("dt", "0.01", "step size (s)");
const SPEED: Parameter = parameter("speed", "-3", "rate of the stretch at the start (m/s)");

pub(super) const XPBD_DAMPING: Law = Law {
    name: "xpbd-damping",
    about: "stretch (m) of one damped XPBD constraint, w = 1 /kg, stretched by 0.5 m, after one step: (C̃ + w h β k C⁰)/(1 + w k h (h + β)), whatever the iterations",
    parameters: &[ITERATIONS, STIFFNESS, DAMPING, DT, SPEED],
    tolerance: 1e-12,
    evaluate: xpbd_damping,
};

const LINKS: Parameter = parameter("links", "8", "number of links N");
const MASS: Parameter = parameter("mass", "0.05", "mass of every vertex (kg)");
const TIP_MASS: Parameter = parameter("tip_mass", "0.05", "mass of the last vertex (kg)");
const LINK_STIFFNESS: Parameter = parameter("stiffness", "2000", "stiffness k of every link (N/m)");
/// Steps until the chain is at rest.
const STEPS: u32 = 400;
const SWEEPS: Parameter = parameter("iterations", "2000", "sweeps per step of 0.1 s");

pub(super) const SUPPORT_FORCE: Law = Law {
    name: "support-force",
    about: "force (N) on the support of a hanging chain at rest, read out of XPBD's multipliers: its weight",
    parameters: &[LINKS, MASS, TIP_MASS, LINK_STIFFNESS, SWEEPS],
    tolerance: 1e-10,
    evaluate: support_force,
};

const SWINGING_LINKS: Parameter = parameter("links", "10", "number of links N");
const SWINGING_STIFFNESS: Parameter =
    parameter("stiffness", "200", "stiffness k of every link (N/m)");
const SWINGING_TIP: Parameter = parameter("tip_mass", "0.1", "mass of the last vertex (kg)");
const SWINGING_DT: Parameter = parameter("dt", "0.01", "step size (s)");
const CONVERGED: Parameter = parameter("iterations", "8000", "sweeps of the one step");
const SYSTEM: Parameter = parameter(
    "system",
    "saddle",
    "linear solver: saddle, saddle-minres, schur or schur-cg",
);

pub(super) const XPBD_COMPLIANCE: Law = Law {
    name: "xpbd-compliance",
    about: "largest C + α̃λ (m) that converged XPBD leaves in one step of a swinging chain of links of 0.1 m: 0",
    parameters: &[
        SWINGING_LINKS,
        SWINGING_STIFFNESS,
        SWINGING_TIP,
        SWINGING_DT,
        CONVERGED,
    ],
    tolerance: 1e-13,
    evaluate: xpbd_compliance,
};

pub(super) const DIRECT_STEP: Law = Law {
    name: "direct-step",
    about: "gradient norm that the direct solver leaves of the implicit Euler step of a swinging chain, relative to that at x̃: 0",
    parameters: &[
        SWINGING_LINKS,
        SWINGING_STIFFNESS,
        SWINGING_TIP,
        SWINGING_DT,
        SYSTEM,
    ],
    tolerance: 1e-8,
    evaluate: direct_step,
};

/// The step of a chain, let go sideways, after 0.3 s of implicit Euler.
fn swinging(settings: &Settings) -> Result<(scene::Scene, StepProblem), BenchError> {
    let links = settings.count(&SWINGING_LINKS, 1)?;
    let dt = settings.positive(&SWINGING_DT)?;
    let steps = (0.3 / dt).ceil().min(1e5);
    within_reach(5e3 * Real::from(links) * steps)?;
    let chain = Settings::default()
        .with("n", links)
        .with("link", 0.1)
        .with("mass", 0.1)
        .with("tip_mass", settings.positive(&SWINGING_TIP)?)
        .with("stiffness", settings.positive(&SWINGING_STIFFNESS)?);
    let scene = scene::build("chain", None, &chain)?;
    let problem = StepProblem::after(&scene, steps as u32, dt)?;
    Ok((scene, problem))
}

fn xpbd_compliance(settings: &Settings) -> Result<Evaluation, BenchError> {
    let iterations = settings.count(&CONVERGED, 1)?;
    let links = settings.count(&SWINGING_LINKS, 1)?;
    within_reach(30.0 * Real::from(links) * Real::from(iterations))?;
    let (scene, problem) = swinging(settings)?;
    let mut solver = XpbdSolver::builder(&scene.model.particles)
        .elements(vec![Elements::Springs(scene.model.springs.clone())])
        .config(XpbdConfig {
            iterations,
            substeps: 1,
            ..XpbdConfig::default()
        })
        .build()
        .map_err(BenchError::usage)?;
    let mut state = problem.state().clone();
    let input = StepInput::new(settings.positive(&SWINGING_DT)?).gravity(scene.gravity);
    solver.step(&mut state, input)?;
    let error = problem.error(&state.positions);
    let residual = solver.compliance_residual(&state.positions);
    Ok(Evaluation::new(0.0, residual)
        .detail("objective_floor", error.objective)
        .detail("gradient_floor", error.gradient))
}

fn direct_step(settings: &Settings) -> Result<Evaluation, BenchError> {
    let (scene, problem) = swinging(settings)?;
    let systems = [
        ("saddle", System::SaddleLdlt),
        ("saddle-minres", System::SaddleMinres),
        ("schur", System::SchurCholesky),
        ("schur-cg", System::SchurConjugateGradients),
    ];
    let mut solver = DirectXpbd::builder(&scene.model.particles)
        .elements(vec![Elements::Springs(scene.model.springs.clone())])
        .config(DirectConfig {
            system: settings.choice(&SYSTEM, &systems)?,
            tolerance: 1e-13,
            ..DirectConfig::default()
        })
        .build()
        .map_err(BenchError::usage)?;
    let (error, report, _) = problem.solve(&mut solver)?;
    Ok(Evaluation::new(0.0, error.gradient)
        .detail("objective_error", error.objective)
        .detail("iterations", Real::from(report.iterations))
        .detail("compliance_residual", solver.residuals().compliance))
}

/// Stretch at the start (m).
const STRETCH: Real = 0.5;

fn xpbd_damping(settings: &Settings) -> Result<Evaluation, BenchError> {
    let k = settings.positive(&STIFFNESS)?;
    let beta = settings.number(&DAMPING)?;
    let h = settings.positive(&DT)?;
    let speed = settings.number(&SPEED)?;
    let iterations = settings.count(&ITERATIONS, 1)?;
    within_reach(100.0 * Real::from(iterations))?;
    let mut particles = Particles::new(vec![1.0; 2])?;
    particles.prescribe(0)?;
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: k,
    };
    let mut solver = XpbdSolver::builder(&particles)
        .elements(vec![Elements::Springs(vec![spring])])
        .config(XpbdConfig {
            iterations,
            substeps: 1,
            damping: beta,
            ..XpbdConfig::default()
        })
        .build()
        .map_err(BenchError::usage)?;
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(1.0 + STRETCH, 0.0, 0.0)]);
    state.velocities[1].x = speed;
    let predicted = STRETCH + h * speed;
    if predicted <= -1.0 {
        return Err(BenchError::Usage(
            "speed takes the spring through its other end within the step".into(),
        ));
    }
    solver.step(&mut state, StepInput::new(h))?;
    let expected = (predicted + h * beta * k * STRETCH) / (1.0 + k * h * (h + beta));
    let measured = state.positions[1].x - 1.0;
    // A position of the order of 1 m is known to ε.
    let rounding = 8.0 * Real::EPSILON * (1.0 + predicted.abs()) / expected.abs();
    Ok(Evaluation::new(expected, measured).rounding(rounding))
}

fn support_force(settings: &Settings) -> Result<Evaluation, BenchError> {
    let links = settings.count(&LINKS, 1)?;
    let iterations = settings.count(&SWEEPS, 1)?;
    within_reach(30.0 * Real::from(STEPS) * Real::from(links) * Real::from(iterations))?;
    let links = links as usize;
    let mass = settings.positive(&MASS)?;
    let tip = settings.positive(&TIP_MASS)?;
    let mut masses = vec![mass; links + 1];
    masses[links] = tip;
    let weight = GRAVITY * (mass * (links as Real - 1.0) + tip);
    let (particles, springs, mut state) = chain(masses, settings.positive(&LINK_STIFFNESS)?)?;
    let mut solver = XpbdSolver::builder(&particles)
        .elements(vec![Elements::Springs(springs)])
        .config(XpbdConfig {
            iterations,
            substeps: 1,
            damping: 0.01,
            ..XpbdConfig::default()
        })
        .build()
        .map_err(BenchError::usage)?;
    for _ in 0..STEPS {
        let input = StepInput::new(0.1).gravity(Vec3::z() * -GRAVITY);
        solver.step(&mut state, input)?;
    }
    let mut forces = vec![Vec3::zeros(); links + 1];
    solver.vertex_forces_into(&mut forces);
    let fastest = state.velocities.iter().map(Vec3::amax).fold(0.0, Real::max);
    Ok(Evaluation::new(weight, -forces[0].z)
        .detail(
            "compliance_residual",
            solver.compliance_residual(&state.positions),
        )
        .detail("fastest", fastest))
}

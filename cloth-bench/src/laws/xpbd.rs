//! What the multipliers of XPBD obey.

use super::chains::{GRAVITY, chain};
use super::prelude::*;
use crate::scene;
use crate::yardstick::StepProblem;
use cloth_xpbd::direct::{DirectConfig, DirectXpbd, System};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

law! {
    XPBD_DAMPING = "xpbd-damping" within 1e-12,
    "stretch (m) of one damped XPBD constraint, w = 1 /kg, stretched by 0.5 m, after one step: (C̃ + w h β k C⁰)/(1 + w k h (h + β)), whatever the iterations";
    xpbd_damping(XpbdDampingSettings {
        iterations: u32 = 3 in AtLeast(1.0), "sweeps of the one step";
        stiffness: Real = 100 "N/m" in Above(0.0), "stiffness k of the spring";
        damping: Real = 0.02 "s", "stiffness-proportional damping β";
        dt: Real = 0.01 "s" in Above(0.0), "step size";
        speed: Real = -3 "m/s", "rate of the stretch at the start";
    })
}

/// Steps until the chain is at rest.
const STEPS: u32 = 400;

law! {
    SUPPORT_FORCE = "support-force" within 1e-10,
    "force (N) on the support of a hanging chain at rest, read out of XPBD's multipliers: its weight";
    support_force(SupportForceSettings {
        links: u32 = 8 in AtLeast(1.0), "number of links N";
        mass: Real = 0.05 "kg" in Above(0.0), "mass of every vertex";
        tip_mass: Real = 0.05 "kg" in Above(0.0), "mass of the last vertex";
        stiffness: Real = 2000 "N/m" in Above(0.0), "stiffness k of every link";
        iterations: u32 = 2000 in AtLeast(1.0), "sweeps per step of 0.1 s";
    })
}

crate::settings! {
    /// Of a swinging chain.
    struct Swinging {
        links: u32 = 10 in AtLeast(1.0), "number of links N";
        stiffness: Real = 200 "N/m" in Above(0.0), "stiffness k of every link";
        tip_mass: Real = 0.1 "kg" in Above(0.0), "mass of the last vertex";
        dt: Real = 0.01 "s" in Above(0.0), "step size";
    }
    struct XpbdComplianceSettings {
        iterations: u32 = 8000 in AtLeast(1.0), "sweeps of the one step";
    }
}

pub(super) const XPBD_COMPLIANCE: Law = Law {
    name: "xpbd-compliance",
    about: "largest C + α̃λ (m) that converged XPBD leaves in one step of a swinging chain of links of 0.1 m: 0",
    parameters: &[Swinging::PARAMETERS, XpbdComplianceSettings::PARAMETERS],
    tolerance: 1e-13,
    evaluate: xpbd_compliance,
};

crate::settings! {
    struct DirectStepSettings {
        system: System = "saddle", "linear solver: saddle, saddle-minres, schur or schur-cg";
    }
}

pub(super) const DIRECT_STEP: Law = Law {
    name: "direct-step",
    about: "gradient norm that the direct solver leaves of the implicit Euler step of a swinging chain, relative to that at x̃: 0",
    parameters: &[Swinging::PARAMETERS, DirectStepSettings::PARAMETERS],
    tolerance: 1e-8,
    evaluate: direct_step,
};

/// So many sweeps over springs in one substep, with stiffness-proportional damping (s).
pub(super) fn sweeps(
    particles: &Particles,
    springs: Vec<Spring>,
    iterations: u32,
    damping: Real,
) -> Result<XpbdSolver, BenchError> {
    let config = XpbdConfig {
        iterations,
        substeps: 1,
        damping,
        ..XpbdConfig::default()
    };
    let builder = XpbdSolver::builder(particles).elements(vec![Elements::Springs(springs)]);
    builder.config(config).build().map_err(BenchError::usage)
}

/// The step of a chain, let go sideways, after 0.3 s of implicit Euler.
fn swinging(own: &Swinging) -> Result<(scene::Scene, StepProblem), BenchError> {
    let (links, dt) = (*own.links, *own.dt);
    let steps = (0.3 / dt).ceil().min(1e5);
    within_reach(5e3 * Real::from(links) * steps)?;
    let chain = Settings::default()
        .with("n", links)
        .with("link", 0.1)
        .with("mass", 0.1)
        .with("tip_mass", *own.tip_mass)
        .with("stiffness", *own.stiffness);
    let scene = scene::build("chain", None, &chain)?;
    let problem = StepProblem::after(&scene, steps as u32, dt)?;
    Ok((scene, problem))
}

fn xpbd_compliance(settings: &Settings) -> Result<Evaluation, BenchError> {
    let chain = Swinging::read(settings)?;
    let iterations = *XpbdComplianceSettings::read(settings)?.iterations;
    let links = *chain.links;
    within_reach(30.0 * Real::from(links) * Real::from(iterations))?;
    let (scene, problem) = swinging(&chain)?;
    let (particles, springs) = (&scene.model.particles, scene.model.springs.clone());
    let mut solver = sweeps(particles, springs, iterations, 0.0)?;
    let mut state = problem.state().clone();
    let input = StepInput::new(*chain.dt).gravity(scene.gravity);
    solver.step(&mut state, input)?;
    let error = problem.error(&state.positions);
    let residual = solver.compliance_residual(&state.positions);
    Ok(Evaluation::new(0.0, residual)
        .detail("objective_floor", error.objective)
        .detail("gradient_floor", error.gradient))
}

fn direct_step(settings: &Settings) -> Result<Evaluation, BenchError> {
    let own = DirectStepSettings::read(settings)?;
    let (scene, problem) = swinging(&Swinging::read(settings)?)?;
    let mut solver = DirectXpbd::builder(&scene.model.particles)
        .elements(vec![Elements::Springs(scene.model.springs.clone())])
        .config(DirectConfig {
            system: *own.system,
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

fn xpbd_damping(own: &XpbdDampingSettings) -> Result<Evaluation, BenchError> {
    let (k, beta, h) = (*own.stiffness, *own.damping, *own.dt);
    let (speed, iterations) = (*own.speed, *own.iterations);
    within_reach(100.0 * Real::from(iterations))?;
    let mut particles = Particles::new(vec![1.0; 2])?;
    particles.prescribe(0)?;
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: k,
    };
    let mut solver = sweeps(&particles, vec![spring], iterations, beta)?;
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

fn support_force(own: &SupportForceSettings) -> Result<Evaluation, BenchError> {
    let (links, iterations) = (*own.links, *own.iterations);
    within_reach(30.0 * Real::from(STEPS) * Real::from(links) * Real::from(iterations))?;
    let links = links as usize;
    let (mass, tip) = (*own.mass, *own.tip_mass);
    let mut masses = vec![mass; links + 1];
    masses[links] = tip;
    let weight = GRAVITY * (mass * (links as Real - 1.0) + tip);
    let (particles, springs, mut state) = chain(masses, *own.stiffness)?;
    let mut solver = sweeps(&particles, springs, iterations, 0.01)?;
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

//! How stiff one constraint is, as simulated.

use super::prelude::*;
use super::xpbd::sweeps;
use cloth_pbd::{PbdConfig, PbdSolver, StiffnessRule};

law! {
    XPBD_CONSTRAINT = "xpbd-constraint" within 1e-10,
    "stiffness (N/m) that one XPBD constraint shows in one step: k, whatever the iterations";
    xpbd_constraint(XpbdConstraintSettings {
        iterations: u32 = 10 in AtLeast(1.0), "sweeps of the one step";
        stiffness: Real = 100 "N/m" in Above(0.0), "stiffness k of the spring";
        dt: Real = 0.01 "s" in Above(0.0), "step size";
    })
}

law! {
    PBD_CONSTRAINT = "pbd-constraint" within 1e-10,
    "stiffness (N/m) that one PBD constraint shows in one step: ((1 − s)⁻ⁿ − 1)/(Δt² w), w = 1 /kg";
    pbd_constraint(PbdConstraintSettings {
        iterations: u32 = 10 in AtLeast(1.0), "sweeps of the one step";
        stiffness: Real = 0.5, "stiffness s of the projection, 0 to 1";
        dt: Real = 0.01 "s" in Above(0.0), "step size";
    })
}

/// A mass of 1 kg on a spring of stiffness `k` (N/m) and rest length 1 m to a held vertex, stretched by half.
#[derive(Debug)]
pub(crate) struct Stretched {
    pub(crate) particles: Particles,
    pub(crate) spring: Spring,
}

/// Stretch at the start (m).
const STRETCH: Real = 0.5;

impl Stretched {
    pub(crate) fn new(k: Real) -> Result<Self, BenchError> {
        let mut particles = Particles::new(vec![1.0; 2])?;
        particles.prescribe(0)?;
        let spring = Spring {
            vertices: [0, 1],
            rest_length: 1.0,
            stiffness: k,
        };
        Ok(Self { particles, spring })
    }

    /// The stiffness (N/m) that one step of `dt` (s) shows: `C̃/C′ = 1 + k Δt² w`.
    pub(crate) fn effective_stiffness(
        &self,
        solver: &mut dyn Stepper,
        dt: Real,
    ) -> Result<Real, BenchError> {
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(1.0 + STRETCH, 0.0, 0.0)]);
        solver.step(&mut state, StepInput::new(dt))?;
        let left = (state.positions[1] - state.positions[0]).norm() - self.spring.rest_length;
        Ok((STRETCH / left - 1.0) / (dt * dt))
    }

    /// What rounding can do to that stiffness `k` (relative): the position, of the order of 1 m, is known to ε, and
    /// both what is left of the stretch and what has gone of it are differences of positions.
    pub(crate) fn rounding(k: Real, dt: Real) -> Real {
        let factor = 1.0 + k * dt * dt;
        4.0 * Real::EPSILON * (factor / STRETCH) * (1.0 + 1.0 / (factor - 1.0))
    }
}

fn xpbd_constraint(own: &XpbdConstraintSettings) -> Result<Evaluation, BenchError> {
    let k = *own.stiffness;
    let stretched = Stretched::new(k)?;
    let iterations = *own.iterations;
    within_reach(100.0 * Real::from(iterations))?;
    let spring = vec![stretched.spring];
    let mut solver = sweeps(&stretched.particles, spring, iterations, 0.0)?;
    let dt = *own.dt;
    let measured = stretched.effective_stiffness(&mut solver, dt)?;
    Ok(Evaluation::new(k, measured).rounding(Stretched::rounding(k, dt)))
}

/// Stiffness (N/m) that n projections with stiffness s amount to in a step of `dt` (s), for w = 1 /kg:
/// `((1 − s)⁻ⁿ − 1)/Δt²`.
pub(crate) fn fixed_projection(s: Real, iterations: u32, dt: Real) -> Real {
    ((1.0 - s).powf(-Real::from(iterations)) - 1.0) / (dt * dt)
}

fn pbd_constraint(own: &PbdConstraintSettings) -> Result<Evaluation, BenchError> {
    let s = *own.stiffness;
    if !(0.0..1.0).contains(&s) {
        return Err(BenchError::Usage(format!(
            "stiffness is {s}, but it has to be at least 0 and below 1, where the constraint is rigid"
        )));
    }
    let iterations = *own.iterations;
    within_reach(100.0 * Real::from(iterations))?;
    let dt = *own.dt;
    let stretched = Stretched::new(1.0)?;
    let mut solver = PbdSolver::builder(&stretched.particles)
        .elements(vec![Elements::Springs(vec![stretched.spring])])
        .config(PbdConfig {
            iterations,
            substeps: 1,
            stiffness: StiffnessRule::Fixed(s),
            ..Default::default()
        })
        .build()
        .map_err(BenchError::usage)?;
    let expected = fixed_projection(s, iterations, dt);
    let measured = stretched.effective_stiffness(&mut solver, dt)?;
    Ok(Evaluation::new(expected, measured).rounding(Stretched::rounding(expected, dt)))
}

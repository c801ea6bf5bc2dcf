//! BDF2: the derivative at the end of the step from a parabola through three points in time.
//!
//! ```text
//! (3 x[1] − 4 x[0] + x[−1]) / (2Δt) = v[1]
//! (3 v[1] − 4 v[0] + v[−1]) / (2Δt) = M⁻¹ f(x[1]) + g
//! ```
//!
//! Solved for the new values that is a stage of `τ = 2Δt/3` from `x_b = (4x[0] − x[−1])/3`, `v_b = (4v[0] − v[−1])/3`.
//!
//! Contact is part of f, but what it stops has no derivative. A vertex that arrives with `v[−1] = −1 m/s` and is
//! stopped, `v[0] = 0`, would begin the next stage with `v_b = 1/3 m/s` and with `x_b` behind the floor, and leave with
//! 0.35 to 1.25 times the speed that it had; a sheet that lands on a corner gained up to five times its energy. So the
//! step after one in which new forces of contact have changed the kinetic energy is one of implicit Euler, which knows
//! nothing of `v[−1]`. A load that rests changes nothing, and is second order as everything else.
//!
//! C. F. Curtiss, J. O. Hirschfelder, "Integration of stiff equations", PNAS 38(3), 1952,
//! <https://doi.org/10.1073/pnas.38.3.235>; for cloth, with one linear solve a step
//! ([`Solve::Linearized`](crate::Solve::Linearized)): K.-J. Choi, H.-S. Ko, 2002,
//! <https://doi.org/10.1145/566570.566624>.

use super::{Extent, Implicit, ImplicitBuilder, Place};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput, StepReport, Stepper};

/// Part of the kinetic energy that new forces of contact may change before the method starts again.
const STOPPED: Real = 1e-4;

/// BDF2: second order, stable for any step, and much less damped than [`ImplicitEuler`](crate::ImplicitEuler).
///
/// An oscillation ω changes by `λ = 1/(2 − √(1 + 2iz))` a step, `z = Δt ω`: for small `z` it shrinks by `z⁴/4`, where
/// implicit Euler takes `z²/2`; for large `z` it goes like `1/√(2z)`, so that stiff modes still die out. Linear
/// momentum is kept as in [`ImplicitEuler`](crate::ImplicitEuler), angular momentum is not.
///
/// It needs the state before the last one. The solver keeps it, together with a copy of the state that it produced;
/// when a step starts from another state, or with another Δt, it *starts again* with one step of implicit Euler. One
/// step of first order leaves the whole of second order. So a change of the state between two steps is always right,
/// but who changes it in every step gets implicit Euler. Velocities of prescribed vertices do not count: steering a pin
/// is no restart. Jumps of load or gravity are none either; the order is then lost for one step. What contact stops
/// is: it starts again after a step in which new forces of contact have changed the kinetic energy by more than 10⁻⁴ of
/// it and of what a step of free fall would give. So nothing bounces with more than half of its speed, and cloth that
/// slides and folds takes steps of implicit Euler.
///
/// Damping: drag and stiffness act at the end of the step, both with second order.
///
/// Errors and residual are those of [`ImplicitEuler`](crate::ImplicitEuler).
#[derive(Debug)]
pub struct Bdf2 {
    implicit: Implicit,
    /// Positions (m) and velocities (m/s) before the last step.
    before: [Vec<Vec3>; 2],
    /// Those after it.
    after: [Vec<Vec3>; 2],
    /// Its size (s), if it succeeded.
    dt: Option<Real>,
    /// The forces of contact (N) after it, empty without contact, and whether they have stopped something in it.
    pressed: Vec<Vec3>,
    is_stopped: bool,
}

impl Bdf2 {
    /// Starts the description of a solver for these particles.
    #[must_use]
    pub fn builder(particles: &Particles) -> ImplicitBuilder<Self> {
        ImplicitBuilder::new(particles, |mut implicit| {
            implicit.contact_forces = Some(Vec::new());
            let zeros = || vec![Vec3::zeros(); implicit.particles.len()];
            Self {
                before: [zeros(), zeros()],
                after: [zeros(), zeros()],
                dt: None,
                pressed: Vec::new(),
                is_stopped: false,
                implicit,
            }
        })
    }

    /// Whether the state is the one that the last step produced, and this step has the same size.
    fn continues(&self, state: &State, dt: Real) -> bool {
        let free = |vertex: &usize| !self.implicit.particles.is_prescribed(*vertex);
        let [positions, velocities] = &self.after;
        self.dt == Some(dt)
            && state.positions == *positions
            && (0..velocities.len())
                .filter(free)
                .all(|vertex| state.velocities[vertex] == velocities[vertex])
    }

    /// The kinetic energy (J) that external forces alone would give in the step to what rests: with less, it does rest.
    fn energy_of_fall(&self, input: &StepInput<'_>) -> Real {
        if input.contacts.is_none() {
            return 0.0;
        }
        let particles = &self.implicit.particles;
        let both = particles.mass().iter().zip(particles.inverse_mass());
        let energies = both.enumerate().map(|(vertex, (m, w))| {
            let a = input.external_acceleration(vertex, *w);
            0.5 * m * (a * input.dt).norm_squared()
        });
        energies.sum()
    }

    /// Whether new forces of contact have changed the kinetic energy in a step of τ (s) that `before` is the start of.
    fn has_stopped(&mut self, state: &State, tau: Real, falling: Real) -> bool {
        let Some(forces) = &self.implicit.contact_forces else {
            return false;
        };
        let particles = &self.implicit.particles;
        let mass = particles.mass();
        let [_, before] = &self.before;
        let mut changed = 0.0;
        for (vertex, force) in forces.iter().enumerate() {
            let along = force.try_normalize(0.0);
            let Some(along) = along.filter(|_| !particles.is_prescribed(vertex)) else {
                continue;
            };
            let held = self.pressed.get(vertex).map_or(0.0, |f| f.dot(&along));
            let new = force.norm() - held.clamp(0.0, force.norm());
            // What is stopped by a few of its vertices hangs on them: none gains more than it has.
            let (v, m) = (before[vertex], mass[vertex]);
            let gained = (state.velocities[vertex] - v).dot(&along);
            let change = along * (tau * new / m).min(gained).max(0.0);
            changed += m * change.dot(&(v + change * 0.5)).abs();
        }
        self.pressed.clone_from(forces);
        let energies = before.iter().zip(mass);
        let kinetic: Real = energies.map(|(v, m)| 0.5 * m * v.norm_squared()).sum();
        changed > STOPPED * (kinetic + falling)
    }

    fn remember(&mut self, state: &State) {
        let [positions, velocities] = &mut self.after;
        positions.copy_from_slice(&state.positions);
        velocities.copy_from_slice(&state.velocities);
    }
}

impl Stepper for Bdf2 {
    fn name(&self) -> &'static str {
        "bdf2"
    }

    fn step(&mut self, state: &mut State, input: StepInput<'_>) -> Result<StepReport, StepError> {
        input.check(state, self.implicit.particles.len())?;
        let dt = input.dt;
        let mut tau = 2.0 / 3.0 * dt;
        let falling = self.energy_of_fall(&input);
        let report = if self.continues(state, dt) && !self.is_stopped {
            let [positions, velocities] = &self.before;
            let third = |now: Vec3, before: Vec3| now + (now - before) / 3.0;
            let place = Place::End;
            let span = Extent { tau, place };
            self.implicit.advance(state, input, span, |vertex, x, v| {
                [third(x, positions[vertex]), third(v, velocities[vertex])]
            })?
        } else {
            self.dt = None;
            tau = dt;
            self.remember(state);
            self.implicit.advance_euler(state, input)?
        };
        std::mem::swap(&mut self.before, &mut self.after);
        self.is_stopped = self.has_stopped(state, tau, falling);
        self.remember(state);
        self.dt = Some(dt);
        Ok(report)
    }
}

//! BDF2: the derivative at the end of the step from a parabola through three points in time.
//!
//! ```text
//! (3 x[1] − 4 x[0] + x[−1]) / (2Δt) = v[1]
//! (3 v[1] − 4 v[0] + v[−1]) / (2Δt) = M⁻¹ f(x[1]) + g
//! ```
//!
//! Solved for the new values that is a stage of `τ = 2Δt/3` from `x_b = (4x[0] − x[−1])/3`, `v_b = (4v[0] − v[−1])/3`.
//!
//! The force of contact is part of f, at the end of the step like all others. A vertex with `v[−1] = −1 m/s` that it
//! has stopped, `v[0] = 0`, begins the next stage with `v_b = 1/3 m/s`.
//!
//! C. F. Curtiss, J. O. Hirschfelder, "Integration of stiff equations", PNAS 38(3), 1952,
//! <https://doi.org/10.1073/pnas.38.3.235>; for cloth, with one linear solve a step
//! ([`Solve::Linearized`](crate::Solve::Linearized)): K.-J. Choi, H.-S. Ko, 2002,
//! <https://doi.org/10.1145/566570.566624>.

use super::{Extent, Implicit, ImplicitBuilder, Place};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput, StepReport, Stepper};

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
/// is no restart. Jumps of load or gravity are none either; the order is then lost for one step. Nor is contact, a
/// force at the end of the step like the others. What it stops bounces: the parabola through a velocity that jumps
/// overshoots. A vertex that hits a floor that does not give way leaves it with 0.35 to 1.25 times its speed (from the
/// equations, without gravity), depending on where in the step it arrives; with implicit Euler it stays.
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
}

impl Bdf2 {
    /// Starts the description of a solver for these particles.
    #[must_use]
    pub fn builder(particles: &Particles) -> ImplicitBuilder<Self> {
        ImplicitBuilder::new(particles, |implicit| {
            let zeros = || vec![Vec3::zeros(); implicit.particles.len()];
            Self {
                before: [zeros(), zeros()],
                after: [zeros(), zeros()],
                dt: None,
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
        let report = if self.continues(state, dt) {
            let [positions, velocities] = &self.before;
            let third = |now: Vec3, before: Vec3| now + (now - before) / 3.0;
            let span = Extent {
                tau: 2.0 / 3.0 * dt,
                place: Place::End,
            };
            self.implicit.advance(state, input, span, |vertex, x, v| {
                [third(x, positions[vertex]), third(v, velocities[vertex])]
            })?
        } else {
            self.dt = None;
            self.remember(state);
            self.implicit.advance_euler(state, input)?
        };
        std::mem::swap(&mut self.before, &mut self.after);
        self.remember(state);
        self.dt = Some(dt);
        Ok(report)
    }
}

//! Where the iteration of a step starts.

use super::PdSolver;
use crate::config::StartGuess;
use cloth_core::contact::{ContactError, ContactPotential, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::in_contact::EXPECTED_CHANGE;
use cloth_core::particles::State;

/// Of the last step, if it was one with contact: the velocities (m/s) where it began, and its size (s), else 0.
#[derive(Debug, Default)]
pub(super) struct Before {
    velocities: Vec<Vec3>,
    dt: Real,
}

impl StartGuess {
    /// Whether the motion goes on at the start.
    pub(super) fn goes_on(self) -> bool {
        matches!(self, Self::Inertial | Self::Extrapolated)
    }
}

impl PdSolver {
    /// Puts the iterate where the iteration starts: q = 0, Δt v[0], Δt (v[0] + ½ (v[0] − v[−1])) or u, and u for a
    /// prescribed vertex.
    pub(super) fn start(&mut self, state: &State, is_in_contact: bool) {
        let dt = self.objective.dt();
        let is_extrapolated = self.config.start == StartGuess::Extrapolated
            && is_in_contact
            && self.continues(state, dt);
        let before = is_extrapolated.then_some(&self.before.velocities[..]);
        let (particles, inertial) = (&self.objective.particles, &self.objective.inertial);
        let q = &mut self.point.displacement;
        for (vertex, q) in q.iter_mut().enumerate() {
            *q = match self.config.start {
                _ if particles.is_prescribed(vertex) => inertial[vertex],
                StartGuess::Previous => Vec3::zeros(),
                StartGuess::Inertial | StartGuess::Extrapolated => {
                    let v = state.velocities[vertex];
                    let change = before.map_or(Vec3::zeros(), |before| v - before[vertex]);
                    (v + change * EXPECTED_CHANGE) * dt
                }
                StartGuess::Predicted => inertial[vertex],
            };
        }
        if self.config.start.goes_on() {
            self.free_components.align(self.objective.momentum(), q);
        }
        self.point.is_evaluated = false;
    }

    /// Whether the state is the one that the last step left, which was of the same size (s) and in contact too.
    fn continues(&self, state: &State, dt: Real) -> bool {
        let is_kept = |vertex| {
            state.positions[vertex] == self.point.positions[vertex]
                && (self.objective.particles.is_prescribed(vertex)
                    || state.velocities[vertex] == self.velocities[vertex])
        };
        self.before.dt == dt && (0..self.velocities.len()).all(is_kept)
    }

    /// Remembers where the step began, which is done, for the next one.
    pub(super) fn remember(&mut self, state: &State, dt: Real, is_in_contact: bool) {
        if is_in_contact && self.config.start == StartGuess::Extrapolated {
            self.before.velocities.clone_from(&state.velocities);
            self.before.dt = dt;
        } else {
            self.before.dt = 0.0;
        }
    }

    /// Begins contact, and truncates the displacement to the start, less what a piece that flies has in common, where
    /// it is not free of crossings; around what is stopped too, by less the further away it is
    /// ([`FadingTruncation`](cloth_core::contact::FadingTruncation)), so that what is stopped hardly strains what flies
    /// on.
    pub(super) fn begin_contact(
        &mut self,
        state: &State,
        dt: Real,
        contact: &mut dyn ContactPotential,
    ) -> Result<(), ContactError> {
        let q = &mut self.point.displacement;
        let taken = ContactStep {
            from: &state.positions,
            inverse_mass: self.objective.particles.inverse_mass(),
            dt,
        };
        let to = &mut self.point.positions;
        for ((to, x), q) in to.iter_mut().zip(&state.positions).zip(&*q) {
            *to = x + q;
        }
        let stiffness = self.global.stiffness();
        let neighbours = |v: usize| {
            let columns = stiffness.outer_view(v).map(|row| row.into_raw_storage().0);
            columns.unwrap_or_default().iter().copied()
        };
        let feasible = &mut self.feasible;
        self.truncation
            .begin(contact, &taken, feasible, to, neighbours)?;
        for ((q, to), x) in q.iter_mut().zip(&*to).zip(&state.positions) {
            // A displacement that is not truncated keeps all digits.
            if *to != x + *q {
                *q = to - x;
            }
        }
        Ok(())
    }
}

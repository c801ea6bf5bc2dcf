//! Where the iteration of a step starts.

use super::PdSolver;
use crate::config::StartGuess;
use cloth_core::contact::{ContactError, ContactPotential, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;

impl PdSolver {
    /// Puts the iterate where the iteration starts: q = 0, Δt v[0] or u, and u for a prescribed vertex.
    pub(super) fn start(&mut self, state: &State) {
        let (particles, inertial) = (&self.objective.particles, &self.objective.inertial);
        let q = &mut self.point.displacement;
        for (vertex, q) in q.iter_mut().enumerate() {
            *q = match self.config.start {
                _ if particles.is_prescribed(vertex) => inertial[vertex],
                StartGuess::Previous => Vec3::zeros(),
                StartGuess::Inertial => state.velocities[vertex] * self.objective.dt(),
                StartGuess::Predicted => inertial[vertex],
            };
        }
        if self.config.start == StartGuess::Inertial {
            self.free_components.align(self.objective.momentum(), q);
        }
        self.point.is_evaluated = false;
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

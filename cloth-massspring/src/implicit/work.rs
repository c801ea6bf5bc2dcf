//! Work that is done on the cloth in a step.

use super::Implicit;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::step::StepInput;

impl Implicit {
    /// Work (J) of prescribed vertices, by the forces that the stage ends with, and these to `input`, where the step
    /// tells them; no work where no vertex moves.
    pub(super) fn pin_work(
        &mut self,
        state: &State,
        input: &mut StepInput<'_>,
        tells: bool,
    ) -> Option<Real> {
        let held = (0..self.particles.len()).filter(|&v| self.particles.is_prescribed(v));
        let moves = held.clone().any(|v| state.velocities[v] != Vec3::zeros());
        if !moves && !tells {
            return None;
        }
        let (x, forces) = (
            &self.minimizer.current.positions,
            &mut self.minimizer.next.gradient,
        );
        forces.fill(Vec3::zeros());
        self.energies.add_gradient(x, forces);
        if let Some(damper) = &self.damper {
            damper.add_gradient(x, forces);
        }
        let mut work = 0.0;
        for v in held {
            work += forces[v].dot(&state.velocities[v]) * input.dt;
            if tells {
                input.add_pin_force(v, -forces[v]);
            }
        }
        moves.then_some(work)
    }

    /// Work (J) of gravity and load on the way to the end of the step.
    pub(super) fn steady_work(&self, state: &State, input: &StepInput<'_>) -> Real {
        let masses = self.particles.mass().iter();
        let masses = masses.zip(self.particles.inverse_mass()).enumerate();
        let work = masses.map(|(v, (m, w))| {
            let displacement = self.predicted[v] - state.positions[v];
            m * input.steady_acceleration(v, *w).dot(&displacement)
        });
        work.sum()
    }
}

//! Steps in several parts, where the cloth pushes bodies.

use super::Course;
use super::energy::EnergyBalance;
use crate::error::BenchError;
use cloth_collide::potential::ContactForces;
use cloth_core::math::Real;
use cloth_core::particles::State;
use cloth_core::step::{StepReport, Stepper};

impl Course<'_> {
    /// One step of `dt` (s), in parts where the cloth pushes a body. `balance` is told of the work done.
    pub(super) fn step(
        &mut self,
        stepper: &mut dyn Stepper,
        state: &mut State,
        dt: Real,
        mut balance: Option<&mut EnergyBalance>,
    ) -> Result<StepReport, BenchError> {
        self.mean_forces = None;
        let parts = self.scene.parts(dt);
        let part = dt / Real::from(parts);
        let mut report = self.part(stepper, state, part, balance.as_deref_mut())?;
        let (mut seconds, mut in_contact) = (self.seconds, self.contact_seconds());
        self.add_forces(parts);
        for _ in 1..parts {
            report = report.and(self.part(stepper, state, part, balance.as_deref_mut())?);
            seconds += self.seconds;
            in_contact += self.contact_seconds();
            self.add_forces(parts);
        }
        self.seconds = seconds;
        if let Some(contacts) = &mut self.contacts {
            contacts.seconds = in_contact;
        }
        self.put_bodies(state.time)?;
        if let Some(balance) = balance {
            balance.count_step();
        }
        Ok(report)
    }

    fn contact_seconds(&self) -> Real {
        self.contacts.as_ref().map_or(0.0, |c| c.seconds)
    }

    /// Adds the forces of one of several parts of a step.
    fn add_forces(&mut self, parts: u32) {
        if !self.forces || parts == 1 {
            return;
        }
        let forces = self
            .contacts
            .as_ref()
            .and_then(|c| c.source.contacts.forces());
        if let Some(forces) = forces {
            let mean = self.mean_forces.take().unwrap_or_default();
            self.mean_forces = Some(mean.plus(forces, 1.0 / Real::from(parts)));
        }
    }

    /// The forces of contact in the last step, if they are wanted.
    pub(super) fn forces(&self) -> Option<&ContactForces> {
        let last = || {
            self.contacts
                .as_ref()
                .and_then(|c| c.source.contacts.forces())
        };
        let forces = self.mean_forces.as_ref().or_else(last);
        forces.filter(|_| self.forces)
    }

    /// Takes the bodies of the scene that the cloth has pushed to where they are at `time` (s).
    fn put_bodies(&mut self, time: Real) -> Result<(), BenchError> {
        let Some(timed) = &self.contacts else {
            return Ok(());
        };
        if timed.source.contacts.free_motions().next().is_some()
            && let Some(touch) = &mut self.scene.to_mut().touch
        {
            touch.put(timed.source.contacts.free_motions(), time)?;
        }
        Ok(())
    }
}

//! Steps in several parts, where the method wants them or the cloth pushes bodies.
//!
//! Where it does, as many as resolve the frequency of a body on its contact, and twice as many where that is not
//! enough: a body moves before the cloth and takes up its push after it, so a method that minimises has felt a body
//! that is Δv Δt from where it should be. Where that is more than the thickness the part is taken back, and taken again
//! as two.

use super::Course;
use super::energy::EnergyBalance;
use super::pin_loads::PinLoads;
use super::timed::Timed;
use crate::error::BenchError;
use cloth_collide::potential::ContactForces;
use cloth_core::math::Real;
use cloth_core::particles::State;
use cloth_core::step::{StepReport, Stepper};

/// A part is halved so often at most.
const MOST_HALVINGS: u32 = 4;

/// What parts of a step have taken (s), and the size (s) of the step.
struct Taken {
    seconds: Real,
    in_contact: Real,
    dt: Real,
}

impl Course<'_> {
    /// One step of `dt` (s), in parts where the method wants them or the cloth pushes a body. `balance` is told of the
    /// work done.
    pub(super) fn step(
        &mut self,
        stepper: &mut dyn Stepper,
        state: &mut State,
        dt: Real,
        mut balance: Option<&mut EnergyBalance>,
    ) -> Result<StepReport, BenchError> {
        self.mean_forces = None;
        self.pin_loads.iter_mut().for_each(PinLoads::begin_step);
        self.untangling.begin_step();
        let parts = self.scene.parts(dt) * stepper.preferred_substeps();
        let part = dt / Real::from(parts);
        let mut taken = Taken {
            seconds: 0.0,
            in_contact: 0.0,
            dt,
        };
        let mut report: Option<StepReport> = None;
        for _ in 0..parts {
            let size = (part, MOST_HALVINGS);
            let next = self.resolve(stepper, state, size, balance.as_deref_mut(), &mut taken)?;
            report = Some(report.map_or(next, |report| report.and(next)));
        }
        self.seconds = taken.seconds;
        self.contact_seconds = taken.in_contact;
        self.put_bodies(state.time)?;
        if let Some(balance) = balance {
            balance.steps += 1;
        }
        report.ok_or_else(|| BenchError::Failed("a step of no parts".into()))
    }

    /// A part of `dt` (s), halved as long as the cloth pushes a body by more than the thickness from the way that it
    /// has taken before the cloth moved.
    fn resolve(
        &mut self,
        stepper: &mut dyn Stepper,
        state: &mut State,
        (dt, halvings): (Real, u32),
        mut balance: Option<&mut EnergyBalance>,
        taken: &mut Taken,
    ) -> Result<StepReport, BenchError> {
        let may_halve = halvings > 0 && !self.untangling.is_on() && self.is_pushing();
        let before = may_halve.then(|| {
            (
                state.clone(),
                balance.as_deref().map(|balance| balance.entries),
            )
        });
        let report = self.part(stepper, state, dt, balance.as_deref_mut())?;
        taken.seconds += self.seconds;
        taken.in_contact += self.contacts.as_ref().map_or(0.0, Timed::seconds);
        let pushed = self
            .contacts
            .as_ref()
            .map_or(0.0, |c| c.source.contacts.largest_push());
        let touch = self.scene.touch.as_ref();
        let thickness = touch.map_or(Real::INFINITY, |touch| touch.thickness);
        let Some((start, entries)) = before.filter(|_| pushed > thickness) else {
            self.add_forces(dt / taken.dt);
            return Ok(report);
        };
        *state = start;
        if let Some(contacts) = &mut self.contacts {
            contacts.source.contacts.take_back();
        }
        if let (Some(balance), Some(entries)) = (&mut balance, entries) {
            balance.entries = entries;
        }
        let half = (0.5 * dt, halvings - 1);
        let first = self.resolve(stepper, state, half, balance.as_deref_mut(), taken)?;
        Ok(first.and(self.resolve(stepper, state, half, balance, taken)?))
    }

    /// Whether the cloth can push a body.
    fn is_pushing(&self) -> bool {
        let bodies = self.contacts.as_ref();
        bodies.is_some_and(|c| c.source.contacts.free_motions().next().is_some())
    }

    /// Adds the forces of one of several parts of a step, which is `share` of it.
    fn add_forces(&mut self, share: Real) {
        self.pin_loads.iter_mut().for_each(|pins| pins.add(share));
        if !self.forces || share == 1.0 {
            return;
        }
        let forces = self
            .contacts
            .as_ref()
            .and_then(|c| c.source.contacts.forces());
        if let Some(forces) = forces {
            let mean = self.mean_forces.take().unwrap_or_default();
            self.mean_forces = Some(mean.plus(forces, share));
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
        if self.is_pushing()
            && let Some(touch) = &mut self.scene.to_mut().touch
        {
            touch.put(timed.source.contacts.free_motions(), time)?;
        }
        Ok(())
    }
}

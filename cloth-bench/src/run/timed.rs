//! Contact with a clock.

use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactSource, ContactStep,
};
use cloth_core::enclosure::Enclosed;
use cloth_core::math::{Real, Vec3};
use std::time::Instant;

/// Contact, with the volumes of the cloth, and how long it took.
pub(super) struct Timed {
    pub(super) source: Enclosed<PotentialContacts>,
    /// Time of the last step (s).
    pub(super) seconds: Real,
    /// Steps, of all so far, that ended with vertices held back.
    pub(super) held_steps: u32,
}

impl ContactSource for Timed {
    fn keep_free(
        &mut self,
        from: &[Vec3],
        inverse_mass: &[Real],
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.source.keep_free(from, inverse_mass, x)
    }

    fn held(&self) -> usize {
        self.source.held()
    }

    fn potential(&mut self) -> &mut dyn ContactPotential {
        self.source.potential()
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        self
    }

    fn work(&self) -> Real {
        self.source.work()
    }

    fn potential_energy(&self) -> Real {
        self.source.potential_energy()
    }
}

impl Timed {
    /// Lets the constraints act, and adds the time.
    fn act<T>(&mut self, act: impl FnOnce(&mut dyn ContactConstraints) -> T) -> T {
        let started = Instant::now();
        let acted = act(self.source.constraints());
        self.seconds += started.elapsed().as_secs_f64();
        acted
    }
}

impl ContactConstraints for Timed {
    fn begin_step(&mut self, step: &ContactStep<'_>) -> Result<(), ContactError> {
        self.act(|c| c.begin_step(step))
    }

    fn begin_substep(
        &mut self,
        step: &ContactStep<'_>,
        predicted: &[Vec3],
    ) -> Result<(), ContactError> {
        self.act(|c| c.begin_substep(step, predicted))
    }

    fn sweep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) {
        self.act(|c| c.sweep(step, x));
    }

    fn end_substep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        self.act(|c| c.end_substep(step, x))
    }

    fn change_velocities(&mut self, velocities: &mut [Vec3]) {
        self.act(|c| c.change_velocities(velocities));
    }

    fn given(&mut self, x: &[Vec3]) -> Real {
        self.act(|c| c.given(x))
    }

    fn end_step(&mut self, x: &[Vec3]) {
        self.act(|c| c.end_step(x));
    }
}

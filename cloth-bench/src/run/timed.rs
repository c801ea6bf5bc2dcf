//! Contact with a clock.

use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactRow, ContactSource, ContactStep,
    GlobalRows,
};
use cloth_core::enclosure::Enclosed;
use cloth_core::math::{Real, Vec3};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Contact, with the volumes of the cloth, and how long it took.
#[derive(Debug)]
pub(super) struct Timed {
    pub(super) source: Enclosed<PotentialContacts>,
    clock: Clock,
    /// Steps, of all so far, that ended with truncated displacements.
    pub(super) truncated_steps: u32,
    /// Those that ended with pinched cloth in a body, and how many of its vertices at most.
    pub(super) pinched_steps: u32,
    pub(super) most_pinched: u32,
    /// Held vertices that were in a body at any time, and its number each; see
    /// [`PotentialContacts::prescribed_inside`].
    pub(super) held_inside: Vec<[u32; 2]>,
}

impl ContactSource for Timed {
    fn keep_free(
        &mut self,
        from: &[Vec3],
        inverse_mass: &[Real],
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        let Self { source, clock, .. } = self;
        clock.time(|| source.keep_free(from, inverse_mass, x))
    }

    fn can_touch(&self) -> bool {
        self.source.can_touch()
    }

    fn check_time(&self, time: Real, dt: Real) -> Result<(), ContactError> {
        self.source.check_time(time, dt)
    }

    fn truncated_count(&self) -> usize {
        self.source.truncated_count()
    }

    fn potential(&mut self) -> &mut dyn ContactPotential {
        self
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

/// The time (ns) that has been taken so far. It can be added to while contact is only read, and from any thread.
#[derive(Debug, Default)]
struct Clock(AtomicU64);

impl Clock {
    /// Lets something act, and adds the time.
    fn time<T>(&self, act: impl FnOnce() -> T) -> T {
        let started = Instant::now();
        let acted = act();
        // A step of 2⁶⁴ ns would last five centuries.
        let taken = started.elapsed().as_nanos() as u64;
        self.0.fetch_add(taken, Ordering::Relaxed);
        acted
    }
}

impl Timed {
    pub(super) fn new(source: Enclosed<PotentialContacts>) -> Self {
        Self {
            source,
            clock: Clock::default(),
            truncated_steps: 0,
            pinched_steps: 0,
            most_pinched: 0,
            held_inside: Vec::new(),
        }
    }

    /// Takes notice of how a step has ended, in which the cloth was still pulled apart or not.
    pub(super) fn count(&mut self, is_tangled: bool) {
        self.truncated_steps += u32::from(self.source.truncated_count() > 0);
        let pinched = match is_tangled {
            true => 0,
            false => self.source.contacts.pinched() as u32,
        };
        self.pinched_steps += u32::from(pinched > 0);
        self.most_pinched = self.most_pinched.max(pinched);
        let held = self.source.contacts.prescribed_inside().iter();
        let known = &mut self.held_inside;
        let new: Vec<_> = held.filter(|pair| !known.contains(pair)).collect();
        known.extend(new);
    }

    /// Time (s) that contact has taken since the clock was set.
    pub(super) fn seconds(&self) -> Real {
        1e-9 * self.clock.0.load(Ordering::Relaxed) as Real
    }

    /// Sets the clock to zero.
    pub(super) fn reset(&mut self) {
        self.clock = Clock::default();
    }

    /// Lets the constraints act, and adds the time.
    fn act<T>(&mut self, act: impl FnOnce(&mut dyn ContactConstraints) -> T) -> T {
        let Self { source, clock, .. } = self;
        clock.time(|| act(source.constraints()))
    }

    /// Lets the potential act, and adds the time.
    fn change<T>(&mut self, act: impl FnOnce(&mut dyn ContactPotential) -> T) -> T {
        let Self { source, clock, .. } = self;
        clock.time(|| act(source.potential()))
    }

    /// Asks the potential, and adds the time: of the same implementation that [`Timed::change`] lets act.
    fn ask<T>(&self, ask: impl FnOnce(&dyn ContactPotential) -> T) -> T {
        let potential: &dyn ContactPotential = match self.source.volumes().is_empty() {
            true => &self.source.contacts,
            false => &self.source,
        };
        self.clock.time(|| ask(potential))
    }
}

impl ContactPotential for Timed {
    fn begin(&mut self, step: &ContactStep<'_>, start: &mut [Vec3]) -> Result<(), ContactError> {
        self.change(|p| p.begin(step, start))
    }

    fn limit(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<Real, ContactError> {
        self.change(|p| p.limit(from, to))
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        self.change(|p| p.limit_each(from, to, fractions))
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        self.ask(|p| p.add_gradient(x, out))
    }

    fn linearize(&self, x: &[Vec3], out: &mut Vec<ContactRow>) {
        self.ask(|p| p.linearize(x, out));
    }

    fn linearize_globally(&self, x: &[Vec3], out: &mut GlobalRows) {
        self.ask(|p| p.linearize_globally(x, out));
    }

    fn linearization_errors(&self, x: &[Vec3], to: &[Vec3], out: &mut Vec<Real>) {
        self.ask(|p| p.linearization_errors(x, to, out));
    }

    fn update_multipliers(&mut self, x: &[Vec3], direction: &[Vec3]) {
        self.change(|p| p.update_multipliers(x, direction));
    }

    fn has_free_bodies(&self) -> bool {
        self.ask(|p| p.has_free_bodies())
    }

    fn end(&mut self, x: &[Vec3], v: &mut [Vec3]) {
        self.change(|p| p.end(x, v));
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

//! Closed volumes beside contact: the same hook, with the energy of the volumes added.

use super::ClosedVolume;
use crate::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactRow, ContactSource, ContactStep,
    GlobalRows,
};
use crate::math::{Real, Vec3};

/// Volumes that the cloth encloses, beside what it can touch. A method feels both at once: as one energy, or as
/// constraints in every substep, the volumes before the contacts.
///
/// ```
/// use cloth_core::enclosure::{ClosedVolume, Enclosed};
/// use cloth_core::mesh::generate::sphere;
/// use cloth_core::step::StepInput;
///
/// let ball = sphere(4, 0.1)?; // m
/// let air = ClosedVolume::new(1e5, &ball)?; // Pa
/// let mut inside = Enclosed::alone(vec![air]);
/// let input = StepInput::new(0.01).contacts(&mut inside); // for the step of any solver
/// # let _ = input;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Enclosed<C> {
    volumes: Vec<ClosedVolume>,
    /// What the cloth can touch.
    pub contacts: C,
    /// Where a step begins (m), and which vertices are prescribed in it.
    start: Vec<Vec3>,
    is_prescribed: Vec<bool>,
    /// Of the gradients there, and at its end, on prescribed vertices (N).
    gradients: [Vec<Vec3>; 2],
    /// Where the last step began, or ended; and of that step (J).
    energy: Real,
    work: Real,
}

/// Nothing that the cloth could touch.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoContact;

impl Enclosed<NoContact> {
    /// Volumes of a cloth that touches nothing.
    #[must_use]
    pub fn alone(volumes: Vec<ClosedVolume>) -> Self {
        Self::new(volumes, NoContact)
    }
}

impl<C> Enclosed<C> {
    /// Volumes beside contacts.
    #[must_use]
    pub fn new(volumes: Vec<ClosedVolume>, contacts: C) -> Self {
        Self {
            volumes,
            contacts,
            start: Vec::new(),
            is_prescribed: Vec::new(),
            gradients: Default::default(),
            energy: 0.0,
            work: 0.0,
        }
    }

    /// The volumes.
    #[must_use]
    pub fn volumes(&self) -> &[ClosedVolume] {
        &self.volumes
    }

    /// The energy (J) of the volumes with the vertices at `x` (m).
    fn stored(&self, x: &[Vec3]) -> Real {
        self.volumes.iter().map(|volume| volume.energy(x)).sum()
    }

    fn begin_at(&mut self, step: &ContactStep<'_>) {
        self.start.clear();
        self.start.extend_from_slice(step.from);
        self.is_prescribed.clear();
        let prescribed = step.inverse_mass.iter().map(|&w| w == 0.0);
        self.is_prescribed.extend(prescribed);
        self.energy = self.stored(step.from);
    }

    fn end_at(&mut self, x: &[Vec3]) {
        self.energy = self.stored(x);
        self.work = self.work_until(x);
    }

    /// The work (J) that prescribed vertices have done against the volumes, by the mean of the forces at both ends of
    /// the step.
    fn work_until(&mut self, x: &[Vec3]) -> Real {
        let moved = |v: usize| self.is_prescribed[v] && x[v] != self.start[v];
        if !(0..x.len()).any(moved) {
            return 0.0;
        }
        for (gradient, at) in self.gradients.iter_mut().zip([&self.start[..], x]) {
            gradient.clear();
            gradient.resize(x.len(), Vec3::zeros());
            for volume in &self.volumes {
                volume.add_gradient(at, gradient);
            }
        }
        let [first, last] = &self.gradients;
        let prescribed = (0..x.len()).filter(|&v| self.is_prescribed[v]);
        let works = prescribed.map(|v| 0.5 * (first[v] + last[v]).dot(&(x[v] - self.start[v])));
        works.sum()
    }
}

impl<C> ContactSource for Enclosed<C>
where
    C: ContactSource + ContactPotential + ContactConstraints,
{
    fn potential(&mut self) -> &mut dyn ContactPotential {
        match self.volumes.is_empty() {
            true => self.contacts.potential(),
            false => self,
        }
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        match self.volumes.is_empty() {
            true => self.contacts.constraints(),
            false => self,
        }
    }

    fn keep_free(
        &mut self,
        from: &[Vec3],
        inverse_mass: &[Real],
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.contacts.keep_free(from, inverse_mass, x)
    }

    fn work(&self) -> Real {
        self.contacts.work() + self.work
    }

    fn potential_energy(&self) -> Real {
        self.contacts.potential_energy() + self.energy
    }

    fn can_touch(&self) -> bool {
        !self.volumes.is_empty() || self.contacts.can_touch()
    }

    fn truncated_count(&self) -> usize {
        self.contacts.truncated_count()
    }

    fn check_time(&self, time: Real, dt: Real) -> Result<(), ContactError> {
        self.contacts.check_time(time, dt)
    }
}

impl<C: ContactPotential> ContactPotential for Enclosed<C> {
    fn begin(&mut self, step: &ContactStep<'_>, start: &mut [Vec3]) -> Result<(), ContactError> {
        self.begin_at(step);
        self.contacts.begin(step, start)
    }

    fn limit(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<Real, ContactError> {
        self.contacts.limit(from, to)
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        self.contacts.limit_each(from, to, fractions)
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let touching = self.contacts.add_gradient(x, out);
        let volumes = self.volumes.iter();
        touching
            + volumes
                .map(|volume| volume.add_gradient(x, out))
                .sum::<Real>()
    }

    fn linearize(&self, x: &[Vec3], out: &mut Vec<ContactRow>) {
        self.contacts.linearize(x, out);
    }

    fn linearize_globally(&self, x: &[Vec3], out: &mut GlobalRows) {
        self.contacts.linearize_globally(x, out);
        self.volumes
            .iter()
            .for_each(|volume| volume.linearize(x, out));
    }

    fn linearization_errors(&self, x: &[Vec3], to: &[Vec3], out: &mut Vec<Real>) {
        self.contacts.linearization_errors(x, to, out);
    }

    fn update_multipliers(&mut self, x: &[Vec3], direction: &[Vec3]) {
        self.contacts.update_multipliers(x, direction);
    }

    fn has_free_bodies(&self) -> bool {
        self.contacts.has_free_bodies()
    }

    fn end(&mut self, x: &[Vec3], v: &mut [Vec3]) {
        self.contacts.end(x, v);
        self.end_at(x);
    }
}

impl<C: ContactConstraints> ContactConstraints for Enclosed<C> {
    fn begin_step(&mut self, step: &ContactStep<'_>) -> Result<(), ContactError> {
        self.begin_at(step);
        self.contacts.begin_step(step)
    }

    fn begin_substep(
        &mut self,
        step: &ContactStep<'_>,
        predicted: &[Vec3],
    ) -> Result<(), ContactError> {
        for volume in &mut self.volumes {
            volume.begin_substep(step.inverse_mass, step.from);
        }
        self.contacts.begin_substep(step, predicted)
    }

    fn sweep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) {
        for volume in &mut self.volumes {
            volume.project(step.inverse_mass, step.dt, x);
        }
        self.contacts.sweep(step, x);
    }

    fn end_substep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        self.contacts.end_substep(step, x)
    }

    fn change_velocities(&mut self, velocities: &mut [Vec3]) {
        self.contacts.change_velocities(velocities);
    }

    fn given(&mut self, x: &[Vec3]) -> Real {
        let of_contact = self.contacts.given(x);
        of_contact + self.work_until(x) + self.energy - self.stored(x)
    }

    fn end_step(&mut self, x: &[Vec3]) {
        self.contacts.end_step(x);
        self.end_at(x);
    }
}

impl ContactSource for NoContact {
    fn potential(&mut self) -> &mut dyn ContactPotential {
        self
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        self
    }

    fn keep_free(&mut self, _: &[Vec3], _: &[Real], _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }
}

impl ContactPotential for NoContact {
    fn begin(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn limit(&mut self, _: &[Vec3], _: &[Vec3]) -> Result<Real, ContactError> {
        Ok(1.0)
    }

    fn limit_each(
        &mut self,
        _: &[Vec3],
        _: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        fractions.fill(1.0);
        Ok(())
    }

    fn add_gradient(&self, _: &[Vec3], _: &mut [Vec3]) -> Real {
        0.0
    }

    fn linearize(&self, _: &[Vec3], _: &mut Vec<ContactRow>) {}

    fn end(&mut self, _: &[Vec3], _: &mut [Vec3]) {}
}

impl ContactConstraints for NoContact {
    fn begin_step(&mut self, _: &ContactStep<'_>) -> Result<(), ContactError> {
        Ok(())
    }

    fn begin_substep(&mut self, _: &ContactStep<'_>, _: &[Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn sweep(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) {}

    fn end_substep(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn change_velocities(&mut self, _: &mut [Vec3]) {}

    fn end_step(&mut self, _: &[Vec3]) {}
}

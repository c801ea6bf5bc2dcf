//! What is lent is a source too: for whoever keeps one, and lends it to something around it.

use super::{
    ContactConstraints, ContactError, ContactPotential, ContactRow, ContactSource, ContactStep,
    GlobalRows,
};
use crate::math::{Real, Vec3};

impl<T: ContactSource + ?Sized> ContactSource for &mut T {
    fn potential(&mut self) -> &mut dyn ContactPotential {
        (**self).potential()
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        (**self).constraints()
    }

    fn keep_free(
        &mut self,
        from: &[Vec3],
        inverse_mass: &[Real],
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        (**self).keep_free(from, inverse_mass, x)
    }

    fn work(&self) -> Real {
        (**self).work()
    }

    fn potential_energy(&self) -> Real {
        (**self).potential_energy()
    }

    fn take_back(&mut self) {
        (**self).take_back();
    }

    fn can_touch(&self) -> bool {
        (**self).can_touch()
    }

    fn check_time(&self, time: Real, dt: Real) -> Result<(), ContactError> {
        (**self).check_time(time, dt)
    }

    fn truncated_count(&self) -> usize {
        (**self).truncated_count()
    }
}

impl<T: ContactPotential + ?Sized> ContactPotential for &mut T {
    fn begin(&mut self, step: &ContactStep<'_>, start: &mut [Vec3]) -> Result<(), ContactError> {
        (**self).begin(step, start)
    }

    fn limit(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<Real, ContactError> {
        (**self).limit(from, to)
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        (**self).limit_each(from, to, fractions)
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        (**self).add_gradient(x, out)
    }

    fn linearize(&self, x: &[Vec3], out: &mut Vec<ContactRow>) {
        (**self).linearize(x, out);
    }

    fn linearize_globally(&self, x: &[Vec3], out: &mut GlobalRows) {
        (**self).linearize_globally(x, out);
    }

    fn linearization_errors(&self, x: &[Vec3], to: &[Vec3], out: &mut Vec<Real>) {
        (**self).linearization_errors(x, to, out);
    }

    fn update_multipliers(&mut self, x: &[Vec3], direction: &[Vec3]) {
        (**self).update_multipliers(x, direction);
    }

    fn has_free_bodies(&self) -> bool {
        (**self).has_free_bodies()
    }

    fn end(&mut self, x: &[Vec3], v: &mut [Vec3]) {
        (**self).end(x, v);
    }
}

impl<T: ContactConstraints + ?Sized> ContactConstraints for &mut T {
    fn begin_step(&mut self, step: &ContactStep<'_>) -> Result<(), ContactError> {
        (**self).begin_step(step)
    }

    fn begin_substep(
        &mut self,
        step: &ContactStep<'_>,
        predicted: &[Vec3],
    ) -> Result<(), ContactError> {
        (**self).begin_substep(step, predicted)
    }

    fn sweep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) {
        (**self).sweep(step, x);
    }

    fn end_substep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        (**self).end_substep(step, x)
    }

    fn change_velocities(&mut self, velocities: &mut [Vec3]) {
        (**self).change_velocities(velocities);
    }

    fn given(&mut self, x: &[Vec3]) -> Real {
        (**self).given(x)
    }

    fn end_step(&mut self, x: &[Vec3]) {
        (**self).end_step(x);
    }
}

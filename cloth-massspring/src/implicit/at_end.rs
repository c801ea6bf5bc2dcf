//! Contact at the end of a step whose stage is solved for its middle.
//!
//! Contact has to be detected where the cloth will be, `x[1] = 2x − x[0]`, not in the middle. And it is to be
//! inelastic: a force in the middle would throw back what it stops, since the midpoint rule keeps all energy. So the
//! force of contact, f, is split. The lasting part f[0] acts like all other forces, so that what rests stays at rest.
//! It is what the forces at the ends of the last two steps have in common: the last one, shortened to the component of
//! the other along it where that is less, and zero where it points the other way. The new part f(x[1]) − f[0] acts over
//! the whole step, as in implicit Euler:
//!
//! ```text
//! v[1] = v[0] + Δt M⁻¹ (f_other((x[0] + x[1])/2) + f(x[1]))
//! x[1] = x[0] + ½ Δt (v[0] + v[1]) + ½ Δt² M⁻¹ (f(x[1]) − f[0])
//! ```
//!
//! The x of that is the stationary point of the midpoint's objective plus `E_contact(2x − x[0]) + f[0]·x`, whose forces
//! are `2 f(x[1]) − f[0]`. The velocity that follows from it has one `Δt M⁻¹ (f(x[1]) − f[0])` too many, which
//! `correct_velocities` takes away. Drag and damping are in f_other, with the velocity of the stage,
//! `(x[1] − x[0])/Δt`: where contact is new that is not the mean of v[0] and v[1], but `½ Δt M⁻¹ (f(x[1]) − f[0])`
//! more. (With the drag α at the mean it would be `Δt/(1 + ατ) M⁻¹ (f(x[1]) − f[0])` too many, τ = Δt/2.)

use cloth_core::contact::{ContactError, ContactPotential, ContactRow, ContactStep, GlobalRows};
use cloth_core::math::{Real, Vec3};
use std::sync::{Mutex, PoisonError};

/// The contact of the end of a step as that of its middle: its energy is `E(2x − x[0])`.
#[derive(Debug)]
pub(super) struct AtEnd<'a> {
    pub(super) contact: &'a mut dyn ContactPotential,
    /// x[0] (m).
    pub(super) start: &'a [Vec3],
    pub(super) memory: &'a mut EndContactMemory,
}

/// What contact at the end of a step leaves to the next, and buffers.
#[derive(Debug, Default)]
pub(super) struct EndContactMemory {
    /// Gradients (N) of contact at the ends of the last two steps, and what of them lasts.
    last: [Vec<Vec3>; 2],
    lasting: Vec<Vec3>,
    /// For the ends of a path (m), and for a gradient (N).
    ends: [Vec<Vec3>; 2],
    shared: Mutex<[Vec<Vec3>; 2]>,
}

/// What two forces (N) have in common.
fn lasting(now: Vec3, before: Vec3) -> Vec3 {
    let common = now.dot(&before);
    if common <= 0.0 {
        return Vec3::zeros();
    }
    now * (common / now.norm_squared()).min(1.0)
}

impl EndContactMemory {
    /// Takes the force of the last step's contact, of which there is none if the cloth has come from elsewhere, into
    /// the predicted positions (m) of a stage with the time s (s) of its inertia.
    pub(super) fn apply_lasting_force(
        &mut self,
        from_elsewhere: bool,
        inverse_mass: &[Real],
        s: Real,
        predicted: &mut [Vec3],
    ) {
        if from_elsewhere {
            self.last.iter_mut().for_each(Vec::clear);
        }
        self.last
            .iter_mut()
            .for_each(|g| g.resize(predicted.len(), Vec3::zeros()));
        self.lasting.clear();
        let both = self.last[0].iter().zip(&self.last[1]);
        self.lasting.extend(both.map(|(a, b)| lasting(*a, *b)));
        for ((x, g), w) in predicted.iter_mut().zip(&self.lasting).zip(inverse_mass) {
            *x += *g * (*w * s * s);
        }
    }

    /// Takes the new force of contact at the end `x` (m) of a step of `dt` (s) out of the velocities (m/s) once: it
    /// counts twice in those that follow from the middle.
    pub(super) fn correct_velocities(
        &mut self,
        contact: &dyn ContactPotential,
        x: &[Vec3],
        inverse_mass: &[Real],
        dt: Real,
        velocities: &mut [Vec3],
    ) {
        let mut now = std::mem::take(&mut self.ends[0]);
        now.clear();
        now.resize(x.len(), Vec3::zeros());
        contact.add_gradient(x, &mut now);
        let changes = now.iter().zip(&self.lasting).zip(inverse_mass);
        for (v, ((now, before), w)) in velocities.iter_mut().zip(changes) {
            *v += (now - before) * (*w * dt);
        }
        let [last, older] = &mut self.last;
        std::mem::swap(last, older);
        self.ends[0] = std::mem::replace(last, now);
    }
}

impl AtEnd<'_> {
    fn ends<'e>(&self, x: &[Vec3], ends: &'e mut Vec<Vec3>) -> &'e mut [Vec3] {
        ends.clear();
        ends.extend(x.iter().zip(self.start).map(|(x, start)| x * 2.0 - start));
        ends
    }

    fn middles(&self, ends: &[Vec3], x: &mut [Vec3]) {
        for ((x, end), start) in x.iter_mut().zip(ends).zip(self.start) {
            *x = (end + start) * 0.5;
        }
    }
}

impl ContactPotential for AtEnd<'_> {
    fn begin(&mut self, step: &ContactStep<'_>, start: &mut [Vec3]) -> Result<(), ContactError> {
        let mut ends = std::mem::take(&mut self.memory.ends[0]);
        let wanted = self.ends(start, &mut ends);
        let begun = self.contact.begin(step, wanted);
        self.middles(wanted, start);
        self.memory.ends[0] = ends;
        begun
    }

    fn limit(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<Real, ContactError> {
        let [mut a, mut b] = std::mem::take(&mut self.memory.ends);
        let fraction = self
            .contact
            .limit(self.ends(from, &mut a), self.ends(to, &mut b));
        self.memory.ends = [a, b];
        fraction
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        let [mut a, mut b] = std::mem::take(&mut self.memory.ends);
        self.ends(from, &mut a);
        let ends = self.ends(to, &mut b);
        let limited = self.contact.limit_each(&a, ends, fractions);
        self.middles(ends, to);
        self.memory.ends = [a, b];
        limited
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let shared = self.memory.shared.lock();
        let [ends, gradient] = &mut *shared.unwrap_or_else(PoisonError::into_inner);
        gradient.clear();
        gradient.resize(x.len(), Vec3::zeros());
        let value = self.contact.add_gradient(self.ends(x, ends), gradient);
        for (out, gradient) in out.iter_mut().zip(gradient) {
            *out += *gradient * 2.0;
        }
        value
    }

    fn linearize(&self, x: &[Vec3], out: &mut Vec<ContactRow>) {
        let first = out.len();
        let shared = self.memory.shared.lock();
        let [ends, _] = &mut *shared.unwrap_or_else(PoisonError::into_inner);
        self.contact.linearize(self.ends(x, ends), out);
        out[first..].iter_mut().for_each(|row| row.stiffness *= 4.0);
    }

    fn linearize_globally(&self, x: &[Vec3], out: &mut GlobalRows) {
        let first = out.rows().len();
        let shared = self.memory.shared.lock();
        let [ends, _] = &mut *shared.unwrap_or_else(PoisonError::into_inner);
        self.contact.linearize_globally(self.ends(x, ends), out);
        let own = &mut out.rows_mut()[first..];
        own.iter_mut().for_each(|row| row.stiffness *= 4.0);
    }

    fn linearization_errors(&self, x: &[Vec3], to: &[Vec3], out: &mut Vec<Real>) {
        let first = out.len();
        let shared = self.memory.shared.lock();
        let [from, end] = &mut *shared.unwrap_or_else(PoisonError::into_inner);
        self.contact
            .linearization_errors(self.ends(x, from), self.ends(to, end), out);
        out[first..].iter_mut().for_each(|error| *error *= 0.5);
    }

    fn update_multipliers(&mut self, x: &[Vec3], direction: &[Vec3]) {
        let [mut ends, mut twice] = std::mem::take(&mut self.memory.ends);
        twice.clear();
        twice.extend(direction.iter().map(|p| p * 2.0));
        self.contact
            .update_multipliers(self.ends(x, &mut ends), &twice);
        self.memory.ends = [ends, twice];
    }

    fn end(&mut self, x: &[Vec3], v: &mut [Vec3]) {
        let mut ends = std::mem::take(&mut self.memory.ends[0]);
        self.contact.end(self.ends(x, &mut ends), v);
        self.memory.ends[0] = ends;
    }
}

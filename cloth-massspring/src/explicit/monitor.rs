//! Notices that a run is unstable before its numbers are nonsense.
//!
//! Two signs. The step is beyond the stable one: known before any harm is done, but only as well as the last estimate
//! still holds. Or the cloth has more kinetic energy than it can have: `K ≤ (K + E)₀ + W − E`, with `W` the work of
//! gravity, load, pins and moving bodies; exact solutions obey, and a run that breaks it by a large factor has blown
//! up, whatever the reason. Sums of squares are at least 0, and E is left out where it is. The cubic shell
//! ([`CubicShell`](cloth_core::energy::CubicShell), bending of third order in the positions) has no least energy, and
//! where E is negative it counts. A run that a cubic shell tears apart ends when its numbers overflow.
//!
//! The account goes on where contact has changed the end of a step. Contact with what does not move takes energy or
//! leaves it, so all that contact is credited with is the work of bodies ([`ContactSource::work`]): stretch that it
//! leaves by moving vertices apart is energy from nowhere, and counts as such when it becomes motion. A cloth that
//! starts nearer to something than the thickness is given what contact holds there, as the first substep finds it.

use super::{EnergyBalance, Failure, Model};
use crate::stability::Spectrum;
use cloth_core::contact::ContactSource;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{kinetic_energy, rounding_energy};
use cloth_core::particles::Particles;

/// Substeps after which the estimate is repeated.
const FRESH_FOR: u32 = 256;
/// Growth of the kinetic energy after which it is repeated, whatever its age.
const GROWTH: Real = 4.0;
/// Kinetic energy over what the cloth started with and was given, from which on a run counts as blown up.
///
/// In a stable run of symplectic Euler an oscillation can show `(2 + z)/(2 − z)` times its least energy: 100 is reached
/// at `z` = 1.96. (It keeps `x² + y² − z x y`, y = v/ω, which is between `1 − z/2` and `1 + z/2` times `x² + y²`.)
const GAIN: Real = 100.0;
/// Margin of the comparison with the limit, for a step that was computed to be equal to it.
const EQUAL: Real = 1.0 + 1e-12;

/// The memory of the monitor.
#[derive(Debug)]
pub(super) struct StabilityMonitor {
    spectrum: Spectrum,
    /// The last estimate (s), if one was made and there is stiffness.
    limit: Option<Real>,
    /// Substeps since then; `None` before the first.
    age: Option<u32>,
    /// Largest kinetic energy (J) that the estimate has been made for.
    kinetic: Real,
    /// `(K + E)₀ + W` (J).
    given: Real,
    /// The largest value it has had, with what elements of negative energy have given (J).
    most_given: Real,
    /// The state as the last step left it, in two numbers.
    left: Option<[Real; 2]>,
}

impl StabilityMonitor {
    pub(super) fn new(particles: &Particles) -> Self {
        Self {
            spectrum: Spectrum::new(particles),
            limit: None,
            age: None,
            kinetic: 0.0,
            given: 0.0,
            most_given: 0.0,
            left: None,
        }
    }

    /// The largest stable substep (s) by the last estimate.
    pub(super) fn limit(&self) -> Option<Real> {
        self.limit
    }

    /// Starts the account of energy anew if this is not the state that the last step left. Beside its elements the
    /// cloth has `stored` some energy (J). Returns whether it did.
    pub(super) fn begin(
        &mut self,
        model: &Model,
        positions: &[Vec3],
        velocities: &[Vec3],
        stored: Real,
    ) -> bool {
        if self.left == Some(fingerprint(&model.particles, positions, velocities)) {
            return false;
        }
        self.age = None;
        self.kinetic = kinetic_energy(&model.particles, velocities);
        self.given = self.kinetic + model.energies.value(positions) + stored;
        self.most_given = self.given;
        true
    }

    /// Enters an energy (J) that contact held at the start of the account, where it was above zero.
    pub(super) fn add_stored(&mut self, energy: Real) {
        self.add_work(energy.max(0.0));
    }

    /// Enters work (J) that was done on the cloth.
    pub(super) fn add_work(&mut self, work: Real) {
        self.given += work;
        self.most_given = self.most_given.max(self.given);
    }

    /// Notes the state that a step leaves, and what moving bodies among the `contacts` have done in it.
    pub(super) fn end(
        &mut self,
        model: &Model,
        positions: &[Vec3],
        velocities: &[Vec3],
        contacts: Option<&dyn ContactSource>,
    ) -> Result<(), Failure> {
        if let Some(contacts) = contacts {
            self.add_work(contacts.work());
            // Springs may have been stretched.
            self.age = None;
            self.check(
                model,
                positions,
                kinetic_energy(&model.particles, velocities),
            )?;
        }
        self.left = Some(fingerprint(&model.particles, positions, velocities));
        Ok(())
    }

    /// A step has failed: the next one starts a new account.
    pub(super) fn reset(&mut self) {
        self.left = None;
    }

    /// Lets a substep of `dt` (s) pass, or not.
    pub(super) fn admit(
        &mut self,
        model: &Model,
        positions: &[Vec3],
        dt: Real,
    ) -> Result<(), Failure> {
        if self.age.is_none_or(|age| age >= FRESH_FOR) {
            let (energies, particles) = (&model.energies, &model.particles);
            let undamped = self
                .spectrum
                .stable_time_step(energies, particles, positions);
            self.limit = model.config.damping.stable_step(undamped);
            self.age = Some(0);
            // Energy that rounding can put in, so that a cloth at rest does not raise the alarm.
            let size = positions.iter().map(Vec3::amax).fold(0.0, Real::max);
            let mass: Real = particles.mass().iter().sum();
            self.most_given = self.most_given.max(rounding_energy(mass, size, dt));
        }
        match self.limit {
            Some(limit) if dt > limit * EQUAL => Err(Failure::TooLarge),
            _ => Ok(()),
        }
    }

    /// Enters what a substep to these positions (m) did into the account, and checks it if it `is_complete`.
    pub(super) fn account(
        &mut self,
        model: &Model,
        positions: &[Vec3],
        balance: &EnergyBalance,
        is_complete: bool,
    ) -> Result<(), Failure> {
        self.add_work(balance.work + balance.pin_work);
        self.age = self.age.map(|age| age + 1);
        if balance.kinetic > GROWTH * self.kinetic {
            self.kinetic = balance.kinetic;
            self.age = None;
        }
        if is_complete {
            self.check(model, positions, balance.kinetic)?;
        }
        Ok(())
    }

    /// Whether a kinetic energy (J) at these positions (m) can come from what was given.
    fn check(&mut self, model: &Model, positions: &[Vec3], kinetic: Real) -> Result<(), Failure> {
        if kinetic > GAIN * self.most_given {
            let stored = model.energies.value(positions);
            self.most_given = self.most_given.max(self.given - stored.min(0.0));
        }
        if kinetic > GAIN * self.most_given {
            return Err(Failure::Gain {
                kinetic,
                given: self.most_given,
            });
        }
        Ok(())
    }
}

/// Two sums that change when anything else than a pin's velocity does.
fn fingerprint(particles: &Particles, positions: &[Vec3], velocities: &[Vec3]) -> [Real; 2] {
    let places = positions.iter().map(Vec3::norm_squared).sum();
    let speeds = particles.inverse_mass().iter().zip(velocities);
    let free = speeds.filter(|(w, _)| **w != 0.0);
    [places, free.map(|(_, v)| v.norm_squared()).sum()]
}

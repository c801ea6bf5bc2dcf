//! Notices that the midpoint rule in contact makes energy.
//!
//! Alone it keeps quadratic energies, and lets others grow slowly where the step does not resolve them. Contact at the
//! end of the step adds to that: what it stops, and the ringing that nothing damps, can stretch stiff cloth more from
//! step to step, until it moves at any speed, with every stage at its minimum. So an account is kept, as the explicit
//! methods keep one: `K ≤ (K + E)₀ + W − E`, with `W` the work of gravity, load, pins, elements that change with time
//! and moving bodies. It begins with the state that the first step in contact leaves, since nobody knows before what
//! contact holds. With air there is none.

use cloth_core::math::{Real, Vec3};
use cloth_core::measure::rounding_energy;
use cloth_core::method::family::Energies;
use cloth_core::particles::{Particles, State};
use cloth_core::step::StepError;

/// Kinetic energy over what the cloth had and was given, from which on a step is refused.
const GAIN: Real = 100.0;

/// The account, if there is one.
#[derive(Debug, Default)]
pub(super) struct EnergyGuard(Option<Account>);

#[derive(Debug)]
struct Account {
    /// `(K + E)₀ + W` (J), and the largest value it has had.
    given: Real,
    most_given: Real,
    /// K (J) of the state that the last step has left, or the next one begins with.
    kinetic: Real,
}

/// What a step has come to.
pub(super) struct Ended<'a> {
    pub(super) particles: &'a Particles,
    pub(super) energies: &'a Energies,
    /// Positions (m) and velocities (m/s).
    pub(super) positions: &'a [Vec3],
    pub(super) velocities: &'a [Vec3],
    pub(super) dt: Real,
    /// Work (J) on the cloth in it, and energy (J) that contact holds now.
    pub(super) work: Real,
    pub(super) stored: Real,
    /// Its number.
    pub(super) step: u64,
}

/// Of the free vertices (J).
fn kinetic_energy(particles: &Particles, velocities: &[Vec3]) -> Real {
    let masses = particles.mass().iter().zip(particles.inverse_mass());
    let free = masses.zip(velocities).filter(|((_, w), _)| **w != 0.0);
    0.5 * free.map(|((m, _), v)| m * v.norm_squared()).sum::<Real>()
}

impl Account {
    fn add(&mut self, work: Real) {
        self.given += work;
        self.most_given = self.most_given.max(self.given);
    }
}

impl EnergyGuard {
    /// There is nothing to guard.
    pub(super) fn forget(&mut self) {
        self.0 = None;
    }

    /// A step begins, after one that has left the cloth at `left` (m): somebody may have changed velocities since then.
    pub(super) fn begin(&mut self, particles: &Particles, state: &State, left: &[Vec3]) {
        if state.positions != left {
            self.0 = None;
        }
        if let Some(account) = &mut self.0 {
            let kinetic = kinetic_energy(particles, &state.velocities);
            account.add((kinetic - account.kinetic).max(0.0));
            account.kinetic = kinetic;
        }
    }

    /// Enters work (J).
    pub(super) fn add(&mut self, work: Real) {
        self.0.iter_mut().for_each(|account| account.add(work));
    }

    /// Whether the energy at the end can come from what was given.
    ///
    /// # Errors
    /// [`StepError::EnergyGrowth`].
    pub(super) fn end(&mut self, ended: &Ended<'_>) -> Result<(), StepError> {
        let x = ended.positions;
        let kinetic = kinetic_energy(ended.particles, ended.velocities);
        let elastic = || ended.energies.value(x);
        let Some(account) = &mut self.0 else {
            let given = kinetic + elastic() + ended.stored;
            self.0 = Some(Account {
                given,
                most_given: given,
                kinetic,
            });
            return Ok(());
        };
        account.add(ended.work);
        // What rounding can put in is no alarm.
        let size = x.iter().map(Vec3::amax).fold(0.0, Real::max);
        let mass: Real = ended.particles.mass().iter().sum();
        let rounding = rounding_energy(mass, size, ended.dt);
        account.most_given = account.most_given.max(rounding);
        if kinetic > GAIN * account.most_given {
            // Some elements can have an energy below 0.
            let most = account.given - elastic().min(0.0);
            account.most_given = account.most_given.max(most);
        }
        let before = std::mem::replace(&mut account.kinetic, kinetic);
        if kinetic > GAIN * account.most_given {
            let given = account.most_given;
            self.0 = None;
            return Err(StepError::EnergyGrowth {
                before,
                after: kinetic,
                given,
                step: ended.step,
            });
        }
        Ok(())
    }
}

//! Steps that would gain energy are taken again with more substeps.
//!
//! Sweeps that are too few for what happens in a step leave strain behind: where cloth is stopped suddenly, or pulled
//! taut, the springs end up with more energy than the motion had. No rule that is applied before a run knows when that
//! will be. It shows in the balance of a step,
//!
//! ```text
//! gain = (K + E after) − (K + E before) − work of gravity, loads, air, prescribed vertices and contact,
//! ```
//!
//! with `E = ½ Σ k C²` over all rows of finite stiffness. (A hard row stores nothing.) XPBD loses energy in most steps,
//! so a gain is usually a sign of too few sweeps. (Not always: the work of prescribed vertices is itself in error where
//! rows turn in a substep.) Gains are summed over the steps and losses taken off, but the sum is never below zero. With
//! a bound of τ times the scale of energy,
//!
//! - *more*: a step that adds to the sum and lifts it above the bound is repeated from its start with twice as many
//!   substeps, and the next one begins with as many. If over 0.8 of the gain is left, more substeps do not help, and
//!   the step is accepted;
//! - *fewer*: where the sum is below half of the bound, the next step begins with fewer, by a factor of √2. If it then
//!   has to be repeated, it is with the number before;
//! - *waiting*: after a repeated step its number is kept before fewer are tried again, for one step at first, then for
//!   twice as many after each further failure, up to 16. A smaller number that succeeds sets this back to one. Cloth in
//!   folds needs many substeps for long, and each failed trial of fewer costs a step.
//!
//! The scale is, with W the work of the formula above,
//!
//! ```text
//! max over all steps so far, with the present one, of max(H, H + W)
//! ```
//!
//! where H is K + E as the step before has left it. H alone would be zero for cloth that starts from rest, and any gain
//! too much; with W the scale has what the cloth is given as soon as it falls. `E before` in the balance is that of the
//! elements as they are at the end of the step, so that what closes a seam is work from outside. In the scale it would
//! be far too much: a stiff seam that closes by a jump stores for an instant what no step hands on.

use cloth_core::math::{Real, Vec3};
use cloth_core::measure::rounding_energy;
use cloth_core::particles::State;
use cloth_core::step::StepInput;
use std::f64::consts::SQRT_2;

/// Most times as many substeps as the settings have.
const MOST: Real = 8.0;
/// Where twice as many substeps leave more than this fraction of the gain, they do not help.
const MAX_REMAINING_GAIN: Real = 0.8;
/// Fraction of the accepted gain below which fewer substeps may do.
const COARSENING_THRESHOLD: Real = 0.5;
/// Most steps for which a number of substeps is kept because fewer have failed.
const LONGEST: u32 = 16;

/// What is known of the energy of a run, and how many times as many substeps the next step takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refinement {
    /// τ (dimensionless).
    tolerance: Real,
    /// K + E (J) as the last step has left it, or where the first one begins.
    pub(crate) held: Option<Real>,
    /// The scale of energy (J): the largest so far.
    energy_scale: Real,
    /// What the last steps have gained (J), less what was lost after it.
    gained: Real,
    /// The gain (J) of the step that is being tried, with half as many substeps.
    coarser: Real,
    factor: Real,
    /// Whether the factor is one that was lowered below [`COARSENING_THRESHOLD`].
    is_lowered: bool,
    /// For how many more steps it is kept, and for how many after the next failure.
    kept: u32,
    retry_interval: u32,
}

impl Refinement {
    pub(crate) fn new(tolerance: Real) -> Self {
        Self {
            tolerance,
            held: None,
            energy_scale: 0.0,
            gained: 0.0,
            coarser: Real::INFINITY,
            factor: 1.0,
            is_lowered: false,
            kept: 0,
            retry_interval: 1,
        }
    }

    /// How many substeps the next step takes, in place of so many.
    pub(crate) fn substeps(&self, count: u32) -> u32 {
        (Real::from(count) * self.factor).round() as u32
    }

    /// Whether a step from `before` to `after` (J), in which the cloth was given `given` (J), is to be taken again.
    pub(crate) fn refines(&mut self, [before, after]: [Real; 2], given: Real) -> bool {
        let gain = after - before - given;
        let held = self.held.unwrap_or(before);
        self.energy_scale = self.energy_scale.max(held).max(held + given);
        let most = self.tolerance * self.energy_scale;
        let gained = self.gained + gain;
        let helps = gain > 0.0 && gain < MAX_REMAINING_GAIN * self.coarser;
        if gained > most && helps && self.factor < MOST {
            if self.coarser.is_infinite() {
                self.kept = self.retry_interval;
                self.retry_interval = (2 * self.retry_interval).min(LONGEST);
            }
            let back = if self.is_lowered { SQRT_2 } else { 2.0 };
            self.factor = (self.factor * back).min(MOST);
            (self.coarser, self.is_lowered) = (gain, false);
            return true;
        }
        self.held = Some(after);
        (self.coarser, self.gained) = (Real::INFINITY, gained.max(0.0));
        if std::mem::take(&mut self.is_lowered) {
            self.retry_interval = 1;
        }
        if self.kept > 0 {
            self.kept -= 1;
        } else if self.factor > 1.0 && gained < COARSENING_THRESHOLD * most {
            self.factor = (self.factor / SQRT_2).max(1.0);
            self.is_lowered = true;
        }
        false
    }
}

/// `½ Σ m ‖v‖²` (J) of the free vertices.
pub(crate) fn kinetic(inverse_mass: &[Real], velocities: &[Vec3]) -> Real {
    let free = inverse_mass
        .iter()
        .zip(velocities)
        .filter(|(w, _)| **w > 0.0);
    free.map(|(w, v)| 0.5 * v.norm_squared() / w).sum()
}

/// Work (J) of gravity, loads and air along the displacement from `state` to `x` (m), and what rounding may add.
pub(crate) fn external_work(
    inverse_mass: &[Real],
    state: &State,
    x: &[Vec3],
    input: &StepInput<'_>,
) -> Real {
    let (mut work, mut mass, mut size) = (0.0, 0.0, 0.0 as Real);
    for (vertex, &w) in inverse_mass.iter().enumerate().filter(|(_, w)| **w > 0.0) {
        let a = input.steady_acceleration(vertex, w);
        work += a.dot(&(x[vertex] - state.positions[vertex])) / w;
        mass += 1.0 / w;
        size = size.max(x[vertex].amax());
    }
    let air = input.air.as_ref();
    work += air.map_or(0.0, |air| air.work(x, inverse_mass));
    work + rounding_energy(mass, size, input.dt)
}

//! The formula of a row, `Δλ = −s C/w̃`, and its s from the stiffness k of the material.

use cloth_core::error::within;
use cloth_core::math::Real;
use cloth_core::method::position_based::{ConstraintUpdate, RowEquation, RowState};
use cloth_core::step::BuildError;

/// The fraction s (dimensionless, 0 to 1) of its violation that a constraint removes in one visit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StiffnessRule {
    /// `s = 1 − (1 + k h² w̃)^(−1/n)` from the stiffness k of each row, the number of iterations n, the substep
    /// h (s) and the generalised inverse mass w̃ of the row.
    ///
    /// One constraint alone whose C is linear along its correction, as a spring's is, then ends a substep where
    /// implicit Euler would put it, whatever n and h. Constraints that share vertices do not: see the limits in the
    /// [crate documentation](crate).
    #[default]
    Material,
    /// The same s, between 0 and 1, for every row, whatever its k. One constraint alone behaves as if it had
    /// the stiffness [`effective_stiffness`].
    Fixed(Real),
}

impl StiffnessRule {
    pub(crate) fn check(self) -> Result<(), BuildError> {
        if let Self::Fixed(s) = self {
            within(
                (0.0..=1.0).contains(&s),
                "the fixed stiffness",
                s,
                "between 0 and 1",
            )?;
        }
        Ok(())
    }
}

/// `s = 1 − (1 + kh²w̃)^(−1/n)` (dimensionless), from `stiffness_times_h2_w` = kh²w̃ (dimensionless) and n =
/// `iterations`: the inverse of [`effective_stiffness`]. For kh²w̃ ≥ 0 and n ≥ 1; between −1 and 0 it is negative, at
/// −1 infinite, and below it is NaN, as it is for NaN.
#[inline]
#[must_use]
pub fn projection_stiffness(stiffness_times_h2_w: Real, iterations: u32) -> Real {
    debug_assert!(iterations > 0);
    // 1 − exp(−ln(1 + z)/n), written so that a soft material (small z) keeps its digits; z = ∞ gives 1.
    -(-stiffness_times_h2_w.ln_1p() / Real::from(iterations)).exp_m1()
}

/// The stiffness k (N/m for a spring) that `iterations` projections with stiffness `s` (dimensionless) in a
/// substep of `h` (s) amount to for one constraint of generalised inverse mass `weight` (1/kg for a spring):
/// `((1 − s)^(−n) − 1)/(h²w̃)`. For s from 0 to 1, n ≥ 1 and h, w̃ > 0.
///
/// ```
/// use cloth_pbd::{effective_stiffness, projection_stiffness};
/// let (k, h, w) = (1000.0, 1.0 / 60.0, 20.0);
/// let s = projection_stiffness(k * h * h * w, 5);
/// assert!((effective_stiffness(s, 5, h, w) - k).abs() < 1e-12 * k);
/// // The same s in twice as many iterations is far more than twice as stiff.
/// assert!(effective_stiffness(s, 10, h, w) > 7.0 * k);
/// ```
#[must_use]
pub fn effective_stiffness(s: Real, iterations: u32, h: Real, weight: Real) -> Real {
    debug_assert!((0.0..=1.0).contains(&s) && iterations > 0 && h * weight > 0.0);
    let growth = -Real::from(iterations) * (-s).ln_1p();
    growth.exp_m1() / (h * h * weight)
}

/// PBD's update of a row: `Δλ = −s C/w̃` (Müller et al. 2007, section 3.3).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    pub(crate) stiffness: StiffnessRule,
    /// h (s).
    pub(crate) substep: Real,
    /// n.
    pub(crate) iterations: u32,
    /// Whether Δλ is accumulated, for the work of prescribed vertices.
    pub(crate) accumulates: bool,
}

/// The s of a row and the w̃ that it belongs to, since a power costs more than the rest of the visit and w̃
/// seldom changes; and its accumulated multiplier.
///
/// The default is no special value: a row with w̃ = 0 has s = 0.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CachedScale {
    weight: Real,
    s: Real,
    /// Σ Δλ (kg m² per unit of C; kg m for a spring) since the last reset. For read-out; no visit uses it.
    pub(crate) lambda: Real,
}

impl Projection {
    /// s for a w̃. Not inlined: seldom needed, and a power in the loop would spill its registers.
    #[cold]
    #[inline(never)]
    fn compute(&self, weight: Real, stiffness: Real) -> Real {
        let z = stiffness * self.substep * self.substep * weight;
        projection_stiffness(z, self.iterations)
    }
}

impl ConstraintUpdate for Projection {
    type Memory = CachedScale;

    #[inline]
    fn accumulates(&self) -> bool {
        self.accumulates
    }

    /// Clears s, which belongs to h.
    fn prepare(&self, _: RowState, cached: &mut CachedScale) {
        *cached = CachedScale::default();
    }

    #[inline]
    fn reset(cached: &mut CachedScale) {
        cached.lambda = 0.0;
    }

    /// A [`RowEquation`] says `(w̃ + scaled_compliance) Δλ = −residual`. With the residual s C and no compliance that
    /// is `Δλ = −s C/w̃`: the sign is in the equation, and s, not a compliance, makes a row soft.
    #[inline(always)]
    fn equation(&self, row: RowState, cached: &mut CachedScale) -> RowEquation {
        let s = match self.stiffness {
            StiffnessRule::Fixed(s) => s,
            StiffnessRule::Material => {
                let weight = rounded(row.weight);
                if weight != cached.weight {
                    (cached.weight, cached.s) = (weight, self.compute(weight, row.stiffness));
                }
                cached.s
            }
        };
        RowEquation {
            residual: s * row.value,
            scaled_compliance: 0.0,
        }
    }

    #[inline(always)]
    fn accumulate(&self, change: Real, cached: &mut CachedScale) {
        cached.lambda += change;
    }

    #[inline]
    fn extrapolate(now: &mut CachedScale, before: &CachedScale, omega: Real) {
        now.lambda = before.lambda + omega * (now.lambda - before.lambda);
    }
}

/// The nearest number with 40 binary digits behind the point instead of 52.
///
/// The w̃ of a spring is constant but for rounding, and should not cost a power each time. Rounding, rather
/// than a tolerance around the cached number, keeps s a function of the configuration alone, so that a
/// restarted run gives the same bits. It changes s by less than 5e-13 of itself.
#[inline]
pub(crate) fn rounded(weight: Real) -> Real {
    const DROPPED: u64 = 12;
    let half = 1 << (DROPPED - 1);
    Real::from_bits((weight.to_bits() + half) >> DROPPED << DROPPED)
}

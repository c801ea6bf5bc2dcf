//! The update of one row, Δλ from its value and its scaled compliance: the formula of XPBD, with and without damping.

use cloth_core::math::Real;
use cloth_core::method::position_based::{ConstraintUpdate, RowEquation, RowState};

/// `Δλ = −(C + α̃λ)/(w̃ + α̃)` with `α̃ = 1/(k h²)` (Macklin et al. 2016, equation 18), and the same with
/// damping.
///
/// It is one Gauss–Seidel step on `(J M⁻¹ Jᵀ + α̃) Δλ = −(C + α̃λ)` (their equation 16) for one row, with λ =
/// h² times the generalised force. The [crate documentation](crate#from-backward-euler-to-the-update) derives it.
///
/// Damping adds `−β k Ċ` to the force `−k C` along the row, with `Ċ = (C − C⁰)/h` and C⁰ the value at the start of the
/// substep, with the rest data of that time: λ is to become `−k h² C − k h β (C − C⁰)`. Written for `ν = λ − k h β C⁰`,
/// that is `C + α̃ν = 0` with `α̃ = 1/(k h (h + β))`: the update of an undamped row that starts from `ν = −k h β C⁰`
/// instead of 0. So damping costs a sweep nothing. ν is what is accumulated.
///
/// Their equation 26 takes `∂C/∂x·(x − x⁰)` for `C − C⁰`; for linear rows it is the same. Their β (N s/m), b here, is
/// βk. With `γ = α̃ b̃/h`, where `α̃ = 1/(k h²)` and `b̃ = h² b`, so that γ = β/h, their Δλ is
/// `−(C + α̃λ + γ (C − C⁰))/((1 + γ) w̃ + α̃)`. Divided above and below by 1 + γ it is `−(C − d C⁰ + α̃′λ)/(w̃ + α̃′)`,
/// with `α̃′ = α̃/(1 + γ) = 1/(k h (h + β))` and `d = γ/(1 + γ) = β/(h + β)`: the same as `C + α̃′ν` above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct XpbdUpdate {
    /// h (s).
    substep: Real,
    /// β (s).
    damping: Real,
    /// `h (h + β)` (s²).
    stiffening: Real,
}

impl XpbdUpdate {
    /// For substeps of `substep` (s) and a damping β (s).
    pub(crate) fn new(substep: Real, damping: Real) -> Self {
        Self {
            substep,
            damping,
            stiffening: substep * (substep + damping),
        }
    }

    /// `α̃` (unit of C² per kg m²): 0 for an infinite stiffness, ∞ for none.
    #[inline]
    pub(crate) fn scaled_compliance(self, stiffness: Real) -> Real {
        // Also where `h (h + β)` is too small or too large for a number.
        if stiffness == Real::INFINITY {
            0.0
        } else if stiffness == 0.0 {
            Real::INFINITY
        } else {
            1.0 / (stiffness * self.stiffening)
        }
    }

    /// `λ − ν = k h β C⁰` (kg m² per unit of C) of a row whose value was `start` when the substep began; 0
    /// where the product overflows, as for a hard row, which has no rate.
    pub(crate) fn offset(self, stiffness: Real, start: Real) -> Real {
        let offset = stiffness * self.substep * self.damping * start;
        if offset.is_finite() { offset } else { 0.0 }
    }

    /// `d = β/(h + β)` (dimensionless), with which a damped row solves `C − d C⁰ + α̃λ = 0`; 0 for a hard row.
    #[cfg(feature = "direct")]
    pub(crate) fn damped_fraction(self, stiffness: Real) -> Real {
        if stiffness.is_finite() {
            self.damping / (self.substep + self.damping)
        } else {
            0.0
        }
    }

    /// h (s).
    #[cfg(feature = "direct")]
    pub(crate) fn substep(self) -> Real {
        self.substep
    }

    /// The same for one row. A damper would push where cloth comes back out of a limit within a substep, and limits
    /// only pull: they are not damped.
    pub(crate) fn for_row(self, is_limit: bool) -> Self {
        match is_limit {
            true => Self::new(self.substep, 0.0),
            false => self,
        }
    }

    /// `λ/h²`, the generalised force (N for a spring), from λ.
    pub(crate) fn force(self, multiplier: Real) -> Real {
        // One by one, since h² may be too small for a number.
        multiplier / self.substep / self.substep
    }

    /// `λ/h`, the generalised impulse (N s for a spring), from λ.
    #[cfg(feature = "direct")]
    pub(crate) fn impulse(self, multiplier: Real) -> Real {
        multiplier / self.substep
    }
}

/// Stands for `α̃ = ∞` of a row without stiffness, so that `α̃ν` has a value (unit of C² per kg m²): the row
/// then moves nothing by more than 1e-290 m.
const MAX_SCALED_COMPLIANCE: Real = 1e300;

/// What is kept of a row between visits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Multiplier {
    /// ν (kg m² per unit of C; kg m for a spring); λ since the start of the substep, if nothing is damped.
    lambda: Real,
    /// α̃ (unit of C² per kg m²): constant over the substep, and kept to save a division in every visit.
    scaled_compliance: Real,
}

impl Multiplier {
    /// `C + α̃ν` (unit of C), what the sweeps bring to zero; `None` where no multiplier could change it: a row
    /// without stiffness, or a hard row whose vertices are all prescribed.
    pub(crate) fn violation(&self, row: RowState) -> Option<Real> {
        let movable = row.weight + self.scaled_compliance;
        (movable > 0.0 && self.scaled_compliance < MAX_SCALED_COMPLIANCE)
            .then_some(row.value + self.scaled_compliance * self.lambda)
    }

    /// ν; exactly 0 without stiffness.
    pub(crate) fn lambda(&self) -> Real {
        if self.scaled_compliance < MAX_SCALED_COMPLIANCE {
            self.lambda
        } else {
            0.0
        }
    }
}

impl ConstraintUpdate for XpbdUpdate {
    type Memory = Multiplier;

    const ROWS_TOGETHER: bool = true;

    /// ν starts from `−k h β C⁰`. Where k is NaN, so is ν, and the step ends in an error.
    fn prepare(&self, row: RowState, memory: &mut Multiplier) {
        *memory = Multiplier {
            lambda: if row.stiffness.is_nan() {
                Real::NAN
            } else {
                -self.offset(row.stiffness, row.value)
            },
            scaled_compliance: self
                .scaled_compliance(row.stiffness)
                .min(MAX_SCALED_COMPLIANCE),
        };
    }

    fn prepare_limit(&self, row: RowState, memory: &mut Multiplier) {
        self.for_row(true).prepare(row, memory);
    }

    #[inline]
    fn reset(memory: &mut Multiplier) {
        memory.lambda = 0.0;
    }

    /// `C + α̃ν` and `α̃`.
    #[inline(always)]
    fn equation(&self, row: RowState, memory: &mut Multiplier) -> RowEquation {
        RowEquation {
            residual: row.value + memory.scaled_compliance * memory.lambda,
            scaled_compliance: memory.scaled_compliance,
        }
    }

    #[inline(always)]
    fn accumulate(&self, change: Real, memory: &mut Multiplier) {
        memory.lambda += change;
    }

    #[inline(always)]
    fn multiplier(memory: &Multiplier) -> Real {
        memory.lambda
    }

    /// `x = x̃ + M⁻¹ Jᵀλ` is affine, and so is the extrapolation: applied to x and λ alike, it preserves the
    /// relation.
    #[inline]
    fn extrapolate(now: &mut Multiplier, before: &Multiplier, omega: Real) {
        now.lambda = before.lambda + omega * (now.lambda - before.lambda);
    }
}

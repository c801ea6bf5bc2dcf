//! How far XPBD goes along a row.

use cloth_core::math::Real;
use cloth_core::position_based::{RowAt, RowEquation, Rule};

/// `Δλ = −(C + α̃λ)/(w̃ + α̃)` with `α̃ = 1/(k h²)`, and the same with damping.
///
/// It is one Gauss–Seidel step on the system S1 (44) with the velocities eliminated,
/// `(J M⁻¹ Jᵀ + α̃) Δλ = −(C + α̃λ)`, for one row and with λ = h² times the multiplier of the source.
///
/// Damping adds `−β k Ċ` to the force `−k C` along the row, with `Ċ = (C − C⁰)/h` and C⁰ the value at the start of the substep:
/// λ is to become `−k h² C − k h β (C − C⁰)`. Written for `ν = λ − k h β C⁰`, that is `C + α̃ν = 0` with `α̃ = 1/(k h (h + β))`: the rule of an
/// undamped row, that starts from `ν = −k h β C⁰` instead of 0. So damping costs a sweep nothing. ν is what is remembered.
///
/// Macklin et al. (2016), equation 26, take `∂C/∂x·(x − x⁰)` for `C − C⁰`. For linear rows it is the same. For others it is not zero in a rigid rotation
/// by a finite angle, and would damp it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compliance {
    /// h (s).
    substep: Real,
    /// β (s).
    damping: Real,
    /// `h (h + β)` (s²).
    stiffening: Real,
}

impl Compliance {
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
    pub(crate) fn scaled(self, stiffness: Real) -> Real {
        // Also where `h (h + β)` is too small or too large for a number.
        if stiffness == Real::INFINITY {
            0.0
        } else if stiffness == 0.0 {
            Real::INFINITY
        } else {
            1.0 / (stiffness * self.stiffening)
        }
    }

    /// `λ − ν = k h β C⁰` (kg m² per unit of C) of a row whose value was `start` when the substep began; 0 for a row that is hard, to the last digit of its stiffness.
    /// Nothing of it can move.
    pub(crate) fn offset(self, stiffness: Real, start: Real) -> Real {
        let offset = stiffness * self.substep * self.damping * start;
        if offset.is_finite() { offset } else { 0.0 }
    }

    /// `β/(h + β)` (dimensionless): the part of C⁰ that a damped row of finite stiffness keeps if it is stiff; 0 for a hard one. With it `C − (part) C⁰ + α̃λ = 0`.
    #[cfg(feature = "direct")]
    pub(crate) fn kept(self, stiffness: Real) -> Real {
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

    /// `λ/h²`, the generalised force (N for a spring), from λ.
    pub(crate) fn force(self, multiplier: Real) -> Real {
        // One by one, since h² may be too small for a number.
        multiplier / self.substep / self.substep
    }

    /// `λ/h`, the generalised impulse (N s for a spring), from λ.
    pub(crate) fn impulse(self, multiplier: Real) -> Real {
        multiplier / self.substep
    }

    /// `C + α̃ν` (unit of C), what the sweeps bring to zero; `None` where no multiplier could change it: it has no stiffness, or it is hard and nothing of it
    /// can move.
    pub(crate) fn violation(self, row: RowAt, total: Real) -> Option<Real> {
        let softness = self.scaled(row.stiffness);
        let movable = row.weight + softness;
        (movable > 0.0 && movable < Real::INFINITY).then_some(row.value + softness * total)
    }
}

/// A row without stiffness has `α̃ = ∞`, and `α̃ν` no value. With this one instead (unit of C² per kg m²) it moves nothing by more than 1e-290 m.
const SOFTEST: Real = 1e300;

/// What is remembered of a row.
#[derive(Clone, Copy, Debug, Default)]
pub struct Multiplier {
    /// ν (kg m² per unit of C; kg m for a spring); λ since the start of the substep, if nothing is damped.
    total: Real,
    /// α̃ (unit of C² per kg m²). It belongs to the element and the substep: computing it takes a division, which a visit can do without.
    softness: Real,
}

impl Multiplier {
    /// ν; exactly 0 without stiffness.
    pub(crate) fn total(&self) -> Real {
        if self.softness < SOFTEST {
            self.total
        } else {
            0.0
        }
    }
}

impl Rule for Compliance {
    type Memory = Multiplier;

    const ROWS_TOGETHER: bool = true;

    /// ν starts from `−k h β C⁰`.
    fn prepare(&self, row: RowAt, memory: &mut Multiplier) {
        *memory = Multiplier {
            total: -self.offset(row.stiffness, row.value),
            softness: self.scaled(row.stiffness).min(SOFTEST),
        };
    }

    #[inline]
    fn forget(memory: &mut Multiplier) {
        memory.total = 0.0;
    }

    /// `C + α̃ν` and `α̃`.
    #[inline(always)]
    fn equation(&self, row: RowAt, memory: &mut Multiplier) -> RowEquation {
        RowEquation {
            residual: row.value + memory.softness * memory.total,
            softness: memory.softness,
        }
    }

    #[inline(always)]
    fn remember(&self, change: Real, memory: &mut Multiplier) {
        memory.total += change;
    }

    #[inline(always)]
    fn multiplier(memory: &Multiplier) -> Real {
        memory.total
    }

    /// `x = x̃ + M⁻¹ ∂Cᵀλ` is affine, and so is the extrapolation: done to both, it keeps them together.
    #[inline]
    fn extrapolate(now: &mut Multiplier, before: &Multiplier, omega: Real) {
        now.total = before.total + omega * (now.total - before.total);
    }
}

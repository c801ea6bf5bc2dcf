//! How far XPBD goes along a row.

use cloth_core::math::Real;
use cloth_core::position_based::{RowAt, Rule};

/// `Δλ = −(C + α̃λ)/(w̃ + α̃)` with `α̃ = 1/(k h²)`.
///
/// It is one Gauss–Seidel step on the system S1 (44) with the velocities eliminated,
/// `(J M⁻¹ Jᵀ + α̃) Δλ = −(C + α̃λ)`, for one row and with λ = h² times the multiplier of the source.
#[derive(Clone, Copy, Debug)]
pub struct Compliance {
    /// h (s).
    pub(crate) substep: Real,
}

impl Compliance {
    /// `α̃` (unit of C² per kg m²): 0 for an infinite stiffness, ∞ for none.
    #[inline]
    fn scaled(self, stiffness: Real) -> Real {
        1.0 / (stiffness * self.substep * self.substep)
    }

    /// `α̃` and `w̃ + α̃` of a row, or `None` where no multiplier could change it: it has no stiffness, or it is hard and nothing of it
    /// can move. Neither is a rare case to be caught later.
    #[inline]
    fn solvable(self, row: RowAt) -> Option<(Real, Real)> {
        let compliance = self.scaled(row.stiffness);
        let movable = row.weight + compliance;
        (movable > 0.0 && movable < Real::INFINITY).then_some((compliance, movable))
    }

    /// `C + α̃λ` (unit of C), what the sweeps bring to zero; `None` where no multiplier could change it.
    pub(crate) fn violation(self, row: RowAt, multiplier: Real) -> Option<Real> {
        self.solvable(row)
            .map(|(compliance, _)| row.value + compliance * multiplier)
    }
}

impl Rule for Compliance {
    /// λ (kg m² per unit of C; kg m for a spring) since the start of the substep.
    type Memory = Real;

    /// `x = x̃ + M⁻¹ ∂Cᵀλ` is affine, and so is the extrapolation: done to both, it keeps them together.
    const MEMORY_ITERATES: bool = true;

    #[inline]
    fn multiplier(&self, row: RowAt, total: &mut Real) -> Real {
        let Some((compliance, movable)) = self.solvable(row) else {
            return 0.0;
        };
        let change = -(row.value + compliance * *total) / movable;
        *total += row.share * change;
        change
    }

    #[inline]
    fn extrapolate(now: &mut Real, before: &Real, omega: Real) {
        *now = before + omega * (*now - before);
    }
}

//! Contact as an energy of the distance.

use super::{ObstacleError, positive};
use cloth_core::math::Real;

/// An energy of the distance φ, nothing at or beyond the range h: ½ k (h − φ)² down to t = h/2, then ½ k t² − k t²
/// ln(φ/t). A spring of known stiffness under a weight, a barrier under an impact, which never yields if no step leads
/// through it. Twice continuously differentiable at h/2, once at h.
///
/// Of the forces c/φᵖ, p = 1 is the weakest whose energy is infinite at φ = 0: hence the logarithm. With E′ = −c/φ
/// below t, equal slopes −k t at t give c = k t²; E″ = k t²/φ² is k there by itself, since t is h/2; and equal energies
/// give the constant ½ k t². As k → ∞ a mass rests at h, as h → 0 at 0: the inequalities φ ≥ h and φ ≥ 0.
///
/// As the energy of one vertex it is in J, with k in N/m; of an area, in J/m² with k in Pa/m.
///
/// Source: Chen et al. 2025, section 3.3; see [`potential`](crate::potential#references).
///
/// ```
/// use cloth_collide::obstacle::PenaltyLaw;
/// let law = PenaltyLaw::new(100.0, 0.01)?; // N/m, m
/// // 4 mm too deep: 0.4 N upwards.
/// assert!((-law.slope(0.006) - 0.4).abs() < 1e-15);
/// # Ok::<(), cloth_collide::obstacle::ObstacleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenaltyLaw {
    pub(crate) stiffness: Real,
    pub(crate) range: Real,
}

/// Fraction of the range below which the derivatives are those at just this fraction, to stay finite numbers.
const FLOOR: Real = 1e-12;

impl PenaltyLaw {
    /// A spring of `stiffness` k (N/m) that starts to push at the distance `range` h (m), and becomes a barrier at h/2.
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`].
    pub fn new(stiffness: Real, range: Real) -> Result<Self, ObstacleError> {
        Ok(Self {
            stiffness: positive("stiffness of the contact (N/m)", stiffness)?,
            range: positive("range of the contact (m)", range)?,
        })
    }

    /// The same law with another `range` (m), which is positive.
    #[must_use]
    pub(crate) fn with_range(self, range: Real) -> Self {
        Self { range, ..self }
    }

    /// The distance h (m) from which on there is no force.
    #[must_use]
    pub fn range(&self) -> Real {
        self.range
    }

    /// E(φ) (J) at the distance `gap` φ (m); infinite from 0 on.
    #[must_use]
    pub fn energy(&self, gap: Real) -> Real {
        let (k, depth, joint) = (self.stiffness, self.range - gap, 0.5 * self.range);
        if depth <= 0.0 {
            0.0
        } else if gap <= 0.0 {
            Real::INFINITY
        } else if gap >= joint {
            0.5 * k * depth * depth
        } else {
            k * joint * joint * (0.5 - (gap / joint).ln())
        }
    }

    /// E′(φ) (N), not positive: the force is its negative. Where it is passed and there is no derivative, that just
    /// before it.
    #[must_use]
    pub fn slope(&self, gap: Real) -> Real {
        let (k, joint) = (self.stiffness, 0.5 * self.range);
        let floored = gap.max(FLOOR * self.range);
        if gap >= self.range {
            0.0
        } else if floored >= joint {
            k * (floored - self.range)
        } else {
            -k * joint * joint / floored
        }
    }

    /// E″(φ) (N/m), not negative. Where it is passed, as [`PenaltyLaw::slope`].
    #[must_use]
    pub fn curvature(&self, gap: Real) -> Real {
        if gap >= self.range {
            return 0.0;
        }
        let ratio = 0.5 * self.range / gap.max(FLOOR * self.range);
        self.stiffness * (ratio * ratio).max(1.0)
    }
}

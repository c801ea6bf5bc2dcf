//! Contact as an energy: a quadratic penalty, a barrier, or the one joined to the other.

use super::{ObstacleError, positive};
use cloth_core::element::{Convexity, Element, Energy};
use cloth_core::math::{Blocks, Real, Vec3};

/// An energy of the distance φ of one vertex from an obstacle, nothing at or beyond the range h.
///
/// | | energy (J) | what it does |
/// |---|---|---|
/// | quadratic | ½ k (h − φ)² | yields: a mass m rests mg/k below h, and passes through if pushed hard enough |
/// | barrier | −k (φ − h)² ln(φ/h), ∞ for φ ≤ 0 | never yields, if no step leads through it: needs a line search that [`super::first_contact`] caps |
/// | two-stage | ½ k (h − φ)² down to t = h/2, then ½ k t² − k t² ln(φ/t) | a spring of known stiffness under a weight, a barrier under an impact |
///
/// The barrier is that of Li et al. 2020, equation (6): twice continuously differentiable at h, and convex. The
/// two-stage law is that of Chen et al. 2025, section 3.3: twice continuously differentiable at h/2, once at h.
///
/// - M. Li et al., Incremental potential contact, *ACM Transactions on Graphics* 39(4), 2020. DOI
///   10.1145/3386569.3392425
/// - A. H. Chen, J. Hsu, Z. Liu, M. Macklin, Y. Yang and C. Yuksel, Offset geometric contact, *ACM Transactions on
///   Graphics* 44(4), 2025. DOI 10.1145/3731205
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenaltyLaw {
    kind: Kind,
    stiffness: Real,
    range: Real,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Quadratic,
    Barrier,
    TwoStage,
}

/// Fraction of the range below which the derivatives of the barrier are those at just this fraction, to stay finite
/// numbers.
const FLOOR: Real = 1e-12;

impl PenaltyLaw {
    /// A spring of `stiffness` k (N/m) that starts to push at the distance `range` h (m).
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`].
    pub fn quadratic(stiffness: Real, range: Real) -> Result<Self, ObstacleError> {
        Self::new(Kind::Quadratic, stiffness, range)
    }

    /// A barrier of `stiffness` k (N/m) that starts to push at the distance `range` h (m).
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`].
    pub fn barrier(stiffness: Real, range: Real) -> Result<Self, ObstacleError> {
        Self::new(Kind::Barrier, stiffness, range)
    }

    /// A spring of `stiffness` k (N/m) that starts to push at the distance `range` h (m), and becomes a barrier at h/2.
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`].
    pub fn two_stage(stiffness: Real, range: Real) -> Result<Self, ObstacleError> {
        Self::new(Kind::TwoStage, stiffness, range)
    }

    /// The same law with another `range` (m), which is positive.
    #[must_use]
    pub(crate) fn with_range(self, range: Real) -> Self {
        Self { range, ..self }
    }

    fn new(kind: Kind, stiffness: Real, range: Real) -> Result<Self, ObstacleError> {
        Ok(Self {
            kind,
            stiffness: positive("stiffness of the contact (N/m)", stiffness)?,
            range: positive("range of the contact (m)", range)?,
        })
    }

    /// The distance h (m) from which on there is no force.
    #[must_use]
    pub fn range(&self) -> Real {
        self.range
    }

    /// E(φ) (J) at the distance `gap` φ (m).
    #[must_use]
    pub fn energy(&self, gap: Real) -> Real {
        let (k, depth) = (self.stiffness, self.range - gap);
        match self.kind {
            _ if depth <= 0.0 => 0.0,
            Kind::Quadratic => 0.5 * k * depth * depth,
            Kind::Barrier | Kind::TwoStage if gap <= 0.0 => Real::INFINITY,
            Kind::TwoStage => {
                let joint = 0.5 * self.range;
                if gap >= joint {
                    0.5 * k * depth * depth
                } else {
                    k * joint * joint * (0.5 - (gap / joint).ln())
                }
            }
            Kind::Barrier => -k * depth * depth * (gap / self.range).ln(),
        }
    }

    /// E′(φ) (N), not positive: the force away from the obstacle is its negative. For a barrier that is passed, where
    /// there is no derivative, that just before it.
    #[must_use]
    pub fn slope(&self, gap: Real) -> Real {
        let k = self.stiffness;
        match self.kind {
            _ if gap >= self.range => 0.0,
            Kind::Quadratic => k * (gap - self.range),
            Kind::Barrier => {
                let (gap, past) = self.floored(gap);
                -k * past * (2.0 * (gap / self.range).ln() + past / gap)
            }
            Kind::TwoStage => {
                let (joint, (gap, past)) = (0.5 * self.range, self.floored(gap));
                if gap >= joint {
                    k * past
                } else {
                    -k * joint * joint / gap
                }
            }
        }
    }

    /// E″(φ) (N/m), not negative. For a barrier that is passed, as [`PenaltyLaw::slope`].
    #[must_use]
    pub fn curvature(&self, gap: Real) -> Real {
        let k = self.stiffness;
        match self.kind {
            _ if gap >= self.range => 0.0,
            Kind::Quadratic => k,
            Kind::Barrier => {
                let (gap, past) = self.floored(gap);
                let ratio = past / gap;
                k * (ratio * ratio - 4.0 * ratio - 2.0 * (gap / self.range).ln())
            }
            Kind::TwoStage => {
                let part = 0.5 * self.range / self.floored(gap).0;
                k * (part * part).max(1.0)
            }
        }
    }

    /// φ and φ − h, with φ a little above 0.
    fn floored(&self, gap: Real) -> (Real, Real) {
        let gap = gap.max(FLOOR * self.range);
        (gap, gap - self.range)
    }
}

/// The contact energy of one vertex with the tangent plane of an obstacle, E(n·x − d): what a Newton-type method takes
/// for the length of a step.
///
/// Where the plane was taken, energy and gradient are those of the distance itself; the Hessian lacks the curvature of
/// the obstacle, and is positive semi-definite for that.
///
/// ```
/// use cloth_collide::obstacle::{PenaltyLaw, PlanePenalty};
/// use cloth_core::element::Energy;
/// use cloth_core::math::Vec3;
/// let law = PenaltyLaw::quadratic(100.0, 0.01)?; // N/m, m
/// let floor = PlanePenalty { vertex: 0, normal: Vec3::z(), offset: 0.0, law };
/// // 4 mm too deep: 0.4 N upwards.
/// let force = -floor.gradient(&[Vec3::new(0.0, 0.0, 0.006)])[0];
/// assert!((force - Vec3::z() * 0.4).norm() < 1e-15);
/// # Ok::<(), cloth_collide::obstacle::ObstacleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanePenalty {
    /// The vertex.
    pub vertex: u32,
    /// Unit normal n of the plane, out of the obstacle.
    pub normal: Vec3,
    /// Where the surface is, d = n·x on it (m).
    pub offset: Real,
    /// The energy of the distance.
    pub law: PenaltyLaw,
}

impl PlanePenalty {
    fn gap(&self, x: &[Vec3; 1]) -> Real {
        self.normal.dot(&x[0]) - self.offset
    }
}

impl Element<1> for PlanePenalty {
    fn vertices(&self) -> [u32; 1] {
        [self.vertex]
    }
}

impl Energy<1> for PlanePenalty {
    fn value(&self, x: &[Vec3; 1]) -> Real {
        self.law.energy(self.gap(x))
    }

    fn gradient(&self, x: &[Vec3; 1]) -> [Vec3; 1] {
        [self.normal * self.law.slope(self.gap(x))]
    }

    fn hessian(&self, x: &[Vec3; 1], _: Convexity) -> Blocks<1> {
        let scaled = self.normal * self.law.curvature(self.gap(x));
        [[scaled * self.normal.transpose()]]
    }
}

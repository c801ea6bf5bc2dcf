//! Everything below a plane.

use super::{Distance, ObstacleError, SignedDistance, finite, positive};
use crate::bounds::Bounds;
use cloth_core::math::Vec3;

/// All points with n·x ≤ 0: a floor, a slope, a wall. φ(x) = n·x.
///
/// ```
/// use cloth_collide::obstacle::{HalfSpace, SignedDistance};
/// use cloth_core::math::Vec3;
/// let floor = HalfSpace::new(Vec3::z())?;
/// assert_eq!(floor.signed_distance(Vec3::new(3.0, 4.0, 0.5)).value, 0.5);
/// # Ok::<(), cloth_collide::obstacle::ObstacleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    normal: Vec3,
}

impl HalfSpace {
    /// The half-space that the origin lies on the surface of, with the outward `normal` (any length).
    ///
    /// # Errors
    /// [`ObstacleError::NonFinite`], [`ObstacleError::OutOfRange`] for a normal without length.
    pub fn new(normal: Vec3) -> Result<Self, ObstacleError> {
        finite("normal of the half-space", normal)?;
        let largest = positive(
            "largest coordinate of the normal of the half-space",
            normal.amax(),
        )?;
        Ok(Self {
            // Scaled first, so that squares neither overflow nor vanish.
            normal: (normal / largest).normalize(),
        })
    }
}

impl SignedDistance for HalfSpace {
    fn signed_distance(&self, point: Vec3) -> Distance {
        Distance::exact(self.normal.dot(&point), self.normal)
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<Bounds> {
        None
    }
}

//! A ball.

use super::{Distance, ObstacleError, SignedDistance, positive};
use crate::bounds::Bounds;
use cloth_core::math::{Real, Vec3};

/// A ball around the origin. φ(x) = ‖x‖ − r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    radius: Real,
}

impl Sphere {
    /// A ball of `radius` (m).
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`].
    pub fn new(radius: Real) -> Result<Self, ObstacleError> {
        let radius = positive("radius of the sphere (m)", radius)?;
        Ok(Self { radius })
    }
}

impl SignedDistance for Sphere {
    fn signed_distance(&self, point: Vec3) -> Distance {
        around_a_point(point, self.radius)
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<Bounds> {
        let corner = Vec3::repeat(self.radius);
        Some(Bounds::around([-corner, corner]))
    }
}

/// Distance (m) of a ball of `radius` (m), seen from `offset` (m) against its centre.
pub(super) fn around_a_point(offset: Vec3, radius: Real) -> Distance {
    let length = offset.norm();
    // At the centre all ways out are equally long.
    let normal = if length > 0.0 {
        offset / length
    } else {
        Vec3::z()
    };
    Distance::exact(length - radius, normal)
}

//! A ball swept along a segment.

use super::sphere::around_a_point;
use super::{Distance, ObstacleError, SignedDistance, not_negative, positive};
use crate::bounds::Bounds;
use cloth_core::math::{Real, Vec3};

/// All points within r of the segment from −l to +l on the z axis. φ(x) = ‖x − s‖ − r, with the nearest point s of the
/// segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    half_length: Real,
    radius: Real,
}

impl Capsule {
    /// A capsule whose straight part is 2 × `half_length` (m) long, with the given `radius` (m). A half length of 0
    /// makes a sphere.
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`].
    pub fn new(half_length: Real, radius: Real) -> Result<Self, ObstacleError> {
        Ok(Self {
            half_length: not_negative("half length of the capsule (m)", half_length)?,
            radius: positive("radius of the capsule (m)", radius)?,
        })
    }
}

impl SignedDistance for Capsule {
    fn signed_distance(&self, point: Vec3) -> Distance {
        let along = point.z.clamp(-self.half_length, self.half_length);
        let offset = point - Vec3::z() * along;
        if offset == Vec3::zeros() && self.half_length > 0.0 {
            // On the axis the nearest surface is beside it, not at the ends.
            return Distance::exact(-self.radius, Vec3::x());
        }
        around_a_point(offset, self.radius)
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<Bounds> {
        let corner = Vec3::new(self.radius, self.radius, self.radius + self.half_length);
        Some(Bounds::around([-corner, corner]))
    }
}

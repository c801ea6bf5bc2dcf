//! A box.

use super::{Distance, ObstacleError, SignedDistance, positive};
use crate::bounds::Bounds;
use cloth_core::math::Vec3;

/// A box around the origin, along the axes, with half extents b. With q = |x| − b (coordinate by coordinate),
/// φ = ‖max(q, 0)‖ outside, where q has a positive coordinate, and φ = max qᵢ inside.
///
/// Inside, the normal is that of the nearest side: a vertex that got in goes out the shortest way, which in a thin box
/// may be the other side. [`super::first_contact`] keeps it from getting in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    half_extents: Vec3,
}

impl Cuboid {
    /// A box of 2 × `half_extents` (m).
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`] for the first that is not.
    pub fn new(half_extents: Vec3) -> Result<Self, ObstacleError> {
        for extent in half_extents.iter() {
            positive("half extent of the box (m)", *extent)?;
        }
        Ok(Self { half_extents })
    }
}

impl SignedDistance for Cuboid {
    fn signed_distance(&self, point: Vec3) -> Distance {
        let beyond = point.abs() - self.half_extents;
        let outside = beyond.sup(&Vec3::zeros());
        let towards = point.map(|x| 1f64.copysign(x));
        let distance = outside.norm();
        if distance > 0.0 {
            let normal = (outside / distance).component_mul(&towards);
            return Distance::exact(distance, normal);
        }
        let axis = beyond.imax();
        let mut normal = Vec3::zeros();
        normal[axis] = towards[axis];
        Distance::exact(beyond[axis], normal)
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<Bounds> {
        Some(Bounds::around([-self.half_extents, self.half_extents]))
    }
}

//! The one place where our vectors become parry's (which are glam's).

use cloth_core::math::Vec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;

/// parry's box from the lower corner to the upper (m).
pub(crate) fn aabb(lower: Vec3, upper: Vec3) -> Aabb {
    Aabb::new(vector(lower), vector(upper))
}

fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

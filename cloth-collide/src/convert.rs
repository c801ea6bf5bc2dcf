//! The one place where our vectors become parry's (which are glam's).

use crate::bounds::Bounds;
use cloth_core::math::Vec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::BvhNode;

/// Our box as parry's.
pub(crate) fn aabb(bounds: &Bounds) -> Aabb {
    let vector = |v: Vec3| Vector::new(v.x, v.y, v.z);
    Aabb::new(vector(bounds.lower), vector(bounds.upper))
}

/// The box of a node of the tree.
pub(crate) fn bounds(node: &BvhNode) -> Bounds {
    let vec3 = |v: Vector| Vec3::new(v.x, v.y, v.z);
    Bounds {
        lower: vec3(node.mins()),
        upper: vec3(node.maxs()),
    }
}

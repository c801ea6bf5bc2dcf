//! The one place where our vectors become parry's (which are glam's).

use crate::bounds::Bounds;
use crate::closest::{PointTriangle, point_triangle};
use cloth_core::math::{Real, Vec3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

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

/// A tree of the boxes around some triangles, by their corners (m).
pub(crate) fn tree_over(triangles: impl Iterator<Item = [Vec3; 3]>) -> Bvh {
    let leaves: Vec<_> = triangles.map(|x| aabb(&Bounds::around(x))).collect();
    Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves)
}

/// The triangle of such a tree that is nearest to a point (m), and nearer than `limit` (m), if there is one.
pub(crate) fn nearest_triangle(
    tree: &Bvh,
    point: Vec3,
    limit: Real,
    corners: impl Fn(usize) -> [Vec3; 3],
) -> Option<(usize, PointTriangle)> {
    let at_point = Bounds::around([point]);
    let found = tree.find_best(
        limit,
        |node: &BvhNode, _| bounds(node).squared_gap(&at_point).sqrt(),
        |t, _| {
            let nearest = point_triangle(point, corners(t as usize));
            Some((nearest.distance(), nearest))
        },
    );
    found.map(|(t, (_, nearest))| (t as usize, nearest))
}

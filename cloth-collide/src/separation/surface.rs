//! The distance of points from a surface.

use crate::convert::{nearest_triangle, tree_over};
use cloth_core::math::{Real, Vec3, gather, is_finite};

/// The smallest distance (m), without a sign, of any of `points` (m) from the triangles of a surface, whose vertices
/// are at `positions` (m); none without a point or without a triangle. Points and triangles that are not finite are
/// left out.
///
/// A tree of boxes is built for the one call. What is no nearer than the nearest point so far is not looked at.
///
/// ```
/// use cloth_collide::distance_from_surface;
/// use cloth_core::math::Vec3;
///
/// let corners = [Vec3::zeros(), Vec3::x(), Vec3::y()];
/// let points = [Vec3::new(0.25, 0.25, -2.0), Vec3::new(4.0, 0.0, 4.0)];
/// assert_eq!(distance_from_surface(&points, &corners, &[[0, 1, 2]]), Some(2.0));
/// ```
///
/// # Panics
/// If a triangle has a vertex without a position.
#[must_use]
pub fn distance_from_surface(
    points: &[Vec3],
    positions: &[Vec3],
    triangles: &[[u32; 3]],
) -> Option<Real> {
    let corners = triangles.iter().map(|&t| gather(positions, t));
    let corners: Vec<[Vec3; 3]> = corners.filter(|x| x.iter().all(is_finite)).collect();
    let tree = tree_over(corners.iter().copied());
    let mut nearest = Real::INFINITY;
    for &point in points.iter().filter(|x| is_finite(x)) {
        let found = nearest_triangle(&tree, point, nearest, |t| corners[t]);
        nearest = found.map_or(nearest, |(_, found)| nearest.min(found.distance()));
    }
    nearest.is_finite().then_some(nearest)
}

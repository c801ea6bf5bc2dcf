//! The quick test before the exact one: most pairs are apart along some direction, by far more than rounding.

use cloth_core::math::{Real, Vec3};

/// True only if the convex hulls of `first` and `second` (positions, m) have no point in common; false if they have,
/// or if the directions tried here leave it open.
///
/// The directions are the normal of the triangle and the in-plane normals of its edges. What they are
/// exactly does not matter, for two sets that are apart along *any* direction are apart. So only the rounding of
/// the projections counts, and the gap has to exceed it.
pub(super) fn certainly_apart<const N: usize>(first: [Vec3; N], second: [Vec3; 3]) -> bool {
    let origin = second[0];
    let first = first.map(|x| x - origin);
    let second = second.map(|x| x - origin);
    let all = first.iter().chain(&second);
    let size = all.map(Vec3::amax).fold(0.0, Real::max);
    let n = second[1].cross(&second[2]);
    let apart_along = |direction: Vec3| {
        // A projection rounds three differences, three products and two sums, each by half of EPSILON at most.
        let rounding = 16.0 * Real::EPSILON * size * direction.amax();
        let [low, high] = range(&first, direction);
        let [other_low, other_high] = range(&second, direction);
        low - other_high > rounding || other_low - high > rounding
    };
    apart_along(n) || (0..3).any(|k| apart_along(n.cross(&(second[(k + 1) % 3] - second[k]))))
}

/// The smallest and the largest projection of `points` on `direction`.
fn range(points: &[Vec3], direction: Vec3) -> [Real; 2] {
    let start = [Real::INFINITY, Real::NEG_INFINITY];
    points.iter().fold(start, |[low, high], x| {
        let along = x.dot(&direction);
        [low.min(along), high.max(along)]
    })
}

//! The triangles of each patch.

use super::PATCH;
use cloth_core::math::Vec3;

/// Cuts a set of triangles across its longest side, until the parts are small enough.
pub(super) fn halve(
    triangles: &mut [u32],
    middle: &impl Fn(u32) -> Vec3,
    done: &mut impl FnMut(&[u32]),
) {
    if triangles.len() <= PATCH {
        done(triangles);
        return;
    }
    let first = middle(triangles[0]);
    let (lower, upper) = triangles.iter().fold((first, first), |(low, high), &t| {
        (low.inf(&middle(t)), high.sup(&middle(t)))
    });
    let axis = (upper - lower).imax();
    triangles.sort_by(|&a, &b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let (a, b) = triangles.split_at_mut(triangles.len() / 2);
    halve(a, middle, done);
    halve(b, middle, done);
}

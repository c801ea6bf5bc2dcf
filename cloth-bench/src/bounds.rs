//! The box around points.

use cloth_core::math::Vec3;

/// The least and the greatest coordinates of some points; twice the origin of none.
pub(crate) fn bounds(points: impl Iterator<Item = Vec3> + Clone) -> [Vec3; 2] {
    let low = points.clone().reduce(|a, b| a.inf(&b));
    let high = points.reduce(|a, b| a.sup(&b));
    [low, high].map(Option::unwrap_or_default)
}

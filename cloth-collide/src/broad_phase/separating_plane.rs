//! A plane between two groups of boxes.

use crate::bounds::Bounds;
use cloth_core::math::{Real, Vec3};

/// Decides whether a plane has two groups of boxes on its two sides, without being misled by rounding.
///
/// Points that stay in their boxes then stay on their sides, whatever they do, and so does everything between the
/// points of one group.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SeparatingPlane {
    /// The largest coordinate (m) of all boxes.
    reach: Real,
}

impl SeparatingPlane {
    pub(super) fn among(boxes: &[Bounds]) -> Self {
        let reach = boxes.iter().map(Bounds::size).fold(0.0, Real::max);
        Self { reach }
    }

    /// Whether a plane across `direction`, of any length and from the second group towards the first, has them apart.
    pub(super) fn is_plane(&self, direction: &Vec3, first: &[&Bounds], second: &[&Bounds]) -> bool {
        let mut sides = [[Real::INFINITY, Real::NEG_INFINITY]; 2];
        let mut widen = |side: usize, bounds: &Bounds| {
            let [low, high] = range(direction, bounds);
            let [lowest, highest] = &mut sides[side];
            *lowest = lowest.min(low);
            *highest = highest.max(high);
        };
        first.iter().for_each(|bounds| widen(0, bounds));
        second.iter().for_each(|bounds| widen(1, bounds));
        let [[first_low, first_high], [second_low, second_high]] = sides;
        let gap = (first_low - second_high).max(second_low - first_high);
        // Three products and two sums for each side, one difference: each less than half of ε of this. If it overflows,
        // nothing is certain, and the comparison fails; it is NaN if the direction is.
        let size = (direction.x.abs() + direction.y.abs() + direction.z.abs()) * self.reach;
        gap > 8.0 * Real::EPSILON * size
    }
}

/// The smallest and the largest n · x for x in a box.
fn range(n: &Vec3, bounds: &Bounds) -> [Real; 2] {
    let (lower, upper) = (
        n.component_mul(&bounds.lower),
        n.component_mul(&bounds.upper),
    );
    [lower.inf(&upper).sum(), lower.sup(&upper).sum()]
}

#[cfg(test)]
#[path = "../../tests/unit/broad_phase_separating_plane.rs"]
mod tests;

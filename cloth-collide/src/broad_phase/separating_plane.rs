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
    /// For groups out of `boxes`.
    pub(super) fn among(boxes: &[Bounds]) -> Self {
        let reach = boxes.iter().map(Bounds::size).fold(0.0, Real::max);
        Self { reach }
    }

    /// Whether a plane across `direction`, of any length and from the second group towards the first, has them apart.
    pub(super) fn is_plane<const M: usize, const N: usize>(
        &self,
        direction: &Vec3,
        first: &[&Bounds; M],
        second: &[&Bounds; N],
    ) -> bool {
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
mod tests {
    use super::*;

    fn at(x: Real, y: Real) -> Bounds {
        let corner = Vec3::new(x, y, 0.0);
        Bounds {
            lower: corner,
            upper: corner + Vec3::new(1.0, 1.0, 1.0),
        }
    }

    /// Squares at a corner, 0.1 from touching along the diagonal: neither axis has them apart, the diagonal has.
    #[test]
    fn plane_is_found_where_no_axis_is() {
        let group = [&at(0.0, 0.0), &at(-1.0, 1.0)];
        let other = at(0.6, 1.6);
        let separating_plane = SeparatingPlane::among(&[*group[0], *group[1], other]);
        let diagonal = Vec3::new(1.0, 1.0, 0.0);
        assert!(!separating_plane.is_plane(&Vec3::x(), &group, &[&other]));
        assert!(!separating_plane.is_plane(&Vec3::y(), &group, &[&other]));
        assert!(separating_plane.is_plane(&diagonal, &group, &[&other]));
        // From either side, and of any length.
        assert!(separating_plane.is_plane(&(diagonal * -1e-3), &[&other], &group));
        assert!(!separating_plane.is_plane(&diagonal, &group, &[&at(0.4, 1.5)]));
    }

    /// What touches is not apart, and nothing is where numbers fail.
    #[test]
    fn doubt_parts_nothing() {
        let (a, b) = (at(0.0, 0.0), at(1.0, 0.0));
        let separating_plane = SeparatingPlane::among(&[a, b]);
        assert!(!separating_plane.is_plane(&Vec3::x(), &[&a], &[&b]));
        assert!(!separating_plane.is_plane(&Vec3::zeros(), &[&a], &[&at(9.0, 0.0)]));
        for bad in [Real::NAN, Real::INFINITY, Real::MAX] {
            let direction = Vec3::new(bad, bad, bad);
            assert!(
                !separating_plane.is_plane(&direction, &[&a], &[&at(9.0, 0.0)]),
                "{bad}"
            );
        }
        let far = at(1e308, 1e308);
        let separating_plane = SeparatingPlane::among(&[a, far]);
        assert!(!separating_plane.is_plane(&Vec3::new(10.0, 0.0, 0.0), &[&a], &[&far]));
    }
}

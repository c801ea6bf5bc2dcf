//! The link of a coarse level.

use cloth_core::element::{Constraint, Element, Row};
use cloth_core::math::{Real, Vec3, length_and_direction};

/// A spring that pulls but never pushes: `C = max(0, ‖x₀ − x₁‖ − L)` (m). Shorter than L it has no value, so cloth that folds between two coarse vertices
/// is none of its business.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tether {
    pub(super) vertices: [u32; 2],
    /// L (m).
    pub(super) length: Real,
}

impl Element<2> for Tether {
    #[inline]
    fn vertices(&self) -> [u32; 2] {
        self.vertices
    }
}

impl Constraint<2> for Tether {
    type Rows = [Row<2>; 1];

    #[inline]
    fn rows(&self, x: &[Vec3; 2]) -> [Row<2>; 1] {
        let (length, n) = length_and_direction(x[0] - x[1], self.vertices);
        [Row {
            value: (length - self.length).max(0.0),
            gradient: [n, -n],
            stiffness: Real::INFINITY,
        }]
    }
}

//! The link of a coarse level.

use cloth_core::element::{Constraint, Element, Row};
use cloth_core::math::{Real, Vec3, length_and_direction};
use cloth_core::position_based::{RowAt, Rule};

/// `C = ‖x₀ − x₁‖ − L` (m), to be solved by [`Pull`].
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
            value: length - self.length,
            gradient: [n, -n],
            stiffness: Real::INFINITY,
        }]
    }
}

/// Brings a row towards zero by a multiplier whose sum is never positive: a link pulls, and may take back what it has pulled too much, but never
/// pushes. Shorter than L it does nothing, so cloth that folds between two coarse vertices is none of its business.
///
/// Without taking back, links that pull by turns would draw the cloth together, since nothing draws it apart again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    /// Part of C (dimensionless) that is removed in a visit.
    pub(super) stiffness: Real,
}

impl Rule for Pull {
    /// λ (kg m) since the start of the correction.
    type Memory = Real;

    #[inline]
    fn multiplier(&self, row: RowAt, total: &mut Real) -> Real {
        if row.weight <= 0.0 {
            return 0.0;
        }
        let change = (-self.stiffness * row.value / row.weight).min(-*total);
        *total += row.share * change;
        change
    }
}

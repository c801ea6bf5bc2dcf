//! The row of a coarse link, and its unilateral update.

use cloth_core::element::{Constraint, Element, Row};
use cloth_core::math::{Real, Vec3, length_and_direction};
use cloth_core::method::position_based::{ConstraintUpdate, RowEquation, RowState};

/// A link of a coarse level: `C = ‖x₀ − x₁‖ − L` (m), to be solved by [`TetherUpdate`].
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

/// Keeps the length of a link between its length at the start of the correction, if that was below L, and L: by a
/// multiplier that pulls where the link would be longer, pushes where it would be shorter, and is zero between.
///
/// A link that is short, as where cloth folds between two coarse vertices, may stay short; but the correction
/// itself does not make links shorter: [`Hierarchy`](super::Hierarchy) has the formulas and the reason.
#[derive(Clone, Copy, Debug)]
pub(super) enum TetherUpdate {
    /// Stores the lengths of the links.
    Begin,
    /// Makes this fraction (dimensionless) of the correction in a visit.
    Project(Real),
}

/// Bound and multiplier of a link during a correction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Memory {
    /// C (m) at the start, or 0 if that was above.
    shortest: Real,
    /// λ (kg m): negative for a pull.
    lambda: Real,
}

impl ConstraintUpdate for TetherUpdate {
    type Memory = Memory;

    #[inline(always)]
    fn equation(&self, row: RowState, memory: &mut Memory) -> RowEquation {
        let residual = match *self {
            Self::Begin => {
                memory.shortest = row.value.min(0.0);
                0.0
            }
            Self::Project(fraction) => {
                // A link that is too long pulls: λ ← min(0, λ − f C/w̃), f the fraction. One that does not pull pushes
                // where it has become shorter than at the start, C₀ = min(C, 0) there: λ ← max(0, λ − f (C − C₀)/w̃).
                // Both times w̃, which saves two divisions.
                let multiplier = memory.lambda * row.weight;
                let pull = multiplier - fraction * row.value;
                let push = multiplier - fraction * (row.value - memory.shortest);
                multiplier - if pull < 0.0 { pull } else { push.max(0.0) }
            }
        };
        RowEquation {
            residual,
            scaled_compliance: 0.0,
        }
    }

    #[inline(always)]
    fn accumulate(&self, change: Real, memory: &mut Memory) {
        memory.lambda += change;
    }
}

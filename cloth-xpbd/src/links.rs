//! Rigid links and joints: hard constraints beside cloth in one scene.
//!
//! A rigid link is a [`Spring`] of infinite stiffness: with α = 0 its row is a hard constraint, and λ/h² is the
//! constraint force. Links that share a vertex are hinged there; a rigid body is a truss of links. This module
//! adds what chains and ragdolls need beside: a joint between two vertices, and a limit of an angle.

use cloth_core::element::{Constraint, Element, Row, RowForm, VectorRow};
use cloth_core::energy::{Spring, StrainLimitSpring};
use cloth_core::math::{Real, Vec3};

/// Rigid links between pairs of vertices, each as long as the distance of the pair at `rest_positions` (m).
///
/// # Panics
/// If an end is not smaller than the number of rest positions.
#[must_use]
pub fn rigid_links(rest_positions: &[Vec3], ends: &[[u32; 2]]) -> Vec<Spring> {
    Spring::along(rest_positions, ends, Real::INFINITY)
}

/// Ties two vertices together: the three rows are the coordinates of `x₀ − x₁` (m).
///
/// They are linear and isotropic, which a [`Spring`] of rest length zero is not. With infinite stiffness it is a ball
/// joint: it attaches a corner of the cloth to the end of a chain without renumbering vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// The two vertices.
    pub vertices: [u32; 2],
    /// Stiffness k (N/m).
    pub stiffness: Real,
}

impl Element<2> for Joint {
    #[inline]
    fn vertices(&self) -> [u32; 2] {
        self.vertices
    }
}

impl Constraint<2> for Joint {
    type Rows = [Row<2>; 3];

    const ROWS_ARE_LINEAR: bool = true;

    #[inline]
    fn rows(&self, x: &[Vec3; 2]) -> [Row<2>; 3] {
        self.as_vector_row().rows(x)
    }

    #[inline]
    fn row_form(&self, _: &[Vec3; 2]) -> RowForm<2> {
        RowForm::Vector(self.as_vector_row())
    }
}

impl Joint {
    #[inline]
    fn as_vector_row(&self) -> VectorRow<2> {
        VectorRow {
            coefficients: [1.0, -1.0],
            target: Vec3::zeros(),
            stiffness: self.stiffness,
        }
    }
}

/// Keeps the distance of two vertices between a shortest and a longest one: the spring with a dead zone, under
/// the name of its use here.
///
/// Between the far ends of two links that meet it limits their angle: with links of lengths a and b,
/// `l² = a² + b² − 2ab cos φ`.
pub type DistanceLimit = StrainLimitSpring;

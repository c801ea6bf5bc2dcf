//! Rigid links and joints, in the same scene as cloth (XPBD-5).
//!
//! A rigid link is a [`Spring`] of infinite stiffness: with α = 0 its row is a hard constraint, and λ/h² is the force that holds it. Links that share a vertex are hinged there.
//! A body is a truss of links. What is missing for chains and ragdolls is here: a joint between two vertices that are not one, and a limit to an angle.

use cloth_core::element::{Constraint, Convexity, Element, Row, VectorRow};
use cloth_core::energy::Spring;
use cloth_core::math::{Blocks, Mat3, Real, Vec3, length_and_direction};

/// Rigid links between pairs of vertices, each as long as the pair is apart at `rest_positions` (m).
///
/// # Panics
/// If an end is not smaller than the number of rest positions.
#[must_use]
pub fn rigid_links(rest_positions: &[Vec3], ends: &[[u32; 2]]) -> Vec<Spring> {
    Spring::along(rest_positions, ends, Real::INFINITY)
}

/// Ties two vertices together: the three rows are the coordinates of `x₀ − x₁` (m).
///
/// They are linear and without a preferred direction, which a [`Spring`] of rest length zero is not. With infinite stiffness it is a ball joint: it attaches a corner of the cloth to the
/// end of a chain without renumbering anything.
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
    fn vector_row(&self) -> Option<VectorRow<2>> {
        Some(self.as_vector_row())
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

/// Keeps the distance of two vertices between a shortest and a longest one: `C = l − longest` beyond, `C = l − shortest` below (m), and nothing between.
///
/// Between the far ends of two links that meet it limits their angle: with links of lengths a and b, `l² = a² + b² − 2ab cos φ`.
///
/// Limits: a sweep that overshoots the range pushes back and is not taken back within the substep, as in every position-based method; it never pulls.
/// E is ½ k C², continuous with its first derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceLimit {
    /// The two vertices.
    pub vertices: [u32; 2],
    /// Shortest distance (m).
    pub shortest: Real,
    /// Longest distance (m), not below the shortest.
    pub longest: Real,
    /// Stiffness k (N/m) outside the range.
    pub stiffness: Real,
}

impl Element<2> for DistanceLimit {
    #[inline]
    fn vertices(&self) -> [u32; 2] {
        self.vertices
    }
}

impl Constraint<2> for DistanceLimit {
    type Rows = [Row<2>; 1];

    #[inline]
    fn rows(&self, x: &[Vec3; 2]) -> [Row<2>; 1] {
        let (length, n) = length_and_direction(x[0] - x[1], self.vertices);
        let value = length - length.max(self.shortest).min(self.longest);
        // Between the limits there is no gradient, so that nothing can push.
        let n = if value == 0.0 { Vec3::zeros() } else { n };
        [Row {
            value,
            gradient: [n, -n],
            stiffness: self.stiffness,
        }]
    }

    fn curvature(&self, x: &[Vec3; 2], convexity: Convexity) -> Blocks<2> {
        let [row] = self.rows(x);
        let force = self.stiffness * row.value;
        self.geometric_stiffness(x, &[-force], convexity)
    }

    /// That of a spring outside the range, zero between.
    fn geometric_stiffness(
        &self,
        x: &[Vec3; 2],
        multipliers: &[Real],
        convexity: Convexity,
    ) -> Blocks<2> {
        let [row] = self.rows(x);
        if row.value == 0.0 {
            return [[Mat3::zeros(); 2]; 2];
        }
        let spring = Spring {
            vertices: self.vertices,
            rest_length: 0.0,
            stiffness: self.stiffness,
        };
        spring.geometric_stiffness(x, multipliers, convexity)
    }
}

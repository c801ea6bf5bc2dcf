//! A tetrahedron that wants to keep its volume.
//!
//! M. Teschner, B. Heidelberger, M. Müller, M. Gross, "A versatile and robust model for geometrically complex
//! deformable solids", Computer Graphics International 2004: their potential for the preservation of volume, here with
//! `k = K/V₀`.

use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, Element, Row};
use crate::error::{OutOfRange, finite, number};
use crate::math::{Blocks, Mat3, Real, Vec3, make_semidefinite};

/// The volume constraint: `C = V − V₀` (m³), `E = ½ k C²` (J), with `V = (x₁ − x₀)·((x₂ − x₀) × (x₃ − x₀))/6`.
///
/// With `k = K/V₀` it costs `½ K (V/V₀ − 1)²` per rest volume: K (Pa) is the bulk modulus. The volume has a sign, so a
/// tetrahedron turned inside out is pushed back. V is linear in each vertex, `∂V/∂xᵢ` is a sixth of the normal of the
/// opposite face (twice its area long), and everything is smooth everywhere; where all four vertices lie on a line the
/// gradient is zero, and a position-based method leaves the element alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeTetrahedron {
    /// Its four corners.
    pub vertices: [u32; 4],
    /// Rest volume V₀ (m³), with its sign.
    pub rest_volume: Real,
    /// k (N/m⁵).
    pub stiffness: Real,
}

impl VolumeTetrahedron {
    /// The element at rest at `rest` (m), which must have a volume, for K (Pa).
    #[must_use]
    pub fn new(vertices: [u32; 4], rest: &[Vec3; 4], modulus: Real) -> Self {
        let rest_volume = signed_volume(rest);
        Self {
            vertices,
            rest_volume,
            stiffness: modulus / rest_volume.abs(),
        }
    }
}

/// `(x₁ − x₀)·((x₂ − x₀) × (x₃ − x₀))/6` (m³).
#[inline]
fn signed_volume(x: &[Vec3; 4]) -> Real {
    let [a, b, c] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
    a.dot(&b.cross(&c)) / 6.0
}

impl Element<4> for VolumeTetrahedron {
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Volumes(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        finite("rest volume (m³)", self.rest_volume)?;
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<4> for VolumeTetrahedron {
    type Rows = [Row<4>; 1];

    #[inline]
    fn rows(&self, x: &[Vec3; 4]) -> [Row<4>; 1] {
        let [a, b, c] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
        let first = b.cross(&c) / 6.0;
        let second = c.cross(&a) / 6.0;
        let third = a.cross(&b) / 6.0;
        [Row {
            value: a.dot(&first) - self.rest_volume,
            gradient: [-(first + second + third), first, second, third],
            stiffness: self.stiffness,
        }]
    }

    /// `∂²V/∂xᵢ∂xⱼ = ±[xₖ − xₗ]/6`, brackets meaning the matrix of the cross product; zero for i = j.
    fn curvature(&self, x: &[Vec3; 4], convexity: Convexity) -> Blocks<4> {
        let [a, b, c] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
        let scale = self.stiffness * (signed_volume(x) - self.rest_volume) / 6.0;
        let mut sum = [[Mat3::zeros(); 4]; 4];
        // 6V = a·(b × c): derivatives by b and then c leave the matrix of a, and so on round.
        for (i, j, edge) in [(1, 2, c), (2, 3, a), (3, 1, b)] {
            let block = edge.cross_matrix() * scale;
            sum[i][j] -= block;
            sum[j][i] += block;
            // x₀ moves against the three others.
            sum[i][0] += block;
            sum[0][i] -= block;
            sum[j][0] -= block;
            sum[0][j] += block;
        }
        make_semidefinite(&sum, convexity)
    }
}

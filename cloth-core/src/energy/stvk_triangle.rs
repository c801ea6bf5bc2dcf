//! The linear-elastic sheet at large rotations: St. Venant–Kirchhoff triangles.
//!
//! P. Volino, N. Magnenat-Thalmann, F. Faure, "A simple approach to nonlinear tensile stiffness for accurate cloth
//! simulation", ACM Trans. Graph. 28(4), 2009, article 105, <https://doi.org/10.1145/1559755.1559762>: the columns f
//! and g of F are their U and V, and G₁₁, G₂₂, G₁₂ their strains ε_uu, ε_vv, ε_uv.

use super::triangle_map::TriangleMap;
use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, Element, Row};
use crate::error::{OutOfRange, number};
use crate::math::{Blocks, Mat3, Real, Vec3, gather};
use crate::mesh::TriMesh;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// A triangle of an isotropic sheet in plane stress, `E = A·½ G:H:G` (J) with the Green strain `G = ½(FᵀF − I)`
/// (dimensionless).
///
/// F (3 × 2) maps rest to present. Plane stress: a thin sheet has no stress across its thickness t, so its modulus Y
/// (N/m) is Young's modulus times t. H takes the strain to the second Piola–Kirchhoff stress S (N/m):
///
/// ```text
/// ⎡S₁₁⎤               ⎡1  ν      0    ⎤ ⎡ G₁₁⎤
/// ⎢S₂₂⎥ = Y/(1 − ν²)  ⎢ν  1      0    ⎥ ⎢ G₂₂⎥
/// ⎣S₁₂⎦               ⎣0  0  (1 − ν)/2⎦ ⎣2G₁₂⎦
/// ```
///
/// or, with Lamé's coefficients, `S = 2μ G + λ tr(G) I`, `μ = Y/(2(1 + ν))`, `λ = Y ν/(1 − ν²)`. This λ is not t times
/// that of the solid, `Y ν/((1 + ν)(1 − 2ν))`, which holds where the thickness cannot change.
///
/// The rows are G in the eigenbasis of H, `C = ((G₁₁ + G₂₂)/√2, (G₁₁ − G₂₂)/√2, √2 G₁₂)`. With the columns f and g of
/// `F = Σ xᵢ bᵢᵀ`, where the constant `bᵢ = (bᵢ₁, bᵢ₂)` (1/m) sum to zero (`triangle_map.rs`),
///
/// ```text
/// C₁ = (f·f + g·g − 2)/(2√2)    ∂C₁/∂xᵢ = (bᵢ₁ f + bᵢ₂ g)/√2    k = A Y/(1 − ν)
/// C₂ = (f·f − g·g)/(2√2)        ∂C₂/∂xᵢ = (bᵢ₁ f − bᵢ₂ g)/√2    k = A Y/(1 + ν)
/// C₃ = f·g/√2                   ∂C₃/∂xᵢ = (bᵢ₁ g + bᵢ₂ f)/√2    k = A Y/(1 + ν)
/// ```
///
/// so `E = ½ Σ k C²` is diagonal, and `∂E/∂xᵢ = A F S bᵢ`. Pulled to s times its length along one direction the sheet
/// answers with `P = Y s (s² − 1)/2` (N/m), and gets `√(1 − ν (s² − 1))` times as wide, in any direction.
///
/// Limits: pressed below `s = 1/√3` the force decreases, and a triangle pressed to nothing costs a finite energy. E is
/// a polynomial of the positions, so E and its derivatives are finite for a collapsed triangle too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StvkTriangle {
    /// Its three corners.
    pub vertices: [u32; 3],
    map: TriangleMap,
    /// `A Y/(1 − ν)` (J): resistance to a change of area.
    area_stiffness: Real,
    /// `A Y/(1 + ν)` (J): resistance to shear.
    shear_stiffness: Real,
}

impl StvkTriangle {
    /// One element on every triangle of the mesh, for a membrane modulus Y (N/m) and Poisson's ratio ν in (−1, 1); see
    /// [`StvkTriangle::new`].
    #[must_use]
    pub fn on(mesh: &TriMesh, modulus: Real, poisson_ratio: Real) -> Vec<Self> {
        mesh.triangles()
            .iter()
            .map(|&vertices| {
                let rest = gather(mesh.positions(), vertices);
                Self::new(vertices, &rest, modulus, poisson_ratio)
            })
            .collect()
    }

    /// The element at rest at `rest` (m), which must have an area, for Y (N/m) and ν in (−1, 1). Nothing is checked:
    /// ν = ±1 makes a stiffness infinite, and ν beyond makes it negative. A [`Cloth`](crate::Cloth) refuses both.
    #[must_use]
    pub fn new(vertices: [u32; 3], rest: &[Vec3; 3], modulus: Real, poisson_ratio: Real) -> Self {
        let map = TriangleMap::new(rest);
        Self {
            vertices,
            area_stiffness: map.area * modulus / (1.0 - poisson_ratio),
            shear_stiffness: map.area * modulus / (1.0 + poisson_ratio),
            map,
        }
    }
}

impl Element<3> for StvkTriangle {
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 3] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Stvk(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        number("area stiffness", self.area_stiffness)?;
        number("shear stiffness", self.shear_stiffness)?;
        Ok(())
    }
}

/// `C` of the rows from the columns of F.
fn strains([f, g]: [Vec3; 2]) -> [Real; 3] {
    let [xx, yy] = [
        0.5 * (f.norm_squared() - 1.0),
        0.5 * (g.norm_squared() - 1.0),
    ];
    [
        (xx + yy) * FRAC_1_SQRT_2,
        (xx - yy) * FRAC_1_SQRT_2,
        f.dot(&g) * FRAC_1_SQRT_2, // √2 G₁₂
    ]
}

impl Constraint<3> for StvkTriangle {
    type Rows = [Row<3>; 3];

    #[inline]
    fn rows(&self, x: &[Vec3; 3]) -> [Row<3>; 3] {
        let [f, g] = self.map.columns(x);
        let value = strains([f, g]);
        let s = FRAC_1_SQRT_2;
        let by_columns = [[f * s, g * s], [f * s, g * -s], [g * s, f * s]];
        let stiffness = [
            self.area_stiffness,
            self.shear_stiffness,
            self.shear_stiffness,
        ];
        std::array::from_fn(|r| Row {
            value: value[r],
            gradient: self.map.back(by_columns[r]),
            stiffness: stiffness[r],
        })
    }

    /// `A bᵢ·S bⱼ I` with the second Piola–Kirchhoff stress S. Making S semi-definite, two eigenvalues in closed form,
    /// makes it so.
    fn curvature(&self, x: &[Vec3; 3], convexity: Convexity) -> Blocks<3> {
        let [area, shear, slant] = strains(self.map.columns(x));
        // A S = mean I + [[half, off], [off, −half]], with eigenvalues mean ± radius.
        let mean = self.area_stiffness * area * FRAC_1_SQRT_2;
        let half = self.shear_stiffness * shear * FRAC_1_SQRT_2;
        let off = self.shear_stiffness * slant / SQRT_2;
        let radius = half.hypot(off);
        let [high, low] = [mean + radius, mean - radius].map(|value| convexity.applied_to(value));
        let (mean, turn) = (
            0.5 * (high + low),
            if radius > 0.0 {
                0.5 * (high - low) / radius
            } else {
                0.0
            },
        );
        let (half, off) = (half * turn, off * turn);
        let b = &self.map.gradients;
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let diagonal = mean * (b[i][0] * b[j][0] + b[i][1] * b[j][1]);
                let split = half * (b[i][0] * b[j][0] - b[i][1] * b[j][1]);
                let mixed = off * (b[i][0] * b[j][1] + b[i][1] * b[j][0]);
                Mat3::identity() * (diagonal + split + mixed)
            })
        })
    }
}

//! Quadratic bending between two triangles that share only the middle of an edge: nonconforming elements.
//!
//! Elements: E. English, R. Bridson, "Animating developable surfaces using nonconforming elements", ACM Trans. Graph.
//! 27 (2008), <https://doi.org/10.1145/1360612.1360665>. That the model of [`super::CurvatureHinge`] is made of just
//! these elements: M. Wardetzky et al., "Discrete quadratic curvature energies", CAGD 24 (2007),
//! <https://doi.org/10.1016/j.cagd.2007.07.006>. The formula below was derived from the two.

use super::cotangent::Cotangents;
use crate::cloth::Elements;
use crate::element::{Constraint, Element, Projective, Row, RowForm, VectorRow};
use crate::error::{OutOfRange, number};
use crate::math::{Real, Vec3};

/// The bending model of Bergou et al. (2006) in terms of edge midpoints.
///
/// Five points: the midpoint `m` of an edge `x₀ x₁`, and of the four other edges of its two triangles: of `x₀x₂`,
/// `x₁x₂`, `x₀x₃`, `x₁x₃`. With the angles θ₀, θ₁ of the first triangle and θ₂, θ₃ of the second at `x₀`, `x₁`,
///
/// `z = 2 (cot θ₀ + cot θ₁ + cot θ₂ + cot θ₃) m − 2 (cot θ₀ m₀₂ + cot θ₁ m₁₂ + cot θ₂ m₀₃ + cot θ₃ m₁₃)` (m)
///
/// is the length of the edge times the sum of two unit vectors, of each triangle the one across the edge, from its tip
/// to the edge (as long as it is not stretched). Where the triangles fit together at the vertices, it is the vector `z`
/// of [`super::CurvatureHinge`], and so is the energy `E = ½ K ‖z‖²`, `K = k·3/(A₀ + A₁)` (N/m).
///
/// For a smooth surface the sum of all these energies tends to `½ k ∫ (κ₁ + κ₂)²` once the midpoints have settled, so
/// `k` is the rigidity D itself.
///
/// Limits: flat at rest. A saddle of equal and opposite curvatures costs nothing (ν = 1); an inextensible sheet cannot
/// make one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MidpointHinge {
    /// Numbers of `m`, `m₀₂`, `m₁₂`, `m₀₃`, `m₁₃`.
    pub vertices: [u32; 5],
    /// Their coefficients in `z` (dimensionless), sum 0.
    pub coefficients: [Real; 5],
    /// `K = k·3/(A₀ + A₁)` (N/m).
    pub stiffness: Real,
}

impl MidpointHinge {
    /// The element with coefficient `k` = D (N·m) on five midpoints; `rest` (m) are the ends of the edge and the wing
    /// tips `x₀ … x₃` of the whole triangles, which must have an area.
    #[must_use]
    pub fn new(midpoints: [u32; 5], rest: &[Vec3; 4], k: Real) -> Self {
        let shape = Cotangents::of(rest);
        let [c0, c1, c2, c3] = shape.angles.map(|c| -2.0 * c);
        Self {
            vertices: midpoints,
            coefficients: [-(c0 + c1 + c2 + c3), c0, c1, c2, c3],
            stiffness: shape.stiffness(k),
        }
    }

    #[inline(always)]
    fn as_vector_row(&self) -> VectorRow<5> {
        VectorRow {
            coefficients: self.coefficients,
            target: Vec3::zeros(),
            stiffness: self.stiffness,
        }
    }
}

impl Element<5> for MidpointHinge {
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 5] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Midpoint(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<5> for MidpointHinge {
    type Rows = [Row<5>; 3];

    const ROWS_ARE_LINEAR: bool = true;

    #[inline]
    fn rows(&self, x: &[Vec3; 5]) -> [Row<5>; 3] {
        self.as_vector_row().rows(x)
    }

    #[inline(always)]
    fn row_form(&self, _: &[Vec3; 5]) -> RowForm<5> {
        RowForm::Vector(self.as_vector_row())
    }
}

/// The set is the single point 0.
impl Projective<5, 1> for MidpointHinge {
    const PROJECTION_IS_CONSTANT: bool = true;

    #[inline]
    fn operator(&self) -> [[Real; 5]; 1] {
        [self.coefficients]
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, _: [Vec3; 1]) -> [Vec3; 1] {
        [Vec3::zeros()]
    }
}

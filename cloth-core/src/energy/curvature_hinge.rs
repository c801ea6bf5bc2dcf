//! Quadratic bending: two triangles that want to lie in one plane.
//!
//! M. Bergou, M. Wardetzky, D. Harmon, D. Zorin, E. Grinspun, "A quadratic bending model for inextensible surfaces",
//! SGP 2006, <https://doi.org/10.2312/SGP/SGP06/227-230>: `E = ½ xᵀQx`, the sum over edges of
//! `Q(e₀) = 3/(A₀ + A₁) K₀ᵀK₀`. Their row vector K₀ is q here, and their Q, times k, is the Hessian.

use super::cotangent::{Cotangents, on_each_hinge};
use crate::cloth::Elements;
use crate::element::{Constraint, Element, Projective, Row, RowForm, VectorRow};
use crate::error::{OutOfRange, finite, number};
use crate::math::{Real, Vec3};
use crate::mesh::TriMesh;
use crate::topology::HingeTable;

/// The isometric bending model of Bergou et al. (2006).
///
/// Four vertices, the edge `x₀ x₁` and the two wing tips `x₂`, `x₃`. The vector
/// `z = q₀x₀ + q₁x₁ + q₂x₂ + q₃x₃` (m), with
///
/// `q = (cot θ₁ + cot θ₃, cot θ₀ + cot θ₂, −(cot θ₀ + cot θ₁), −(cot θ₂ + cot θ₃))`,
///
/// θ₀, θ₁ the angles of the first triangle at `x₀`, `x₁`, and θ₂, θ₃ those of the second, all at rest, is zero for
/// every flat configuration, and `‖z‖ = 2e sin(θ/2)` when the hinge, of an edge of length e, is folded by θ without
/// stretching. The energy is `E = ½ K ‖z‖²` with `K = k·3/(A₀ + A₁)` (N/m): quadratic in the positions, so the Hessian
/// is constant and semi-definite. (Some texts print the last two entries of q as positive; then the entries do not sum
/// to zero and a translation costs energy.)
///
/// Why z: the part of the first triangle, `cot θ₁ x₀ + cot θ₀ x₁ − (cot θ₀ + cot θ₁) x₂`, is
/// `(cot θ₀ + cot θ₁)(p − x₂)`, with p the foot of the height h from `x₂` to the edge. The foot divides the edge into
/// `h cot θ₀` and `h cot θ₁`, so `(cot θ₀ + cot θ₁) h = e`: the part is a vector across the edge, from the tip to the
/// edge, of length e. So is that of the second triangle. The two are opposite where the hinge is flat, and make the
/// angle π − θ where it is folded; their sum is `2e cos((π − θ)/2) = 2e sin(θ/2)` long.
///
/// Why K: a triangle has three edges, so a third of both triangles belongs to this one, `a = (A₀ + A₁)/3` (m²).
/// `‖z‖/a`, for small folds `e θ/a`, is a curvature (1/m), and `½ k (‖z‖/a)² a = ½ K ‖z‖²` its energy over that area.
/// [`crate::energy`] has an example.
///
/// Its three rows are the coordinates of `z`. They are linear, and PBD and XPBD solve them exactly.
///
/// Limits: the rest shape is flat, whatever the mesh looks like. Out of the isometric range
/// (stretched triangles) the energy feels the stretch too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvatureHinge {
    /// Edge `x₀ x₁`, then the wing tips `x₂`, `x₃`.
    pub vertices: [u32; 4],
    /// `q` (dimensionless), sum 0.
    pub coefficients: [Real; 4],
    /// `K = k·3/(A₀ + A₁)` (N/m).
    pub stiffness: Real,
}

impl CurvatureHinge {
    /// The coefficient k (N·m) of this model that gives a sheet of equilateral triangles
    /// the cylindrical bending rigidity `rigidity` = D (N·m): `k = D/3`.
    #[must_use]
    pub fn coefficient(rigidity: Real) -> Real {
        rigidity / 3.0
    }

    /// One element on every hinge of the mesh, for a bending rigidity D (N·m).
    #[must_use]
    pub fn across(mesh: &TriMesh, hinges: &HingeTable, rigidity: Real) -> Vec<Self> {
        let k = Self::coefficient(rigidity);
        on_each_hinge(mesh, hinges, |vertices, rest| Self::new(vertices, rest, k))
    }

    /// The element with coefficient `k` (N·m) on four vertices whose rest positions (m) are `rest`. The two triangles
    /// must have an area, as those of a [`TriMesh`] have.
    #[must_use]
    pub fn new(vertices: [u32; 4], rest: &[Vec3; 4], k: Real) -> Self {
        let shape = Cotangents::of(rest);
        Self {
            vertices,
            coefficients: shape.coefficients,
            stiffness: shape.stiffness(k),
        }
    }
}

impl Element<4> for CurvatureHinge {
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Quadratic(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        for coefficient in self.coefficients {
            finite(
                "coefficient, of a triangle with an area at rest,",
                coefficient,
            )?;
        }
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<4> for CurvatureHinge {
    type Rows = [Row<4>; 3];

    const ROWS_ARE_LINEAR: bool = true;

    #[inline]
    fn rows(&self, x: &[Vec3; 4]) -> [Row<4>; 3] {
        self.as_vector_row().rows(x)
    }

    #[inline(always)]
    fn row_form(&self, _: &[Vec3; 4]) -> RowForm<4> {
        RowForm::Vector(self.as_vector_row())
    }
}

impl CurvatureHinge {
    #[inline(always)]
    fn as_vector_row(&self) -> VectorRow<4> {
        VectorRow {
            coefficients: self.coefficients,
            target: Vec3::zeros(),
            stiffness: self.stiffness,
        }
    }
}

/// The set is the single point 0: `E = ½ K ‖q x‖²` is already a squared distance to a set.
impl Projective<4, 1> for CurvatureHinge {
    const PROJECTION_IS_CONSTANT: bool = true;

    #[inline]
    fn operator(&self) -> [[Real; 4]; 1] {
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

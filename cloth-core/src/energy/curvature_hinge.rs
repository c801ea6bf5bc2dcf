//! Quadratic bending: two triangles that want to lie in one plane (CORE-6).
//!
//! M. Bergou, M. Wardetzky, D. Harmon, D. Zorin, E. Grinspun, "A quadratic bending model for inextensible surfaces",
//! SGP 2006, <https://doi.org/10.2312/SGP/SGP06/227-230>.

use crate::element::{Constraint, Convexity, Element, Projective, Row};
use crate::math::{Blocks, Mat3, Real, Vec3, gather};
use crate::mesh::TriMesh;
use crate::topology::HingeTable;

/// The isometric bending model of Bergou et al. (2006), S1 (16) with its signs corrected.
///
/// Four vertices, the edge `x₀ x₁` and the two wing tips `x₂`, `x₃`. The vector
/// `z = q₀x₀ + q₁x₁ + q₂x₂ + q₃x₃` (m), with
///
/// `q = (cot θ₁ + cot θ₃, cot θ₀ + cot θ₂, −(cot θ₀ + cot θ₁), −(cot θ₂ + cot θ₃))`,
///
/// θ₀, θ₁ the angles of the first triangle at `x₀`, `x₁`, and θ₂, θ₃ those of the second, is zero for every flat
/// configuration, and `‖z‖ = 2e sin(θ/2)` when the hinge is folded by θ without stretching. The energy
/// is `E = ½ K ‖z‖²` with `K = k·3/(A₀ + A₁)` (N/m): quadratic in the positions, so the Hessian is constant and
/// semi-definite. (The printed last two entries of S1 (16) are positive; then the entries
/// do not sum to zero and a translation costs energy.)
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
    /// the cylindrical bending rigidity `rigidity` = D (N·m): `k = D/3` (VALIDATION 4).
    #[must_use]
    pub fn coefficient(rigidity: Real) -> Real {
        rigidity / 3.0
    }

    /// One element on every hinge of the mesh, for a bending rigidity D (N·m).
    #[must_use]
    pub fn across(mesh: &TriMesh, hinges: &HingeTable, rigidity: Real) -> Vec<Self> {
        let k = Self::coefficient(rigidity);
        hinges
            .hinges()
            .iter()
            .map(|&vertices| Self::new(vertices, &gather(mesh.positions(), vertices), k))
            .collect()
    }

    /// The element with coefficient `k` (N·m) on four vertices whose rest positions (m) are `rest`. The two triangles must
    /// have an area, as those of a [`TriMesh`] have.
    #[must_use]
    pub fn new(vertices: [u32; 4], rest: &[Vec3; 4], k: Real) -> Self {
        let [x0, x1, x2, x3] = *rest;
        let edge = x1 - x0;
        let [c0, c2] = [x2, x3].map(|tip| cotangent(edge, tip - x0));
        let [c1, c3] = [x2, x3].map(|tip| cotangent(-edge, tip - x1));
        let areas = [x2, x3].map(|tip| 0.5 * edge.cross(&(tip - x0)).norm());
        Self {
            vertices,
            coefficients: [c1 + c3, c0 + c2, -(c0 + c1), -(c2 + c3)],
            stiffness: k * 3.0 / (areas[0] + areas[1]),
        }
    }

    /// `z` (m), zero when flat.
    #[inline]
    fn curvature_vector(&self, x: &[Vec3; 4]) -> Vec3 {
        // Differences to one vertex, so that coordinates far from the origin do not cancel; the
        // coefficients sum to zero.
        let q = &self.coefficients;
        (x[1] - x[0]) * q[1] + (x[2] - x[0]) * q[2] + (x[3] - x[0]) * q[3]
    }
}

/// Cotangent (dimensionless) of the angle between two vectors.
fn cotangent(a: Vec3, b: Vec3) -> Real {
    a.dot(&b) / a.cross(&b).norm()
}

impl Element<4> for CurvatureHinge {
    #[inline]
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }
}

impl Constraint<4> for CurvatureHinge {
    type Rows = [Row<4>; 3];

    const ROWS_ARE_INDEPENDENT: bool = true;

    #[inline]
    fn rows(&self, x: &[Vec3; 4]) -> [Row<4>; 3] {
        let z = self.curvature_vector(x);
        let mut rows = [Row {
            value: 0.0,
            gradient: [Vec3::zeros(); 4],
            stiffness: self.stiffness,
        }; 3];
        // Loops, because `map` and `from_fn` to arrays of this size are calls that copy.
        for axis in 0..3 {
            rows[axis].value = z[axis];
            for i in 0..4 {
                rows[axis].gradient[i][axis] = self.coefficients[i];
            }
        }
        rows
    }

    /// Zero: the rows are linear.
    #[inline]
    fn geometric_stiffness(&self, _: &[Vec3; 4], _: &[Real], _: Convexity) -> Blocks<4> {
        [[Mat3::zeros(); 4]; 4]
    }
}

/// The set is the single point 0: `E = ½ K ‖q x‖²` is already in the form of S1 (27).
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

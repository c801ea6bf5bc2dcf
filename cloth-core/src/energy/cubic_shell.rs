//! Bending that is a cubic polynomial of the positions, with a rest angle.
//!
//! A. Garg, E. Grinspun, M. Wardetzky, D. Zorin, "Cubic shells", SCA 2007, <https://doi.org/10.2312/SCA/SCA07/091-098>.

use super::cotangent::{Cotangents, curvature_vector, on_each_hinge};
use super::dihedral_hinge::angle;
use crate::cloth::Elements;
use crate::element::{Convexity, Element, Energy};
use crate::error::{OutOfRange, number};
use crate::math::{Blocks, Mat3, Real, Vec3, make_semidefinite};
use crate::mesh::TriMesh;
use crate::topology::HingeTable;

/// The energy `E = K (1 − cos(θ − θ₀))` (J), written as a polynomial.
///
/// `1 − cos(θ − θ₀) = 1 − cos θ₀ cos θ − sin θ₀ sin θ`. As long as the triangles are not stretched, the vector
/// `z = q x` (m) of [`CurvatureHinge`](super::CurvatureHinge) gives `cos θ = 1 − ‖z‖²/(2e²)`, a quadratic, and the
/// volume `V = e·(d₂ × d₃)` (m³) that the edge and the two arms `dᵢ = xᵢ − x₀` span gives `sin θ = −‖e‖ V/(4A₀A₁)`, a
/// cubic. With all lengths at rest,
///
/// `E = K (1 − cos θ₀ + cos θ₀ ‖z‖²/(2e²) + sin θ₀ ‖e‖ V/(4A₀A₁))`, `K = k·3e²/(A₀ + A₁)`.
///
/// The Hessian is linear in the positions; with θ₀ = 0 it is that of [`CurvatureHinge`](super::CurvatureHinge). The
/// sign of θ is that of [`super::DihedralHinge`].
///
/// It is no sum of squares, so there is no constraint view and no projective one.
///
/// Limits: the polynomial means `1 − cos` only for triangles that keep their shape, and needs a membrane that keeps
/// it. A curved rest shape alone is not in equilibrium: scaled by s, `dE/ds = −K (1 − cos θ₀)(3 + cos θ₀)` at s = 1,
/// a pull outwards that the membrane balances at a strain of order `D/(Y e²)`; and without bound on the stretch there
/// is no bound on E from below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicShell {
    /// Edge `x₀ x₁`, then the wing tips `x₂`, `x₃`.
    pub vertices: [u32; 4],
    /// `q` of [`CurvatureHinge`](super::CurvatureHinge) (dimensionless), sum 0.
    pub coefficients: [Real; 4],
    /// `K (1 − cos θ₀)` (J).
    pub constant: Real,
    /// `K cos θ₀/e²` (N/m), the factor of `½ ‖z‖²`.
    pub quadratic: Real,
    /// `K sin θ₀ ‖e‖/(4A₀A₁)` (J/m³), the factor of V.
    pub cubic: Real,
}

impl CubicShell {
    /// The coefficient k (N·m) that gives a sheet of equilateral triangles the cylindrical bending rigidity
    /// `rigidity` = D (N·m): `k = D/3`.
    #[must_use]
    pub fn coefficient(rigidity: Real) -> Real {
        rigidity / 3.0
    }

    /// One element on every hinge of the mesh, for a bending rigidity D (N·m). The shape of the mesh is the rest shape.
    #[must_use]
    pub fn across(mesh: &TriMesh, hinges: &HingeTable, rigidity: Real) -> Vec<Self> {
        let k = Self::coefficient(rigidity);
        on_each_hinge(mesh, hinges, |vertices, rest| Self::new(vertices, rest, k))
    }

    /// The element with coefficient `k` (N·m), at rest at `rest` (m). The two triangles must have an area.
    #[must_use]
    pub fn new(vertices: [u32; 4], rest: &[Vec3; 4], k: Real) -> Self {
        let shape = Cotangents::of(rest);
        let length = (rest[1] - rest[0]).norm();
        let (sin, cos) = angle(rest).unwrap_or(0.0).sin_cos();
        let flat = shape.stiffness(k);
        let stiffness = flat * length * length;
        let [a, b] = shape.areas;
        Self {
            vertices,
            coefficients: shape.coefficients,
            constant: stiffness * (1.0 - cos),
            quadratic: flat * cos,
            cubic: stiffness * sin * length / (4.0 * a * b),
        }
    }
}

impl Element<4> for CubicShell {
    const IS_IN_ELEMENTS: bool = true;
    const HAS_NUMERICAL_EIGENVALUES: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Cubic(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        number("constant", self.constant)?;
        number("quadratic stiffness", self.quadratic)?;
        number("cubic stiffness", self.cubic)?;
        Ok(())
    }
}

impl Energy<4> for CubicShell {
    fn value(&self, x: &[Vec3; 4]) -> Real {
        let [e, a, b] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
        let square = curvature_vector(&self.coefficients, x).norm_squared();
        self.constant + 0.5 * self.quadratic * square + self.cubic * e.dot(&a.cross(&b))
    }

    fn gradient(&self, x: &[Vec3; 4]) -> [Vec3; 4] {
        let [e, a, b] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
        let z = curvature_vector(&self.coefficients, x);
        let mut volume = [Vec3::zeros(), a.cross(&b), b.cross(&e), e.cross(&a)];
        volume[0] = -(volume[1] + volume[2] + volume[3]);
        std::array::from_fn(|i| {
            z * (self.quadratic * self.coefficients[i]) + volume[i] * self.cubic
        })
    }

    fn hessian(&self, x: &[Vec3; 4], convexity: Convexity) -> Blocks<4> {
        let arms = [x[1] - x[0], x[2] - x[0], x[3] - x[0]].map(|arm| arm.cross_matrix());
        let [e, a, b] = arms;
        let cubic = match convexity {
            Convexity::GaussNewton if self.quadratic >= 0.0 => 0.0,
            _ => self.cubic,
        };
        // ∂²V/∂e∂d₂ = −[d₃]×, and so on round; the rows and columns of x₀ make the sums zero.
        let zero = Mat3::zeros();
        let mut volume = [[zero; 4]; 4];
        for (i, j, block) in [(1, 2, -b), (1, 3, a), (2, 3, -e)] {
            volume[i][j] = block;
            volume[j][i] = block.transpose();
        }
        for i in 1..4 {
            volume[i][0] = -(volume[i][1] + volume[i][2] + volume[i][3]);
            volume[0][i] = volume[i][0].transpose();
        }
        // volume[0][0] is minus the sum of skew blocks that cancel in pairs: zero.
        let mut sum = [[zero; 4]; 4];
        for i in 0..4 {
            for j in 0..4 {
                let q = self.quadratic * self.coefficients[i] * self.coefficients[j];
                sum[i][j] = Mat3::identity() * q + volume[i][j] * cubic;
            }
        }
        // What is convex by its form needs no eigenvalues, as the square of the curvature vector, which is what has a
        // Gauss–Newton matrix.
        if cubic == 0.0 && self.quadratic >= 0.0 {
            return sum;
        }
        make_semidefinite(&sum, convexity)
    }
}

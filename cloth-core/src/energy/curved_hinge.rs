//! The cotangent form with a curved rest shape: what projective dynamics bends by.
//!
//! S. Bouaziz, S. Martin, T. Liu, L. Kavan, M. Pauly, "Projective dynamics: fusing constraint projections for fast
//! simulation", ACM Trans. Graph. 33 (2014), <https://doi.org/10.1145/2601097.2601116>: the bending constraint of its
//! section 5, which keeps the length of the cotangent Laplacian at a vertex. Here z of one hinge takes its place.

use super::CurvatureHinge;
use super::cotangent::{Cotangents, curvature_vector, on_each_hinge};
use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, Element, Projective, Row};
use crate::error::{OutOfRange, finite, number};
use crate::math::{Blocks, Mat3, Real, Vec3, length_and_direction};
use crate::mesh::TriMesh;
use crate::topology::HingeTable;

/// The hinge whose curvature vector `z = q x` (m) wants the length r that it has at rest: `C = ‖z‖ − r`, `E = ½ K C²`
/// (J).
///
/// `q` and `K` are those of [`CurvatureHinge`], which is the case r = 0 (a rest shape that is flat up to rounding
/// counts as such). Folded by θ without stretching, `‖z‖ = 2e |sin(θ/2)|`, so
///
/// `E = ½ K 4e² (|sin(θ/2)| − |sin(θ₀/2)|)²`.
///
/// It is a spring between `z` and the origin, and has all views of one. The set of the projective view is the sphere
/// of radius r: the rest vector turned with the cloth, `p = r z/‖z‖`.
///
/// Limits: a fold to either side is at rest, θ₀ as well as −θ₀; between them, at flat, E has a point where the
/// direction of the force is not defined ([`length_and_direction`] says which it gets). Near rest the stiffness is that
/// of a flat hinge times `cos²(θ₀/2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvedHinge {
    /// Edge `x₀ x₁`, then the wing tips `x₂`, `x₃`.
    pub vertices: [u32; 4],
    /// `q` (dimensionless), sum 0.
    pub coefficients: [Real; 4],
    /// r (m).
    pub rest_curvature: Real,
    /// K (N/m).
    pub stiffness: Real,
}

impl CurvedHinge {
    /// One element on every hinge of the mesh, for a bending rigidity D (N·m). The shape of the mesh is the rest shape.
    #[must_use]
    pub fn across(mesh: &TriMesh, hinges: &HingeTable, rigidity: Real) -> Vec<Self> {
        let k = CurvatureHinge::coefficient(rigidity);
        on_each_hinge(mesh, hinges, |vertices, rest| Self::new(vertices, rest, k))
    }

    /// The element with coefficient `k` (N·m) of [`CurvatureHinge`], at rest at `rest` (m). The two triangles must have
    /// an area.
    #[must_use]
    pub fn new(vertices: [u32; 4], rest: &[Vec3; 4], k: Real) -> Self {
        let shape = Cotangents::of(rest);
        let curvature = curvature_vector(&shape.coefficients, rest).norm();
        // What the rounding of the coordinates makes of a flat hinge is no curvature: E would be a cone of that size.
        let size = rest.iter().map(Vec3::amax).fold(0.0, Real::max);
        let coefficients: Real = shape.coefficients.iter().map(|q| q.abs()).sum();
        let is_flat = curvature <= 4.0 * Real::EPSILON * coefficients * size;
        Self {
            vertices,
            coefficients: shape.coefficients,
            rest_curvature: if is_flat { 0.0 } else { curvature },
            stiffness: shape.stiffness(k),
        }
    }

    /// `‖z‖` (m) and the direction of z.
    fn length_and_direction(&self, z: Vec3) -> (Real, Vec3) {
        length_and_direction(z, [self.vertices[0], self.vertices[1]])
    }
}

impl Element<4> for CurvedHinge {
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Curved(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        finite("rest curvature r (m)", self.rest_curvature)?;
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<4> for CurvedHinge {
    type Rows = [Row<4>; 1];

    #[inline]
    fn rows(&self, x: &[Vec3; 4]) -> [Row<4>; 1] {
        let (length, n) = self.length_and_direction(curvature_vector(&self.coefficients, x));
        [Row {
            value: length - self.rest_curvature,
            gradient: self.coefficients.map(|q| n * q),
            stiffness: self.stiffness,
        }]
    }

    /// `K (1 − r/‖z‖)(I − n nᵀ) qᵢqⱼ`: negative where the hinge is flatter than at rest.
    fn curvature(&self, x: &[Vec3; 4], convexity: Convexity) -> Blocks<4> {
        let (length, n) = self.length_and_direction(curvature_vector(&self.coefficients, x));
        let excess = if self.rest_curvature == 0.0 {
            1.0 // E = ½ K ‖z‖² is smooth everywhere
        } else if length > 0.0 {
            1.0 - self.rest_curvature / length
        } else {
            0.0 // no second derivative exists; the rank-one part stands alone
        };
        let factor = convexity.applied_to(excess);
        let across = (Mat3::identity() - n * n.transpose()) * (self.stiffness * factor);
        self.coefficients
            .map(|a| self.coefficients.map(|b| across * (a * b)))
    }
}

impl Projective<4, 1> for CurvedHinge {
    #[inline]
    fn operator(&self) -> [[Real; 4]; 1] {
        [self.coefficients]
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, [z]: [Vec3; 1]) -> [Vec3; 1] {
        [self.length_and_direction(z).1 * self.rest_curvature]
    }

    /// As of a spring.
    #[inline]
    fn projected_hessian(&self, [z]: [Vec3; 1]) -> [[Mat3; 1]; 1] {
        let (length, n) = self.length_and_direction(z);
        [[crate::math::projected_radial_hessian(
            length,
            n,
            self.rest_curvature,
        )]]
    }
}

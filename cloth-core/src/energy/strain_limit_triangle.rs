//! A triangle that is slack while its principal stretches stay within a range: strain limiting of a sheet.
//!
//! H. Wang, J. O'Brien, R. Ramamoorthi, "Multi-resolution isotropic strain limiting", ACM Trans. Graph. 29 (2010),
//! <https://doi.org/10.1145/1882261.1866182>; as a projection, S. Bouaziz et al., "Projective dynamics", 2014,
//! <https://doi.org/10.1145/2601097.2601116>, section 5.1.

use super::arap_triangle::Singular;
use super::triangle_map::TriangleMap;
use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, DeadZoneRow, Element, Projective, Row};
use crate::error::{OutOfRange, number};
use crate::math::{Blocks, Mat3, Real, Vec3, absolute_up_to_one, gather};
use crate::mesh::TriMesh;

/// Costs nothing while the singular values σ of F (3 × 2, rest to present) are between σ_min and σ_max: two rows
/// `C = σ − clamp(σ)` (dimensionless), `E = ½ A k Σ C²` (J).
///
/// With both limits 1 it is an [`ArapTriangle`](super::ArapTriangle). It limits the strain in all directions alike, not
/// only along edges, so it does not depend on how the sheet is meshed.
///
/// Limits: a soft limit, of membrane modulus k outside. The stiffness jumps at the limits, where the one of the inside
/// is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainLimitTriangle {
    /// Its three corners.
    pub vertices: [u32; 3],
    map: TriangleMap,
    limits: [Real; 2],
    /// `A k` (J).
    stiffness: Real,
}

impl StrainLimitTriangle {
    /// One element on every triangle of the mesh, with limits `[σ_min, σ_max]` (dimensionless) and a membrane modulus
    /// (N/m) outside.
    ///
    /// # Panics
    /// If `0 ≤ σ_min ≤ σ_max` does not hold.
    #[must_use]
    pub fn on(mesh: &TriMesh, limits: [Real; 2], modulus: Real) -> Vec<Self> {
        let triangles = mesh.triangles().iter();
        triangles
            .map(|&v| Self::new(v, &gather(mesh.positions(), v), limits, modulus))
            .collect()
    }

    /// The element at rest at `rest` (m), which must have an area, for limits `[σ_min, σ_max]` (dimensionless) and a
    /// membrane modulus (N/m).
    ///
    /// # Panics
    /// If `0 ≤ σ_min ≤ σ_max` does not hold.
    #[must_use]
    pub fn new(vertices: [u32; 3], rest: &[Vec3; 3], limits: [Real; 2], modulus: Real) -> Self {
        super::check_limits(limits);
        let map = TriangleMap::new(rest);
        Self {
            vertices,
            limits,
            stiffness: map.area * modulus,
            map,
        }
    }

    /// The same element without slack: stiff at every stretch.
    #[must_use]
    pub fn taut(self) -> Self {
        let limits = [1.0; 2];
        Self { limits, ..self }
    }

    /// φ is σ.
    fn stretches(&self, x: &[Vec3; 3]) -> [DeadZoneRow<3>; 2] {
        let singular = Singular::of(self.map.columns(x));
        [[1.0, 0.0], [0.0, 1.0]].map(|choice| DeadZoneRow {
            value: singular.values[0] * choice[0] + singular.values[1] * choice[1],
            gradient: self.map.back(singular.combine(singular.left, choice)),
            range: self.limits,
            stiffness: self.stiffness,
        })
    }

    fn nearest(&self, stretch: Real) -> Real {
        stretch.min(self.limits[1]).max(self.limits[0])
    }

    /// The four modes of F in which its singular vectors turn, as left vectors, a scale and the second derivative of
    /// `½ Σ C²` along each: twist and flip in the plane, and each of the two out of it, with u₃ the normal. They are
    /// those of an [`ArapTriangle`](super::ArapTriangle), whose C is `σ − 1`.
    fn turns(&self, singular: &Singular) -> [(Real, [Vec3; 2], Real); 4] {
        let [u, v] = singular.left;
        let (w, zero) = (u.cross(&v), Vec3::zeros());
        let stretches = singular.values;
        let [first, second] = stretches;
        let excess = stretches.map(|stretch| stretch - self.nearest(stretch));
        let quotient = |over: Real, by: Real| {
            let quotient = over / by;
            if quotient.is_finite() { quotient } else { 0.0 }
        };
        let shear = if first - second > 1e-8 * first {
            (excess[0] - excess[1]) / (first - second)
        } else {
            Real::from(u8::from(excess[0] != 0.0)) // the derivative of C
        };
        let half = std::f64::consts::FRAC_1_SQRT_2;
        [
            (
                quotient(excess[0] + excess[1], first + second),
                [-v, u],
                half,
            ),
            (shear, [v, u], half),
            (quotient(excess[0], first), [w, zero], 1.0),
            (quotient(excess[1], second), [zero, w], 1.0),
        ]
    }
}

impl Element<3> for StrainLimitTriangle {
    const HAS_JUMPS: bool = true;
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 3] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::LimitedTriangles(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<3> for StrainLimitTriangle {
    type Rows = [Row<3>; 2];

    /// The gradient of a row vanishes with its C between the limits.
    fn rows(&self, x: &[Vec3; 3]) -> [Row<3>; 2] {
        self.stretches(x).map(|row| row.row())
    }

    /// Solved one after another they are solved together: at each vertex the gradients of the two are at right angles.
    fn dead_zone_rows(&self, x: &[Vec3; 3]) -> Option<[DeadZoneRow<3>; 2]> {
        Some(self.stretches(x))
    }

    fn curvature(&self, x: &[Vec3; 3], convexity: Convexity) -> Blocks<3> {
        let singular = Singular::of(self.map.columns(x));
        let mut sum = [[Mat3::zeros(); 3]; 3];
        for (value, left, scale) in self.turns(&singular) {
            let factor = convexity.applied_to(value);
            let mode = self.map.back(singular.combine(left, [scale; 2]));
            for i in 0..3 {
                for j in 0..3 {
                    sum[i][j] += mode[i] * mode[j].transpose() * (self.stiffness * factor);
                }
            }
        }
        sum
    }
}

/// The set is that of all maps with singular values between the limits; its nearest point to F has them clamped.
impl Projective<3, 2> for StrainLimitTriangle {
    #[inline]
    fn operator(&self) -> [[Real; 3]; 2] {
        std::array::from_fn(|column| self.map.gradients.map(|b| b[column]))
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    fn project(&self, z: [Vec3; 2]) -> [Vec3; 2] {
        let singular = Singular::of(z);
        let nearest = singular.values.map(|stretch| self.nearest(stretch));
        if nearest == singular.values {
            return z; // to the last bit
        }
        singular.combine(singular.left, nearest)
    }

    fn projected_hessian(&self, z: [Vec3; 2]) -> [[Mat3; 2]; 2] {
        let singular = Singular::of(z);
        let along = [0, 1].map(|index| {
            let stretch = singular.values[index];
            let mut choice = [0.0; 2];
            choice[index] = 1.0;
            let is_free = stretch == self.nearest(stretch) && self.limits[0] < self.limits[1];
            let value = if is_free { 0.0 } else { 1.0 };
            (value, singular.combine(singular.left, choice))
        });
        let turning = self.turns(&singular).map(|(value, left, scale)| {
            (
                absolute_up_to_one(value),
                singular.combine(left, [scale; 2]),
            )
        });
        let mut sum = [[Mat3::zeros(); 2]; 2];
        for (value, mode) in along.into_iter().chain(turning) {
            for k in 0..2 {
                for l in 0..2 {
                    sum[k][l] += mode[k] * mode[l].transpose() * value;
                }
            }
        }
        sum
    }
}

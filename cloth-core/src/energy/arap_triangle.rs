//! The corotated sheet: as rigid as possible, triangle by triangle.
//!
//! O. Sorkine, M. Alexa, "As-rigid-as-possible surface modeling", SGP 2007,
//! <https://doi.org/10.2312/SGP/SGP07/109-116>; as a projection, S. Bouaziz et al., "Projective dynamics", 2014,
//! <https://doi.org/10.1145/2601097.2601116>, section 5.1. Eigenvalues of its Hessian: B. Smith, F. de Goes, T. Kim,
//! "Analytic eigensystems for isotropic distortion energies", ACM Trans. Graph. 38(1), 2019,
//! <https://doi.org/10.1145/3241041>.

use super::triangle_map::TriangleMap;
use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, Element, Projective, Row};
use crate::error::{OutOfRange, number};
use crate::math::{Blocks, Mat3, Real, Vec3, absolute_up_to_one, gather};
use crate::mesh::TriMesh;

/// A triangle that wants to be turned only: `E = ½ A k ‖F − R‖²` (J), R (3 × 2) the nearest map without strain.
///
/// With the singular values σ of F (3 × 2, rest to present), `E = ½ A k ((σ₁ − 1)² + (σ₂ − 1)²)`, and the two rows are
/// `C = σ − 1` (dimensionless). Small strains ε cost `½ k (ε₁² + ε₂²)` per area, so the sheet has modulus `Y = k` and
/// Poisson's ratio ν = 0, in any direction: pulled to s times its length it answers with `P = Y (s − 1)` (N/m) and
/// keeps its width.
///
/// # Hessian
///
/// Let `F = U Σ Vᵀ`, R the nearest map without strain, and S symmetric with `F = R S` (so S has the eigenvalues σ and
/// the eigenvectors v). Along a displacement δF the gradient `A k (F − R)` changes by `A k (δF − δR)`, so what is
/// needed is δR. As R keeps its columns orthonormal, `Ω = RᵀδR` is antisymmetric. From `δF = δR S + R δS`:
///
/// - *In the plane*, `RᵀδF = Ω S + δS`. The symmetric δS drops out of the antisymmetric part: with `G = Vᵀ(RᵀδF)V` it
///   is `Gᵢⱼ − Gⱼᵢ = Ωᵢⱼ (σᵢ + σⱼ)`, Ω in the same axes. A symmetric G has no δR, so its eigenvalue is 1. The
///   antisymmetric one has `Ω = G · 2/(σᵢ + σⱼ)`, so its eigenvalue is `1 − 2/(σᵢ + σⱼ)`.
/// - *Out of the plane*, with the normal u₃ and `u₃ᵀR = 0`, it is `u₃ᵀδF = u₃ᵀδR S`. Along vₖ that is `u₃ᵀδR vₖ =
///   u₃ᵀδF vₖ/σₖ`, so the eigenvalue is `1 − 1/σₖ`.
///
/// These modes of δF are orthonormal and diagonalise the Hessian by F. The modes `uₖvₖᵀ`, of eigenvalue 1, are those of
/// the rows (`Σ ∂C ∂Cᵀ`); [`Constraint::curvature`] has the others. Below rest (σ < 1) those that turn are negative: a
/// triangle that is pressed can give way by turning.
///
/// Limits: ν = 0 only. Where a singular value is zero its direction is not defined (any is taken that is at right
/// angles to the other), and what has no second derivative there is left out of the Hessian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArapTriangle {
    /// Its three corners.
    pub vertices: [u32; 3],
    map: TriangleMap,
    /// `A k` (J).
    stiffness: Real,
}

impl ArapTriangle {
    /// One element on every triangle of the mesh, for a membrane modulus Y (N/m).
    #[must_use]
    pub fn on(mesh: &TriMesh, modulus: Real) -> Vec<Self> {
        let triangles = mesh.triangles().iter();
        triangles
            .map(|&v| Self::new(v, &gather(mesh.positions(), v), modulus))
            .collect()
    }

    /// The element at rest at `rest` (m), which must have an area, for Y (N/m).
    #[must_use]
    pub fn new(vertices: [u32; 3], rest: &[Vec3; 3], modulus: Real) -> Self {
        let map = TriangleMap::new(rest);
        Self {
            vertices,
            stiffness: map.area * modulus,
            map,
        }
    }
}

/// `F = σ₁ u₁ v₁ᵀ + σ₂ u₂ v₂ᵀ`, σ₁ ≥ σ₂ ≥ 0.
pub(super) struct Singular {
    pub(super) values: [Real; 2],
    pub(super) left: [Vec3; 2],
    right: [[Real; 2]; 2],
}

impl Singular {
    pub(super) fn of([f, g]: [Vec3; 2]) -> Self {
        // FᵀF is diagonal in axes turned by this angle.
        let angle = 0.5 * (2.0 * f.dot(&g)).atan2(f.norm_squared() - g.norm_squared());
        let (s, c) = angle.sin_cos();
        let (long, short) = (f * c + g * s, g * c - f * s);
        let first = direction(long).unwrap_or_else(Vec3::x);
        // At right angles also where rounding or collapse leaves nothing of the second.
        let rest = short - first * first.dot(&short);
        let second = direction(rest).unwrap_or_else(|| {
            let axis = Vec3::ith(first.iamin(), 1.0);
            (axis - first * first.dot(&axis)).normalize()
        });
        Self {
            values: [long.norm(), rest.norm()],
            left: [first, second],
            right: [[c, s], [-s, c]],
        }
    }

    /// The two columns of `Σ weightₖ uₖ vₖᵀ` for left vectors `u`.
    pub(super) fn combine(&self, u: [Vec3; 2], weights: [Real; 2]) -> [Vec3; 2] {
        std::array::from_fn(|column| {
            u[0] * (weights[0] * self.right[0][column])
                + u[1] * (weights[1] * self.right[1][column])
        })
    }
}

fn direction(d: Vec3) -> Option<Vec3> {
    let squared = d.norm_squared();
    (squared > 1e-280).then(|| d / squared.sqrt())
}

impl Element<3> for ArapTriangle {
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 3] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Arap(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<3> for ArapTriangle {
    type Rows = [Row<3>; 2];

    #[inline]
    fn rows(&self, x: &[Vec3; 3]) -> [Row<3>; 2] {
        let singular = Singular::of(self.map.columns(x));
        [[1.0, 0.0], [0.0, 1.0]].map(|choice| Row {
            value: singular.values[0] * choice[0] + singular.values[1] * choice[1] - 1.0,
            gradient: self.map.back(singular.combine(singular.left, choice)),
            stiffness: self.stiffness,
        })
    }

    /// Four orthonormal modes of F, with u₃ the normal: the twist `(u₁v₂ᵀ − u₂v₁ᵀ)/√2` with `1 − 2/(σ₁ + σ₂)`, the flip
    /// `(u₁v₂ᵀ + u₂v₁ᵀ)/√2` with 1 (both after Smith et al. 2019), and, out of the plane, `u₃vₖᵀ` with `1 − 1/σₖ`, all
    /// times `A k` (derived at [`ArapTriangle`](ArapTriangle#hessian)). They are its eigenvalues, so `convexity` acts
    /// on them one by one.
    fn curvature(&self, x: &[Vec3; 3], convexity: Convexity) -> Blocks<3> {
        let singular = Singular::of(self.map.columns(x));
        let [u, v] = singular.left;
        let (w, zero) = (u.cross(&v), Vec3::zeros());
        let [first, second] = singular.values;
        let less = |inverse: Real| {
            if inverse.is_finite() {
                1.0 - inverse
            } else {
                0.0
            }
        };
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let modes = [
            (less(2.0 / (first + second)), [-v, u], half),
            (1.0, [v, u], half),
            (less(1.0 / first), [w, zero], 1.0),
            (less(1.0 / second), [zero, w], 1.0),
        ];
        let mut sum = [[Mat3::zeros(); 3]; 3];
        for (value, left, scale) in modes {
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

/// The set is that of all maps without strain; its nearest point to F is `R = u₁v₁ᵀ + u₂v₂ᵀ`.
impl Projective<3, 2> for ArapTriangle {
    #[inline]
    fn operator(&self) -> [[Real; 3]; 2] {
        std::array::from_fn(|column| self.map.gradients.map(|b| b[column]))
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, z: [Vec3; 2]) -> [Vec3; 2] {
        let singular = Singular::of(z);
        singular.combine(singular.left, [1.0; 2])
    }

    /// The identity less what the three modes of [`Constraint::curvature`] that turn F take away from it.
    fn projected_hessian(&self, z: [Vec3; 2]) -> [[Mat3; 2]; 2] {
        let singular = Singular::of(z);
        let [u, v] = singular.left;
        let (w, zero) = (u.cross(&v), Vec3::zeros());
        let [first, second] = singular.values;
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let modes = [
            (2.0 / (first + second), [-v, u], half),
            (1.0 / first, [w, zero], 1.0),
            (1.0 / second, [zero, w], 1.0),
        ];
        let mut sum = [
            [Mat3::identity(), Mat3::zeros()],
            [Mat3::zeros(), Mat3::identity()],
        ];
        for (loss, left, scale) in modes {
            let mode = singular.combine(left, [scale; 2]);
            let taken = 1.0 - absolute_up_to_one(1.0 - loss);
            for k in 0..2 {
                for l in 0..2 {
                    sum[k][l] -= mode[k] * mode[l].transpose() * taken;
                }
            }
        }
        sum
    }
}

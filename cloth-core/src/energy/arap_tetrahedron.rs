//! The corotated solid: as rigid as possible, tetrahedron by tetrahedron.
//!
//! I. Chao, U. Pinkall, P. Sanan, P. Schröder, "A simple geometric model for elastic deformations", 2010,
//! <https://doi.org/10.1145/1778765.1778775>; its Hessian, B. Smith, F. de Goes, T. Kim, "Analytic eigensystems for
//! isotropic distortion energies", 2019, <https://doi.org/10.1145/3241041>.

use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, Element, Projective, Row};
use crate::error::{OutOfRange, number};
use crate::math::{Blocks, Mat3, Real, Vec3, absolute_up_to_one};
use std::f64::consts::FRAC_1_SQRT_2;

/// A tetrahedron that wants to be turned only: `E = μ V ‖F − R‖²` (J), R the rotation nearest to F.
///
/// With the singular values σ of F (3 × 3, rest to present), the smallest of them negative where F turns the
/// tetrahedron inside out, `E = μ V Σ (σ − 1)²`, and the three rows are `C = σ − 1` (dimensionless). Small strains ε
/// cost `μ ε:ε` per volume: a solid of shear modulus μ, Young's modulus 2μ and Poisson's ratio ν = 0, in any direction.
/// Beside a [`VolumeTetrahedron`](super::VolumeTetrahedron) of modulus λ it is the *fixed corotated* solid with the
/// Lamé parameters μ and λ (A. Stomakhin et al., "Energetically consistent invertible elasticity", SCA 2012).
///
/// Limits: where two singular values sum to zero their rotation is not defined, and what has no second derivative there
/// is left out of the Hessian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArapTetrahedron {
    /// Its four corners.
    pub vertices: [u32; 4],
    /// `bᵢ` (1/m), with `F = Σ xᵢ bᵢᵀ`; they sum to zero.
    gradients: [Vec3; 4],
    /// `2 μ V` (J).
    stiffness: Real,
}

impl ArapTetrahedron {
    /// The element at rest at `rest` (m), which must have a volume, for a shear modulus μ (Pa).
    #[must_use]
    pub fn new(vertices: [u32; 4], rest: &[Vec3; 4], shear_modulus: Real) -> Self {
        let [a, b, c] = [rest[1] - rest[0], rest[2] - rest[0], rest[3] - rest[0]];
        let six_volumes = a.dot(&b.cross(&c));
        // The rows of the inverse of the matrix with the columns a, b, c.
        let [p, q, r] = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|row| row / six_volumes);
        Self {
            vertices,
            gradients: [-(p + q + r), p, q, r],
            stiffness: 2.0 * shear_modulus * six_volumes.abs() / 6.0,
        }
    }

    /// F, by differences to one vertex.
    #[inline]
    fn map(&self, x: &[Vec3; 4]) -> Mat3 {
        let [_, p, q, r] = &self.gradients;
        (x[1] - x[0]) * p.transpose()
            + (x[2] - x[0]) * q.transpose()
            + (x[3] - x[0]) * r.transpose()
    }

    /// From a derivative by F to one by the corners.
    #[inline]
    fn back(&self, by_map: Mat3) -> [Vec3; 4] {
        self.gradients.map(|b| by_map * b)
    }
}

/// Two of three axes each.
const PAIRS: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];

/// Two columns are at right angles when their product is this part of their lengths.
const ORTHOGONAL: Real = 1e-16;

/// Rounds of rotations: they converge quadratically, and some four are enough.
const MOST_ROUNDS: usize = 12;

/// `F = Σ σₖ uₖ vₖᵀ`, with `σ₁ ≥ σ₂ ≥ |σ₃|`, and rotations u and v.
struct Singular {
    values: [Real; 3],
    left: [Vec3; 3],
    right: [Vec3; 3],
}

impl Singular {
    /// By rotations of pairs of columns until all are at right angles (Hestenes).
    fn of(map: &Mat3) -> Self {
        let mut columns: [Vec3; 3] = [0, 1, 2].map(|k| map.column(k).into());
        let mut right = [Vec3::x(), Vec3::y(), Vec3::z()];
        for _ in 0..MOST_ROUNDS {
            let mut is_done = true;
            for [p, q] in PAIRS {
                let (long, short) = (columns[p].norm_squared(), columns[q].norm_squared());
                let product = columns[p].dot(&columns[q]);
                if product.abs() > ORTHOGONAL * (long * short).sqrt() || short > long {
                    let (s, c) = (0.5 * (2.0 * product).atan2(long - short)).sin_cos();
                    for pair in [&mut columns, &mut right] {
                        (pair[p], pair[q]) = (pair[p] * c + pair[q] * s, pair[q] * c - pair[p] * s);
                    }
                    is_done = false;
                }
            }
            if is_done {
                break;
            }
        }
        let first = direction(columns[0]).unwrap_or_else(Vec3::x);
        // At right angles also where rounding or collapse leaves nothing of the others.
        let rest = columns[1] - first * first.dot(&columns[1]);
        let second = direction(rest).unwrap_or_else(|| {
            let axis = Vec3::ith(first.iamin(), 1.0);
            (axis - first * first.dot(&axis)).normalize()
        });
        let third = first.cross(&second);
        Self {
            values: [columns[0].norm(), rest.norm(), third.dot(&columns[2])],
            left: [first, second, third],
            right,
        }
    }

    /// R.
    fn rotation(&self) -> Mat3 {
        let both = self.left.iter().zip(&self.right);
        both.map(|(u, v)| u * v.transpose()).sum()
    }

    /// `(uᵢ vⱼᵀ + sign uⱼ vᵢᵀ)/√2`.
    fn mode(&self, [i, j]: [usize; 2], sign: Real) -> Mat3 {
        let (u, v) = (&self.left, &self.right);
        (u[i] * v[j].transpose() + u[j] * v[i].transpose() * sign) * FRAC_1_SQRT_2
    }
}

fn direction(d: Vec3) -> Option<Vec3> {
    let squared = d.norm_squared();
    (squared > 1e-280).then(|| d / squared.sqrt())
}

impl Element<4> for ArapTetrahedron {
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::ArapTetrahedra(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<4> for ArapTetrahedron {
    type Rows = [Row<4>; 3];

    #[inline]
    fn rows(&self, x: &[Vec3; 4]) -> [Row<4>; 3] {
        let singular = Singular::of(&self.map(x));
        [0, 1, 2].map(|k| Row {
            value: singular.values[k] - 1.0,
            gradient: self.back(singular.left[k] * singular.right[k].transpose()),
            stiffness: self.stiffness,
        })
    }

    /// Six orthonormal modes of F, for each pair of axes: `(uᵢvⱼᵀ − uⱼvᵢᵀ)/√2` with `1 − 2/(σᵢ + σⱼ)`, and
    /// `(uᵢvⱼᵀ + uⱼvᵢᵀ)/√2` with 1, all times `2 μ V`. The derivation is that of the modes in the plane of an
    /// [`ArapTriangle`](super::ArapTriangle#hessian), for each pair of axes. They are its eigenvalues, so `convexity`
    /// acts on them one by one.
    fn curvature(&self, x: &[Vec3; 4], convexity: Convexity) -> Blocks<4> {
        let singular = Singular::of(&self.map(x));
        let mut sum = [[Mat3::zeros(); 4]; 4];
        for [i, j] in PAIRS {
            let loss = 2.0 / (singular.values[i] + singular.values[j]);
            let turned = if loss.is_finite() { 1.0 - loss } else { 0.0 };
            for (value, sign) in [(turned, -1.0), (1.0, 1.0)] {
                let factor = self.stiffness * convexity.applied_to(value);
                let mode = self.back(singular.mode([i, j], sign));
                for a in 0..4 {
                    for b in 0..4 {
                        sum[a][b] += mode[a] * mode[b].transpose() * factor;
                    }
                }
            }
        }
        sum
    }
}

/// The set is that of all rotations; `S x` are the columns of F.
impl Projective<4, 3> for ArapTetrahedron {
    #[inline]
    fn operator(&self) -> [[Real; 4]; 3] {
        std::array::from_fn(|column| self.gradients.map(|b| b[column]))
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, z: [Vec3; 3]) -> [Vec3; 3] {
        let rotation = Singular::of(&Mat3::from_columns(&z)).rotation();
        [0, 1, 2].map(|k| rotation.column(k).into())
    }

    /// The identity less what the three modes of [`Constraint::curvature`] that turn F take away from it.
    fn projected_hessian(&self, z: [Vec3; 3]) -> [[Mat3; 3]; 3] {
        let singular = Singular::of(&Mat3::from_columns(&z));
        let mut sum = [[Mat3::zeros(); 3]; 3];
        for (k, row) in sum.iter_mut().enumerate() {
            row[k] = Mat3::identity();
        }
        for [i, j] in PAIRS {
            let loss = 2.0 / (singular.values[i] + singular.values[j]);
            let mode = singular.mode([i, j], -1.0);
            let taken = 1.0 - absolute_up_to_one(1.0 - loss);
            for k in 0..3 {
                for l in 0..3 {
                    sum[k][l] -= mode.column(k) * mode.column(l).transpose() * taken;
                }
            }
        }
        sum
    }
}

//! The only place where the scalar and the small-vector types are chosen.

use crate::element::Convexity;
use std::f64::consts::FRAC_1_SQRT_2;

/// In the version whose vectors and matrices are those here.
pub use nalgebra;

/// The scalar of the whole workspace.
pub type Real = f64;

/// A point, a direction or a force: three scalars, in the unit that the item using it states.
pub type Vec3 = nalgebra::Vector3<Real>;

/// A 3 × 3 matrix, for instance one block of a Hessian (N/m).
pub type Mat3 = nalgebra::Matrix3<Real>;

/// `N × N` table of 3 × 3 blocks: the Hessian (N/m) of one `N`-vertex element.
pub type Blocks<const N: usize> = [[Mat3; N]; N];

/// Squared lengths (m²) below this are treated as zero, because their square root and quotient
/// would no longer be accurate.
const ZERO_LENGTH_SQUARED: Real = 1e-280;

/// Whether all three coordinates are finite numbers.
#[inline]
#[must_use]
pub fn is_finite(v: &Vec3) -> bool {
    v.x.is_finite() && v.y.is_finite() && v.z.is_finite()
}

/// The vertices of one element, copied out of the array of all vertices.
///
/// # Panics
/// If an index is not smaller than `x.len()`.
#[inline(always)]
#[must_use]
pub fn gather<const N: usize>(x: &[Vec3], vertices: [u32; N]) -> [Vec3; N] {
    // A loop, because `map` is a call where it is not inlined.
    let mut local = [Vec3::zeros(); N];
    for i in 0..N {
        local[i] = x[vertices[i] as usize];
    }
    local
}

/// Length (m) and direction (dimensionless, unit length) of the difference `d` (m) of the two
/// vertices `pair`.
///
/// Where the two vertices coincide the length has no gradient. Any unit vector is then a limit of
/// nearby gradients; we return one that depends on the vertex numbers only. It makes a collapsed cloth
/// unfold in all directions instead of staying a point, gives opposite forces to the two
/// vertices, and repeats from run to run.
#[inline(always)]
#[must_use]
pub fn length_and_direction(d: Vec3, pair: [u32; 2]) -> (Real, Vec3) {
    let squared = d.norm_squared();
    if squared > ZERO_LENGTH_SQUARED {
        let length = squared.sqrt();
        (length, d / length)
    } else {
        (0.0, arbitrary_direction(pair))
    }
}

/// What stands for an eigenvalue of `I − ∂p/∂z` (dimensionless, at most 1) in a positive semi-definite matrix: its
/// absolute value, as by [`Convexity::Abs`], and no more than 1, which bounds all others.
#[inline(always)]
#[must_use]
pub fn absolute_up_to_one(eigenvalue: Real) -> Real {
    eigenvalue.abs().min(1.0)
}

/// Second derivative (dimensionless) of `½ (l − rest)²` by a vector of `length` l (m) and direction `n`, with
/// eigenvalues by [`absolute_up_to_one`]: `n nᵀ + min(|1 − rest/l|, 1)(I − n nᵀ)`.
#[inline]
#[must_use]
pub fn projected_radial_hessian(length: Real, n: Vec3, rest: Real) -> Mat3 {
    let across = match length {
        _ if rest == 0.0 => 1.0, // ½ l² is smooth, also at 0
        _ => absolute_up_to_one(1.0 - rest / length),
    };
    let along = n * n.transpose();
    along * (1.0 - across) + Mat3::from_diagonal_element(across)
}

/// The Hessian of two vertices that resist being moved apart across n only, by `stiffness` (N/m):
/// `± stiffness (I − n nᵀ)`.
#[inline(always)]
pub(crate) fn across_pair(n: Vec3, stiffness: Real) -> Blocks<2> {
    let block = (Mat3::identity() - n * n.transpose()) * stiffness;
    [[block, -block], [-block, block]]
}

/// [`across_pair`] times p.
#[inline]
pub(crate) fn across_pair_product(n: Vec3, stiffness: Real, p: &[Vec3; 2]) -> [Vec3; 2] {
    let d = p[0] - p[1];
    let force = (d - n * n.dot(&d)) * stiffness;
    [force, -force]
}

/// A unit vector that depends on the two numbers only, spread evenly over the sphere.
#[cold]
fn arbitrary_direction(pair: [u32; 2]) -> Vec3 {
    // Two rounds of a 64-bit multiplicative hash; the upper and the lower half give a point of the
    // unit square, which Archimedes' map takes to the sphere without crowding the poles.
    let mut bits = (u64::from(pair[0]) << 32) | u64::from(pair[1]);
    for _ in 0..2 {
        bits = (bits ^ (bits >> 32)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
    let unit = |half: u64| (half as u32 as Real + 0.5) / (u32::MAX as Real + 1.0);
    let height = 2.0 * unit(bits >> 32) - 1.0;
    let angle = std::f64::consts::TAU * unit(bits);
    let radius = (1.0 - height * height).sqrt();
    Vec3::new(radius * angle.cos(), radius * angle.sin(), height)
}

/// A symmetric Hessian of four vertices (N/m) with its negative eigenvalues treated as `convexity` says; clamped under
/// [`Convexity::GaussNewton`]. For elements whose eigenvalues have no closed form, and whose energy no translation
/// changes: its eigenvectors are those of nine combinations of the vertices, in which it is written. On the stack.
#[must_use]
pub fn make_semidefinite(blocks: &Blocks<4>, convexity: Convexity) -> Blocks<4> {
    if convexity == Convexity::Exact {
        return *blocks;
    }
    let columns: [[Mat3; 3]; 4] = std::array::from_fn(|i| differences(&blocks[i]));
    let reduced: [[Mat3; 3]; 3] =
        std::array::from_fn(|j| differences(&std::array::from_fn(|i| columns[i][j])));
    let dense =
        nalgebra::SMatrix::<Real, 9, 9>::from_fn(|r, c| reduced[c / 3][r / 3][(r % 3, c % 3)]);
    let eigen = dense.symmetric_eigen();
    let values = match convexity {
        Convexity::Abs => eigen.eigenvalues.map(Real::abs),
        _ => eigen.eigenvalues.map(|value| value.max(0.0)),
    };
    // V Λ Vᵀ as W Wᵀ with W = V √Λ: symmetric to the last bit.
    let mut root = nalgebra::SMatrix::<Real, 12, 9>::zeros();
    for (column, value) in values.iter().enumerate() {
        let vector = eigen.eigenvectors.column(column) * value.sqrt();
        let parts: [Vec3; 3] = std::array::from_fn(|k| vector.fixed_rows::<3>(3 * k).into_owned());
        for (vertex, part) in vertices_of(&parts).into_iter().enumerate() {
            root.fixed_view_mut::<3, 1>(3 * vertex, column)
                .copy_from(&part);
        }
    }
    let sum = root * root.transpose();
    let block = |i, j| sum.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
    std::array::from_fn(|i| std::array::from_fn(|j| block(i, j)))
}

/// Three orthonormal combinations of four vertices that sum to zero: `(0 − 1)/√2`, `(2 − 3)/√2`, `(0 + 1 − 2 − 3)/2`.
fn differences(of: &[Mat3; 4]) -> [Mat3; 3] {
    let [a, b, c, d] = of;
    [
        (a - b) * FRAC_1_SQRT_2,
        (c - d) * FRAC_1_SQRT_2,
        (a + b - c - d) * 0.5,
    ]
}

/// What the combinations of [`differences`] are at the vertices.
fn vertices_of([p, q, r]: &[Vec3; 3]) -> [Vec3; 4] {
    let (p, q, r) = (p * FRAC_1_SQRT_2, q * FRAC_1_SQRT_2, r * 0.5);
    [r + p, r - p, q - r, -q - r]
}

//! Finite-difference checks that any element can be put through, ours or a user's: at positions x (m), with results
//! that are dimensionless unless they say otherwise.
//!
//! The central difference `(E(x + h) − E(x − h))/(2h)` is off by `h² E‴/6`, its truncation, and by about `ε E/h`, the
//! rounding of E, with ε = 2·10⁻¹⁶. Where E changes over a length `scale`, both are about as large for `h = ε^⅓ scale`,
//! and the error is then about `ε^⅔ ≈ 4·10⁻¹¹` of `E/scale`. So it is for the differences of a gradient.
//!
//! The tests of this crate allow for details smaller than `scale`, and for forces that cancel:
//! [`gradient_error`] up to 10⁻⁷, [`hessian_error`] up to 10⁻⁶, [`smallest_eigenvalue`] down to −2·10⁻¹³ of the largest
//! entry (by every choice but `Exact`), [`projection_error`] up to 10⁻¹². A wrong sign or factor is far beyond these.
//! Elements that are not tied to a place are also turned and shifted (`tests/support/element_checks.rs`): E has to stay
//! the same, the forces have to turn with the vertices, and forces and torques have to add up to zero, to 10⁻¹¹.

use crate::element::{Convexity, Energy, Projective};
use crate::math::{Blocks, Real, Vec3};

/// Largest error of the gradient against central differences of the value, relative to the largest entry of the
/// gradient (dimensionless).
///
/// `x` in m; `scale` (m) is a typical length of the element, and the difference is taken over `ε^⅓` of it.
#[must_use]
pub fn gradient_error<const N: usize, E: Energy<N>>(
    element: &E,
    x: &[Vec3; N],
    scale: Real,
) -> Real {
    let step = scale * Real::EPSILON.cbrt();
    let gradient = element.gradient(x);
    let mut error: Real = 0.0;
    let mut size: Real = 0.0;
    for (vertex, g) in gradient.iter().enumerate() {
        for axis in 0..3 {
            let at = |shift: Real| {
                let mut moved = *x;
                moved[vertex][axis] += shift;
                (element.value(&moved), moved[vertex][axis])
            };
            let ((above, high), (below, low)) = (at(step), at(-step));
            error = error.max(((above - below) / (high - low) - g[axis]).abs());
            size = size.max(g[axis].abs());
        }
    }
    relative(error, size)
}

/// Largest error of the exact Hessian against central differences of the gradient, relative to its largest entry
/// (dimensionless). `x` and `scale` in m, as in [`gradient_error`].
#[must_use]
pub fn hessian_error<const N: usize, E: Energy<N>>(
    element: &E,
    x: &[Vec3; N],
    scale: Real,
) -> Real {
    let step = scale * Real::EPSILON.cbrt();
    let hessian = element.hessian(x, Convexity::Exact);
    let mut error: Real = 0.0;
    let mut size: Real = 0.0;
    for j in 0..N {
        for axis in 0..3 {
            let at = |shift: Real| {
                let mut moved = *x;
                moved[j][axis] += shift;
                (element.gradient(&moved), moved[j][axis])
            };
            let ((above, high), (below, low)) = (at(step), at(-step));
            for i in 0..N {
                let difference = (above[i] - below[i]) / (high - low);
                let column = hessian[i][j].column(axis).into_owned();
                error = error.max((difference - column).amax());
                size = size.max(column.amax());
            }
        }
    }
    relative(error, size)
}

/// Smallest eigenvalue (N/m) of the Hessian at `x` (m) under a choice of convexity.
#[must_use]
pub fn smallest_eigenvalue<const N: usize, E: Energy<N>>(
    element: &E,
    x: &[Vec3; N],
    convexity: Convexity,
) -> Real {
    dense(&element.hessian(x, convexity))
        .symmetric_eigenvalues()
        .min()
}

/// Largest difference between the gradient at `x` (m) as an energy and the gradient `w Sᵀ(S x − p)` as a projection,
/// relative to the largest entry of the former (dimensionless).
#[must_use]
pub fn projection_error<const N: usize, const K: usize, E: Energy<N> + Projective<N, K>>(
    element: &E,
    x: &[Vec3; N],
) -> Real {
    let operator = element.operator();
    let z: [Vec3; K] = std::array::from_fn(|k| (0..N).map(|i| x[i] * operator[k][i]).sum());
    let p = element.project(z);
    let gradient = element.gradient(x);
    let mut error: Real = 0.0;
    let mut size: Real = 0.0;
    for i in 0..N {
        let pull: Vec3 = (0..K).map(|k| (z[k] - p[k]) * operator[k][i]).sum();
        error = error.max((pull * element.weight() - gradient[i]).amax());
        size = size.max(gradient[i].amax());
    }
    relative(error, size)
}

fn dense<const N: usize>(blocks: &Blocks<N>) -> nalgebra::DMatrix<Real> {
    nalgebra::DMatrix::from_fn(3 * N, 3 * N, |r, c| blocks[r / 3][c / 3][(r % 3, c % 3)])
}

fn relative(error: Real, size: Real) -> Real {
    if size > 0.0 { error / size } else { error }
}

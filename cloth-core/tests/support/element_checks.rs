//! What every element is put through, for the tests of several files.

use cloth_core::check;
use cloth_core::element::{Convexity, Energy};
use cloth_core::math::{Blocks, Mat3, Real, Vec3};

/// Deterministic numbers in (−1, 1).
pub(crate) fn noise(index: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let t = (3 * index + axis) as Real * 0.754_877_666 + 0.17;
        2.0 * t.fract() - 1.0
    })
}

/// Deterministic vertices.
pub(crate) fn shape<const N: usize>(seed: usize) -> [Vec3; N] {
    std::array::from_fn(|i| noise(17 * seed + i))
}

/// Derivatives to the accuracy that differences allow, with difference steps for details of size `scale` (m).
pub(crate) fn derivatives_agree<const N: usize, E: Energy<N>>(
    element: &E,
    x: &[Vec3; N],
    scale: Real,
) {
    let gradient = check::gradient_error(element, x, scale);
    let hessian = check::hessian_error(element, x, scale);
    let size = largest(&element.hessian(x, Convexity::Exact));
    // Where the forces cancel, errors are measured against the forces that a displacement of `scale` makes.
    let force = element
        .gradient(x)
        .iter()
        .map(|g| g.amax())
        .fold(0.0, Real::max);
    let gradient = if force < 1e-2 * size * scale {
        gradient * if force > 0.0 { force } else { 1.0 } / (size * scale)
    } else {
        gradient
    };
    assert!(
        gradient <= 1e-7,
        "gradient of {element:?} at {x:?}: {gradient:e}"
    );
    assert!(
        hessian <= 1e-6,
        "Hessian of {element:?} at {x:?}: {hessian:e}"
    );
}

/// The convex choices are convex, and every Hessian is symmetric to the last bit of what is assembled from it.
pub(crate) fn convex_choices_are_convex<const N: usize, E: Energy<N>>(element: &E, x: &[Vec3; N]) {
    let size = largest(&element.hessian(x, Convexity::Abs));
    for convexity in [Convexity::Clamp, Convexity::Abs, Convexity::GaussNewton] {
        let least = check::smallest_eigenvalue(element, x, convexity);
        assert!(
            least >= -2e-13 * size,
            "{convexity:?} of {element:?} at {x:?}: {least:e} of {size:e}"
        );
        let hessian = element.hessian(x, convexity);
        for i in 0..N {
            for j in 0..N {
                let skew = (hessian[i][j] - hessian[j][i].transpose()).amax();
                assert!(
                    skew <= 1e-13 * size,
                    "{convexity:?} of {element:?}: {skew:e}"
                );
            }
        }
    }
}

/// Largest entry of a block (N/m).
pub(crate) fn largest<const N: usize>(blocks: &Blocks<N>) -> Real {
    blocks.iter().flatten().map(Mat3::amax).fold(0.0, Real::max)
}

/// `E` and the forces do not notice a translation and turn with a rotation; no net force, no net torque.
pub(crate) fn is_invariant<const N: usize, E: Energy<N>>(element: &E, x: &[Vec3; N]) {
    let axis = Vec3::new(0.6, -0.48, 0.64).cross_matrix();
    let turn = Mat3::identity() + axis * Real::sin(1.234) + axis * axis * (1.0 - Real::cos(1.234));
    let moved = x.map(|x| turn * x + Vec3::new(3.0, -5.0, 2.0));
    let (before, after) = (element.value(x), element.value(&moved));
    assert!((after - before).abs() < 1e-12 * before.abs().max(1.0));
    let (g, moved_g) = (element.gradient(x), element.gradient(&moved));
    let size = g.iter().map(Vec3::norm).fold(1.0, Real::max);
    for i in 0..N {
        assert!((turn * g[i] - moved_g[i]).norm() < 1e-11 * size);
    }
    assert!(g.iter().sum::<Vec3>().norm() < 1e-12 * size);
    let torque: Vec3 = x.iter().zip(&g).map(|(x, g)| x.cross(g)).sum();
    assert!(torque.norm() < 1e-12 * size);
}

/// At shapes without a normal, an angle or an area nobody says which force is right, but every force is a number, all
/// of an element sum to zero, and each Hessian is symmetric and does not notice a translation.
#[allow(dead_code)] // not every test has such shapes
pub(crate) fn balanced<const N: usize, E: Energy<N>>(element: &E, x: &[Vec3; N]) {
    assert!(element.value(x) >= 0.0, "{x:?}");
    let forces = element.gradient(x);
    let size = forces.iter().map(|f| f.amax()).fold(0.0, Real::max);
    let sum: Vec3 = forces.iter().sum();
    assert!(
        sum.amax() <= 1e-12 * size + Real::MIN_POSITIVE,
        "{x:?}: {forces:?}"
    );
    // What clamping takes away leaves its rounding behind.
    let size = largest(&element.hessian(x, Convexity::Exact));
    for convexity in [
        Convexity::Exact,
        Convexity::Clamp,
        Convexity::Abs,
        Convexity::GaussNewton,
    ] {
        let hessian = element.hessian(x, convexity);
        let mut numbers = hessian.iter().flatten().flatten();
        assert!(numbers.all(|h| h.is_finite()), "{x:?}");
        for i in 0..N {
            let row: Mat3 = hessian[i].iter().sum();
            assert!(
                row.amax() <= 1e-12 * size + Real::MIN_POSITIVE,
                "{convexity:?} {x:?}: {:e} of {size:e}",
                row.amax()
            );
            for j in 0..N {
                let skew = hessian[i][j] - hessian[j][i].transpose();
                assert!(
                    skew.amax() <= 1e-12 * size + Real::MIN_POSITIVE,
                    "{convexity:?} {x:?}: {:e} of {size:e}",
                    skew.amax()
                );
            }
        }
    }
}

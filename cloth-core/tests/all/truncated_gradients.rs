//! Conjugate gradients that may end early.

use cloth_core::math::{Real, Vec3};
use cloth_core::method::linear::TruncatedConjugateGradients;
use cloth_core::method::vectors::dot;

/// Three different eigenvalues take three iterations; what is left, and what was found, make up `gᵀ H⁻¹ g`.
#[test]
fn the_direction_and_the_residual_make_up_the_decrement() {
    let stiffness = [2.0, 3.0, 7.0];
    let gradient: Vec<Vec3> = [1.0, -2.0, 0.5].map(|g| Vec3::new(g, 2.0 * g, -g)).into();
    let multiply = |d: &[Vec3], out: &mut [Vec3]| {
        let terms = out.iter_mut().zip(d).zip(stiffness);
        terms.for_each(|((out, d), k)| *out = d * k);
    };
    let copy = |r: &[Vec3], z: &mut [Vec3]| z.copy_from_slice(r);
    let squares = gradient.iter().zip(stiffness);
    let whole: Real = squares.map(|(g, k)| g.norm_squared() / k).sum();
    let mut solver = TruncatedConjugateGradients::default();
    let mut out = vec![Vec3::zeros(); 3];
    let (left, taken) = solver.solve((1e-12, 9), multiply, copy, &gradient, &mut out);
    assert!(taken == 3 && left < 1e-24, "{taken} {left:e}");
    for ((p, g), k) in out.iter().zip(&gradient).zip(stiffness) {
        assert!((p * k + g).norm() < 1e-12, "{p} {g}");
    }
    assert!((-dot(&gradient, &out) - whole).abs() < 1e-12 * whole);
    // With the exact inverse, one.
    let exact = |r: &[Vec3], z: &mut [Vec3]| {
        let terms = z.iter_mut().zip(r).zip(stiffness);
        terms.for_each(|((z, r), k)| *z = r / k);
    };
    assert_eq!(
        solver
            .solve((1e-9, 9), multiply, exact, &gradient, &mut out)
            .1,
        1
    );
}

/// A nearly closed pair of contact makes the correction of a cycle for it indefinite, by rounding. The residual is then
/// not less than nothing: with what the direction promises it would make a decrement of zero, as at a minimum.
#[test]
fn an_indefinite_preconditioner_does_not_pass_for_a_minimum() {
    let stiffness = [2.0, 3.0];
    let gradient = vec![Vec3::x(), Vec3::y()];
    let multiply = |d: &[Vec3], out: &mut [Vec3]| {
        let terms = out.iter_mut().zip(d).zip(stiffness);
        terms.for_each(|((out, d), k)| *out = d * k);
    };
    // Right at first, and of the other sign for what is left.
    let mut is_first = true;
    let inverse = |r: &[Vec3], z: &mut [Vec3]| {
        let sign = if std::mem::take(&mut is_first) {
            1.0
        } else {
            -1.0
        };
        z.iter_mut().zip(r).for_each(|(z, r)| *z = r * sign);
    };
    let mut solver = TruncatedConjugateGradients::default();
    let mut out = vec![Vec3::zeros(); 2];
    let (left, _) = solver.solve((1e-3, 9), multiply, inverse, &gradient, &mut out);
    assert_eq!(left, 0.0);
    // One step of steepest descent: (g·g)²/(g·Hg) = 4/5.
    assert!((dot(&gradient, &out) + 0.8).abs() < 1e-14);
}

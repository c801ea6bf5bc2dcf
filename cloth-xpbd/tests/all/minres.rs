//! MINRES against dense algebra.

use cloth_core::math::Real;
use cloth_xpbd::direct::Minres;
use nalgebra::{DMatrix, DVector};

const POSITIVE: usize = 20;
const N: usize = 32;

/// Deterministic numbers in (−1, 1).
fn noise(index: usize) -> Real {
    2.0 * (index as Real * 0.754_877_666 + 0.17).fract() - 1.0
}

/// `[H Jᵀ; J −S]`: H a chain, each row of J on three unknowns, S between `softness` and twice that.
fn matrix(softness: Real) -> DMatrix<Real> {
    let mut a = DMatrix::zeros(N, N);
    for i in 0..POSITIVE {
        a[(i, i)] = 3.0 + noise(i);
        if i > 0 {
            a[(i, i - 1)] = noise(3 * i);
            a[(i - 1, i)] = a[(i, i - 1)];
        }
    }
    for row in POSITIVE..N {
        a[(row, row)] = -softness * (1.5 + 0.5 * noise(row));
        for k in 0..3 {
            let column = (7 * row + 5 * k) % POSITIVE;
            a[(row, column)] = noise(11 * row + k);
            a[(column, row)] = a[(row, column)];
        }
    }
    a
}

fn right() -> DVector<Real> {
    DVector::from_fn(N, |i, _| noise(101 + i))
}

#[test]
fn minres_solves_what_conjugate_gradients_cannot() {
    let a = matrix(1e-2);
    let eigenvalues = a.symmetric_eigenvalues();
    assert!(eigenvalues.min() < 0.0 && eigenvalues.max() > 0.0);
    let mut minres = Minres::new(N);
    for preconditioned in [false, true] {
        let diagonal = |i: usize| {
            if preconditioned {
                a[(i, i)].abs().max(0.1)
            } else {
                1.0
            }
        };
        let mut x = vec![0.0; N];
        let end = minres.solve(
            |x, y| y.copy_from_slice((&a * DVector::from_column_slice(x)).as_slice()),
            |r, z| (0..N).for_each(|i| z[i] = r[i] / diagonal(i)),
            right().as_slice(),
            &mut x,
            1e-12,
            200,
        );
        let residual = &a * DVector::from_vec(x) - right();
        let norm = |v: &DVector<Real>| -> Real {
            let squares = (0..N).map(|i| v[i] * v[i] / diagonal(i));
            squares.sum::<Real>().sqrt()
        };
        let relative = norm(&residual) / norm(&right());
        assert!(
            end.residual <= 1e-12 && relative < 1e-11,
            "{end:?} {relative:e}"
        );
        assert!(end.iterations <= 2 * N as u32, "{end:?}");
    }
}

/// After k iterations the residual is the smallest one in the Krylov space of dimension k.
#[test]
fn each_iterate_of_minres_has_the_smallest_residual_of_its_space() {
    let a = matrix(0.3);
    let b = right();
    for k in [1, 2, 5, 9] {
        // An orthonormal basis of b, Ab, A²b, …, and least squares in it.
        let mut basis = DMatrix::zeros(N, k);
        let mut next = b.clone();
        for column in 0..k {
            for _ in 0..2 {
                for before in 0..column {
                    let part = basis.column(before).dot(&next);
                    next -= basis.column(before) * part;
                }
            }
            basis.set_column(column, &next.normalize());
            next = &a * basis.column(column);
        }
        let image = &a * &basis;
        let best = image.clone().svd(true, true).solve(&b, 1e-14).unwrap();
        let expected = (&b - image * best).norm();
        let mut x = vec![0.0; N];
        let end = Minres::new(N).solve(
            |x, y| y.copy_from_slice((&a * DVector::from_column_slice(x)).as_slice()),
            |r, z| z.copy_from_slice(r),
            b.as_slice(),
            &mut x,
            0.0,
            k as u32,
        );
        let residual = (&b - &a * DVector::from_vec(x)).norm();
        assert!(
            (residual - expected).abs() < 1e-12,
            "{k}: {residual} {expected}"
        );
        assert!(
            (end.residual * b.norm() - expected).abs() < 1e-12,
            "{k}: {end:?}"
        );
    }
}

#[test]
fn a_right_hand_side_of_zero_takes_no_iteration() {
    let mut x = vec![1.0; N];
    let zeros = vec![0.0; N];
    let copy = |x: &[Real], y: &mut [Real]| y.copy_from_slice(x);
    let end = Minres::new(N).solve(copy, copy, &zeros, &mut x, 1e-9, 10);
    assert_eq!((end.iterations, end.residual), (0, 0.0));
    assert_eq!(x, zeros);
}

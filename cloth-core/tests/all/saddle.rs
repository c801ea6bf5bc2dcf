//! Saddle-point systems against dense ones.

use cloth_core::math::Real;
use cloth_core::method::linear::{QuasidefiniteLdlt, UpperPattern};
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

fn upper(a: &DMatrix<Real>) -> (UpperPattern, Vec<Real>) {
    let (mut column_offsets, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in 0..N {
        for row in 0..=column {
            if a[(row, column)] != 0.0 || row == column {
                rows.push(row as u32);
                values.push(a[(row, column)]);
            }
        }
        column_offsets.push(rows.len() as u32);
    }
    let pattern = UpperPattern {
        column_offsets,
        rows,
    };
    (pattern, values)
}

fn right() -> DVector<Real> {
    DVector::from_fn(N, |i, _| noise(101 + i))
}

#[test]
fn a_quasi_definite_matrix_is_solved_and_refilled() {
    let (pattern, _) = upper(&matrix(1.0));
    let mut factor = QuasidefiniteLdlt::analyze(pattern, POSITIVE).unwrap();
    assert!(factor.factor_len() >= N);
    for softness in [1.0, 1e-3, 1e-8] {
        let a = matrix(softness);
        factor.values_mut().copy_from_slice(&upper(&a).1);
        factor.factorize().unwrap();
        let mut x = right();
        factor.solve_in_place(x.as_mut_slice());
        let error = (&a * &x - right()).norm();
        // Where S is small the factor loses digits.
        assert!(error < 1e-15 / softness + 1e-13, "{softness}: {error:e}");
    }
    factor.values_mut().fill(Real::NAN);
    assert!(factor.factorize().is_err());
}

/// One column of zeros: its pivot is replaced, and the others are solved.
#[test]
fn a_vanishing_pivot_is_replaced() {
    let mut a = matrix(1.0);
    let (pattern, _) = upper(&a);
    a.row_mut(N - 1).fill(0.0);
    a.column_mut(N - 1).fill(0.0);
    let mut factor = QuasidefiniteLdlt::analyze(pattern.clone(), POSITIVE).unwrap();
    let mut values = Vec::new();
    for column in 0..N {
        let range = pattern.column_offsets[column]..pattern.column_offsets[column + 1];
        values.extend(range.map(|slot| a[(pattern.rows[slot as usize] as usize, column)]));
    }
    factor.values_mut().copy_from_slice(&values);
    factor.factorize().unwrap();
    let mut right = right();
    right[N - 1] = 0.0;
    let mut x = right.clone();
    factor.solve_in_place(x.as_mut_slice());
    assert!((&a * &x - right).norm() < 1e-13);
}

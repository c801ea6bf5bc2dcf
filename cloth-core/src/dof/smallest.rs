//! The smallest singular values of the edge-length Jacobian themselves, where rounding hides their squares.
//!
//! The eigenvalues of `JᵀJ` are known to about 1e-15, so singular values below 3e-8 cannot be told from zero by
//! counting them. Seen from the edges there are few of those in a bent sheet: the `E − r` directions t with `Jᵀt ≈ 0`.
//! They are found by subspace iteration with `(JJᵀ + δ I)⁻¹ t = (t − J (JᵀJ + δ I)⁻¹ Jᵀ t)/δ`, one Cholesky
//! factorisation of the small shift `δ`, and their singular values are those of `Jᵀ` on the subspace (Rayleigh and
//! Ritz; G. W. Stewart, *Matrix Algorithms II*, SIAM 2001, chapter 6). No square of them is ever taken, and they come
//! out to about 1e-12.

use super::{RankError, normal_matrix};
use crate::math::{Real, Vec3};
use crate::method::linear::{BlockCholesky, LinearSolver};
use nalgebra::DMatrix;

/// The shift δ. Directions are told apart by how σ² + δ differs; much less and the factorisation would meet rounding.
const SHIFT: Real = 1e-12;
/// Directions more than are asked for: the more, the faster the others are left behind.
const SPARE: usize = 6;
const ITERATIONS: usize = 16;

/// The `count` smallest singular values of the Jacobian of the distances between `pairs` at `positions` (m), ascending,
/// as far as there are pairs.
pub(super) fn singular_values(
    positions: &[Vec3],
    pairs: &[[u32; 2]],
    count: usize,
) -> Result<Vec<Real>, RankError> {
    let directions: Vec<Vec3> = pairs
        .iter()
        .map(|&[a, b]| (positions[b as usize] - positions[a as usize]).normalize())
        .collect();
    // Jᵀ t: tensions pull at both ends.
    let pull = |tensions: &[Real], forces: &mut [Vec3]| {
        forces.fill(Vec3::zeros());
        for ((&[a, b], n), &t) in pairs.iter().zip(&directions).zip(tensions) {
            forces[b as usize] += n * t;
            forces[a as usize] -= n * t;
        }
    };
    let mut shifted = normal_matrix(positions, pairs);
    shifted.add_diagonal(std::iter::repeat_n(SHIFT, positions.len()));
    let is_free = vec![true; positions.len()];
    let mut cholesky =
        BlockCholesky::analyze(shifted.pattern(), &is_free).map_err(RankError::Factorization)?;
    LinearSolver::prepare(&mut cholesky, &shifted).map_err(|_| RankError::Indefinite {
        singular_value: SHIFT.sqrt(),
    })?;
    let width = (count + SPARE).min(pairs.len());
    let mut basis = DMatrix::from_fn(pairs.len(), width, scattered);
    orthonormalise(&mut basis);
    let mut forces = vec![Vec3::zeros(); positions.len()];
    let mut moved = forces.clone();
    for _ in 0..ITERATIONS {
        for mut column in basis.column_iter_mut() {
            pull(column.as_slice(), &mut forces);
            cholesky.solve(&forces, &mut moved);
            for ((&[a, b], n), t) in pairs.iter().zip(&directions).zip(column.iter_mut()) {
                *t -= n.dot(&(moved[b as usize] - moved[a as usize]));
            }
        }
        orthonormalise(&mut basis);
    }
    let mut pulled = DMatrix::zeros(3 * positions.len(), width);
    for (tensions, mut column) in basis.column_iter().zip(pulled.column_iter_mut()) {
        pull(tensions.as_slice(), &mut forces);
        let flat = forces.iter().flat_map(|f| [f.x, f.y, f.z]);
        column
            .iter_mut()
            .zip(flat)
            .for_each(|(to, from)| *to = from);
    }
    let mut values: Vec<Real> = pulled.qr().r().singular_values().iter().copied().collect();
    values.sort_by(Real::total_cmp);
    values.truncate(count);
    Ok(values)
}

/// Numbers between −1 and 1 without pattern, the same every time.
fn scattered(row: usize, column: usize) -> Real {
    let phase =
        0.618_033_988_75 * row as Real + 0.754_877_666_25 * ((row * (column + 1)) % 8191) as Real;
    2.0 * (phase * 37.0 + 0.1 * column as Real).fract() - 1.0
}

/// Gram and Schmidt, twice, for rounding.
fn orthonormalise(basis: &mut DMatrix<Real>) {
    for column in 0..basis.ncols() {
        let (before, mut rest) = basis.columns_range_pair_mut(0..column, column..);
        let mut own = rest.column_mut(0);
        for _ in 0..2 {
            for other in before.column_iter() {
                let part = other.dot(&own);
                own.axpy(-part, &other, 1.0);
            }
        }
        let norm = own.norm();
        if norm > 0.0 {
            own /= norm;
        }
    }
}

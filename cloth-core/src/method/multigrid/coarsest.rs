//! The coarsest level: a dense Cholesky factorisation.

use super::blocks::{Lanes, lanes, vector};
use super::level::Level;
use crate::math::{Real, Vec3};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// By how much of itself (dimensionless) the diagonal is made larger, until the matrix is positive definite: the levels
/// are in single precision, so that of stiff cloth in a long step may not be.
const SHIFTS: [f64; 3] = [1e-6, 1e-5, 1e-4];

/// The factor, and where the level's free vertices stand in it.
#[derive(Debug)]
pub(super) struct Coarsest {
    factor: Option<Cholesky<Real, Dyn>>,
    /// The memory of the matrix while there is no factor.
    matrix: Option<DMatrix<Real>>,
    right_hand_side: DVector<Real>,
}

impl Coarsest {
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            factor: None,
            matrix: Some(DMatrix::zeros(3 * vertex_count, 3 * vertex_count)),
            right_hand_side: DVector::zeros(3 * vertex_count),
        }
    }

    /// Factorises the matrix of the level, with a larger diagonal if it has to be. Returns whether it is positive
    /// definite as it is.
    pub(super) fn factorize(&mut self, level: &Level) -> bool {
        let is_positive_definite = self.factorize_shifted(level, 0.0);
        if !is_positive_definite {
            SHIFTS
                .iter()
                .any(|&shift| self.factorize_shifted(level, shift));
        }
        is_positive_definite
    }

    /// The same with the diagonal larger by a part `shift` (dimensionless).
    fn factorize_shifted(&mut self, level: &Level, shift: f64) -> bool {
        let kept = self.factor.take().map(Cholesky::unpack_dirty);
        let Some(mut dense) = kept.or_else(|| self.matrix.take()) else {
            return false;
        };
        dense.fill(0.0);
        for row in 0..level.len() {
            if !level.is_free()[row] {
                dense
                    .fixed_view_mut::<3, 3>(3 * row, 3 * row)
                    .fill_with_identity();
                continue;
            }
            for slot in level.pattern().row(row) {
                let column = level.pattern().columns()[slot] as usize;
                if level.is_free()[column] {
                    let block = level.blocks[slot].to_double();
                    dense
                        .fixed_view_mut::<3, 3>(3 * row, 3 * column)
                        .copy_from(&block);
                }
            }
        }
        level.rank_one.for_each_block(|row, column, block| {
            let mut place = dense.fixed_view_mut::<3, 3>(3 * row, 3 * column);
            place += block;
        });
        for entry in 0..dense.nrows() {
            dense[(entry, entry)] *= 1.0 + shift;
        }
        self.factor = Cholesky::new(dense);
        if self.factor.is_none() {
            let size = self.right_hand_side.len();
            self.matrix = Some(DMatrix::zeros(size, size));
        }
        self.factor.is_some()
    }

    /// Whether there is a factor.
    pub(super) fn has_factor(&self) -> bool {
        self.factor.is_some()
    }

    /// Solves with the last factor, or gives no correction without one.
    pub(super) fn solve(&mut self, level: &mut Level) {
        let Some(factor) = &self.factor else {
            return level.solution.fill(Lanes::ZERO);
        };
        let (rows, _) = self.right_hand_side.as_mut_slice().as_chunks_mut::<3>();
        for ((row, r), is_free) in rows
            .iter_mut()
            .zip(&level.right_hand_side)
            .zip(level.is_free())
        {
            *row = if *is_free { vector(r) } else { Vec3::zeros() }.into();
        }
        factor.solve_mut(&mut self.right_hand_side);
        let (rows, _) = self.right_hand_side.as_slice().as_chunks::<3>();
        for (row, x) in rows.iter().zip(&mut level.solution) {
            *x = lanes(&Vec3::from(*row));
        }
    }
}

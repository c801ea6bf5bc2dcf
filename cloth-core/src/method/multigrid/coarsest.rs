//! The coarsest level: a dense Cholesky factorisation.

use super::blocks::{Lanes, lanes, vector};
use super::dense::Dense;
use super::level::Level;
use crate::math::{Mat3, Real, Vec3};

/// By how much of itself (dimensionless) the diagonal is made larger, until the matrix is positive definite: the levels
/// are in single precision, so that of stiff cloth in a long step may not be.
const SHIFTS: [Real; 3] = [1e-6, 1e-5, 1e-4];

/// The factor, and whether there is one.
#[derive(Debug)]
pub(super) struct Coarsest {
    dense: Dense,
    has_factor: bool,
}

impl Coarsest {
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            dense: Dense::new(vertex_count),
            has_factor: false,
        }
    }

    /// Factorises the matrix of the level, with a larger diagonal if it has to be. Returns whether it is positive
    /// definite as it is.
    pub(super) fn factorize(&mut self, level: &Level) -> bool {
        let is_positive_definite = self.factorize_shifted(level, 0.0);
        self.has_factor = is_positive_definite
            || SHIFTS
                .iter()
                .any(|&shift| self.factorize_shifted(level, shift));
        is_positive_definite
    }

    /// The same with the diagonal larger by a part `shift` (dimensionless).
    fn factorize_shifted(&mut self, level: &Level, shift: Real) -> bool {
        self.dense.clear();
        for row in 0..level.len() {
            if !level.is_free()[row] {
                self.dense.add(row, row, &Mat3::identity());
                continue;
            }
            for slot in level.pattern().row(row) {
                let column = level.pattern().columns()[slot] as usize;
                if level.is_free()[column] {
                    self.dense.add(row, column, &level.blocks[slot].to_double());
                }
            }
        }
        let dense = &mut self.dense;
        level
            .rank_one
            .for_each_block(|row, column, block| dense.add(row, column, &block));
        self.dense.shift(shift);
        self.dense.factorize()
    }

    /// Whether there is a factor.
    pub(super) fn has_factor(&self) -> bool {
        self.has_factor
    }

    /// Solves with the last factor, or gives no correction without one.
    pub(super) fn solve(&mut self, level: &mut Level) {
        if !self.has_factor {
            return level.solution.fill(Lanes::ZERO);
        }
        let (rows, _) = self.dense.vector().as_chunks_mut::<3>();
        for ((row, r), is_free) in rows
            .iter_mut()
            .zip(&level.right_hand_side)
            .zip(level.is_free())
        {
            *row = if *is_free { vector(r) } else { Vec3::zeros() }.into();
        }
        self.dense.solve();
        let (rows, _) = self.dense.vector().as_chunks::<3>();
        for (row, x) in rows.iter().zip(&mut level.solution) {
            *x = lanes(&Vec3::from(*row));
        }
    }
}

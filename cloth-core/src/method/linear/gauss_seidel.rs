//! Gauss–Seidel by 3 × 3 blocks, in the order of the rows: each vertex takes the value that solves its own three
//! equations.
//!
//! With `A = L + D + Lᵀ` a sweep solves `(L + D) x = b − Lᵀ x_old`. Only `L` and `D` are stored, by rows. Row i gathers
//! `L_ij x_j` from the rows before it, finds its `x_i`, and at once scatters `L_ijᵀ x_i` to where the *next* sweep will
//! want it: one pass over the matrix a sweep, like a product. The difference of what was scattered in two sweeps is the
//! residual, `b − A x = Lᵀ x_old − Lᵀ x`, for nothing.
//!
//! A sweep never raises `½ xᵀA x − bᵀx`, so it converges for every positive definite matrix, and `x` after any number
//! of sweeps is a direction of descent for Newton's method. How fast: for matrices that couple two colours only (a
//! chain, a grid without diagonals) by exactly the square of what undamped Jacobi has.
//!
//! Y. Saad, *Iterative Methods for Sparse Linear Systems*, 2nd ed. 2003, sections 4.1 and 4.2.4.

use super::diagonal::InverseDiagonal;
use super::solver::{LinearError, LinearReport, LinearSolver, StoppingCriteria, dot};
use crate::math::{Real, Vec3};
use crate::method::block_matrix::BlockMatrix;
use crate::step::BuildError;

/// The solver and its vectors.
#[derive(Debug)]
pub struct GaussSeidel {
    criteria: StoppingCriteria,
    is_free: Vec<bool>,
    diagonal: InverseDiagonal,
    /// `Lᵀ x` of the sweep before.
    upper: Vec<Vec3>,
    /// `Lᵀ x` of this sweep.
    next_upper: Vec<Vec3>,
}

impl GaussSeidel {
    /// A solver over the free vertices.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for criteria out of range.
    pub fn new(is_free: &[bool], criteria: StoppingCriteria) -> Result<Self, BuildError> {
        criteria.check()?;
        let zeros = vec![Vec3::zeros(); is_free.len()];
        Ok(Self {
            criteria,
            is_free: is_free.to_vec(),
            diagonal: InverseDiagonal::identity(is_free),
            upper: zeros.clone(),
            next_upper: zeros,
        })
    }

    /// One sweep. Returns the squared norm of the residual after it.
    fn sweep(&mut self, matrix: &BlockMatrix, b: &[Vec3], x: &mut [Vec3]) -> Real {
        let pattern = matrix.pattern();
        self.next_upper.fill(Vec3::zeros());
        for row in (0..x.len()).filter(|&row| self.is_free[row]) {
            let range = pattern.row(row);
            let lower = range.start..range.end - 1;
            let mut rest = b[row] - self.upper[row];
            for slot in lower.clone() {
                rest -= matrix.blocks()[slot] * x[pattern.columns()[slot] as usize];
            }
            x[row] = self.diagonal.blocks()[row] * rest;
            for slot in lower {
                let column = pattern.columns()[slot] as usize;
                self.next_upper[column] += matrix.blocks()[slot].tr_mul(&x[row]);
            }
        }
        self.diagonal.clear_prescribed(&mut self.next_upper);
        let change = self.upper.iter().zip(&self.next_upper);
        let residual_squared = change.map(|(old, new)| (old - new).norm_squared()).sum();
        std::mem::swap(&mut self.upper, &mut self.next_upper);
        residual_squared
    }
}

impl LinearSolver for GaussSeidel {
    fn name(&self) -> &'static str {
        "gauss-seidel"
    }

    fn prepare(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError> {
        self.diagonal.invert(matrix)
    }

    fn solve(
        &mut self,
        matrix: &BlockMatrix,
        b: &[Vec3],
        x: &mut [Vec3],
    ) -> Result<LinearReport, LinearError> {
        x.fill(Vec3::zeros());
        self.upper.fill(Vec3::zeros());
        self.diagonal.copy_free(b, &mut self.next_upper);
        let b_squared = dot(&self.next_upper, &self.next_upper);
        let mut residual_squared = b_squared;
        for iteration in 0.. {
            let end = self
                .criteria
                .outcome(iteration, residual_squared, b_squared);
            if let Some(result) = end {
                return result;
            }
            residual_squared = self.sweep(matrix, b, x);
        }
        unreachable!("the criteria end the loop")
    }
}

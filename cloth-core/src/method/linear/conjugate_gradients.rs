//! Conjugate gradients, preconditioned by the inverse of the diagonal blocks.
//!
//! Iteration k finds the best `x` of the Krylov space spanned by `D⁻¹b, (D⁻¹A) D⁻¹b, …`: no method that only multiplies
//! by `A` does better. An iteration is one product and two passes over the vectors; the passes are fused, as the memory
//! is what they wait for.
//!
//! J. R. Shewchuk, *An introduction to the conjugate gradient method without the agonizing pain*, 1994, section B3.

use super::diagonal::InverseDiagonal;
use super::solver::{LinearError, LinearReport, LinearSolver, StoppingCriteria, dot};
use super::spectrum::{Spectrum, Tridiagonal};
use crate::math::{Real, Vec3};
use crate::method::block_matrix::BlockMatrix;
use crate::step::BuildError;

/// What the residual is multiplied by before it becomes a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preconditioner {
    /// Nothing: the spectrum is that of the matrix itself.
    Identity,
    /// The inverse of the 3 × 3 diagonal blocks.
    BlockJacobi,
}

/// The solver and its vectors: five, each of V entries.
#[derive(Debug)]
pub struct ConjugateGradients {
    preconditioner: Preconditioner,
    criteria: StoppingCriteria,
    diagonal: InverseDiagonal,
    residual: Vec<Vec3>,
    /// `D⁻¹` times the residual.
    preconditioned: Vec<Vec3>,
    direction: Vec<Vec3>,
    /// `A` times the direction.
    product: Vec<Vec3>,
    tridiagonal: Tridiagonal,
}

impl ConjugateGradients {
    /// A solver over the free vertices.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for criteria out of range.
    pub fn new(
        is_free: &[bool],
        preconditioner: Preconditioner,
        criteria: StoppingCriteria,
    ) -> Result<Self, BuildError> {
        criteria.check()?;
        let zeros = vec![Vec3::zeros(); is_free.len()];
        Ok(Self {
            preconditioner,
            criteria,
            diagonal: InverseDiagonal::identity(is_free),
            residual: zeros.clone(),
            preconditioned: zeros.clone(),
            direction: zeros.clone(),
            product: zeros,
            tridiagonal: Tridiagonal::with_room_for(criteria.max_iterations),
        })
    }

    /// What the last solve tells about the eigenvalues of `D⁻¹A`, or of `A` without a preconditioner; `None` before it
    /// has taken a step.
    #[must_use]
    pub fn spectrum(&self) -> Option<Spectrum> {
        self.tridiagonal.spectrum()
    }

    /// The inverted diagonal blocks of the last matrix, lent to the solvers that estimate their interval with this one.
    pub(super) fn diagonal(&self) -> &InverseDiagonal {
        &self.diagonal
    }
}

impl LinearSolver for ConjugateGradients {
    fn name(&self) -> &'static str {
        "conjugate-gradients"
    }

    fn prepare(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError> {
        match self.preconditioner {
            Preconditioner::Identity => Ok(()),
            Preconditioner::BlockJacobi => self.diagonal.invert(matrix),
        }
    }

    fn solve(
        &mut self,
        matrix: &BlockMatrix,
        b: &[Vec3],
        x: &mut [Vec3],
    ) -> Result<LinearReport, LinearError> {
        x.fill(Vec3::zeros());
        self.tridiagonal.clear();
        self.diagonal.copy_free(b, &mut self.residual);
        let b_squared = dot(&self.residual, &self.residual);
        let first = self.residual.iter().zip(self.diagonal.blocks());
        let mut slope = 0.0;
        for ((r, inverse), p) in first.zip(&mut self.direction) {
            *p = inverse * r;
            slope += r.dot(p);
        }
        let mut residual_squared = b_squared;
        for iteration in 0.. {
            let end = self
                .criteria
                .outcome(iteration, residual_squared, b_squared);
            if let Some(result) = end {
                return result;
            }
            matrix.multiply(&self.direction, &mut self.product);
            self.diagonal.clear_prescribed(&mut self.product);
            let curvature = dot(&self.direction, &self.product);
            if !(curvature > 0.0 && slope > 0.0) {
                return Err(LinearError::NotPositiveDefinite);
            }
            let length = slope / curvature;
            let sums = self.advance(length, x);
            let turn = sums.slope / slope;
            self.tridiagonal.push(length, turn);
            (slope, residual_squared) = (sums.slope, sums.residual_squared);
            for (p, z) in self.direction.iter_mut().zip(&self.preconditioned) {
                *p = z + *p * turn;
            }
        }
        unreachable!("the criteria end the loop")
    }
}

/// Inner products taken on the way.
struct Sums {
    /// `r·D⁻¹r`.
    slope: Real,
    /// `r·r`.
    residual_squared: Real,
}

impl ConjugateGradients {
    /// Goes `length` along the direction, and takes the new residual's inner products in the same pass.
    fn advance(&mut self, length: Real, x: &mut [Vec3]) -> Sums {
        let mut sums = Sums {
            slope: 0.0,
            residual_squared: 0.0,
        };
        let along = self.direction.iter().zip(&self.product);
        let inverse = self.diagonal.blocks().iter();
        let residual = self.residual.iter_mut().zip(&mut self.preconditioned);
        for (((x, (p, product)), inverse), (r, z)) in
            x.iter_mut().zip(along).zip(inverse).zip(residual)
        {
            *x += p * length;
            *r -= product * length;
            *z = inverse * *r;
            sums.slope += r.dot(z);
            sums.residual_squared += r.norm_squared();
        }
        sums
    }
}

//! Damped Jacobi by 3 × 3 blocks: `x ← x + ω D⁻¹ (b − A x)`.
//!
//! An error along an eigenvector of `D⁻¹A` with eigenvalue λ is multiplied by `1 − ωλ` in every iteration. So the
//! iteration converges for `ω < 2/λ_max` only (cloth has λ_max up to 4: undamped Jacobi, ω = 1, diverges on it), and
//! fastest for `ω = 2/(λ_min + λ_max)`, by `(κ − 1)/(κ + 1)`.
//!
//! Y. Saad, *Iterative Methods for Sparse Linear Systems*, 2nd ed. 2003, section 4.2.

use super::chebyshev::Interval;
use super::solver::{LinearError, LinearReport, LinearSolver, StoppingCriteria, dot};
use crate::error::positive;
use crate::math::{Real, Vec3};
use crate::method::block_matrix::BlockMatrix;
use crate::step::BuildError;

/// The solver and its vectors.
#[derive(Debug)]
pub struct Jacobi {
    criteria: StoppingCriteria,
    /// ω, if it is given.
    given: Option<Real>,
    interval: Interval,
    residual: Vec<Vec3>,
    product: Vec<Vec3>,
}

impl Jacobi {
    /// A solver over the free vertices with the damping ω, or with `2/(λ_min + λ_max)` of the estimated spectrum.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for criteria or a damping out of range.
    pub fn new(
        is_free: &[bool],
        damping: Option<Real>,
        criteria: StoppingCriteria,
    ) -> Result<Self, BuildError> {
        criteria.check()?;
        if let Some(omega) = damping {
            positive("damping of the Jacobi iteration", omega)?;
        }
        let zeros = vec![Vec3::zeros(); is_free.len()];
        Ok(Self {
            criteria,
            given: damping,
            interval: Interval::new(is_free)?,
            residual: zeros.clone(),
            product: zeros,
        })
    }

    /// ω.
    fn damping(&self) -> Real {
        let [low, high] = self.interval.bounds();
        self.given.unwrap_or(2.0 / (low + high))
    }
}

impl LinearSolver for Jacobi {
    fn name(&self) -> &'static str {
        "jacobi"
    }

    fn prepare(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError> {
        match self.given {
            Some(_) => self.interval.invert_diagonal(matrix),
            None => self.interval.estimate(matrix),
        }
    }

    fn solve(
        &mut self,
        matrix: &BlockMatrix,
        b: &[Vec3],
        x: &mut [Vec3],
    ) -> Result<LinearReport, LinearError> {
        let omega = self.damping();
        let diagonal = self.interval.diagonal();
        x.fill(Vec3::zeros());
        diagonal.copy_free(b, &mut self.residual);
        let b_squared = dot(&self.residual, &self.residual);
        let mut residual_squared = b_squared;
        for iteration in 0.. {
            let end = self
                .criteria
                .outcome(iteration, residual_squared, b_squared);
            if let Some(result) = end {
                return result;
            }
            for ((x, r), inverse) in x.iter_mut().zip(&self.residual).zip(diagonal.blocks()) {
                *x += inverse * r * omega;
            }
            matrix.multiply(x, &mut self.product);
            diagonal.clear_prescribed(&mut self.product);
            diagonal.copy_free(b, &mut self.residual);
            for (r, product) in self.residual.iter_mut().zip(&self.product) {
                *r -= product;
            }
            residual_squared = dot(&self.residual, &self.residual);
        }
        unreachable!("the criteria end the loop")
    }
}

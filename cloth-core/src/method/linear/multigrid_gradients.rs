//! Conjugate gradients, preconditioned by one multigrid cycle.
//!
//! The cycle is computed in single precision and only symmetric to its rounding, so directions are made conjugate by
//! the change of the residual (Polak and Ribière's form), which does not rely on it.
//!
//! [`prepare`](LinearSolver::prepare) refuses a matrix whose coarsest level is not positive definite. The levels are in
//! single precision, so it may refuse a definite one that is very stiff beside its masses; a factorisation takes that.
//!
//! G. H. Golub, Q. Ye, "Inexact preconditioned conjugate gradient method with inner-outer iteration", SIAM J. Sci.
//! Comput. 21(4), 1999, <https://doi.org/10.1137/S1064827597323415>.

use super::solver::{LinearError, LinearReport, LinearSolver, StoppingCriteria};
use crate::math::{Real, Vec3};
use crate::method::block_matrix::BlockMatrix;
use crate::method::multigrid::Multigrid;
use crate::method::vectors::{add, dot};
use crate::step::BuildError;

/// The solver, its levels, which are made for the first matrix, and its vectors.
#[derive(Debug)]
pub struct MultigridGradients {
    criteria: StoppingCriteria,
    is_free: Vec<bool>,
    rest: Vec<Vec3>,
    multigrid: Option<Multigrid>,
    residual: Vec<Vec3>,
    /// The residual before.
    before: Vec<Vec3>,
    preconditioned: Vec<Vec3>,
    direction: Vec<Vec3>,
    product: Vec<Vec3>,
}

impl MultigridGradients {
    /// A solver over the free vertices, at rest at `rest` (m) if that is known.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for criteria out of range.
    ///
    /// # Panics
    /// If there is not one rest position per vertex.
    pub fn new(
        is_free: &[bool],
        rest: Option<&[Vec3]>,
        criteria: StoppingCriteria,
    ) -> Result<Self, BuildError> {
        criteria.check()?;
        let zeros = vec![Vec3::zeros(); is_free.len()];
        let rest = rest.map_or_else(|| zeros.clone(), <[Vec3]>::to_vec);
        assert_eq!(rest.len(), is_free.len(), "one rest position per vertex");
        Ok(Self {
            criteria,
            is_free: is_free.to_vec(),
            rest,
            multigrid: None,
            residual: zeros.clone(),
            before: zeros.clone(),
            preconditioned: zeros.clone(),
            direction: zeros.clone(),
            product: zeros,
        })
    }
}

impl LinearSolver for MultigridGradients {
    fn name(&self) -> &'static str {
        "multigrid"
    }

    fn prepare(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError> {
        let levels = || Multigrid::new(matrix, &self.is_free, &self.rest);
        if self.multigrid.get_or_insert_with(levels).refresh(matrix) {
            Ok(())
        } else {
            Err(LinearError::NotPositiveDefinite)
        }
    }

    fn solve(
        &mut self,
        matrix: &BlockMatrix,
        b: &[Vec3],
        x: &mut [Vec3],
    ) -> Result<LinearReport, LinearError> {
        let multigrid = self
            .multigrid
            .as_mut()
            .ok_or(LinearError::NotPositiveDefinite)?;
        x.fill(Vec3::zeros());
        // That of a matrix which was refused need not be finite.
        self.direction.fill(Vec3::zeros());
        for ((r, b), free) in self.residual.iter_mut().zip(b).zip(&self.is_free) {
            *r = if *free { *b } else { Vec3::zeros() };
        }
        let b_squared = dot(&self.residual, &self.residual);
        let (mut residual_squared, mut slope) = (b_squared, 0.0);
        for iteration in 0.. {
            if let Some(result) = self
                .criteria
                .outcome(iteration, residual_squared, b_squared)
            {
                return result;
            }
            multigrid.apply(&self.residual, &mut self.preconditioned);
            let next = dot(&self.residual, &self.preconditioned);
            let kept = dot(&self.before, &self.preconditioned);
            let turn = if iteration == 0 {
                0.0
            } else {
                (next - kept) / slope
            };
            slope = next;
            for (p, z) in self.direction.iter_mut().zip(&self.preconditioned) {
                *p = z + *p * turn;
            }
            matrix.multiply(&self.direction, &mut self.product);
            for (product, free) in self.product.iter_mut().zip(&self.is_free) {
                if !free {
                    *product = Vec3::zeros();
                }
            }
            let curvature = dot(&self.direction, &self.product);
            if !(curvature > 0.0 && slope > 0.0) {
                return Err(LinearError::NotPositiveDefinite);
            }
            // Along the direction, whatever its history: the residual is at right angles to it afterwards.
            let length: Real = dot(&self.direction, &self.residual) / curvature;
            self.before.copy_from_slice(&self.residual);
            add(x, length, &self.direction);
            add(&mut self.residual, -length, &self.product);
            residual_squared = dot(&self.residual, &self.residual);
        }
        unreachable!("the criteria end the loop")
    }
}

//! Jacobi by blocks with Chebyshev acceleration.
//!
//! After k iterations an error along an eigenvector of `D⁻¹A` is multiplied by a polynomial of degree k of its
//! eigenvalue λ, which is 1 at 0. Here it is the one that is smallest, at worst, on an interval from a to b:
//!
//! ```text
//! T_k((b + a − 2λ)/(b − a)) / T_k((b + a)/(b − a))
//! ```
//!
//! with the Chebyshev polynomial `T_k`. That is at most `2((√κ − 1)/(√κ + 1))^k` inside the interval, shrinks more
//! slowly below a, and grows without bound above b. No inner product is needed, only the interval.
//!
//! Y. Saad, *Iterative Methods for Sparse Linear Systems*, 2nd ed. 2003, section 12.3. H. Wang, "A Chebyshev
//! semi-iterative approach for accelerating projective and position-based dynamics", ACM TOG 34(6), 2015,
//! <https://doi.org/10.1145/2816795.2818063>, uses the same recurrence.

use super::conjugate_gradients::{ConjugateGradients, Preconditioner};
use super::diagonal::InverseDiagonal;
use super::solver::{LinearError, LinearReport, LinearSolver, StoppingCriteria, dot};
use super::spectrum::noise;
use crate::error::within;
use crate::math::{Real, Vec3};
use crate::method::block_matrix::BlockMatrix;
use crate::step::BuildError;

/// Iterations of conjugate gradients for an estimate of the interval.
const ESTIMATION: u32 = 100;
/// The largest eigenvalue is estimated from below; beyond the interval the iteration diverges.
const ABOVE: Real = 1.05;
/// The smallest is estimated from above, and at [`ESTIMATION`] iterations not well.
const BELOW: Real = 0.5;

/// The interval that holds the eigenvalues of `D⁻¹A`, and how it is found.
#[derive(Debug)]
pub(super) struct Interval {
    estimator: ConjugateGradients,
    noise: Vec<Vec3>,
    scratch: Vec<Vec3>,
    bounds: [Real; 2],
}

impl Interval {
    pub(super) fn new(is_free: &[bool]) -> Result<Self, BuildError> {
        let criteria = StoppingCriteria {
            tolerance: 1e-12,
            max_iterations: ESTIMATION,
        };
        Ok(Self {
            estimator: ConjugateGradients::new(is_free, Preconditioner::BlockJacobi, criteria)?,
            noise: (0..is_free.len()).map(noise).collect(),
            scratch: vec![Vec3::zeros(); is_free.len()],
            bounds: [1.0, 1.0],
        })
    }

    pub(super) fn invert_diagonal(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError> {
        self.estimator.prepare(matrix)
    }

    /// Inverts the diagonal blocks and estimates the interval by some iterations of conjugate gradients.
    pub(super) fn estimate(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError> {
        self.invert_diagonal(matrix)?;
        self.estimator
            .solve(matrix, &self.noise, &mut self.scratch)?;
        // Without a free vertex there is nothing to estimate, and nothing to solve.
        let spectrum = self.estimator.spectrum();
        self.bounds = spectrum.map_or([1.0, 1.0], |s| [BELOW * s.smallest, ABOVE * s.largest]);
        Ok(())
    }

    pub(super) fn bounds(&self) -> [Real; 2] {
        self.bounds
    }

    pub(super) fn diagonal(&self) -> &InverseDiagonal {
        self.estimator.diagonal()
    }
}

/// The solver and its vectors.
#[derive(Debug)]
pub struct ChebyshevJacobi {
    criteria: StoppingCriteria,
    given: Option<[Real; 2]>,
    interval: Interval,
    residual: Vec<Vec3>,
    direction: Vec<Vec3>,
    product: Vec<Vec3>,
}

impl ChebyshevJacobi {
    /// A solver over the free vertices, for eigenvalues of `D⁻¹A` between the two given numbers, or between estimates
    /// of them.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for criteria or an interval out of range.
    pub fn new(
        is_free: &[bool],
        interval: Option<[Real; 2]>,
        criteria: StoppingCriteria,
    ) -> Result<Self, BuildError> {
        criteria.check()?;
        if let Some([low, high]) = interval {
            let is_right = low > 0.0 && low <= high && high.is_finite();
            let range = "positive and not above the upper end, which is finite";
            within(is_right, "lower end of the Chebyshev interval", low, range)?;
        }
        let zeros = vec![Vec3::zeros(); is_free.len()];
        Ok(Self {
            criteria,
            given: interval,
            interval: Interval::new(is_free)?,
            residual: zeros.clone(),
            direction: zeros.clone(),
            product: zeros,
        })
    }
}

impl LinearSolver for ChebyshevJacobi {
    fn name(&self) -> &'static str {
        "chebyshev-jacobi"
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
        let [low, high] = self.given.unwrap_or(self.interval.bounds());
        let (center, radius) = (0.5 * (high + low), 0.5 * (high - low));
        let diagonal = self.interval.diagonal();
        x.fill(Vec3::zeros());
        diagonal.copy_free(b, &mut self.residual);
        let b_squared = dot(&self.residual, &self.residual);
        let mut residual_squared = b_squared;
        // T_{k−1}/T_k at (b + a)/(b − a): zero before the first iteration, radius/center after it.
        let mut ratio = 0.0;
        for iteration in 0.. {
            let end = self
                .criteria
                .outcome(iteration, residual_squared, b_squared);
            if let Some(result) = end {
                return result;
            }
            let (keep, push) = match iteration {
                0 => (0.0, 1.0 / center),
                _ => {
                    let push = 2.0 / (2.0 * center - ratio * radius);
                    (0.5 * radius * push * ratio, push)
                }
            };
            ratio = if iteration == 0 {
                radius / center
            } else {
                0.5 * radius * push
            };
            let residual = self.residual.iter().zip(diagonal.blocks());
            for ((x, p), (r, inverse)) in x.iter_mut().zip(&mut self.direction).zip(residual) {
                *p = *p * keep + inverse * r * push;
                *x += *p;
            }
            matrix.multiply(&self.direction, &mut self.product);
            diagonal.clear_prescribed(&mut self.product);
            for (r, product) in self.residual.iter_mut().zip(&self.product) {
                *r -= product;
            }
            residual_squared = dot(&self.residual, &self.residual);
        }
        unreachable!("the criteria end the loop")
    }
}

//! What all solvers of `A x = b` have in common, and their choice by name.

#[cfg(feature = "cholesky")]
use super::block_cholesky::BlockCholesky;
use super::chebyshev::ChebyshevJacobi;
use super::conjugate_gradients::{ConjugateGradients, Preconditioner};
use super::gauss_seidel::GaussSeidel;
use super::jacobi::Jacobi;
use super::multigrid_gradients::MultigridGradients;
use crate::error::{at_least_one, within};
use crate::math::{Real, Vec3};
use crate::method::block_matrix::{BlockMatrix, BlockPattern};
use crate::step::{BuildError, Outcome};
use std::fmt;

/// A way to solve `A x = b` over the free vertices for a symmetric positive definite [`BlockMatrix`].
///
/// A solver is made for one pattern and one set of free vertices. It allocates then, and not later.
pub trait LinearSolver: fmt::Debug + Send + Sync {
    /// Its name: `cholesky`, `conjugate-gradients`, `multigrid`, `jacobi`, `chebyshev-jacobi` or `gauss-seidel`.
    fn name(&self) -> &'static str;

    /// Takes in the numbers of a matrix: factorises it, or inverts its diagonal blocks and estimates eigenvalues.
    ///
    /// # Errors
    /// [`LinearError::NotPositiveDefinite`], as far as the solver can tell.
    ///
    /// # Panics
    /// If the matrix does not have the pattern the solver was made for.
    fn prepare(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError>;

    /// Solves with the matrix of the last [`LinearSolver::prepare`]. Iterations start at zero; `x` is zero at
    /// prescribed vertices afterwards, and what `b` is there does not matter.
    ///
    /// # Errors
    /// [`LinearError::NotPositiveDefinite`] where only the iteration finds out; [`LinearError::Diverged`].
    ///
    /// # Panics
    /// If `b` or `x` does not have one entry per row.
    fn solve(
        &mut self,
        matrix: &BlockMatrix,
        b: &[Vec3],
        x: &mut [Vec3],
    ) -> Result<LinearReport, LinearError>;

    /// Whether [`LinearSolver::prepare`] refuses every matrix that is not positive definite, so that its success is a
    /// proof.
    fn proves_definiteness(&self) -> bool {
        false
    }
}

/// What a solve did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearReport {
    /// Converged, or the iterations were spent.
    pub outcome: Outcome,
    /// Iterations: products with the matrix, or sweeps; 1 for a direct solver.
    pub iterations: u32,
    /// `‖b − A x‖/‖b‖` over the free vertices; zero for `b = 0`.
    pub residual: Real,
}

/// Why a system could not be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LinearError {
    /// A pivot, a diagonal block or a curvature was not positive, or NaN.
    NotPositiveDefinite,
    /// The residual grew, or overflowed.
    Diverged {
        /// Iterations until then.
        iterations: u32,
    },
}

impl fmt::Display for LinearError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositiveDefinite => write!(f, "the matrix is not positive definite"),
            Self::Diverged { iterations } => {
                write!(f, "the iteration diverged within {iterations} iterations")
            }
        }
    }
}

impl std::error::Error for LinearError {}

/// A residual of this many times `‖b‖` is taken for divergence.
const DIVERGED: Real = 1e8;

/// When an iterative solver stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoppingCriteria {
    /// `‖b − A x‖/‖b‖` at which a solve is done; zero to spend all iterations.
    pub tolerance: Real,
    /// Most iterations of a solve.
    pub max_iterations: u32,
}

impl Default for StoppingCriteria {
    /// To 10⁻³, in at most 1000 iterations.
    fn default() -> Self {
        Self {
            tolerance: 1e-3,
            max_iterations: 1000,
        }
    }
}

impl StoppingCriteria {
    pub(super) fn check(&self) -> Result<(), BuildError> {
        let (name, tolerance) = ("tolerance of the linear solver", self.tolerance);
        let is_right = (0.0..1.0).contains(&tolerance);
        within(is_right, name, tolerance, "at least 0 and below 1")?;
        at_least_one("max_iterations of the linear solver", self.max_iterations)?;
        Ok(())
    }

    /// Whether a solve ends here: squared norms of residual and right-hand side.
    pub(super) fn outcome(
        &self,
        iterations: u32,
        residual_squared: Real,
        b_squared: Real,
    ) -> Option<Result<LinearReport, LinearError>> {
        let ratio = (residual_squared / b_squared).sqrt();
        let report = |outcome, residual| LinearReport {
            outcome,
            iterations,
            residual,
        };
        if b_squared == 0.0 {
            return Some(Ok(report(Outcome::Converged, 0.0)));
        }
        if ratio > DIVERGED || !ratio.is_finite() {
            return Some(Err(LinearError::Diverged { iterations }));
        }
        if ratio <= self.tolerance {
            return Some(Ok(report(Outcome::Converged, ratio)));
        }
        (iterations >= self.max_iterations).then(|| Ok(report(Outcome::BudgetSpent, ratio)))
    }
}

/// Which solver, as data.
///
/// How much the error shrinks goes by the condition number κ of `D⁻¹ A`, D the diagonal blocks. With `q = (√κ − 1)/(√κ
/// + 1)`:
///
/// | solver | error after k iterations, over that at the start | for |
/// |---|---|---|
/// | Cholesky | 0 after one | stiff systems, several right-hand sides, proof of definiteness |
/// | conjugate gradients | at most `2 qᵏ` in the norm `√(eᵀA e)`, and mostly less | well-conditioned systems |
/// | multigrid | hardly depends on κ and size | large and stiff systems |
/// | Chebyshev–Jacobi | at most `2 qᵏ` in the norm `√(eᵀD e)` | where inner products are dear |
/// | Gauss–Seidel | by `((κ − 1)/(κ + 1))²` an iteration in the end if the matrix couples two colours only, as of a chain or a grid without diagonals | smoothing, comparison |
/// | Jacobi | by `(κ − 1)/(κ + 1)` an iteration | comparison |
///
/// No bound holds for a single iteration of conjugate gradients. The error falls in its norm in each, by an amount that
/// varies, and the residual `‖b − A x‖`, by which [`StoppingCriteria`] ends a solve, may rise in between.
///
/// Iterations to a residual of 10⁻³ (the default) for `M/Δt² + H`, Δt = 1/60 s, of an alternating grid of a sheet of
/// 10⁴ N/m, shaken by a tenth of its edges (the matrices of `tests/all/multigrid.rs`):
///
/// | vertices | 17² | 33² | 65² | 129² |
/// |---|---|---|---|---|
/// | multigrid | 16 | 22 | 31 | 29 |
/// | conjugate gradients | 175 | 320 | 717 | 1379 |
/// | Chebyshev–Jacobi | 254 | 648 | 2045 | 5032 |
/// | Gauss–Seidel | 1815 | 13 831 | more than 20 000 | more than 20 000 |
/// | Jacobi | 3678 | more than 20 000 | more than 20 000 | more than 20 000 |
///
/// An iteration of multigrid takes as long as four to five of conjugate gradients (65² and 129², one thread of an AMD
/// EPYC), and making the levels for a new matrix about as long as two or three of its own. So it is the faster from a
/// few hundred vertices on.
///
/// Threads: the multigrid cycle uses them, and the passes over vectors around it. All else is serial: products with the
/// matrix, the other solvers, the factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LinearMethod {
    /// Sparse Cholesky factorisation, [`BlockCholesky`].
    #[cfg(feature = "cholesky")]
    Cholesky,
    /// Conjugate gradients, preconditioned by the diagonal blocks.
    ConjugateGradients(StoppingCriteria),
    /// Conjugate gradients, preconditioned by a multigrid cycle.
    Multigrid(StoppingCriteria),
    /// Damped Jacobi by blocks; the damping is estimated.
    Jacobi(StoppingCriteria),
    /// Jacobi by blocks with Chebyshev acceleration; the interval is estimated.
    ChebyshevJacobi(StoppingCriteria),
    /// Gauss–Seidel by blocks, forwards.
    GaussSeidel(StoppingCriteria),
}

impl Default for LinearMethod {
    /// The factorisation, or multigrid where the feature `cholesky` is off.
    fn default() -> Self {
        #[cfg(feature = "cholesky")]
        return Self::Cholesky;
        #[cfg(not(feature = "cholesky"))]
        Self::Multigrid(StoppingCriteria::default())
    }
}

impl LinearMethod {
    /// Whether its numbers are in the range that [`build`](Self::build) asks for.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`].
    pub fn check(&self) -> Result<(), BuildError> {
        match self {
            #[cfg(feature = "cholesky")]
            Self::Cholesky => Ok(()),
            Self::ConjugateGradients(criteria)
            | Self::Multigrid(criteria)
            | Self::Jacobi(criteria)
            | Self::ChebyshevJacobi(criteria)
            | Self::GaussSeidel(criteria) => criteria.check(),
        }
    }

    /// A solver for matrices of that pattern; `is_free[v]` says whether vertex `v` takes part, `rest` (m) where it is
    /// at rest. Only multigrid asks for that, to weight its levels with; without, all weights are equal, and it
    /// converges more slowly.
    ///
    /// # Errors
    /// [`BuildError::MatrixTooLarge`], [`BuildError::OutOfRange`].
    ///
    /// # Panics
    /// If `is_free` does not have one entry per row of the pattern.
    pub fn build(
        &self,
        pattern: &BlockPattern,
        is_free: &[bool],
        rest: Option<&[Vec3]>,
    ) -> Result<Box<dyn LinearSolver>, BuildError> {
        assert_eq!(is_free.len(), pattern.row_count(), "one flag per row");
        Ok(match *self {
            #[cfg(feature = "cholesky")]
            Self::Cholesky => Box::new(
                BlockCholesky::analyze(pattern, is_free).map_err(|_| BuildError::MatrixTooLarge)?,
            ),
            Self::ConjugateGradients(criteria) => Box::new(ConjugateGradients::new(
                is_free,
                Preconditioner::BlockJacobi,
                criteria,
            )?),
            Self::Multigrid(criteria) => {
                Box::new(MultigridGradients::new(is_free, rest, criteria)?)
            }
            Self::Jacobi(criteria) => Box::new(Jacobi::new(is_free, None, criteria)?),
            Self::ChebyshevJacobi(criteria) => {
                Box::new(ChebyshevJacobi::new(is_free, None, criteria)?)
            }
            Self::GaussSeidel(criteria) => Box::new(GaussSeidel::new(is_free, criteria)?),
        })
    }

    /// Whether the solver's success proves that the matrix is positive definite.
    #[must_use]
    pub fn proves_definiteness(&self) -> bool {
        match self {
            #[cfg(feature = "cholesky")]
            Self::Cholesky => true,
            _ => false,
        }
    }
}

/// `Σ a·b`.
pub(super) fn dot(a: &[Vec3], b: &[Vec3]) -> Real {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

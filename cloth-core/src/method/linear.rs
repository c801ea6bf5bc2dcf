//! Solvers for `A x = b`: one trait, [`LinearSolver`], over one matrix,
//! [`BlockMatrix`](crate::method::block_matrix::BlockMatrix).
//!
//! | solver | file |
//! |---|---|
//! | sparse Cholesky by blocks, `BlockCholesky` | `block_cholesky`, over `cholesky` |
//! | conjugate gradients, [`ConjugateGradients`] | `conjugate_gradients` |
//! | the same, preconditioned by a multigrid cycle, [`MultigridGradients`] | `multigrid_gradients` |
//! | around any operator, and ended early, [`TruncatedConjugateGradients`] | `truncated` |
//! | damped Jacobi, [`Jacobi`] | `jacobi` |
//! | Jacobi with Chebyshev acceleration, [`ChebyshevJacobi`] | `chebyshev` |
//! | Gauss–Seidel, [`GaussSeidel`] | `gauss_seidel` |
//!
//! [`LinearMethod`] names them; [`spectrum()`] estimates condition numbers. The factorisations need the feature
//! `cholesky`: `BlockCholesky`, `Cholesky` for a scalar matrix, `QuasidefiniteLdlt` for a saddle-point matrix,
//! `Inertia` to count eigenvalues.

#[cfg(feature = "cholesky")]
mod block_cholesky;
mod chebyshev;
#[cfg(feature = "cholesky")]
mod cholesky;
mod conjugate_gradients;
mod diagonal;
#[cfg(feature = "cholesky")]
mod fill;
mod gauss_seidel;
#[cfg(feature = "cholesky")]
mod inertia;
mod jacobi;
mod multigrid_gradients;
#[cfg(feature = "cholesky")]
mod quasidefinite;
mod solver;
mod spectrum;
mod truncated;

#[cfg(feature = "cholesky")]
pub use block_cholesky::{BlockCholesky, upper_half};
pub use chebyshev::ChebyshevJacobi;
#[cfg(feature = "cholesky")]
pub use cholesky::{Cholesky, CholeskyError, FactorView, UpperPattern};
pub use conjugate_gradients::{ConjugateGradients, Preconditioner};
#[cfg(feature = "cholesky")]
pub use fill::{Elimination, FillOrdering};
pub use gauss_seidel::GaussSeidel;
#[cfg(feature = "cholesky")]
pub use inertia::Inertia;
pub use jacobi::Jacobi;
pub use multigrid_gradients::MultigridGradients;
#[cfg(feature = "cholesky")]
pub use quasidefinite::QuasidefiniteLdlt;
pub use solver::{LinearError, LinearMethod, LinearReport, LinearSolver, StoppingCriteria};
pub use spectrum::{Spectrum, spectrum};
pub use truncated::TruncatedConjugateGradients;

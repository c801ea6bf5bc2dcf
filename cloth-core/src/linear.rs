//! Linear solvers over the matrices of this crate (CORE-12).

mod block_cholesky;
mod cholesky;
mod panel;
mod inertia;

pub use block_cholesky::BlockCholesky;
pub use cholesky::{Cholesky, CholeskyError, FactorView, UpperPattern};
pub use panel::PanelFactor;
pub use inertia::Inertia;

//! Linear solvers over the matrices of this crate (CORE-12).

mod block_cholesky;
mod cholesky;
mod inertia;
mod minres;
mod panel;
mod signed_cholesky;

pub use block_cholesky::BlockCholesky;
pub use cholesky::{Cholesky, CholeskyError, FactorView, UpperPattern};
pub use inertia::Inertia;
pub use minres::{KrylovEnd, Minres};
pub use panel::PanelFactor;
pub use signed_cholesky::SignedCholesky;

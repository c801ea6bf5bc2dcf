//! Linear solvers over the matrices of this crate (CORE-12).

mod block_cholesky;
mod cholesky;
mod inertia;
mod low_rank;
mod panel;

pub use block_cholesky::BlockCholesky;
pub use cholesky::{Cholesky, CholeskyError, FactorView, UpperPattern};
pub use inertia::Inertia;
pub use low_rank::LowRank;
pub use panel::PanelFactor;

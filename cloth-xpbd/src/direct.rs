//! The step of XPBD as one system, solved directly (XPBD-2), with geometric stiffness (XPBD-3). Behind the feature `direct`.
//!
//! # Idea
//! A sweep looks at one element at a time, and word of a pull travels one element per visit. Here all rows are linearised together, and one
//! linear system answers for all of them; a light chain with a heavy end takes as many iterations as any other.
//!
//! # Equations
//! Implicit Euler with the multipliers kept, λ being h² times those of the source (and the signs corrected, `f = Jᵀλ/h²`):
//!
//! ```text
//! M (x − x̃) − J(x)ᵀ λ = 0,   C(x) + α̃ λ = 0                                S1 (42)–(44)
//! ```
//!
//! Newton's method on both, with `H = M − Σ λ ∂²C` made positive definite:
//!
//! ```text
//! [ H  −Jᵀ ] [ Δx ]     [ M (x − x̃) − Jᵀλ ]
//! [ J   α̃  ] [ Δλ ]  = −[ C + α̃ λ          ]
//! ```
//!
//! With `H = M` alone, and once from `x⁰`, this is S1 (44) as printed. The published XPBD drops the first right-hand side and keeps `H = M`; we keep it, so that
//! the iteration ends at the implicit Euler step and not near it, and so that elastic energies and hard constraints can stand in one system.
//!
//! | equation | where |
//! |---|---|
//! | the system, scaled | `direct/kkt.rs` |
//! | `[H Jᵀ; J −α̃]`: `L D Lᵀ`, MINRES | `direct/saddle.rs` |
//! | `(J H⁻¹ Jᵀ + α̃) Δλ = …`: Cholesky, conjugate gradients | `direct/schur.rs` |
//! | `−Σ λ ∂²C ⪰ 0` | [`Constraint::geometric_stiffness`](cloth_core::element::Constraint::geometric_stiffness) |
//! | which of two iterates is better | `direct/merit.rs` |

mod builder;
mod config;
mod kkt;
mod linear;
mod merit;
mod rows;
mod saddle;
mod schur;
mod solver;

pub use builder::DirectBuilder;
pub use config::{DirectConfig, DirectStart, System};
pub use solver::{DirectXpbd, Residuals};

//! Projective dynamics.
#![forbid(unsafe_code)]

mod config;
mod global;
mod local;
#[cfg(feature = "parallel")]
mod parallel;
mod residual;
mod solver;

pub use config::{PdConfig, Start};
pub use solver::{PdBuilder, PdSolver};

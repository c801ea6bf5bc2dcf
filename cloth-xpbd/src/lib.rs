//! xpbd
#![forbid(unsafe_code)]

mod compliance;
mod config;
mod solver;

pub use config::XpbdConfig;
pub use solver::{XpbdBuilder, XpbdSolver};

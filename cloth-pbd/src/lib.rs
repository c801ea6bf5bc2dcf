//! pbd
#![forbid(unsafe_code)]

mod config;
mod solver;
mod stiffness;

pub use config::PbdConfig;
pub use solver::{PbdBuilder, PbdSolver};
pub use stiffness::{StiffnessRule, effective_stiffness, projection_stiffness};

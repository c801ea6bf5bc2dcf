//! Cloth as a mass-spring system.
#![forbid(unsafe_code)]

mod config;
mod explicit;
mod implicit;
mod stability;

pub use config::{
    Accept, ExplicitConfig, HessianPolicy, ImplicitConfig, StabilityCheck, StartGuess,
};
pub use explicit::{ExplicitBuilder, ExplicitEuler, SymplecticEuler};
pub use implicit::{ImplicitBuilder, ImplicitEuler};
pub use stability::stable_time_step;

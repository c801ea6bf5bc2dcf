//! The cloth, and what it costs to deform it: the common ground of all method crates.

pub mod math;
pub mod mesh;
pub mod topology;
pub mod particles;
pub mod pin;
pub mod element;
pub mod energy;
pub mod family;
pub mod coloring;
pub mod ordering;
mod parallel;
pub mod block_matrix;
#[cfg(feature = "cholesky")]
pub mod linear;
#[cfg(feature = "cholesky")]
pub mod dof;
pub mod step;
pub mod position_based;
pub mod measure;
pub mod check;
pub mod cloth;

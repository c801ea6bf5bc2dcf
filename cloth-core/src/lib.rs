//! The cloth, and what it costs to deform it.

pub mod math;
pub mod mesh;
pub mod ordering;
pub mod particles;
pub mod topology;

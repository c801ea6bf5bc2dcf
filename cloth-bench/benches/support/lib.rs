//! What the benches have in common: how they are run, and the sheet that they step.

pub mod limit;
pub mod sheet;

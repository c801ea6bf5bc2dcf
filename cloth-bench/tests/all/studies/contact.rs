//! The comparison with contact in it.

mod cylinder;
mod laws;
mod step;
mod survival;

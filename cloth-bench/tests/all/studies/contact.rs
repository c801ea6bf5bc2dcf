//! The comparison with contact in it.

mod cylinder;
mod laws;
mod meeting;
mod motion;
mod step;
mod survival;

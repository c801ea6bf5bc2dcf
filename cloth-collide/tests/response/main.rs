//! What cloth does where it touches itself or an obstacle.

#[path = "../support/random.rs"]
mod random;
mod flight;
mod laws;
mod safety;
mod stack;

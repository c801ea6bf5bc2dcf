//! What cloth does where it touches itself or an obstacle.

mod bad_input;
mod close_at_rest;
mod flight;
mod laws;
#[path = "../support/random.rs"]
mod random;
mod safety;
mod stack;

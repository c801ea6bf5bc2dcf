//! Contact constraints at the end of steps of free flight: what is promised holds, whatever the motion.

mod bad_input;
mod close_at_rest;
mod flight;
#[path = "../support/random.rs"]
mod random;
mod safety;

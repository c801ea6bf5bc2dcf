//! Contact constraints at the end of steps of free flight: what is guaranteed holds, whatever the motion.

use crate::random;
mod bad_input;
mod close_at_rest;
mod flight;
mod safety;

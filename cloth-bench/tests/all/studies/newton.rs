//! The study of Newton's method.

mod convexity;
mod overshoot;
mod steps;

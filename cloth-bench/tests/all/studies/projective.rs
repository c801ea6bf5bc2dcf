//! The study of projective dynamics.

mod swing;

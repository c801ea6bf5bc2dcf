//! The study of convergence.

mod variants;

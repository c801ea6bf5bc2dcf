//! Geometric stiffness.

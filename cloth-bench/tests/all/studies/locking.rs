//! The study of locking.

mod finer;
mod fold;
mod methods;
mod picture;
mod sphere;
mod sweeps;

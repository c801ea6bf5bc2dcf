//! The one hook for contact (COL-9): what a method asks of obstacles and of the cloth itself, without knowing of either.
//!
//! A method moves the cloth as if it were alone, and then shows where it would go. [`ContactSource::resolve`] changes that to a motion on which nothing passes through
//! anything. So every method can have contact, and one without a source in its [`StepInput`](crate::step::StepInput) runs no code for it.
//! The crate `cloth-collide` has the sources.

use crate::math::{Real, Vec3};
use std::fmt;

/// A step that a method has taken, seen from outside: where the cloth was, and what can be moved.
#[derive(Clone, Copy, Debug)]
pub struct ContactStep<'a> {
    /// Positions (m) at the start of the step, one per vertex.
    pub from: &'a [Vec3],
    /// Inverse masses (1/kg), one per vertex; 0 for a prescribed one.
    pub inverse_mass: &'a [Real],
    /// Step size Δt (s).
    pub dt: Real,
}

/// Whatever the cloth can touch.
pub trait ContactSource {
    /// Changes the end of a step so that it keeps what the source promises. Vertices move linearly from `step.from` to `positions` (m), which the method has found
    /// with the velocities `velocities` (m/s) there; both have one entry per vertex. Those of prescribed vertices must be left alone.
    ///
    /// Called once in a step, with finite positions and velocities. What was there before, if it is to be used again, the source has to keep.
    ///
    /// # Errors
    /// If the promise cannot be kept. The method then refuses the step, with its state as it was, and the source has to be as it was too.
    fn resolve(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<(), ContactError>;
}

/// Why contact could not be resolved.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ContactError {
    /// The source was made for another cloth.
    VertexCount {
        /// Number of vertices it was made for.
        expected: usize,
        /// Number of positions it got.
        found: usize,
    },
    /// A position or velocity is not finite.
    NonFinite {
        /// The first such vertex.
        vertex: usize,
    },
    /// The step starts with parts that pass through each other, so there is nothing to keep.
    Tangled {
        /// Number of pairs of triangles that do.
        pairs: usize,
    },
    /// Prescribed vertices or obstacles leave no way that is free.
    NoWay {
        /// A vertex that has none.
        vertex: u32,
    },
}

impl fmt::Display for ContactError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::VertexCount { expected, found } => write!(
                f,
                "contact was set up for {expected} vertices, but the cloth has {found}"
            ),
            Self::NonFinite { vertex } => {
                write!(
                    f,
                    "contact was asked about vertex {vertex}, which is not finite"
                )
            }
            Self::Tangled { pairs } => write!(
                f,
                "{pairs} pairs of triangles pass through each other at the start of the step; untangle them first"
            ),
            Self::NoWay { vertex } => write!(
                f,
                "prescribed vertices or obstacles leave no free way to vertex {vertex}"
            ),
        }
    }
}

impl std::error::Error for ContactError {}

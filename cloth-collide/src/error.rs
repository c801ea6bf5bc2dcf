//! What can be wrong with the positions that are to be measured.

use cloth_core::math::Real;
use std::fmt;

/// Why positions cannot be searched for contact.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CollideError {
    /// A coordinate is NaN or infinite: a step before this has diverged.
    NonFinitePosition {
        /// The first such vertex.
        vertex: usize,
    },
    /// The margin of a search is negative or not a finite number.
    InvalidMargin {
        /// What it was (m).
        margin: Real,
    },
    /// The time step is not a positive finite number.
    InvalidTimeStep {
        /// What it was (s).
        dt: Real,
    },
}

impl fmt::Display for CollideError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinitePosition { vertex } => write!(
                f,
                "vertex {vertex} has a coordinate that is not a finite number"
            ),
            Self::InvalidMargin { margin } => write!(
                f,
                "the margin is {margin} m, but it has to be a finite number that is not negative"
            ),
            Self::InvalidTimeStep { dt } => {
                write!(f, "the time step is {dt} s, but it has to be positive")
            }
        }
    }
}

impl std::error::Error for CollideError {}

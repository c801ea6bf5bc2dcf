//! What can be wrong with the positions that are to be measured.

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
}

impl fmt::Display for CollideError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinitePosition { vertex } => write!(
                f,
                "vertex {vertex} has a coordinate that is not a finite number"
            ),
        }
    }
}

impl std::error::Error for CollideError {}

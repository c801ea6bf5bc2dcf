//! What can be wrong with positions, and with what is asked of them.

use cloth_core::contact::ContactError;
use cloth_core::error::OutOfRange;
use std::fmt;

/// Why positions cannot be searched for contact, or not in the way asked for.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CollideError {
    /// A coordinate is NaN or infinite: a step before this has diverged.
    NonFinitePosition {
        /// The first such vertex.
        vertex: usize,
    },
    /// A setting is out of its range.
    OutOfRange(OutOfRange),
    /// Two vertices are so far apart, above 1e300 m, that their distance is not a number any more.
    TooFarApart,
}

/// The first vertex with a coordinate that is NaN or infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NonFinite {
    pub(crate) vertex: usize,
}

impl From<NonFinite> for CollideError {
    fn from(NonFinite { vertex }: NonFinite) -> Self {
        Self::NonFinitePosition { vertex }
    }
}

impl From<NonFinite> for ContactError {
    fn from(NonFinite { vertex }: NonFinite) -> Self {
        Self::NonFinite { vertex }
    }
}

impl fmt::Display for CollideError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinitePosition { vertex } => write!(
                f,
                "vertex {vertex} has a coordinate that is not a finite number"
            ),
            Self::OutOfRange(error) => write!(f, "the {error}"),
            Self::TooFarApart => write!(f, "two vertices are more than 1e300 m apart"),
        }
    }
}

impl std::error::Error for CollideError {}

impl From<OutOfRange> for CollideError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

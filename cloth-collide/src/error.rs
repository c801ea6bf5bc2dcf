//! What can be wrong with positions, and with what is asked of them.

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
    /// Two vertices are so far apart, above 1e300 m, that their distance is not a number any more.
    TooFarApart,
    /// A minimal separation is negative or not a number.
    Separation {
        /// What was given (m).
        separation: f64,
    },
    /// A slack is not in 0..1.
    Slack {
        /// What was given (dimensionless).
        slack: f64,
    },
}

impl fmt::Display for CollideError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinitePosition { vertex } => write!(
                f,
                "vertex {vertex} has a coordinate that is not a finite number"
            ),
            Self::Separation { separation } => write!(
                f,
                "the separation {separation} m is not a finite number, zero or more"
            ),
            Self::Slack { slack } => {
                write!(f, "the slack {slack} is not in the range from 0 to below 1")
            }
            Self::TooFarApart => write!(f, "two vertices are more than 1e300 m apart"),
        }
    }
}

impl std::error::Error for CollideError {}

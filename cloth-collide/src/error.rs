//! What can be wrong with positions, and with what is asked of them.

use cloth_core::contact::ContactError;
use cloth_core::math::Real;
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
    /// Two vertices are so far apart, above 1e300 m, that their distance is not a number any more.
    TooFarApart,
    /// A minimal separation is negative or not a number.
    Separation {
        /// What was given (m).
        separation: Real,
    },
    /// A slack is not in 0..1.
    Slack {
        /// What was given (dimensionless).
        slack: Real,
    },
}

impl CollideError {
    /// The same for a step with contact: coordinates are not finite, or too large to work with.
    pub(crate) fn not_finite(&self) -> ContactError {
        match self {
            Self::NonFinitePosition { vertex } => ContactError::NonFinite { vertex: *vertex },
            _ => ContactError::NonFinite { vertex: 0 },
        }
    }
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

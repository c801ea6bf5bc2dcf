//! A number out of its range: the one error of that kind, which the errors of all crates wrap.
//!
//! ```
//! use cloth_core::error::{OutOfRange, positive, within};
//! fn friction(value: f64) -> Result<f64, OutOfRange> {
//!     within((0.0..=1.0).contains(&value), "friction", value, "between 0 and 1")
//! }
//! assert_eq!(positive("mass (kg)", 2.0), Ok(2.0));
//! let error = friction(-1.0).unwrap_err();
//! assert_eq!(error.to_string(), "friction is -1, but it has to be between 0 and 1");
//! ```

use crate::math::Real;
use std::fmt;

/// A number is out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// Which one, with its unit.
    pub name: &'static str,
    /// What it was.
    pub value: Real,
    /// What it has to be.
    pub range: &'static str,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, value, range } = self;
        write!(f, "{name} is {value}, but it has to be {range}")
    }
}

impl std::error::Error for OutOfRange {}

/// The value if it `is_right`.
///
/// # Errors
/// [`OutOfRange`] if not.
pub fn within(
    is_right: bool,
    name: &'static str,
    value: Real,
    range: &'static str,
) -> Result<Real, OutOfRange> {
    let error = OutOfRange { name, value, range };
    is_right.then_some(value).ok_or(error)
}

/// The value if it is finite and above 0.
///
/// # Errors
/// [`OutOfRange`] if not.
pub fn positive(name: &'static str, value: Real) -> Result<Real, OutOfRange> {
    let is_right = value > 0.0 && value.is_finite();
    within(is_right, name, value, "a positive finite number")
}

/// The value if it is finite and not below 0.
///
/// # Errors
/// [`OutOfRange`] if not.
pub fn not_negative(name: &'static str, value: Real) -> Result<Real, OutOfRange> {
    let is_right = value >= 0.0 && value.is_finite();
    within(is_right, name, value, "zero or a positive finite number")
}

/// The value if it is finite.
///
/// # Errors
/// [`OutOfRange`] if not.
pub fn finite(name: &'static str, value: Real) -> Result<Real, OutOfRange> {
    within(value.is_finite(), name, value, "a finite number")
}

/// The value if it is a number, which may be infinite.
///
/// # Errors
/// [`OutOfRange`] if not.
pub fn number(name: &'static str, value: Real) -> Result<Real, OutOfRange> {
    within(!value.is_nan(), name, value, "a number")
}

/// The count if it is not 0.
///
/// # Errors
/// [`OutOfRange`] if it is.
pub fn at_least_one(name: &'static str, count: u32) -> Result<u32, OutOfRange> {
    within(count > 0, name, Real::from(count), "at least 1").map(|_| count)
}

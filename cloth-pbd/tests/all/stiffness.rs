//! The stiffness of a projection: its limits, and what of it is kept from visit to visit.

// How a number is rounded only shows here: elsewhere it changes nothing that is seen.
#[allow(dead_code, unreachable_pub)] // a part of the file is enough
#[path = "../../src/stiffness.rs"]
mod formula;

use cloth_core::math::Real;
use cloth_pbd::projection_stiffness;
use formula::{CachedScale, rounded};

#[test]
fn rounding_is_finer_than_promised_and_forgets_the_last_digits() {
    for w in [1e-300, 0.3, 1.0 / 3.0, 7e5, 1e300] {
        assert!((rounded(w) - w).abs() < 2.3e-13 * w);
    }
    assert_eq!(rounded(40.0 * (1.0 + 4.0 * Real::EPSILON)), 40.0);
    assert_eq!(rounded(40.0 * (1.0 - 4.0 * Real::EPSILON)), 40.0);
}

#[test]
fn stiffness_of_a_projection_has_its_limits() {
    assert_eq!(projection_stiffness(0.0, 7), 0.0);
    assert_eq!(projection_stiffness(Real::INFINITY, 7), 1.0);
    // Soft: s → z/n, to the last digits.
    let s = projection_stiffness(1e-14, 4);
    assert!((s - 0.25e-14).abs() < 1e-28, "{s}");
    assert!(projection_stiffness(-0.5, 7) < 0.0);
    for nothing in [-2.0, Real::NAN] {
        assert!(projection_stiffness(nothing, 7).is_nan());
    }
}

#[test]
fn a_row_is_stored_in_24_bytes() {
    assert_eq!(size_of::<CachedScale>(), 24);
}

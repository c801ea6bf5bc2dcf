//! Backtracking along a direction of descent.

use cloth_core::math::Real;
use cloth_core::method::line_search::{Trial, backtrack};

/// φ(α) = α² − 2 α·0.3: from α = 1 the parabola through φ(0), φ'(0) and φ(1) is φ itself.
#[test]
fn the_second_length_is_the_minimum_of_a_parabola() {
    let mut tried = Vec::new();
    let found = backtrack(-0.6, 1.0, 10, |length| {
        tried.push(length);
        let rise = length * length - 0.6 * length;
        Trial {
            rise,
            accepted: rise <= -0.05,
        }
    });
    assert_eq!((found.accepted, found.backtracks), (true, 1));
    assert!((tried[1] - 0.3).abs() < 1e-15);
}

#[test]
fn lengths_stay_between_a_tenth_and_a_half_of_the_one_before() {
    for (rise, factor) in [
        (Real::NAN, 0.5),
        (Real::INFINITY, 0.1),
        (1e9, 0.1),
        (-0.9, 0.5),
    ] {
        let mut tried = Vec::new();
        let found = backtrack(-1.0, 2.0, 3, |length| {
            tried.push(length);
            Trial {
                rise: rise * length,
                accepted: false,
            }
        });
        assert!(!found.accepted && found.backtracks == 3);
        assert!(
            (tried[1] - 2.0 * factor).abs() < 1e-8 && (tried[2] - tried[1] * factor).abs() < 1e-8
        );
    }
}

//! When an iteration that is too slow is given up.

// A step that is given up ends at the same minimum by another method: the rule only shows here.
#[path = "../../src/implicit/progress.rs"]
mod rule;

use cloth_core::math::Real;
use rule::Progress;

/// The iteration at which a decrement that falls by `factor` in each is given up, on its way to 1e-6.
fn given_up(factor: Real) -> Option<u32> {
    let mut progress = Progress::new();
    let decrement = |iteration: u32| factor.powi(iteration as i32);
    (1..5000)
        .take_while(|&iteration| decrement(iteration) > 1e-6)
        .find(|&iteration| progress.is_too_slow(iteration, decrement(iteration), 1e-6))
}

#[test]
fn what_needs_a_thousand_iterations_more_is_given_up_after_three_windows() {
    assert_eq!(given_up(0.98), None);
    assert_eq!(given_up(0.985), None);
    assert_eq!(given_up(0.99), Some(300));
    assert_eq!(given_up(0.9999), Some(300));
    assert_eq!(given_up(1.0), Some(300));
}

/// With a decrement of 1 a whole step promises ½: a fall of 0.005 in a window is as much as has to be.
#[test]
fn steps_that_contact_cuts_to_nothing_are_given_up_after_a_window() {
    let stalled = |fall: Real| {
        let mut progress = Progress::new();
        (1..1000).find(|&number| progress.is_stalled(number, -fall * Real::from(number), 1.0))
    };
    assert_eq!(stalled(5.1e-5), None);
    assert_eq!(stalled(4.9e-5), Some(200));
    assert_eq!(stalled(0.0), Some(200));
}

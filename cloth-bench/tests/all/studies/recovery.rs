//! Starts that a method recovers from.

use cloth_bench::studies::recovery::{RUNS, cell};

/// PBD stretches far more than the cloth it is given, from any start; that is not a failure to recover.
#[test]
fn a_method_is_held_against_its_own_rest() {
    let found = cell(5, 150, "mirrored", "pbd").unwrap();
    let of_newton = cell(5, 150, "mirrored", "implicit-euler").unwrap().rest.0;
    assert!(found.rest.0 > 2.0 * of_newton, "{found:?}");
    assert_eq!(found.recovered, RUNS, "{found:?}");
}

#[test]
fn implicit_euler_recovers_from_a_point() {
    let found = cell(5, 150, "collapsed", "implicit-euler").unwrap();
    assert_eq!(found.recovered, RUNS, "{found:?}");
}

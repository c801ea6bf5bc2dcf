//! Starts that a method recovers from.

use cloth_bench::method::Method;
use cloth_bench::studies::recovery::{Outcome, RUNS, cell};
use cloth_bench::studies::variants::Variant;

fn published(start: &str, name: &str) -> Outcome {
    let variant = Variant::published(Method::find(name).unwrap());
    cell(5, 150, start, &variant).unwrap()
}

/// PBD stretches far more than the cloth it is given, from any start; that is not a failure to recover.
#[test]
fn a_method_is_held_against_its_own_rest() {
    let found = published("mirrored", "pbd");
    let of_newton = published("mirrored", "implicit-euler").rest.0;
    assert!(found.rest.0 > 2.0 * of_newton, "{found:?}");
    assert_eq!(found.recovered, RUNS, "{found:?}");
}

#[test]
fn implicit_euler_recovers_from_a_point() {
    let found = published("collapsed", "implicit-euler");
    assert_eq!(found.recovered, RUNS, "{found:?}");
}

//! A step in contact, against its minimiser.

use cloth_bench::method::Method;
use cloth_bench::settings::Settings;
use cloth_bench::studies::Scope;
use cloth_bench::studies::contact::step::{ContactProblem, refined};

#[test]
fn every_way_of_the_study_takes_its_step() {
    let problem = ContactProblem::new(9).unwrap();
    for (variant, key, values) in refined(Scope::Quick) {
        let method = Method::find(variant.method()).unwrap();
        let settings = variant.settings.clone().with(key, &values[0]);
        let reached = problem.reached(method, &settings);
        assert!(reached.is_ok(), "{}: {:?}", variant.label, reached.err());
    }
}

/// Implicit Euler gets as near to the minimiser as its tolerance says, projective dynamics with enough iterations,
/// and the sweeps of XPBD in one substep come nearer slowly.
#[test]
fn methods_approach_the_minimiser_with_contact() {
    let problem = ContactProblem::new(13).unwrap();
    let error = |name: &str, key: &str, values: [&str; 3]| {
        let method = Method::find(name).unwrap();
        let settings = Settings::default();
        let settings = match name {
            "xpbd" => settings.with("substeps", 1),
            _ => settings,
        };
        let reached = |value| problem.reached(method, &settings.clone().with(key, value));
        values.map(|value| reached(value).unwrap().position.0)
    };
    let implicit = error("implicit-euler", "tolerance", ["1e-2", "1e-4", "1e-6"]);
    assert!(implicit[0] < 0.1 && implicit[2] < 2e-5, "{implicit:?}");
    let pd = error("pd", "iterations", ["10", "100", "1000"]);
    assert!(pd[0] > 1.0 && pd[2] < 1e-4, "{pd:?}");
    let xpbd = error("xpbd", "iterations", ["10", "100", "1000"]);
    assert!(xpbd.is_sorted_by(|a, b| a > b) && xpbd[2] > 0.1, "{xpbd:?}");
}

//! Settings and the tables that read them.

use cloth_bench::error::BenchError;
use cloth_bench::settings::{Auto, Or, Range, Settings, Table};
use cloth_core::math::Real;

cloth_bench::settings! {
    /// Of a test.
    struct Chain {
        stiffness: Real = 1e4 "N/m" in Range::Above(0.0), "k of every link";
        iterations: u32 = 10 in Range::AtLeast(1.0), "sweeps of a step";
        collides as "self": bool = "no", "whether it touches itself";
        strain: Or<Auto, Real> = "auto", "strain to be left";
    }
}

fn read(pairs: &[&str]) -> Result<Chain, BenchError> {
    Chain::read(&Settings::parse(pairs).unwrap())
}

#[test]
fn the_last_value_of_a_key_holds_and_defaults_fill_in() {
    let set = Settings::parse(&["stiffness = 5"]).unwrap();
    let chain = Chain::read(&set.with("stiffness", 7).with_defaults("iterations=3")).unwrap();
    assert_eq!((*chain.stiffness, *chain.iterations), (7.0, 3));
    assert!(chain.stiffness.is_given() && !chain.iterations.is_given());
    assert_eq!(*chain.strain, Or::Word(Auto::Auto));
    assert_eq!(*read(&["strain=0.1"]).unwrap().strain, Or::Value(0.1));
    assert!(*read(&["self=yes"]).unwrap().collides);
}

#[test]
fn a_parameter_says_what_the_field_does() {
    let [stiffness, iterations, collides, _] = Chain::PARAMETERS else {
        panic!("four fields");
    };
    assert_eq!((stiffness.default, stiffness.unit), ("1e4", "N/m"));
    assert_eq!(stiffness.explained(), "(N/m, above 0) k of every link");
    assert_eq!(iterations.explained(), "(at least 1) sweeps of a step");
    assert_eq!((collides.name, collides.default), ("self", "no"));
}

#[test]
fn an_unknown_key_is_answered_with_the_nearest_known_one() {
    let set = Settings::parse(&["stifness=5"]).unwrap();
    let message = set
        .check("scene `hang`", &[Chain::PARAMETERS])
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("`stifness`") && message.contains("`stiffness`"),
        "{message}"
    );
}

#[test]
fn what_the_tables_do_not_know_stays_behind() {
    let set = Settings::parse(&["stiffness=5", "other=1"]).unwrap();
    assert_eq!(
        set.among(&[Chain::PARAMETERS]),
        Settings::parse(&["stiffness=5"]).unwrap()
    );
}

#[test]
fn values_out_of_range_are_refused_by_name() {
    for pair in [
        "stiffness=nan",
        "stiffness=-1",
        "stiffness=x",
        "iterations=0",
        "strain=few",
    ] {
        let error = read(&[pair]).unwrap_err().to_string();
        let (name, value) = pair.split_once('=').unwrap();
        assert!(
            error.starts_with(&format!("{name} is `{value}`")),
            "{error}"
        );
    }
    let error = read(&["self=maybe"]).unwrap_err().to_string();
    assert_eq!(error, "unknown self `maybe` (known: yes, no)");
    assert!(Settings::parse(&["iterations"]).is_err());
    assert!(Settings::parse(&["=3"]).is_err());
    assert!(Settings::parse(&["iterations=1", " iterations = 1"]).is_err());
}

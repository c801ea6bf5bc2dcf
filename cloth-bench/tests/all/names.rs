//! Answers to names that are not known.

use cloth_bench::names::{nearest, unknown};

const METHODS: [&str; 5] = ["implicit-euler", "implicit-midpoint", "pbd", "xpbd", "pd"];

#[test]
fn swapped_letters_are_one_mistake() {
    assert_eq!(nearest("xpdb", &METHODS), Some("xpbd"));
    assert_eq!(nearest("implicit-uelr", &METHODS), Some("implicit-euler"));
}

#[test]
fn case_and_beginnings_are_forgiven() {
    assert_eq!(nearest("XPBD", &METHODS), Some("xpbd"));
    assert_eq!(nearest("implicit-m", &METHODS), Some("implicit-midpoint"));
}

#[test]
fn nothing_near_gives_no_suggestion() {
    assert_eq!(nearest("conjugate-gradient", &METHODS), None);
    assert_eq!(nearest("", &METHODS), None);
    assert_eq!(
        unknown("scene", "x", &[]),
        "unknown scene `x` (known: none)"
    );
}

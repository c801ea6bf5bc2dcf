use super::*;

#[test]
fn polynomial_is_positive_as_far_as_its_hull() {
    assert_eq!(positive_until([1.0, 0.5, 0.5, 1e-300]), 1.0);
    assert_eq!(positive_until([0.0, 1.0]), 0.0);
    assert_eq!(positive_until([1.0, -1.0]), 0.5);
    // The line from (0, 1) to (2/3, −1); and that from (1/3, 1/10), which is below it.
    assert!((positive_until([1.0, 0.25, -1.0, 3.0]) - 1.0 / 3.0).abs() < 1e-15);
    assert!((positive_until([9.0, 0.1, -0.1, 3.0]) - 0.5).abs() < 1e-15);
}

/// However little is missing at the end, it is not the end.
#[test]
fn zero_or_less_at_the_end_is_not_reached() {
    for last in [0.0, -1e-300, -1e-30, -1e-17] {
        assert!(positive_until([1.0, last]) < 1.0);
        assert!(positive_until([1.0, 1.0, 1.0, last]) < 1.0);
    }
}

//! Numbers in the journal.

use cloth_bench::journal::Number;

#[test]
fn numbers_come_back_with_all_bits() {
    for number in [
        0.1,
        -0.0,
        5e-324,
        f64::MAX,
        1.0 / 3.0,
        f64::INFINITY,
        -f64::INFINITY,
    ] {
        let text = serde_json::to_string(&Number(number)).unwrap();
        let back: Number = serde_json::from_str(&text).unwrap();
        assert_eq!(back.0.to_bits(), number.to_bits());
    }
    let none: Number = serde_json::from_str("\"NaN\"").unwrap();
    assert!(none.0.is_nan());
}

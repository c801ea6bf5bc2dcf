//! How the table that leads the report judges.

use cloth_bench::report::table::Mark;
use cloth_bench::studies::decision::Row;
use cloth_bench::studies::decision::columns::Rule;
use cloth_bench::studies::decision::measure::Cost;
use cloth_core::math::Real;

#[test]
fn real_time_follows_the_power_law() {
    let cost = Cost {
        sides: [10, 20],
        // Proportional to the power 1.5 of the vertices.
        ms: [Some(1.0), Some(8.0)],
        memory: None,
    };
    let row = Row {
        method: "pd",
        cost: Some(cost),
        step: None,
        contact: None,
    };
    let expected = 100.0 * (1000.0 / 60.0_f64).powf(2.0 / 3.0);
    assert!((row.real_time().unwrap() / expected - 1.0).abs() < 1e-12);
    // Where the time has hardly grown yet, as at small sizes, it is taken to grow as the vertices do.
    let flat = Cost {
        sides: [10, 20],
        ms: [Some(1.0), Some(1.1)],
        memory: None,
    };
    let row = Row {
        cost: Some(flat),
        ..row
    };
    let expected = 100.0 * 1000.0 / 60.0;
    assert!((row.real_time().unwrap() / expected - 1.0).abs() < 1e-12);
}

#[test]
fn marks_tell_the_best_from_the_unfit() {
    let marks =
        |rule: Rule, values: [Real; 4]| values.map(|value| rule.judge(value, &values, Some(1.0)));
    let (best, plain, unfit) = (Mark::Best, Mark::Plain, Mark::Unfit);
    let ten_times = marks(Rule::Cost, [1.0, 1.04, 9.0, 11.0]);
    assert_eq!(ten_times, [best, best, plain, unfit]);
    let a_tenth = marks(Rule::Gain, [100.0, 96.0, 11.0, 9.0]);
    assert_eq!(a_tenth, [best, best, plain, unfit]);
    let below = marks(Rule::Below(0.1), [0.0, 1e-9, 0.1, 0.2]);
    assert_eq!(below, [best, plain, plain, unfit]);
    let above = marks(Rule::Above(1e4), [1e9, 1e8, 1e4, 1e3]);
    assert_eq!(above, [best, plain, plain, unfit]);
    let near = marks(Rule::Reference(0.5), [1.0, 0.96, 1.5, 1.6]);
    assert_eq!(near, [best, best, plain, unfit]);
    assert_eq!(
        marks(Rule::One, [1.0, 0.8, 0.6, 0.4]),
        [best, best, plain, unfit]
    );
}

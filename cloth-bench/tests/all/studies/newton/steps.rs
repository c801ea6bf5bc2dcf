//! Iterations until a step is solved.

use cloth_bench::studies::newton::steps::first_within;
use cloth_bench::yardstick::{Sample, StepError};
use cloth_core::math::Real;

#[test]
fn a_lower_minimum_is_not_reached_where_it_passes_the_other() {
    let sample = |(iteration, objective): (u32, Real)| Sample {
        iteration,
        seconds: Real::from(iteration),
        error: StepError {
            objective,
            gradient: 0.0,
        },
    };
    let trace = |values: [Real; 4]| (1..).zip(values).map(sample).collect::<Vec<_>>();
    let same = trace([1e-2, 1e-5, 1e-9, 1e-13]);
    assert_eq!(first_within(1e-8, &same), Some((3, 3.0)));
    let lower = trace([1e-2, -1e-5, -2e-5, -2e-5 - 1e-12]);
    assert_eq!(first_within(1e-8, &lower), Some((3, 3.0)));
    let higher = trace([1e-2, 1e-3, 1e-4, 1e-5]);
    assert_eq!(first_within(1e-8, &higher), None);
    assert_eq!(first_within(1e-3, &[]), None);
}

//! Interleaved timing.

use cloth_bench::error::BenchError;
use cloth_bench::studies::interleaved::{ENOUGH, Interleaved, interleaved};
use cloth_core::math::Real;

/// A machine that is slower from round to round, and once hiccups in one variant only.
#[test]
fn ratios_are_those_of_the_variants_on_a_machine_that_changes_its_speed() {
    let mut runs: usize = 0;
    let measured = interleaved::<3>(0.0, |variant| {
        let round = (runs / 3) as Real;
        assert_eq!(variant, runs % 3);
        runs += 1;
        let slower = [round, 1e6][usize::from(runs == 41)];
        Ok([1.0, 2.0, 0.5][variant] * slower)
    });
    // Round 0 warms up, 1 to 15 count: the median is that of round 8.
    let expected = Interleaved {
        seconds: [8.0, 16.0, 4.0],
        ratios: [1.0, 2.0, 0.5],
        upper: [1.0, 2.0, 0.5],
    };
    assert_eq!(measured, Ok(expected));
    assert_eq!(runs, 3 * (ENOUGH + 1));
}

#[test]
fn an_error_ends_it() {
    let broken = BenchError::Failed("broken".into());
    let measured = interleaved::<2>(0.0, |variant| match variant {
        0 => Ok(1.0),
        _ => Err(broken.clone()),
    });
    assert_eq!(measured, Err(broken));
}

//! Timing: of one piece of work, and interleaved of several variants of it, one run of each per round.

use crate::studies::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// How long (s) `work` takes.
pub(super) fn timed<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<Real, E> {
    let started = Instant::now();
    black_box(work()?);
    Ok(started.elapsed().as_secs_f64())
}

/// Rounds that are enough once they have lasted long enough.
pub const ENOUGH: usize = 15;
const MOST: usize = 200;
/// Time (s) after which one round is enough.
const LONG: Real = 10.0;

/// What [`interleaved`] measures.
#[derive(Debug, PartialEq)]
pub struct Interleaved<const N: usize> {
    /// Median time (s) of each variant.
    pub seconds: [Real; N],
    /// Medians of the times over that of the first variant in the same round (dimensionless).
    pub ratios: [Real; N],
    /// Upper quartiles of these ratios: three rounds of four are below.
    pub upper: [Real; N],
}

/// Compares `N` variants, of which `time` runs the one with that index and gives its time (s): in rounds of one run of
/// each, for `least` seconds, after one that warms up.
///
/// What slows the machine for a while slows a whole round, and so leaves the ratios within it alone. Of shortest times,
/// each may come from another while.
pub fn interleaved<const N: usize>(
    least: Real,
    mut time: impl FnMut(usize) -> Result<Real, BenchError>,
) -> Result<Interleaved<N>, BenchError> {
    let mut round = || {
        let mut seconds = [0.0; N];
        for (variant, seconds) in seconds.iter_mut().enumerate() {
            *seconds = time(variant)?;
        }
        Ok::<_, BenchError>(seconds)
    };
    let started = Instant::now();
    round()?;
    let mut rounds: Vec<[Real; N]> = Vec::new();
    let is_enough = |rounds: usize| {
        let seconds = started.elapsed().as_secs_f64();
        let long_enough = seconds >= least && rounds >= ENOUGH;
        long_enough || seconds > LONG || rounds >= MOST
    };
    while rounds.is_empty() || !is_enough(rounds.len()) {
        rounds.push(round()?);
    }
    let each = |value: fn(&[Real; N], usize) -> Real| {
        let over =
            |variant| -> Vec<Real> { rounds.iter().map(|round| value(round, variant)).collect() };
        std::array::from_fn(|variant| median(&mut over(variant)))
    };
    Ok(Interleaved {
        seconds: each(|round, variant| round[variant]),
        ratios: each(|round, variant| round[variant] / round[0]),
        upper: std::array::from_fn(|variant| {
            let ratios = rounds.iter().map(|round| round[variant] / round[0]);
            let ratios = ratios.sorted_by(Real::total_cmp).collect_vec();
            ratios[3 * (ratios.len() - 1) / 4]
        }),
    })
}

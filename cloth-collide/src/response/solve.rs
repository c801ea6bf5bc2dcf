//! All contacts at once: projected Gauss–Seidel, accelerated by conjugate directions.

use super::row::Row;
use cloth_core::math::{Real, Vec3};

/// No solve takes more sweeps than this.
pub(super) const MOST_SWEEPS: u32 = 100;

/// Changes `x` (positions in m or velocities in m/s) to the nearest values in the metric of the masses that satisfy all `rows`, with friction; goes on from
/// the multipliers that the rows have, whose part of `x` is already in it. Ends when no row has to be corrected by more than a tenth of its tolerance.
/// Returns the number of sweeps.
///
/// One sweep takes the rows in turn. With one row it is exact. Through a pile of n layers it takes about n² sweeps, so between sweeps the multipliers go on in a conjugate
/// direction (Silcowitz-Hansen, Niebe and Erleben 2010), the change by a sweep being taken for the gradient: about n.
pub(super) fn solve(rows: &mut [Row], inverse_mass: &[Real], x: &mut [Vec3]) -> u32 {
    for row in &mut *rows {
        row.direction = Vec3::zeros();
    }
    let mut before = 0.0;
    for count in 1..=MOST_SWEEPS {
        let swept = sweep(rows, inverse_mass, x);
        if swept.largest <= 0.1 || count == MOST_SWEEPS {
            return count;
        }
        let share = swept.squared / before;
        before = swept.squared;
        // In the first sweep there is no direction yet, and the share is infinite.
        let share = if share <= 1.0 { share } else { 0.0 };
        for row in &mut *rows {
            let onward = row.direction * share;
            row.direction = onward + row.change;
            if onward != Vec3::zeros() {
                row.multiplier += onward;
                row.apply(onward, inverse_mass, x);
            }
        }
    }
    MOST_SWEEPS
}

/// How much a sweep has changed.
struct Swept {
    /// The largest correction of a row, in tolerances of that row.
    largest: Real,
    /// Σ ‖Δλ‖²/mass.
    squared: Real,
}

fn sweep(rows: &mut [Row], inverse_mass: &[Real], x: &mut [Vec3]) -> Swept {
    let mut swept = Swept {
        largest: 0.0,
        squared: 0.0,
    };
    for row in rows {
        let point = row.point(x);
        let along = row.normal.dot(&row.multiplier);
        let excess = row.normal.dot(&point) - row.offset;
        let pressure = (along - excess * row.mass).max(0.0);
        let mut wanted = row.normal * pressure;
        if row.friction > 0.0 && pressure > 0.0 {
            let slip = point - row.anchor;
            let across = |v: Vec3| v - row.normal * row.normal.dot(&v);
            let held = across(row.multiplier) - across(slip) * row.mass;
            let limit = row.friction * pressure;
            let size = held.norm();
            wanted += if size > limit {
                held * (limit / size)
            } else {
                held
            };
        }
        row.change = wanted - row.multiplier;
        row.multiplier = wanted;
        row.apply(row.change, inverse_mass, x);
        let squared = row.change.norm_squared() / row.mass;
        swept.squared += squared;
        let allowed = row.mass * row.tolerance.powi(2);
        swept.largest = swept.largest.max(squared / allowed);
    }
    swept.largest = swept.largest.sqrt();
    swept
}

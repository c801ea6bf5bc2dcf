//! The walk in `f64`, which nearly always is all that is needed.

use super::Walk;
use crate::ccd::difference::{Feature, NearestFeature};
use crate::ccd::direction::steady;
use crate::ccd::{Impact, Stop};
use cloth_core::math::{Real, Vec3};

impl<const K: usize> Walk<K>
where
    [Vec3; K]: NearestFeature,
{
    /// Walks in `f64`, at most `budget` steps. Also tells which fraction of the motion it would have tried next.
    pub(super) fn coarse(&self, slack: Real, budget: u32) -> (Option<Impact>, Real) {
        let Self { polygon, margin } = self;
        if margin.apart_along_an_axis(&polygon.from.rounded, &polygon.to.rounded) {
            return (None, 1.0);
        }
        let (mut time, mut trial, mut goal) = (0.0, 1.0, 0.0);
        let mut before: Option<[Real; 2]> = None;
        let mut x = polygon.from.rounded;
        for steps in 1..=budget {
            let stopped = |stop: Stop| Some(Impact { time, stop });
            let feature = x.nearest_feature();
            let Some((direction, gap)) = self.best_steady(feature, &x) else {
                return (stopped(Stop::Contact), trial);
            };
            if steps == 1 {
                goal = slack * gap;
            }
            // Where rounding hides the gap, it may still be as large as the rounding.
            let plausible = gap.max(Real::EPSILON * margin.size);
            trial = next_trial(trial, plausible, before);
            if gap <= 0.0 {
                return (stopped(Stop::Contact), trial);
            }
            if gap <= goal {
                return (stopped(Stop::Slack), trial);
            }
            let far = margin.steady_reach(direction, &x, &polygon.to.rounded);
            let mut next = part_of([time, 1.0], far);
            let until = (time + trial).min(1.0);
            if next < until {
                let (start, end) = (x.map(Into::into), polygon.at(until));
                for feature in <[Vec3; K]>::containing(feature) {
                    let reach = self.reach_of(feature, &start, &end);
                    next = next.max(part_of([time, until], reach));
                }
            }
            if next >= 1.0 {
                return (None, trial);
            }
            if next <= time {
                return (stopped(Stop::Contact), trial);
            }
            trial = match (next - time) / trial {
                whole if next >= until && whole >= 0.5 => 8.0 * trial,
                much if much >= 0.25 => 0.5 * trial,
                _ => 0.125 * trial,
            };
            before = Some([next - time, gap]);
            time = next;
            x = polygon.at(time).map(Into::into);
        }
        let stop = Stop::Budget;
        (Some(Impact { time, stop }), trial)
    }

    /// The steady direction that certifies the largest certified gap at `x`, and this gap (own unit).
    fn best_steady(&self, feature: Feature, x: &[Vec3; K]) -> Option<(Vec3, Real)> {
        <[Vec3; K]>::containing(feature)
            .filter_map(|feature| steady(feature, x))
            .map(|direction| (direction, self.margin.certified_gap(direction, x)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The fraction of the motion to try next: not much more than twice as far as where a straight line through the last
/// two gaps meets zero. `before` holds the last advance and the gap ahead of it.
fn next_trial(trial: Real, gap: Real, before: Option<[Real; 2]>) -> Real {
    match before {
        Some([advance, earlier]) if earlier > gap => {
            let zero = advance * gap / (earlier - gap);
            trial.min(2.0 * zero)
        }
        _ => trial.min(1.0),
    }
}

/// The time at the fraction `reach` of the interval, rounded down.
fn part_of([from, to]: [Real; 2], reach: Real) -> Real {
    if reach >= 1.0 {
        return to;
    }
    // `reach` and the product are each right to a few roundings; the sum rounds once more.
    let certain = 1.0 - 8.0 * Real::EPSILON;
    (from + (to - from) * reach * certain).next_down().max(from)
}

#[cfg(test)]
#[path = "../../../tests/unit/ccd_advance_coarse.rs"]
mod tests;

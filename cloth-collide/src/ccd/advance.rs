//! The walk through time: from one certified moment to the next, until contact or the end.

use super::difference::{Difference, Feature, NearestFeature};
use super::direction::{moving, steady};
use super::number::{Double, Number, Triple, value};
use super::reach::Margin;
use super::{Impact, Stop};
use cloth_core::math::{Real, Vec3};

/// What was found, and after how many steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    pub(super) impact: Option<Impact>,
    pub(super) steps: u32,
}

/// Walks along the motion of `polygon` while it is certain to be further than `separation` (m) from the origin. Ends
/// when the distance beyond that has shrunk to the fraction `slack` of what it was at the start.
pub(super) fn walk<const K: usize>(polygon: &Difference<K>, separation: Real, slack: Real) -> Walk
where
    [Vec3; K]: NearestFeature,
{
    let margin = Margin {
        separation: separation * polygon.scale,
        size: polygon.size,
    };
    let (walk, trial) = coarse(polygon, margin, slack);
    match walk.impact {
        Some(Impact { time, stop }) if separation == 0.0 && stop != Stop::Slack => {
            if stop == Stop::Contact && goes_through(polygon, margin, time, trial) {
                return walk;
            }
            let fine = fine(polygon, margin, time, trial);
            Walk {
                steps: walk.steps + fine.steps,
                ..fine
            }
        }
        _ => walk,
    }
}

/// Whether, as far as `f64` can tell, the origin goes through the inside of the face within a few `trial`s after `time`. Then there is no need
/// to look closer. A wrong yes would be a contact too many, which is safe.
fn goes_through<const K: usize>(
    polygon: &Difference<K>,
    margin: Margin,
    time: Real,
    trial: Real,
) -> bool
where
    [Vec3; K]: NearestFeature,
{
    let before = polygon.at(time).map(Into::into);
    let after = polygon.at((time + 8.0 * trial).min(1.0)).map(Into::into);
    let inside = |x: &[Vec3; K]| x.nearest_feature() == Feature::Face;
    inside(&before)
        && inside(&after)
        && steady(Feature::Face, &before).is_some_and(|n| margin.clearance(-n, &after) > 0.0)
}

/// An advance in time that leads nowhere: the numbers end soon after.
const SHORTEST_ADVANCE: Real = 1e-31;

/// Steps in `f64` before giving up.
pub(super) const COARSE_STEPS: u32 = 96;

/// Steps in `f64` before it is left to double precision, if that can be used.
const PATIENCE: u32 = 24;

/// Steps in double precision before giving up.
pub(super) const FINE_STEPS: u32 = 64;

/// The walk in `f64`. Also tells over which part of the step it would have tried to go next.
fn coarse<const K: usize>(polygon: &Difference<K>, margin: Margin, slack: Real) -> (Walk, Real)
where
    [Vec3; K]: NearestFeature,
{
    let (mut time, mut trial, mut goal) = (0.0, 1.0, 0.0);
    let mut before: Option<[Real; 2]> = None;
    let mut x = polygon.from.rounded;
    let budget = if margin.separation == 0.0 {
        PATIENCE
    } else {
        COARSE_STEPS
    };
    for steps in 1..=budget {
        let ended = |impact: Option<Impact>| Walk { impact, steps };
        let stopped = |stop: Stop| ended(Some(Impact { time, stop }));
        let feature = x.nearest_feature();
        let Some((direction, clearance)) = best_steady(margin, feature, &x) else {
            return (stopped(Stop::Contact), trial);
        };
        if steps == 1 {
            goal = slack * clearance;
        }
        // Where rounding hides the clearance, it may still be as large as the rounding.
        let plausible = clearance.max(Real::EPSILON * margin.size);
        trial = next_trial(trial, plausible, before);
        if clearance <= 0.0 {
            return (stopped(Stop::Contact), trial);
        }
        if clearance <= goal {
            return (stopped(Stop::Slack), trial);
        }
        let far = margin.steady_reach(direction, &x, &polygon.to.rounded);
        let mut next = part_of([time, 1.0], far);
        let until = (time + trial).min(1.0);
        if next < until {
            let (start, end) = (x.map(Into::into), polygon.at(until));
            for feature in with_face(feature) {
                let reach = reach_of(margin, feature, &start, &end);
                next = next.max(part_of([time, until], reach));
            }
        }
        if next >= 1.0 {
            return (ended(None), trial);
        }
        if next <= time {
            return (stopped(Stop::Contact), trial);
        }
        before = Some([next - time, clearance]);
        time = next;
        x = polygon.at(time).map(Into::into);
    }
    let impact = Some(Impact {
        time,
        stop: Stop::Budget,
    });
    (
        Walk {
            impact,
            steps: budget,
        },
        trial,
    )
}

/// The walk in double precision from `time` on, which `coarse` has reached, trying the part `trial` of the motion first. It
/// decides whether the two touch or only come nearer than `f64` can tell, and goes on if they do not touch.
///
/// So near, what the nearest feature is cannot be told in `f64` either. All are tried, first the one that led furthest last.
fn fine<const K: usize>(polygon: &Difference<K>, margin: Margin, time: Real, trial: Real) -> Walk
where
    [Vec3; K]: NearestFeature,
{
    let features = <[Vec3; K]>::FEATURES;
    let (mut now, mut trial) = (Double::new(time, 0.0), trial);
    let mut x = polygon.at(now);
    let mut favourite = 0;
    let mut growth = 8.0;
    for steps in 1..=FINE_STEPS {
        let rest = (Double::new(1.0, 0.0) - now).value();
        let whole = trial >= rest;
        let until = if whole {
            Double::new(1.0, 0.0)
        } else {
            now + Double::new(trial, 0.0)
        };
        let end = polygon.at(until);
        let mut reach = 0.0;
        let rounded = x.map(|x| value(&x));
        let first = favourite;
        let order = std::iter::once(first).chain((0..features.len()).filter(|&k| k != first));
        for k in order {
            if !may_separate(margin, features[k], &rounded) {
                continue;
            }
            let found = reach_of(margin, features[k], &x, &end);
            if found > reach {
                (reach, favourite) = (found, k);
            }
            if reach >= 1.0 {
                break;
            }
        }
        if reach >= 1.0 {
            if whole {
                return Walk {
                    impact: None,
                    steps,
                };
            }
            now = until;
            x = end;
            trial *= growth;
            growth = 64.0;
        } else {
            let length = (until - now).value();
            let advance = length * reach * (1.0 - 8.0 * Real::EPSILON);
            if advance < SHORTEST_ADVANCE {
                return Walk {
                    impact: Some(Impact {
                        time: now.rounded_down(),
                        stop: Stop::Contact,
                    }),
                    steps,
                };
            }
            now = now + Double::new(advance, 0.0);
            x = polygon.at(now);
            trial = length * if reach < 0.25 { 0.125 } else { 0.5 };
            growth = 8.0;
        }
    }
    Walk {
        impact: Some(Impact {
            time: now.rounded_down(),
            stop: Stop::Budget,
        }),
        steps: FINE_STEPS,
    }
}

/// False if the direction of `feature` does not have the polygon `x` on one side of the origin, by more than rounding.
fn may_separate<const K: usize>(margin: Margin, feature: Feature, x: &[Vec3; K]) -> bool {
    let rounding = 256.0 * Real::EPSILON * margin.size;
    steady(feature, x).is_some_and(|n| margin.clearance(n, x) > -rounding)
}

/// The share of the motion from `x` to `end` that the direction which follows `feature` certifies.
fn reach_of<S: Number, const K: usize>(
    margin: Margin,
    feature: Feature,
    x: &[Triple<S>; K],
    end: &[Triple<S>; K],
) -> Real {
    moving(feature, x, end).map_or(0.0, |direction| margin.moving_reach(&direction, x, end))
}

/// The part of the motion to try next: twice as far as where a straight line through the last two clearances meets zero.
/// `before` holds the last advance and the clearance ahead of it.
fn next_trial(trial: Real, clearance: Real, before: Option<[Real; 2]>) -> Real {
    match before {
        Some([advance, earlier]) if earlier > clearance => {
            let zero = advance * clearance / (earlier - clearance);
            (2.0 * zero).min(4.0 * trial)
        }
        Some(_) => (4.0 * trial).min(1.0),
        None => trial,
    }
}

/// The nearest feature, and the face if it is not the nearest: at an angle its normal often serves for longer.
fn with_face(feature: Feature) -> impl Iterator<Item = Feature> {
    let face = (feature != Feature::Face).then_some(Feature::Face);
    std::iter::once(feature).chain(face)
}

/// The steady direction that certifies the largest clearance at `x`, and this clearance (own unit).
fn best_steady<const K: usize>(
    margin: Margin,
    feature: Feature,
    x: &[Vec3; K],
) -> Option<(Vec3, Real)> {
    with_face(feature)
        .filter_map(|feature| steady(feature, x))
        .map(|direction| (direction, margin.clearance(direction, x)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
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

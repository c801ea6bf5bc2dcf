//! The walk through time: from one certified moment to the next, until contact or the end.

mod coarse;
mod fine;

use super::difference::{Difference, Feature, NearestFeature};
use super::direction::{moving, steady};
use super::number::{Number, Triple};
use super::reach::Margin;
use super::{Impact, Stop};
use cloth_core::math::{Real, Vec3};

/// What was found, and after how many steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    pub(super) impact: Option<Impact>,
    pub(super) steps: u32,
}

impl Walk {
    /// To the end of the motion.
    fn free(steps: u32) -> Self {
        let impact = None;
        Self { impact, steps }
    }

    fn stopped(time: Real, stop: Stop, steps: u32) -> Self {
        let impact = Some(Impact { time, stop });
        Self { impact, steps }
    }
}

/// No walk has more steps.
pub(super) const MOST_STEPS: u32 = 96;

/// Steps in `f64` before it is left to double precision, where that can be used.
const PATIENCE: u32 = MOST_STEPS - fine::BUDGET;

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
    let exactly = separation == 0.0 && slack == 0.0;
    let budget = if separation == 0.0 {
        PATIENCE
    } else {
        MOST_STEPS
    };
    let (walk, trial) = coarse::coarse(polygon, margin, slack, budget);
    let Some(Impact { time, stop }) = walk.impact else {
        return walk;
    };
    let unclear = match stop {
        Stop::Contact => separation == 0.0 && !goes_through(polygon, margin, time, trial),
        Stop::Budget => exactly,
        Stop::Slack => false,
    };
    if !unclear {
        return walk;
    }
    let fine = fine::fine(polygon, margin, time, trial);
    Walk {
        steps: walk.steps + fine.steps,
        ..fine
    }
}

/// Whether, as far as `f64` can tell, the origin goes through the inside of the face within a few `trial`s after
/// `time`. Then there is no need to look closer. A wrong yes would be a contact too many, which is safe.
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
    // Near the boundary of the face the origin may pass it by.
    let inside = |x: &[Vec3; K]| x.depth_inside() > 1e-6;
    inside(&before)
        && inside(&after)
        && steady(Feature::Face, &before).is_some_and(|n| margin.clearance(-n, &after) > 0.0)
}

/// The share of the motion from `x` to `end` that the direction which follows `feature` certifies.
fn reach_of<S: Number, const K: usize>(
    margin: Margin,
    feature: Feature,
    x: &[Triple<S>; K],
    end: &[Triple<S>; K],
) -> Real {
    let direction = moving(feature, x, end, |start| margin.facing(start, x));
    direction.map_or(0.0, |direction| margin.moving_reach(&direction, x, end))
}

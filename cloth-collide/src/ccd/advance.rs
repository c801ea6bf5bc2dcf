//! The walk through time: from one certified moment to the next, until contact or the end.

mod coarse;
mod fine;

use super::difference::{Difference, Feature, NearestFeature};
use super::direction::{moving, steady};
use super::number::{Number, Triple};
use super::reach::Margin;
use super::{Impact, Stop};
use cloth_core::math::{Real, Vec3};

pub(super) const MOST_STEPS: u32 = 96;

/// Steps in `f64` before it is left to double-double numbers, where that can be used.
const COARSE_BUDGET: u32 = MOST_STEPS - fine::BUDGET;

/// A polygon that is followed while it is certain to be further than the separation from the origin.
pub(super) struct Walk<const K: usize> {
    polygon: Difference<K>,
    margin: Margin,
}

impl<const K: usize> Walk<K>
where
    [Vec3; K]: NearestFeature,
{
    /// Where the walk along the motion of `polygon` ends before the motion does: at a contact, or when the distance
    /// beyond `separation` (m) has shrunk to the fraction `slack` of what it was at the start.
    pub(super) fn end(polygon: Difference<K>, separation: Real, slack: Real) -> Option<Impact> {
        let margin = Margin {
            separation: separation * polygon.scale,
            size: polygon.size,
        };
        let walk = Self { polygon, margin };
        let may_touch = separation == 0.0;
        let budget = if may_touch { COARSE_BUDGET } else { MOST_STEPS };
        let (impact, trial) = walk.coarse(slack, budget);
        let Impact { time, stop } = impact?;
        let is_unclear = match stop {
            Stop::Contact => may_touch && !walk.goes_through(time, trial),
            Stop::Budget => may_touch && slack == 0.0,
            Stop::Slack => false,
        };
        if is_unclear {
            walk.fine(time, trial)
        } else {
            impact
        }
    }

    /// Whether, as far as `f64` can tell, the origin goes through the inside of the face within a few `trial`s after
    /// `time`. Then there is no need for a finer test. A wrong yes would be a contact too many, which is safe.
    fn goes_through(&self, time: Real, trial: Real) -> bool {
        let before = self.polygon.at(time).map(Into::into);
        let after = self.polygon.at((time + 8.0 * trial).min(1.0));
        let after = after.map(Into::into);
        // Near the boundary of the face the origin may pass it by.
        let inside = |x: &[Vec3; K]| x.depth_inside() > 1e-6;
        let across = |n: Vec3| self.margin.certified_gap(-n, &after) > 0.0;
        inside(&before) && inside(&after) && steady(Feature::Face, &before).is_some_and(across)
    }

    /// The fraction of the motion from `x` to `end` that the direction which follows `feature` certifies.
    fn reach_of<S: Number>(
        &self,
        feature: Feature,
        x: &[Triple<S>; K],
        end: &[Triple<S>; K],
    ) -> Real {
        let direction = moving(feature, x, end, |start| self.margin.facing(start, x));
        direction.map_or(0.0, |direction| {
            self.margin.moving_reach(&direction, x, end)
        })
    }
}

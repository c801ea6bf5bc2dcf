//! The walk in double-double numbers, for what is nearer than `f64` can tell.

use super::Walk;
use crate::ccd::difference::{Feature, NearestFeature};
use crate::ccd::number::{Double, Number};
use crate::ccd::{Impact, Stop};
use cloth_core::math::{Real, Vec3};

/// Steps before giving up.
pub(super) const BUDGET: u32 = 64;

/// An advance in time (dimensionless) that leads nowhere: the numbers end soon after.
const SHORTEST_ADVANCE: Real = 1e-31;

/// What is tried first is not shorter than this (dimensionless).
const SHORTEST_TRIAL: Real = 1e-24;

impl<const K: usize> Walk<K>
where
    [Vec3; K]: NearestFeature,
{
    /// The walk in double-double numbers from `time` on, which `coarse` has reached, trying the fraction `trial` of the
    /// motion first. It decides whether the two touch or only come nearer than `f64` can tell, and goes on if they do
    /// not.
    ///
    /// So near, `f64` cannot tell either which feature is the nearest. So in each step all are tried, and the one is
    /// taken whose direction certifies most of the trial. The one that was taken in the step before comes first: it
    /// often certifies all of the trial again, and then the others are left out.
    pub(super) fn fine(&self, time: Real, trial: Real) -> Option<Impact> {
        let polygon = &self.polygon;
        let (mut now, mut trial) = (Double::new(time, 0.0), trial.max(SHORTEST_TRIAL));
        let mut x = polygon.at(now);
        let mut favourite = Feature::Face;
        let mut growth = 8.0;
        for _ in 0..BUDGET {
            let rest = (Double::new(1.0, 0.0) - now).value();
            let whole = trial >= rest;
            let until = if whole {
                Double::new(1.0, 0.0)
            } else {
                now + Double::new(trial, 0.0)
            };
            let end = polygon.at(until);
            let mut reach = 0.0;
            let first = favourite;
            let others = <[Vec3; K]>::features().filter(|feature| *feature != first);
            for feature in std::iter::once(first).chain(others) {
                let found = self.reach_of(feature, &x, &end);
                if found > reach {
                    (reach, favourite) = (found, feature);
                }
                if reach >= 1.0 {
                    break;
                }
            }
            if reach >= 1.0 {
                if whole {
                    return None;
                }
                now = until;
                x = end;
                trial *= growth;
                growth = 64.0;
            } else {
                let length = (until - now).value();
                let advance = length * reach * (1.0 - 8.0 * Real::EPSILON);
                if advance < SHORTEST_ADVANCE {
                    let (time, stop) = (now.rounded_down(), Stop::Contact);
                    return Some(Impact { time, stop });
                }
                now = now + Double::new(advance, 0.0);
                x = polygon.at(now);
                trial = length * if reach < 0.25 { 0.125 } else { 0.5 };
                growth = 8.0;
            }
        }
        let (time, stop) = (now.rounded_down(), Stop::Budget);
        Some(Impact { time, stop })
    }
}

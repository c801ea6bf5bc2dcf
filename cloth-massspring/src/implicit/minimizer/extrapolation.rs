//! Extrapolation: steps longer than the model of `G` says.
//!
//! The matrix of a direction is made positive, and is too stiff where cloth buckles: along the directions out of a fold
//! the true curvature is small or negative, and whole steps there are many and short. The slope at the end of one
//! tells. If a large fraction of it is left, the secant through both slopes says where it would be zero, and one more
//! step along the same direction goes there (J. J. Moré, D. J. Thuente, "Line search algorithms with guaranteed
//! sufficient decrease", ACM TOMS 20, 1994, <https://doi.org/10.1145/192115.192132>): it costs a contact query and an
//! evaluation, and no solve.

use super::{Contact, Minimizer, Task, with};
use crate::implicit::line_search::{self, Point};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::vectors::dot;
use cloth_core::step::StepError;

/// Fraction of the slope that has to be left.
const MIN_SLOPE_RATIO: Real = 0.5;
/// How many times the direction a step may go beyond it.
const MAX_EXTRAPOLATION: Real = 4.0;
/// A step is not taken if contact leaves less than this fraction of it.
const MIN_FREE_FRACTION: Real = 0.2;

impl Minimizer {
    /// Takes the next point, which is at the end of the direction, farther along it in contact, if `G` falls there.
    /// `slope` (J) is that of the current point. Returns how many times the direction it is away.
    pub(super) fn extrapolate(
        &mut self,
        task: &Task<'_>,
        contact: &mut Contact<'_>,
        slope: Real,
    ) -> Result<Real, StepError> {
        let Some(source) = contact.as_deref_mut() else {
            return Ok(1.0);
        };
        let left = dot(&self.next.gradient, &self.direction);
        if left > MIN_SLOPE_RATIO * slope {
            return Ok(1.0);
        }
        // Zero of the secant; where the slope has grown there is none ahead.
        let length = match left > slope {
            true => (left / (slope - left)).min(MAX_EXTRAPOLATION),
            false => MAX_EXTRAPOLATION,
        };
        let count = self.next.positions.len();
        let farther = self.farther.get_or_insert_with(|| Point::new(count));
        line_search::place(&self.next, &self.direction, length, farther);
        let limited = source.limit(&self.next.positions, &farther.positions);
        let safe = limited.map_err(|reason| task.refused(reason))?;
        if safe < MIN_FREE_FRACTION {
            return Ok(1.0);
        }
        let stage = with(task, contact);
        let direction: &[Vec3] = &self.direction;
        let found =
            line_search::search(&stage, &self.next, direction, left, length * safe, farther);
        if !found.accepted {
            return Ok(1.0);
        }
        std::mem::swap(&mut self.next, farther);
        Ok(1.0 + found.length)
    }
}

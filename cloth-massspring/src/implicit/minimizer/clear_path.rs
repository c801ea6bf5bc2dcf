//! Whether nothing is in between two places far apart.

use super::Task;
use cloth_core::contact::ContactPotential;
use cloth_core::math::{Real, Vec3};
use cloth_core::step::StepError;

/// A path is followed in so many parts, at most.
const MOST_PARTS: Real = 100.0;
/// Part of the first progress that is lost to rounding alone.
const ROUNDING: Real = 1e-6;

/// Whether the straight path from `from` to `to` (m) is free of crossings: contact, which tests only the beginning of a
/// long path, is asked part by part. A part in which something is in the way is shorter than the one before. Contact is
/// then ready for places on the last part, up to `to`, or for `from` if it is not clear. `at` is a buffer.
pub(super) fn is_clear(
    task: &Task<'_>,
    contact: &mut dyn ContactPotential,
    [from, to]: [&[Vec3]; 2],
    at: &mut Vec<Vec3>,
) -> Result<bool, StepError> {
    at.clear();
    at.extend_from_slice(from);
    // What is left of the whole, and what the first part was of it.
    let (mut left, mut first) = (1.0, None);
    loop {
        let limited = contact.limit(at, to);
        let safe = limited.map_err(|reason| task.refused(reason))?;
        if safe == 1.0 {
            return Ok(true);
        }
        let progress = safe * left;
        let usual = *first.get_or_insert(progress);
        if progress < (1.0 - ROUNDING) * usual || MOST_PARTS * usual < 1.0 {
            let stays = contact.limit(from, from);
            return stays.map(|_| false).map_err(|reason| task.refused(reason));
        }
        at.iter_mut()
            .zip(to)
            .for_each(|(at, to)| *at += (to - *at) * safe);
        left *= 1.0 - safe;
    }
}

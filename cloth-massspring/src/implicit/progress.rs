//! Whether an iteration that converges linearly will reach its tolerance within a bearable number of iterations, and
//! whether contact leaves it any way at all.

use cloth_core::math::Real;

/// Iterations between two comparisons.
const WINDOW: u32 = 100;
/// More iterations than this, at the rate of the last two windows, are too many: Newton's method takes over.
const MAX_REMAINING_ITERATIONS: Real = 1000.0;

/// Fall of G in a window, over what one whole step promises, below which the iteration stalls.
const STALLED: Real = 0.01;

/// The smallest Newton decrements (√J) so far.
#[derive(Debug)]
pub(super) struct Progress {
    smallest: Real,
    /// The smallest two windows ago and one window ago.
    marks: [Real; 2],
    /// G (J) a window ago.
    value: Real,
}

impl Progress {
    pub(super) fn new() -> Self {
        Self {
            smallest: Real::INFINITY,
            marks: [Real::INFINITY; 2],
            value: Real::INFINITY,
        }
    }

    /// Takes notice of G (J) and the Newton decrement (√J) of an iteration, counted from 1, and says whether contact
    /// has cut all steps of a window so short that they were for nothing.
    pub(super) fn is_stalled(&mut self, iteration: u32, value: Real, decrement: Real) -> bool {
        if !iteration.is_multiple_of(WINDOW) {
            return false;
        }
        let before = std::mem::replace(&mut self.value, value);
        before - value < STALLED * 0.5 * decrement * decrement
    }

    /// Takes notice of the Newton decrement (√J) of an iteration, counted from 1, and says whether it falls too slowly
    /// to become `enough`.
    pub(super) fn is_too_slow(&mut self, iteration: u32, decrement: Real, enough: Real) -> bool {
        self.smallest = self.smallest.min(decrement);
        if !iteration.is_multiple_of(WINDOW) {
            return false;
        }
        let [before, last] = self.marks;
        self.marks = [last, self.smallest];
        let fall_per_iteration = (before / self.smallest).ln() / Real::from(2 * WINDOW);
        (decrement / enough).ln() > MAX_REMAINING_ITERATIONS * fall_per_iteration
    }
}

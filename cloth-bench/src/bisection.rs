//! Bisection.

use cloth_core::math::Real;

/// Halves a range so many times: `is_below` holds at its lower end, and at its upper end it does not.
pub(crate) fn bisected(
    [mut low, mut high]: [Real; 2],
    times: u32,
    is_below: impl Fn(Real) -> bool,
) -> [Real; 2] {
    for _ in 0..times {
        let middle = 0.5 * (low + high);
        match is_below(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    [low, high]
}

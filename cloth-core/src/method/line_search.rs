//! How far to go along a direction of descent: backtracking, with the condition left to the method.
//!
//! The usual condition is Armijo's: of a length t along a direction p it asks that the objective G falls by a fraction
//! of what its slope at x promises, `G(x + t p) ≤ G(x) + c t ∇G(x)·p`, with c = 10⁻⁴ ([`ARMIJO`]). The slope `∇G(x)·p`
//! is negative, so a length that is short enough fulfils it. The next length to try after t is the minimum of the
//! parabola with the value and the slope of G at 0 and its value at t.
//!
//! J. Nocedal and S. J. Wright, *Numerical Optimization*, 2nd ed., 2006, section 3.1 (Armijo's condition) and 3.5
//! (interpolation).

use crate::math::Real;

/// Armijo's constant c: the fraction of the promised decrease that has to be kept.
pub const ARMIJO: Real = 1e-4;

/// What is known at a step length that was tried.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// How much the objective rose (J); it may be NaN or infinite.
    pub rise: Real,
    /// Whether the method accepts it.
    pub accepted: bool,
}

/// What a search found.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Step lengths that were rejected.
    pub backtracks: u32,
    /// Whether one was accepted.
    pub accepted: bool,
    /// The last one that was tried (dimensionless).
    pub length: Real,
}

/// Tries `most`, then smaller and smaller lengths along a direction with the given `slope` (J, negative), until one is
/// accepted or `trials` have been rejected. Each is the minimum of the parabola through what is known, between a tenth
/// and a half of the one before.
pub fn backtrack(
    slope: Real,
    most: Real,
    trials: u32,
    mut evaluate: impl FnMut(Real) -> Trial,
) -> Found {
    let mut found = Found {
        backtracks: 0,
        accepted: false,
        length: most,
    };
    let mut length = most;
    while found.backtracks < trials {
        let Trial { rise, accepted } = evaluate(length);
        (found.length, found.accepted) = (length, accepted);
        if accepted {
            break;
        }
        found.backtracks += 1;
        length = shorter(length, slope, rise);
    }
    found
}

fn shorter(length: Real, slope: Real, rise: Real) -> Real {
    let minimum = -0.5 * slope * length * length / (rise - slope * length);
    // A rise that is NaN comes out of `min` as a half, an infinite one of `max` as a tenth.
    minimum.min(0.5 * length).max(0.1 * length)
}

//! How far a direction is followed before anything is evaluated there: a trust radius, from how far the last steps have
//! come.
//!
//! A quadratic model knows nothing of contacts that a step would only make. Where one step has had to be shortened
//! because of them, the next one mostly has to be as well, and what is evaluated in vain is dearest there: the farther
//! cloth may go, the more of it can touch on the way. The radius follows what the steps did, as in trust-region methods
//! (Nocedal and Wright, *Numerical Optimization*, 2nd ed., 2006, algorithm 4.1).

use super::line_search::Found;
use cloth_core::math::{Real, Vec3};

/// Radius after a step that has been shortened, in ways of that step.
const AFTER_SHORTER: Real = 2.0;
/// Factor on the radius after a step to its end that has not been shortened.
const AFTER_WHOLE: Real = 4.0;

/// The way of the vertex that goes farthest is to be no longer than this (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct TrustRadius(Real);

/// A direction, and what the radius leaves of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trusted {
    /// The way of the vertex that goes farthest (m).
    longest: Real,
    /// The part of the direction within the radius (dimensionless, 0..=1).
    pub(super) part: Real,
}

impl TrustRadius {
    /// Any way is tried.
    pub(super) fn unlimited() -> Self {
        Self(Real::INFINITY)
    }

    /// What is left of a direction (m).
    pub(super) fn trust(self, direction: &[Vec3]) -> Trusted {
        let longest = direction.iter().map(Vec3::norm_squared);
        let longest = longest.fold(0.0, Real::max).sqrt();
        let part = if longest > self.0 {
            self.0 / longest
        } else {
            1.0
        };
        Trusted { longest, part }
    }

    /// Takes notice of how far the search along a direction has come.
    pub(super) fn learn(&mut self, trusted: Trusted, found: Found) {
        if found.backtracks > 0 {
            self.0 = AFTER_SHORTER * found.length * trusted.longest;
        } else if trusted.part < 1.0 && found.length == trusted.part {
            self.0 *= AFTER_WHOLE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(length: Real, backtracks: u32) -> Found {
        Found {
            backtracks,
            accepted: true,
            length,
        }
    }

    #[test]
    fn radius_follows_what_steps_have_come_to() {
        let direction = [Vec3::x() * 3.0, Vec3::y() * 4.0];
        let mut radius = TrustRadius::unlimited();
        let whole = radius.trust(&direction);
        assert_eq!(whole.part, 1.0);
        radius.learn(whole, found(1.0, 0));
        assert_eq!(radius.trust(&direction).part, 1.0);
        // A tenth of 4 m: 0.8 m are tried next.
        radius.learn(whole, found(0.1, 1));
        let part = radius.trust(&direction);
        assert!((part.part - 0.2).abs() < 1e-15);
        // What contact has cut says nothing about the radius, what came to its end does.
        radius.learn(part, found(0.1, 0));
        assert_eq!(radius.trust(&direction).part, part.part);
        radius.learn(part, found(part.part, 0));
        assert!((radius.trust(&direction).part - 0.8).abs() < 1e-15);
        // Short directions are not touched.
        assert_eq!(radius.trust(&[Vec3::x()]).part, 1.0);
    }
}

//! How far a direction is followed before anything is evaluated there: a trust radius, from how far the last steps have
//! come.
//!
//! A quadratic model knows nothing of contacts that a step would only make. Where one step has had to be shortened
//! because of them, the next one mostly has to be as well, and what is evaluated in vain is dearest there: the farther
//! cloth may go, the more of it can touch on the way. The radius follows what the steps did, as in trust-region methods
//! (Nocedal and Wright, *Numerical Optimization*, 2nd ed., 2006, algorithm 4.1).

use crate::math::{Real, Vec3};

/// Radius after a step that has been shortened, over the displacement that was left of it.
const AFTER_SHORTER: Real = 2.0;

/// Bound on the displacement (m) of the vertex that goes farthest.
#[derive(Clone, Copy, Debug)]
pub struct TrustRadius {
    radius: Real,
    growth: Real,
}

/// A direction, and what the radius leaves of it.
#[derive(Clone, Copy, Debug)]
pub struct Trusted {
    /// Displacement of the vertex that goes farthest along the whole direction (m).
    pub longest: Real,
    /// The fraction of the direction within the radius (0 to 1).
    pub fraction: Real,
}

impl TrustRadius {
    /// Begins with a radius (m, infinite: any direction is tried), which is multiplied by `growth` (above 1) where it
    /// was in the way.
    #[must_use]
    pub fn new(radius: Real, growth: Real) -> Self {
        Self { radius, growth }
    }

    /// What is left of a direction (m).
    #[must_use]
    pub fn trust(self, direction: &[Vec3]) -> Trusted {
        let longest = longest(direction);
        let fraction = if longest > self.radius {
            self.radius / longest
        } else {
            1.0
        };
        Trusted { longest, fraction }
    }

    /// Records a step that had to be shortened, and the displacement (m) of its farthest vertex.
    pub fn shorten(&mut self, displacement: Real) {
        self.radius = AFTER_SHORTER * displacement;
    }

    /// Records a step that was shortened by nothing but the radius.
    pub fn grow(&mut self) {
        self.radius *= self.growth;
    }
}

/// Displacement of the vertex that goes farthest (m).
#[must_use]
pub fn longest(displacements: &[Vec3]) -> Real {
    let squares = displacements.iter().map(Vec3::norm_squared);
    squares.fold(0.0, Real::max).sqrt()
}

//! What one row makes of the law of contact and of that of friction.

use super::rows::LEAST;
use crate::obstacle::{PenaltyLaw, hold};
use cloth_core::math::{Real, Vec3};

/// The tangent of a contact law at a distance: the force (N) is `stiffness` (N/m) times what is missing to `range` (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangent {
    pub(super) range: Real,
    pub(super) stiffness: Real,
}

impl Tangent {
    /// At the distance `d` (m), for the area `area` (m²); never further than a little beyond where the law begins to be
    /// a spring.
    pub(super) fn of(law: PenaltyLaw, area: Real, d: Real) -> Self {
        let h = law.range();
        let at = d.clamp(LEAST * h, 0.75 * h);
        let curvature = law.curvature(at);
        let beyond = -law.slope(at) / curvature;
        Self {
            range: (if d < at { d } else { at }) + beyond,
            stiffness: area * curvature,
        }
    }

    /// α̃ (1/kg) in a substep of `dt` (s).
    pub(super) fn compliance(&self, dt: Real) -> Real {
        1.0 / (self.stiffness * dt * dt)
    }
}

/// The part of `v` at right angles to `normal` (unit length).
#[inline]
pub(super) fn across(v: Vec3, normal: Vec3) -> Vec3 {
    v - normal * normal.dot(&v)
}

/// What friction is stretched by (m) after a `displacement` (m) from where it sticks: it gives in elastically by
/// `reach` (m), and what is more is slip. Nothing without a force λ.
pub(super) fn stretch(displacement: Vec3, lambda: Real, reach: Real) -> Vec3 {
    if lambda > 0.0 {
        hold(displacement, reach)
    } else {
        Vec3::zeros()
    }
}

//! What one constraint makes of the law of contact and of that of friction.

use super::constraints::LEAST;
use crate::obstacle::{Distance, PenaltyLaw};
use cloth_core::math::{Real, Vec3};

/// The tangent of a contact law at a distance: the force (N) is `stiffness` (N/m) times what is missing to `range` (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangent {
    pub(super) range: Real,
    pub(super) stiffness: Real,
}

impl Tangent {
    /// At the distance `d` (m), for the area `area` (m²). `d` is clamped to 0.05 h … 0.75 h.
    ///
    /// Above h/2 the law is a spring, so its tangent is the same everywhere there, also beyond h. Below h/2 −ψ′/ψ″ is
    /// d, so the tangent ends at d₀ = 2 d, and what is almost in touch could no more than double its distance in a
    /// substep. So below 0.05 h the force stays that at 0.05 h, and ends at d + 0.05 h.
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

/// A force or displacement along the surface that is not larger than `most`.
pub(super) fn clamp_to_friction_cone(tangential: Vec3, most: Real) -> Vec3 {
    tangential * (most / tangential.norm()).min(1.0)
}

/// A unilateral constraint in a substep, C = d − d₀ ≥ 0 for a distance d, and what it has pushed with so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ConstraintState {
    /// d₀ (m), α̃ (1/kg), and μ (dimensionless).
    pub(super) range: Real,
    pub(super) compliance: Real,
    pub(super) coefficient: Real,
    /// λ (kg m) along the normal, and the same of friction.
    pub(super) lambda: Real,
    pub(super) friction: Vec3,
    /// Where it sticks at the end of the substep (m).
    pub(super) origin: Vec3,
}

impl ConstraintState {
    /// Makes a constraint hard that has not kept its pair apart: without compliance, with a new range d₀. `distance`
    /// (m) is that at the start of the substep, `now` (m) what the sweeps have left of it.
    ///
    /// - d₀ is the `distance`: the pair does not come nearer than it was.
    /// - Where that is below `least` (m), d₀ is more, up to `least`: the `distance` and half of what the pair has come
    ///   nearer by. So it comes back with half of the speed with which it came. Put back to `least` at once, it would
    ///   leave the faster the shorter the substep is.
    /// - d₀ is never more than before.
    pub(super) fn harden(&mut self, distance: Real, least: Real, now: Real) {
        let inward = (distance - now).max(0.0);
        let back = (distance + 0.5 * inward).min(least);
        self.compliance = 0.0;
        self.range = self.range.min(distance.max(back));
    }

    /// XPBD's projection, with friction in its cone: the push (kg m) on a `point` (m) at the distance `at`, which gives
    /// way by `inverse_effective_mass` (1/kg). Nothing without contact.
    #[inline]
    pub(super) fn project(
        &mut self,
        at: &Distance,
        point: Vec3,
        inverse_effective_mass: Real,
    ) -> Option<Vec3> {
        let value = at.value - self.range;
        if value >= 0.0 && self.lambda == 0.0 {
            return None;
        }
        let change = -(value + self.compliance * self.lambda)
            / (inverse_effective_mass * at.slope * at.slope + self.compliance);
        let lambda = (self.lambda + change).max(0.0);
        let mut push = at.gradient() * (lambda - self.lambda);
        self.lambda = lambda;
        if self.coefficient > 0.0 {
            let slip = across(point - self.origin, at.normal);
            let most = self.coefficient * lambda * at.slope;
            let clamped =
                clamp_to_friction_cone(self.friction - slip / inverse_effective_mass, most);
            push += clamped - self.friction;
            self.friction = clamped;
        }
        Some(push)
    }

    /// Tangential displacement (m) with the point at `point` (m) where the substep ends. Friction has no compliance:
    /// this is what the sweeps have left of it. The next substep begins with up to `reach` (m) of it and takes that
    /// back; what is more is slip. Nothing without a force λ.
    pub(super) fn tangential(&self, point: Vec3, normal: Vec3, reach: Real) -> Vec3 {
        if self.lambda > 0.0 {
            clamp_to_friction_cone(across(point - self.origin, normal), reach)
        } else {
            Vec3::zeros()
        }
    }
}

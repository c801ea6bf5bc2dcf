//! Coulomb friction as a potential, with normal forces and directions from the start of the step.
//!
//! Friction has no energy, but friction under a normal force λ and in a tangent plane T that do not change has one
//! (lagged friction, Li et al. 2020, section 5.4): μ λ f(‖u‖), with u the displacement of the contact point in the
//! plane. f is quadratic below a small length ε, so that sticking is a spring of the stiffness μ λ/ε, and ‖u‖ − ε/2
//! beyond, where the force is μ λ. The next step takes u on from there, cut to the length ε. So a cloth that sticks
//! keeps the force that holds it, and does not creep, whatever the number of steps: under a tangential force F < μ λ it
//! gives way by ε F/(μ λ) once. With u from 0 in every step, as where ε is a speed ε_v times Δt, it would give way by
//! that in each, and creep with the speed ε_v F/(μ λ). ε is h/100: small beside the thickness, so that the give is not
//! seen. The stiffness μ λ/ε is at most 50 μ times A ψ″(d), that of the law itself: 100 μ (1 − d/h) times down to h/2,
//! and 100 μ d/h times below. With pieces of different thickness h is the largest of theirs in ε = h/100.
//!
//! # Limits
//!
//! - There is one μ, for sticking and for sliding.
//! - λ, the normal and the contact point are those of the start of the step, and are not iterated: the energy stays one
//!   function, which a line search can lower. Where the pressure changes from λ₀ to λ₁ in a step the force is bounded
//!   by μ λ₀, so the error is the change of μ λ over one step; on landing it is all of it.
//! - A pair is known by its vertices. Where a contact passes on to the next triangle, u begins at 0 there.
//! - The constraints of `pair_constraint` and `bodies` take the λ of the sweep instead, and the same memory of u.

use super::tangent::{across, clamp_to_friction_cone};
use crate::pair::{Pair, weighted};
use cloth_core::contact::ContactRow;
use cloth_core::math::{Real, Vec3};

/// The weights of a vertex before a body, which stands for all four.
pub(super) const ALONE: [Real; 4] = [1.0, 0.0, 0.0, 0.0];

/// What a contact is known by from step to step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Key {
    Pair(Pair),
    /// A vertex, and the number of an obstacle.
    Obstacle([u32; 2]),
}

/// Friction of one contact during one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrictionContact {
    pub(super) key: Key,
    /// The vertices, and the weights (dimensionless) of the difference of the two contact points.
    pub(super) vertices: [u32; 4],
    pub(super) weights: [Real; 4],
    /// Unit normal, at right angles to which friction acts.
    pub(super) normal: Vec3,
    /// μ λ (N).
    pub(super) most: Real,
    /// Σ c_k x_k (m) at the start, moved along with the body if there is one, less the tangential displacement then.
    pub(super) origin: Vec3,
}

impl FrictionContact {
    /// u (m) at `x` (m).
    #[inline]
    pub(super) fn displacement(&self, x: &[Vec3]) -> Vec3 {
        across(
            weighted(self.vertices, self.weights, x) - self.origin,
            self.normal,
        )
    }

    /// Adds the gradient (N) at `x` (m) to `out`, and returns the energy (J). `reach` is ε (m).
    pub(super) fn add_gradient(&self, reach: Real, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let (force, length) = self.force(reach, x);
        for (v, w) in self.vertices.iter().zip(self.weights) {
            out[*v as usize] += force * w;
        }
        if length < reach {
            0.5 * self.most * length * length / reach
        } else {
            self.most * (length - 0.5 * reach)
        }
    }

    /// The gradient (N) by the point, and the length of u (m), at `x` (m).
    #[inline]
    pub(super) fn force(&self, reach: Real, x: &[Vec3]) -> (Vec3, Real) {
        let displacement = self.displacement(x);
        let length = displacement.norm();
        (displacement * (self.most / length.max(reach)), length)
    }

    /// The second derivative at `x` (m): beyond ε friction turns with u, and does not grow along it. So the stiffness
    /// across u is F/u, and along u should be 0; ε²/u² of F/u is kept, so that it does not jump at u = ε.
    pub(super) fn rows(&self, reach: Real, x: &[Vec3]) -> [ContactRow; 2] {
        let displacement = self.displacement(x);
        let length = displacement.norm();
        let stiffness = self.most / length.max(reach);
        let along = if length > reach {
            displacement / length
        } else {
            // Any direction that is not nearly the normal.
            let other = Vec3::ith(self.normal.iamin(), 1.0);
            self.normal.cross(&other).normalize()
        };
        let fraction = reach / length.max(reach);
        let directions = [along, self.normal.cross(&along)];
        let stiffnesses = [stiffness * fraction * fraction, stiffness];
        [0, 1].map(|i| ContactRow {
            vertices: self.vertices,
            weights: self.weights,
            normal: directions[i],
            stiffness: stiffnesses[i],
        })
    }
}

/// The tangential displacements of contacts at the end of a step, at most ε.
#[derive(Clone, Debug, Default)]
pub(super) struct TangentialDisplacements {
    /// In rising order of the contacts (m); and those before the last step.
    displacements: Vec<(Key, Vec3)>,
    before: Vec<(Key, Vec3)>,
}

impl TangentialDisplacements {
    /// That of a contact (m), zero of a new one.
    pub(super) fn of(&self, key: Key) -> Vec3 {
        let place = self
            .displacements
            .binary_search_by_key(&key, |entry| entry.0);
        place.map_or_else(|_| Vec3::zeros(), |place| self.displacements[place].1)
    }

    /// Replaces all by those at `x` (m); `reach` is ε (m).
    pub(super) fn replace(&mut self, all: &[FrictionContact], reach: Real, x: &[Vec3]) {
        std::mem::swap(&mut self.displacements, &mut self.before);
        self.displacements.clear();
        self.displacements.extend(all.iter().map(|contact| {
            (
                contact.key,
                clamp_to_friction_cone(contact.displacement(x), reach),
            )
        }));
        self.displacements.sort_unstable_by_key(|entry| entry.0);
    }

    /// They are those before the last step again.
    pub(super) fn take_back(&mut self) {
        self.displacements.clone_from(&self.before);
    }
}

#[cfg(test)]
#[path = "../../tests/unit/potential_friction.rs"]
mod tests;

//! The forces that contacts are going to need, for a primal–dual Hessian.
//!
//! Below h/2 the force of a pair is A κ h²/(4 d), a logarithmic barrier. Where cloth is pulled taut over a pole, the
//! force λ that holds it in the end may be thousands of times the force F at the distance d of an iterate, and then A ψ″
//! = F/d says nothing of it: directions run far through the pair, each iteration closes it by a constant factor, and a
//! hundred of them pass before any other vertex has moved. Interior-point methods know this, and take λ/d for F/d: the
//! linearisation of d λ = A κ h²/4 in both variables (Nocedal and Wright 2006, section 19.3; at the minimum λ = F, and
//! the two are the same). λ comes from the iteration itself: in the solution of a linear system in which the pair has
//! the stiffness k, and gets nearer by −J·p, its force is F − k J·p. So the next system has, for a pair below
//! h/2 that gets nearer, k = max(A ψ″, λ/d) with that force as λ. Above h/2, where the law is a spring, A ψ″ is right.
//! Gradients are what they were, and so is the minimum.

use super::near_pairs::NearPairs;
use super::pair::PairContact;
use crate::pair::{Gap, Pair, weighted};
use cloth_core::math::{Real, Vec3, gather};

/// Fraction of its distance by which a pair gets nearer in a solution, from which on its multiplier is kept.
const PRESSED: Real = 0.5;

/// Multipliers λ (N) of pairs that are pressed, in the order of the pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    known: Vec<(Pair, Real)>,
    next: Vec<(Pair, Real)>,
}

impl Multipliers {
    pub(super) fn clear(&mut self) {
        self.known.clear();
    }

    fn of(&self, pair: Pair) -> Option<Real> {
        let place = self.known.binary_search_by_key(&pair, |entry| entry.0);
        place.ok().map(|place| self.known[place].1)
    }

    /// k (N/m) of a pair with this `gap` that stands for an `area` (m²).
    pub(super) fn stiffness(&self, contact: &PairContact, gap: &Gap, area: Real) -> Real {
        let own = area * contact.law.curvature(gap.distance);
        match self.of(contact.pair) {
            Some(multiplier) => own.max(multiplier / gap.distance),
            None => own,
        }
    }

    /// Replaces all by those of the solution that is `direction` (m) away from `x` (m), with the stiffnesses that were
    /// taken there.
    pub(super) fn update(&mut self, pairs: &NearPairs, x: &[Vec3], direction: &[Vec3]) {
        self.next.clear();
        for contact in pairs.iter_at(x) {
            let (pair, law) = (contact.pair, &contact.law);
            let places = gather(x, pair.vertices);
            let gap = Gap::new(pair.kind, &places);
            let nearer = -gap
                .normal
                .dot(&weighted(pair.vertices, gap.weights, direction));
            if gap.distance >= 0.5 * law.range() || nearer <= 0.0 {
                continue;
            }
            if nearer > PRESSED * gap.distance || self.of(pair).is_some() {
                let area = contact.area_at(&places);
                let force = -area * law.slope(gap.distance);
                let more = self.stiffness(contact, &gap, area) * nearer;
                self.next.push((pair, force + more));
            }
        }
        self.next.sort_unstable_by_key(|entry| entry.0);
        std::mem::swap(&mut self.known, &mut self.next);
    }
}

//! Restitution, of methods that project positions: what is hit is left with a fraction of the speed of the impact.
//!
//! The law of contact gives back what it has stored, less what a method damps. With a coefficient of restitution e the
//! velocities of a substep follow instead: a pair that approached with the speed u and has touched parts with e u
//! (Müller et al. 2020, section 3.6; see the [chapter](super#references)), and one that parts already is not pushed to
//! be faster: what the law has stored is lost.
//!
//! Let s be the relative velocity of a pair along n, and K = Σ c_k²/m_k the inverse effective mass. The impulse J = (e
//! u − s)/K changes the velocities by J c_k n/m_k, and the kinetic energy by J s + ½ J² K = ((e u)² − s²)/(2 K). An
//! impact at the speed u has s = −u at first, and takes (1 − e²) u²/(2 K) in all: nothing with e = 1, all of the
//! relative motion along n with e = 0. Before a body at rest K = 1/m, so it is ½ m (1 − e²) u² of a vertex. Pairs are
//! visited once: where they share vertices, a later one changes the speed of an earlier one, whose e u is not exact
//! then.
//!
//! What lies on something approaches it by g Δt² in a substep. The paper has no rebound below the speed 2 g Δt, which
//! is an approach by 2 g Δt². Contact does not know g, so here there is none where the approach is below h/1000, which
//! is as much for Δt = 0.23 ms and h = 1 mm.
//!
//! - In long substeps what lies still rebounds in each. It begins one with the speed v at which the last rebound has
//!   left it, so it approaches with u = g Δt − v, and v = e u makes u = g Δt/(1 + e). The law carries 1/(1 + e) of its
//!   weight, the rebound the rest. This goes on as long as that approach, u Δt = g Δt²/(1 + e), is above h/1000: with h
//!   = 1 mm in substeps of more than 0.32 √(1 + e) ms.
//! - In short ones, g Δt² < h/1000 (Δt < 0.32 ms), nothing that lies rebounds, and the law carries all of its weight.
//! - In between, what lies rebounds in one substep, and in the next, which it begins with the speed of that, its
//!   approach may be no impact.

use super::forces::Ledger;
use super::near::Near;
use super::pair_constraint::PairConstraint;
use crate::pair::ends;
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3};

/// An approach in one substep by less than this fraction of the thickness is none.
const RESTING: Real = 1e-3;

/// A pair, or a vertex and a body, that has to part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rebound {
    pub(super) vertices: [u32; 4],
    pub(super) weights: [Real; 4],
    pub(super) normal: Vec3,
    /// Of the vertices (1/kg), and Σ c_k²/m_k (1/kg).
    pub(super) inverse_mass: [Real; 4],
    pub(super) inverse_effective_mass: Real,
    /// How fast it approached, and the part of its velocity that is that of a body (m/s).
    pub(super) approach: Real,
    pub(super) of_body: Real,
}

/// All of a substep, with the coefficient e (dimensionless).
#[derive(Clone, Debug)]
pub(super) struct Rebounds {
    pub(super) coefficient: Real,
    pub(super) list: Vec<Rebound>,
}

impl Rebounds {
    /// How far (m) a pair has to approach in one substep.
    pub(super) fn least(&self, near: &Near) -> Real {
        RESTING * near.law.range()
    }

    /// Takes those between primitives of a substep that ends at `x` (m).
    pub(super) fn find<'a>(
        &mut self,
        touching: impl Iterator<Item = &'a PairConstraint>,
        near: &Near,
        step: &ContactStep<'_>,
        x: &[Vec3],
    ) {
        self.list.clear();
        let least = self.least(near);
        for contact in touching.filter(|contact| contact.approach.abs() > least) {
            let of_bodies =
                ends(contact.pair.vertices, contact.weights).filter(|(v, _)| *v >= near.cloth);
            let moved = of_bodies.map(|(v, w)| (x[v] - step.from[v]) * w);
            self.list.push(Rebound {
                vertices: contact.pair.vertices,
                weights: contact.weights,
                normal: contact.normal,
                inverse_mass: contact.pair.vertices.map(|v| step.inverse_mass[v as usize]),
                inverse_effective_mass: contact.inverse_effective_mass,
                approach: contact.approach / step.dt,
                of_body: contact.normal.dot(&moved.sum()) / step.dt,
            });
        }
    }

    /// Changes the velocities (m/s), and returns the work (J) of moving bodies.
    pub(super) fn act(&self, velocities: &mut [Vec3], mut ledger: Option<&mut Ledger>) -> Real {
        let mut work = 0.0;
        for rebound in &self.list {
            let (normal, weights) = (rebound.normal, rebound.weights);
            let ends = || ends(rebound.vertices, weights);
            let own = ends().filter_map(|(v, w)| Some(*velocities.get(v)? * w));
            let speed = normal.dot(&own.sum()) + rebound.of_body;
            let wanted = match rebound.approach > 0.0 {
                true => self.coefficient * rebound.approach,
                false => speed.min(-rebound.approach),
            };
            let impulse = (wanted - speed) / rebound.inverse_effective_mass;
            for ((v, weight), w) in ends().zip(rebound.inverse_mass) {
                if let Some(velocity) = velocities.get_mut(v) {
                    *velocity += normal * (impulse * weight * w);
                }
            }
            work -= impulse * rebound.of_body;
            if let Some(ledger) = &mut ledger {
                ledger.add_pair(rebound.vertices, weights, [normal * impulse, Vec3::zeros()]);
            }
        }
        work
    }
}

//! One unilateral constraint between two primitives: what it is made from, and how positions are projected onto it.

use super::constraints::{DETECTION_MARGIN, KEPT, LEAST};
use super::near::Near;
use super::patches::NearPair;
use super::tangent::{ConstraintState, Tangent};
use crate::ccd::Query;
use crate::obstacle::Distance;
use crate::pair::{Gap, Pair, weighted};
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3, gather};

/// Travel of patches (in thicknesses) during which the nearest points of two primitives stay what they are.
const PERSISTENT: Real = 0.02;

/// A pair that the motion of a substep may bring into contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairConstraint {
    pub(super) pair: Pair,
    pub(super) role: Role,
    pub(super) is_violated: bool,
    /// From the second nearest point to the first, where they were last found; of a [`Role::Separated`] pair, across a
    /// plane that has the two apart.
    pub(super) normal: Vec3,
    pub(super) weights: [Real; 4],
    /// At the start of the substep (m).
    pub(super) distance: Real,
    /// Of the point Σ c_k x_k (m).
    pub(super) state: ConstraintState,
    /// Σ c_k²/m_k (1/kg).
    pub(super) inverse_effective_mass: Real,
    /// Distance (m) at which the law begins, and the area (m²) that the pair stands for: at rest, and where its nearest
    /// points were found.
    thickness: Real,
    area_at_rest: Real,
    area: Real,
    /// By how much it would get nearer in the substep (m).
    pub(super) approach: Real,
}

/// What is done with a pair in a substep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A plane keeps the two apart in the predicted motion.
    Separated,
    /// It is only tested.
    Tested,
    /// It pushes.
    Pushes,
}

impl PairConstraint {
    /// Adds that of a pair in a substep in which it would go to `to` (m); `last` is its constraint of the substep
    /// before, if it had one, `travel` (m) how far the patches have travelled, and `reach` (m) the largest tangential
    /// displacement of what sticks. Returns how far (m) the two are apart, at least.
    #[inline]
    pub(super) fn add(
        constraints: &mut Vec<Self>,
        found: &mut NearPair,
        last: Option<&PairConstraint>,
        near: &Near,
        step: &ContactStep<'_>,
        (to, travel, reach): (&[Vec3], Real, Real),
    ) -> Real {
        let index = constraints.len();
        constraints.push(Self {
            pair: found.pair,
            role: Role::Separated,
            is_violated: false,
            normal: last.map_or(Vec3::zeros(), |last| last.normal),
            weights: [0.0; 4],
            distance: 0.0,
            state: ConstraintState::default(),
            inverse_effective_mass: 0.0,
            thickness: found.range,
            area_at_rest: found.area,
            area: 0.0,
            approach: 0.0,
        });
        let contact = &mut constraints[index];
        let known = last.filter(|last| {
            last.role == Role::Pushes && travel - found.known_at <= PERSISTENT * near.law.range()
        });
        if last.is_some() && known.is_none() {
            let apart = found.range + DETECTION_MARGIN * near.law.range();
            let now = contact.pair.gap_along(&contact.normal, step.from);
            if now > apart && contact.pair.gap_along(&contact.normal, to) > apart {
                found.known_at = Real::NEG_INFINITY;
                return now;
            }
        }
        contact.prepare(near, step, to, known);
        if known.is_none() {
            found.known_at = match contact.role {
                Role::Pushes => travel,
                _ => Real::NEG_INFINITY,
            };
        }
        if let (Role::Pushes, Some(last)) = (contact.role, last) {
            contact.state.origin -= last.tangential(step.from, reach);
        }
        contact.distance
    }

    /// Finds the nearest points at the start of the substep, or takes those that are `known`, and what becomes of the
    /// pair on the path to `to` (m).
    pub(super) fn prepare(
        &mut self,
        near: &Near,
        step: &ContactStep<'_>,
        to: &[Vec3],
        known: Option<&PairConstraint>,
    ) {
        let vertices = self.pair.vertices;
        let x = gather(step.from, vertices);
        match known {
            Some(known) => {
                (self.normal, self.weights, self.area) = (known.normal, known.weights, known.area);
                self.distance = self.normal.dot(&self.point(step.from));
            }
            None => {
                let gap = Gap::new(self.pair.kind, &x);
                (self.normal, self.weights, self.distance) =
                    (gap.normal, gap.weights, gap.distance);
            }
        }
        self.approach = self.distance - self.normal.dot(&self.point(to));
        let w = vertices.map(|v| step.inverse_mass[v as usize]);
        let squares = self.weights.iter().zip(w);
        self.inverse_effective_mass = squares.map(|(weight, w)| weight * weight * w).sum();
        let reach = self.thickness + DETECTION_MARGIN * near.law.range();
        let comes = self.distance - self.approach.max(0.0) < reach;
        let is_at_boundary = self.weights.contains(&0.0);
        let faces = self.distance < self.thickness || !is_at_boundary;
        self.role = Role::Tested;
        self.state.origin = self.point(step.from);
        self.state.coefficient = near.friction(vertices);
        self.state.range = self.thickness;
        if comes && faces && self.inverse_effective_mass > 0.0 {
            if known.is_none() {
                self.area = near.area_of(self.pair, self.area_at_rest, &x);
            }
            let law = near.law.with_range(self.thickness);
            let tangent = Tangent::of(law, self.area, self.distance);
            self.state.range = tangent.range;
            if tangent.stiffness > 0.0 {
                self.role = Role::Pushes;
                self.state.compliance = tangent.compliance(step.dt);
            }
        }
    }

    /// Distance (m) to keep.
    fn kept(&self) -> Real {
        KEPT * self.distance.min(self.thickness)
    }

    #[inline(always)]
    pub(super) fn point(&self, x: &[Vec3]) -> Vec3 {
        weighted(self.pair.vertices, self.weights, x)
    }

    /// See [`ConstraintState::tangential`]; at `x` (m).
    fn tangential(&self, x: &[Vec3], reach: Real) -> Vec3 {
        self.state.tangential(self.point(x), self.normal, reach)
    }

    #[inline]
    pub(super) fn project(&mut self, w: &[Real], x: &mut [Vec3]) {
        let point = self.point(x);
        let at = Distance::exact(self.normal.dot(&point), self.normal);
        if let Some(push) = self.state.project(&at, point, self.inverse_effective_mass) {
            for k in 0..4 {
                let v = self.pair.vertices[k] as usize;
                x[v] += push * (self.weights[k] * w[v]);
            }
        }
    }

    /// Takes its compliance away: for a pair that has come too near on the way to `x` (m).
    pub(super) fn harden(&mut self, x: &[Vec3]) {
        if self.inverse_effective_mass > 0.0 {
            self.role = Role::Pushes;
        }
        let now = self.normal.dot(&self.point(x));
        let least = LEAST * self.thickness;
        self.state.harden(self.distance, least, now);
    }

    /// Notes whether the pair keeps its distance on the path to `to` (m). One that its plane does not keep apart there
    /// is no [`Role::Separated`] any more.
    pub(super) fn test(&mut self, near: &Near, step: &ContactStep<'_>, to: &[Vec3]) {
        self.is_violated = false;
        if self.role == Role::Separated {
            if self.pair.gap_along(&self.normal, to) > KEPT * self.thickness {
                return;
            }
            self.prepare(near, step, to, None);
        }
        let kept = self.kept();
        let is_apart = |x| self.pair.gap_along(&self.normal, x) - kept > 0.0;
        if is_apart(to) && is_apart(step.from) {
            return;
        }
        let path = Query::of(self.pair, step.from, to);
        self.is_violated = !path.is_shift(self.distance) && path.time_at(kept).is_some();
    }

    /// Energy A ψ(d) (J) at `x` (m), with the true distance d there.
    ///
    /// What has pushed is the tangent of the law at the start of the substep ([`Tangent`]): down to 0.05 h its force is
    /// that of this energy but for the square of what d has changed by. Below, the force stays that at 0.05 h, and is
    /// less than −A ψ′(d). So for a pair nearer than that the energy that contact is said to have given
    /// ([`ContactConstraints::given`](cloth_core::contact::ContactConstraints::given)) is not what its pushes have
    /// done.
    pub(super) fn energy(&self, x: &[Vec3], near: &Near) -> Real {
        let x = gather(x, self.pair.vertices);
        let law = near.law.with_range(self.thickness);
        let distance = Gap::new(self.pair.kind, &x).distance;
        near.area_of(self.pair, self.area_at_rest, &x) * law.energy(distance)
    }
}

//! One unilateral constraint between two pieces: what it is made from, and how positions are projected onto it.

use super::near::Near;
use super::patches::{Known, Memory, NearPair, Patches, Place};
use super::rows::{KEPT, LEAST, SLACK};
use super::tangent::{RowState, Tangent};
use crate::ccd::Query;
use crate::obstacle::Distance;
use crate::pair::{Gap, Pair, ends, weighted};
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3, gather};

/// Travel of patches (in thicknesses) during which the nearest points of two pieces stay what they are.
const PERSISTENT: Real = 0.02;

/// A pair that can touch in this substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) place: Place,
    pub(super) pair: Pair,
    pub(super) weights: [Real; 4],
    pub(super) normal: Vec3,
    /// At the start of the substep (m).
    pub(super) distance: Real,
    /// Of the point Σ wᵢ xᵢ (m).
    pub(super) state: RowState,
    /// Σ wᵢ²/mᵢ (1/kg).
    pub(super) ease: Real,
    /// Distance (m) to keep, and to come back to.
    pub(super) kept: Real,
    pub(super) least: Real,
    /// Whether it pushes, or is only tested.
    pub(super) pushes: bool,
    pub(super) is_violated: bool,
    /// By how much it would get nearer in the substep (m).
    pub(super) approach: Real,
}

/// A pair that a plane keeps apart in the predicted motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parted {
    pub(super) place: Place,
    pub(super) pair: Pair,
    pub(super) normal: Vec3,
    /// Distance (m) to keep.
    pub(super) kept: Real,
}

impl Row {
    /// Of a pair at `x` (m), in a substep of `dt` (s) in which it would go to `to` (m).
    pub(super) fn new(
        place: Place,
        (found, memory): (&NearPair, &mut Memory),
        near: &Near,
        step: &ContactStep<'_>,
        to: &[Vec3],
        travel: Option<Real>,
    ) -> Self {
        let (law, pair) = (near.law, found.pair);
        let x = gather(step.from, pair.vertices);
        let fresh =
            |known: &Known| travel.is_some_and(|t| t - known.travel <= PERSISTENT * law.range());
        let known = memory.known.filter(fresh);
        let sum = |x: &[Vec3], weights: [Real; 4]| weighted(pair.vertices, weights, x);
        let gap = match &known {
            Some(known) => Gap {
                distance: known.gap.normal.dot(&sum(step.from, known.gap.weights)),
                ..known.gap
            },
            None => Gap::new(pair.kind, &x),
        };
        let approach = gap.distance - gap.normal.dot(&sum(to, gap.weights));
        let w = pair.vertices.map(|v| step.inverse_mass[v as usize]);
        let ease = (0..4).map(|k| gap.weights[k] * gap.weights[k] * w[k]).sum();
        let comes = gap.distance - approach.max(0.0) < found.range + SLACK * law.range();
        let faces = gap.distance < found.range || !gap.is_at_boundary();
        let mut pushes = comes && faces && ease > 0.0;
        let mut tangent = Tangent {
            range: found.range,
            stiffness: 0.0,
        };
        if pushes {
            let area = match &known {
                Some(known) => known.area,
                None => near.area_of(found, &x),
            };
            if known.is_none() {
                memory.known = travel.map(|travel| Known { gap, area, travel });
            }
            tangent = Tangent::of(law.with_range(found.range), area, gap.distance);
            pushes = tangent.stiffness > 0.0;
        } else {
            memory.stretch = Vec3::zeros();
        }
        Self {
            place,
            pair,
            weights: gap.weights,
            normal: gap.normal,
            distance: gap.distance,
            state: RowState {
                range: tangent.range,
                compliance: match pushes {
                    true => tangent.compliance(step.dt),
                    false => 0.0,
                },
                coefficient: near.friction(pair.vertices),
                origin: sum(step.from, gap.weights) - memory.stretch,
                ..RowState::default()
            },
            ease,
            kept: KEPT * gap.distance.min(found.range),
            least: LEAST * found.range,
            pushes,
            is_violated: false,
            approach,
        }
    }

    pub(super) fn point(&self, x: &[Vec3]) -> Vec3 {
        weighted(self.pair.vertices, self.weights, x)
    }

    #[inline]
    pub(super) fn project(&mut self, w: &[Real], x: &mut [Vec3]) {
        let point = self.point(x);
        let at = Distance::exact(self.normal.dot(&point), self.normal);
        if let Some(push) = self.state.project(&at, point, self.ease) {
            for (v, weight) in ends(self.pair.vertices, self.weights) {
                x[v] += push * (weight * w[v]);
            }
        }
    }

    /// Gives in no more: for a pair that has come too near on the way to `x` (m).
    pub(super) fn harden(&mut self, x: &[Vec3]) {
        self.pushes = self.ease > 0.0;
        let now = self.normal.dot(&self.point(x));
        self.state.harden(self.distance, self.least, now);
    }

    pub(super) fn is_safe(&self, from: &[Vec3], to: &[Vec3]) -> bool {
        let path = Query::of(self.pair, from, to);
        path.is_apart_along(&self.normal, self.kept)
            || path.is_shift(self.distance)
            || path.time_at(self.kept).is_none()
    }

    /// Energy (J) at `x` (m).
    pub(super) fn energy(&self, x: &[Vec3], near: &Near, patches: Option<&mut Patches>) -> Real {
        let found = patches.and_then(|patches| patches.pair_mut(self.place, self.pair));
        found.map_or(0.0, |(found, _)| {
            let x = gather(x, self.pair.vertices);
            let law = near.law.with_range(found.range);
            near.area_of(found, &x) * law.energy(Gap::new(self.pair.kind, &x).distance)
        })
    }
}

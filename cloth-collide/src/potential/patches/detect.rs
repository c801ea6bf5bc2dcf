//! The pairs of primitives between two patches.

use super::between::PatchPair;
use super::{LARGEST_BOUND, LEAST_BOUND, MOTIONS, NearPair, PATCH, Patches};
use crate::bounds::Bounds;
use crate::pair::{Pair, nearest};
use crate::potential::constraints::DETECTION_MARGIN;
use crate::potential::near::Near;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::method::parallel::{join, wide};

/// Queries that are not split between threads any more, at most.
const BATCH: usize = 8;

/// What is asked of two patches.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchQuery {
    /// The number of the pair of patches.
    pub(super) number: u32,
    /// By how much (m) the two have moved relative to each other since their pairs were found, and how much they may in
    /// the motion at hand.
    pub(super) now: Real,
    pub(super) once: Real,
    /// The answer: how far (m) they can move until another pair may touch.
    pub(super) left: Real,
}

impl PatchQuery {
    pub(super) fn new(number: usize, now: Real, once: Real) -> Self {
        Self {
            number: number as u32,
            now,
            once,
            left: 0.0,
        }
    }

    /// Both together (m).
    pub(super) fn moved(&self) -> Real {
        self.now + self.once
    }
}

impl Patches {
    /// Makes sure that the pairs of primitives are complete for what is asked.
    pub(super) fn find(&mut self, near: &Near, x: &[Vec3], queries: &mut [PatchQuery]) {
        for query in &*queries {
            let pair = &self.pairs[query.number as usize];
            if query.moved() > pair.budget {
                let [p, q] = pair.patches.map(|p| p as usize);
                self.refer(p);
                self.refer(q);
            }
        }
        let mut pairs = std::mem::take(&mut self.pairs);
        self.detections += self.detect_all(near, x, &mut pairs, 0, queries);
        self.pairs = pairs;
    }

    /// Finds the pairs of primitives anew where they do not reach, on several threads. The first of the pairs of
    /// patches has the number `first`. Returns how many were searched.
    fn detect_all(
        &self,
        near: &Near,
        x: &[Vec3],
        pairs: &mut [PatchPair],
        first: usize,
        queries: &mut [PatchQuery],
    ) -> u32 {
        if queries.len() > BATCH {
            let (one, other) = queries.split_at_mut(queries.len() / 2);
            let middle = other[0].number as usize;
            let (before, after) = pairs.split_at_mut(middle - first);
            let (a, b) = join(
                x.len(),
                || self.detect_all(near, x, before, first, one),
                || self.detect_all(near, x, after, middle, other),
            );
            return a + b;
        }
        let mut count = 0;
        for query in queries {
            let pair = &mut pairs[query.number as usize - first];
            if query.moved() > pair.budget {
                count += u32::from(self.detect(near, x, pair, query.once));
                query.now = 0.0;
            }
        }
        count
    }

    /// Finds the pairs between two patches anew, with a motion bound for the present motion, of `once` (m), and more.
    /// Returns whether they are near at all.
    fn detect(&self, near: &Near, x: &[Vec3], pair: &mut PatchPair, once: Real) -> bool {
        let h = near.law.range();
        let [p, q] = pair.patches.map(|p| p as usize);
        let boxes = [p, q].map(|p| Bounds::of_vertices(&self.members[p].1, x));
        let bound = self.motion_bound(near, once);
        pair.pose = self.now.pose(pair.patches);
        pair.spread = self.now.spread(pair.patches);
        pair.travel = 0.0;
        (pair.first, pair.next) = (0, Real::NEG_INFINITY);
        pair.active_from.clear();
        pair.known.clear();
        let known = pair.pairs.drain(..).filter(|old| self.has_constraint(old));
        pair.known.extend(known);
        let gap = boxes[0].squared_gap(&boxes[1]).sqrt();
        if gap > h + bound {
            pair.budget = gap - h;
            return false;
        }
        pair.budget = bound;
        self.collect(near, x, ([p, q], boxes), h + bound, &mut pair.pairs);
        let order = |a: &NearPair, b: &NearPair| {
            let excess = a.excess.total_cmp(&b.excess);
            excess.then_with(|| a.pair.cmp(&b.pair))
        };
        pair.pairs.sort_unstable_by(order);
        pair.active_from
            .extend(pair.pairs.iter().map(|pair| pair.excess));
        pair.known.sort_unstable_by_key(|old| old.pair);
        if !pair.known.is_empty() {
            for found in &mut pair.pairs {
                if let Ok(old) = pair.known.binary_search_by_key(&found.pair, |old| old.pair) {
                    (found.seen, found.constraint) =
                        (pair.known[old].seen, pair.known[old].constraint);
                }
            }
        }
        true
    }

    /// The motion bound (m) of a detection, where patches move by `once` (m) in the motion.
    fn motion_bound(&self, near: &Near, once: Real) -> Real {
        let h = near.law.range();
        let once = once + DETECTION_MARGIN * h;
        let largest = (LARGEST_BOUND * self.edge).max(h) * self.share;
        let bound = (MOTIONS * once).min(largest).max(LEAST_BOUND * h);
        bound.max(1.5 * once)
    }

    /// Appends the pairs of primitives of two patches that are nearer than `reach` (m) at `x` (m).
    fn collect(
        &self,
        near: &Near,
        x: &[Vec3],
        ([p, q], boxes): ([usize; 2], [Bounds; 2]),
        reach: Real,
        out: &mut Vec<NearPair>,
    ) {
        let is_near = |a: &Bounds, b: &Bounds| a.squared_gap(b) <= reach * reach;
        let at = |v: u32| x[v as usize];
        let bounds = |t: u32| Bounds::around(near.incidence.triangles[t as usize].map(at));
        let mut others: [(u32, Bounds); PATCH] = [(0, boxes[0]); PATCH];
        // The same bounds, coordinate by coordinate: none overlaps what is nowhere.
        let mut sides = [[Real::INFINITY; PATCH]; 6];
        let mut count = 0;
        for &u in &self.members[q].0 {
            let bounds = bounds(u);
            if is_near(&bounds, &boxes[0]) {
                others[count] = (u, bounds);
                for axis in 0..3 {
                    sides[axis][count] = bounds.lower[axis];
                    sides[3 + axis][count] = bounds.upper[axis];
                }
                count += 1;
            }
        }
        for &t in &self.members[p].0 {
            let own = bounds(t);
            if !is_near(&own, &boxes[1]) {
                continue;
            }
            let mut near_boxes = wide(|| nearer(&own, &sides, reach * reach));
            while near_boxes != 0 {
                let (u, other) = &others[near_boxes.trailing_zeros() as usize];
                near_boxes &= near_boxes - 1;
                if p == q && *u <= t {
                    continue;
                }
                let reaches = |ends, _| is_near(&Bounds::around(gather(x, ends)), other);
                near.incidence.visit([t, *u], reaches, |pair, numbers| {
                    out.extend(near_pair(near, x, pair, numbers, reach));
                });
            }
        }
    }
}

/// A vertex and a triangle, or two edges, with their numbers, if they are nearer than `reach` (m) at `x` (m).
#[inline]
fn near_pair(
    near: &Near,
    x: &[Vec3],
    pair: Pair,
    numbers: [u32; 2],
    reach: Real,
) -> Option<NearPair> {
    let places = gather(x, pair.vertices);
    let (one, other) = places.split_at(pair.kind.split());
    if Bounds::of(one).squared_gap(&Bounds::of(other)) > reach * reach || near.is_kept_out(pair) {
        return None;
    }
    let distance = nearest(pair.kind, &places).1.norm();
    if distance >= reach || !near.meets(pair.vertices) {
        return None;
    }
    let range = near.range_of(pair);
    Some(NearPair {
        excess: distance - range,
        range,
        area: near.area_at_rest(pair, numbers),
        pair,
        known_at: Real::NEG_INFINITY,
        seen: 0,
        constraint: [0; 2],
    })
}

/// Which of the boxes, given coordinate by coordinate (m), are nearer than the root of `squared` (m²): a bit for each.
#[inline(always)]
fn nearer(own: &Bounds, sides: &[[Real; PATCH]; 6], squared: Real) -> u32 {
    let mut sum = [0.0; PATCH];
    for axis in 0..3 {
        let (low, high) = (own.lower[axis], own.upper[axis]);
        let (lower, upper) = (&sides[axis], &sides[3 + axis]);
        for k in 0..PATCH {
            let (after, before) = (lower[k] - high, low - upper[k]);
            let gap = if after > before { after } else { before };
            let gap = if gap > 0.0 { gap } else { 0.0 };
            sum[k] += gap * gap;
        }
    }
    let bits = sum.iter().enumerate();
    bits.fold(0, |bits, (k, sum)| bits | (u32::from(*sum < squared) << k))
}

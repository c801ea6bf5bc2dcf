//! The pairs of primitives between two patches.

use super::between::PatchPair;
use super::{HOLD, LEAST_ROOM, MOST_ROOM, NearPair, PATCH, Patches, around};
use crate::bounds::Bounds;
use crate::pair::{Pair, nearest};
use crate::potential::near::Near;
use crate::potential::rows::SLACK;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::method::parallel::{join, wide};

/// Looks at pairs of patches that are not split between threads any more, at most.
const BATCH: usize = 8;

/// A look at the motion of two patches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// The number of the pair of patches.
    pub(super) number: u32,
    /// By how much (m) the two have moved against each other since their pairs were found: now, and at most in the
    /// motion; and in the motion alone.
    pub(super) now: Real,
    pub(super) moved: Real,
    pub(super) once: Real,
    /// How far (m) they can move until another pair may touch, once that is known.
    pub(super) left: Real,
}

impl Look {
    pub(super) fn new(number: usize, [now, moved, once]: [Real; 3]) -> Self {
        Self {
            number: number as u32,
            now,
            moved,
            once,
            left: 0.0,
        }
    }
}

impl Patches {
    /// Makes sure that the pairs of primitives are complete for what is looked at.
    pub(super) fn find(&mut self, near: &Near, x: &[Vec3], looks: &mut [Look]) {
        for look in &*looks {
            let pair = &self.pairs[look.number as usize];
            if look.moved > pair.budget {
                let [p, q] = pair.patches.map(|p| p as usize);
                self.refer(p);
                self.refer(q);
            }
        }
        let mut pairs = std::mem::take(&mut self.pairs);
        self.detections += self.detect_all(near, x, &mut pairs, 0, looks);
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
        looks: &mut [Look],
    ) -> u32 {
        if looks.len() > BATCH {
            let (one, other) = looks.split_at_mut(looks.len() / 2);
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
        for look in looks {
            let pair = &mut pairs[look.number as usize - first];
            if look.moved > pair.budget {
                count += u32::from(self.detect(near, x, pair, look.once));
                (look.now, look.moved) = (0.0, look.once);
            }
        }
        count
    }

    /// Finds the pairs between two patches anew, with room for the present motion, of `once` (m), and more. Returns
    /// whether they are near at all.
    fn detect(&self, near: &Near, x: &[Vec3], pair: &mut PatchPair, once: Real) -> bool {
        let h = near.law.range();
        let [p, q] = pair.patches.map(|p| p as usize);
        let boxes = [p, q].map(|p| around(&self.members[p].1, x));
        let room = self.room_for(near, once);
        (pair.last_apart, pair.last_path) = self.now.of(pair.patches);
        pair.pose = self.now.pose(pair.patches);
        pair.spread = self.now.spread(pair.patches);
        pair.travel = 0.0;
        (pair.first, pair.next) = (0, Real::NEG_INFINITY);
        pair.wakes.clear();
        pair.known.clear();
        let known = pair.pairs.drain(..).filter(|old| self.has_row(old));
        pair.known.extend(known);
        let gap = boxes[0].squared_gap(&boxes[1]).sqrt();
        if gap > h + room {
            pair.budget = gap - h;
            return false;
        }
        pair.budget = room;
        self.collect(near, x, ([p, q], boxes), h + room, &mut pair.pairs);
        let order = |a: &NearPair, b: &NearPair| {
            let rooms = a.room.total_cmp(&b.room);
            rooms.then_with(|| a.pair.cmp(&b.pair))
        };
        pair.pairs.sort_unstable_by(order);
        pair.wakes.extend(pair.pairs.iter().map(|pair| pair.room));
        pair.known.sort_unstable_by_key(|old| old.pair);
        if !pair.known.is_empty() {
            for found in &mut pair.pairs {
                if let Ok(old) = pair.known.binary_search_by_key(&found.pair, |old| old.pair) {
                    (found.seen, found.row) = (pair.known[old].seen, pair.known[old].row);
                }
            }
        }
        true
    }

    /// The room (m) of a search, where patches move by `once` (m) in the motion.
    fn room_for(&self, near: &Near, once: Real) -> Real {
        let h = near.law.range();
        let once = once + SLACK * h;
        let room = (HOLD * once).clamp(LEAST_ROOM * h, (MOST_ROOM * self.edge).max(h));
        room.max(1.5 * once)
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
        room: distance - range,
        range,
        area: near.area_at_rest(pair, numbers),
        pair,
        known_at: Real::NEG_INFINITY,
        seen: 0,
        row: [0; 2],
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

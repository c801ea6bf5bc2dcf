//! The pairs of primitives between two patches.

use super::{HOLD, LEAST_ROOM, MOST_ROOM, NearPair, PATCH, Patches, around};
use crate::bounds::Bounds;
use crate::ccd::QueryKind;
use crate::closest::{edge_edge, point_triangle};
use crate::potential::gap::Gap;
use crate::potential::near::Near;
use crate::potential::rows::SLACK;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::parallel::wide;

/// Two primitives that are near each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Close {
    /// What they lack to contact (m).
    room: Real,
    kind: QueryKind,
    vertices: [u32; 4],
    /// As in [`NearPair`].
    range: Real,
    area: Real,
}

impl NearPair {
    fn new(close: &Close) -> Self {
        Self {
            kind: close.kind,
            vertices: close.vertices,
            range: close.range,
            area: close.area,
            seen: 0,
            stretch: Vec3::zeros(),
            normal: Vec3::zeros(),
            known: None,
        }
    }
}

impl Patches {
    /// Finds the pairs between two patches anew, with room for the present motion and more.
    pub(super) fn detect(&mut self, near: &Near, x: &[Vec3], k: usize, once: Real) {
        let h = near.law().range();
        let [p, q] = self.pairs[k].patches.map(|p| p as usize);
        let boxes = [p, q].map(|p| around(&self.members[p].1, x));
        let room = self.room_for(near, once);
        self.refer(p, x);
        self.refer(q, x);
        let pair = &mut self.pairs[k];
        (pair.last_apart, pair.last_path) = self.now.of(pair.patches);
        pair.apart = pair.last_apart;
        pair.spread = self.now.spreads[p] + self.now.spreads[q];
        pair.travel = 0.0;
        self.memory.clear();
        let stretched = pair.pairs.iter().filter(|p| p.stretch != Vec3::zeros());
        self.memory.extend(stretched);
        let mut close = std::mem::take(&mut self.close);
        close.clear();
        let gap = boxes[0].squared_gap(&boxes[1]).sqrt();
        let mut budget = room;
        if gap > h + room {
            budget = gap - h;
        } else {
            self.detections += 1;
            self.collect(near, x, ([p, q], boxes), h + room, &mut close);
            close.sort_unstable_by(|a, b| {
                let of = |pair: &Close| (pair.kind == QueryKind::EdgeEdge, pair.vertices);
                a.room.total_cmp(&b.room).then_with(|| of(a).cmp(&of(b)))
            });
        }
        let pair = &mut self.pairs[k];
        pair.budget = budget;
        pair.pairs.clear();
        pair.pairs.extend(close.iter().map(NearPair::new));
        pair.rooms.clear();
        pair.rooms.extend(close.iter().map(|close| close.room));
        pair.wakes.clone_from(&pair.rooms);
        (pair.first, pair.next) = (0, Real::NEG_INFINITY);
        for old in &self.memory {
            let same =
                |pair: &&mut NearPair| pair.vertices == old.vertices && pair.kind == old.kind;
            if let Some(pair) = pair.pairs.iter_mut().find(same) {
                pair.stretch = old.stretch;
            }
        }
        self.close = close;
    }

    /// The room (m) of a search, where patches move by `once` (m) in the substep.
    fn room_for(&self, near: &Near, once: Real) -> Real {
        let h = near.law().range();
        let once = once + 2.0 * SLACK * h;
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
        out: &mut Vec<Close>,
    ) {
        let big = boxes[0].loosened(reach);
        let at = |v: u32| x[v as usize];
        let bounds = |t: u32| Bounds::around(self.triangles[t as usize].map(at));
        let mut others: [(u32, Bounds); PATCH] = [(0, big); PATCH];
        // The same bounds, coordinate by coordinate: none overlaps what is nowhere.
        let mut sides = [[Real::INFINITY; PATCH]; 6];
        let mut count = 0;
        for &u in &self.members[q].0 {
            let bounds = bounds(u);
            if bounds.overlaps(&big) {
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
            if !own.loosened(reach).overlaps(&boxes[1]) {
                continue;
            }
            let mut near_boxes = wide(|| nearer(&own, &sides, reach * reach));
            while near_boxes != 0 {
                let (u, other) = &others[near_boxes.trailing_zeros() as usize];
                near_boxes &= near_boxes - 1;
                if p == q && *u <= t {
                    continue;
                }
                self.add_vertices(near, x, [t, *u], other, reach, out);
                self.add_vertices(near, x, [*u, t], &own, reach, out);
                self.add_edges(near, x, [t, *u], other, reach, out);
            }
        }
    }

    fn add_vertices(
        &self,
        near: &Near,
        x: &[Vec3],
        [t, u]: [u32; 2],
        bounds: &Bounds,
        reach: Real,
        out: &mut Vec<Close>,
    ) {
        let corners = self.triangles[u as usize];
        for k in (0..3).filter(|&k| self.owned[t as usize].vertices[k]) {
            let vertex = self.triangles[t as usize][k];
            let place = Bounds::around([x[vertex as usize]]);
            if corners.contains(&vertex) || place.squared_gap(bounds) > reach * reach {
                continue;
            }
            let distance = point_triangle(x[vertex as usize], gather(x, corners)).distance();
            if distance < reach {
                let vertices = [vertex, corners[0], corners[1], corners[2]];
                let rest = |x: &[Vec3; 4]| Gap::vertex_triangle(x).distance;
                let range = near.law_of(vertices, rest).range();
                let area = near.vertex_area[vertex as usize];
                push(
                    near,
                    QueryKind::VertexTriangle,
                    vertices,
                    [range, area, distance],
                    out,
                );
            }
        }
    }

    fn add_edges(
        &self,
        near: &Near,
        x: &[Vec3],
        [t, u]: [u32; 2],
        bounds: &Bounds,
        reach: Real,
        out: &mut Vec<Close>,
    ) {
        for i in (0..3).filter(|&i| self.owned[t as usize].edges[i]) {
            let e = self.triangle_edges[t as usize][i] as usize;
            let first = self.edges[e];
            let own = Bounds::around(gather(x, first));
            if own.squared_gap(bounds) > reach * reach {
                continue;
            }
            for j in (0..3).filter(|&j| self.owned[u as usize].edges[j]) {
                let f = self.triangle_edges[u as usize][j] as usize;
                let second = self.edges[f];
                if first.iter().any(|v| second.contains(v)) {
                    continue;
                }
                let other = gather(x, second);
                if own.squared_gap(&Bounds::around(other)) > reach * reach {
                    continue;
                }
                let distance = edge_edge(gather(x, first), other).distance();
                if distance < reach {
                    let vertices = [first[0], first[1], second[0], second[1]];
                    let rest = |x: &[Vec3; 4]| Gap::edge_edge(x).distance;
                    let range = near.law_of(vertices, rest).range();
                    let area = near.edge_area[e].min(near.edge_area[f]);
                    push(
                        near,
                        QueryKind::EdgeEdge,
                        vertices,
                        [range, area, distance],
                        out,
                    );
                }
            }
        }
    }
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

fn push(
    near: &Near,
    kind: QueryKind,
    vertices: [u32; 4],
    [range, area, distance]: [Real; 3],
    out: &mut Vec<Close>,
) {
    if vertices.iter().any(|&v| near.is_free[v as usize]) {
        out.push(Close {
            room: distance - range,
            kind,
            vertices,
            range,
            area,
        });
    }
}

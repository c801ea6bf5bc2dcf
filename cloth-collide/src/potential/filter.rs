//! How far a path is safe.

use super::near::Near;
use super::near_pairs::{ChosenPair, NearPairs};
use crate::ccd::Query;
use crate::obstacle::{Obstacle, VertexPath, first_contact};
use crate::pair::Gap;
use cloth_core::math::{Real, Vec3};

/// What a path leaves of each distance, or of the thickness where that is less.
const SLACK: Real = 0.2;
/// The continuous test may end when this part of what is above that is left.
const EARLY: Real = 0.1;
/// Distances below this part of the coordinates cannot be relied on: positions on the path are rounded.
const ROUNDING: Real = 64.0 * Real::EPSILON;
/// Rounds in which paths are shortened one by one, each because of a neighbour's in the round before. After that all
/// are shortened alike.
const ROUNDS: u32 = 20;

impl NearPairs {
    /// The part of a path (m) on which every near pair keeps [`SLACK`] of its distance.
    pub(super) fn safe_part(
        &self,
        near: &Near,
        from: &[Vec3],
        to: &[Vec3],
        obstacles: &[Obstacle],
    ) -> Real {
        let mut cap: Real = 1.0;
        for pair in self.iter() {
            cap = cap.min(time_of_pair(pair, from, to));
        }
        for &[vertex, number] in &self.vertex_obstacle {
            let (v, obstacle) = (vertex as usize, &obstacles[number as usize]);
            cap = cap.min(time_of_obstacle(
                obstacle,
                near.law_at(v).range(),
                from[v],
                to[v],
            ));
        }
        cap
    }

    /// Takes vertices back on their paths (m) until every near pair keeps [`SLACK`] of its distance: all vertices of a
    /// pair that does not by the same fraction, and again where that brings others too near. `parts` is what is left of
    /// each path. Returns whether that changed anything.
    pub(super) fn shorten(
        &mut self,
        near: &Near,
        path: (&[Vec3], &mut [Vec3]),
        parts: &mut [Real],
        obstacles: &[Obstacle],
    ) -> bool {
        let (from, to) = path;
        let mut is_cut = false;
        for &[vertex, number] in &self.vertex_obstacle {
            let v = vertex as usize;
            let obstacle = &obstacles[number as usize];
            let part = time_of_obstacle(obstacle, near.law_at(v).range(), from[v], to[v]);
            is_cut |= part < 1.0;
            shorten_one(from, to, parts, v, part);
        }
        let [mut before, mut now] = std::mem::take(&mut self.fractions);
        before.clear();
        before.resize(from.len(), 0.0);
        let mut rounds = 0;
        let is_done = loop {
            now.clear();
            now.resize(from.len(), 1.0);
            let was_cut = |v: &[u32; 4]| v.iter().any(|&v| before[v as usize] < 1.0);
            let mut is_short = false;
            let mut take = |vertices: [u32; 4], part: Real| {
                is_short |= part < 1.0;
                for vertex in vertices {
                    let fraction = &mut now[vertex as usize];
                    *fraction = fraction.min(part);
                }
            };
            for chosen in self.iter() {
                let vertices = chosen.contact.pair.vertices;
                if was_cut(&vertices) {
                    take(vertices, time_of_pair(chosen, from, to));
                }
            }
            if !is_short || rounds == ROUNDS {
                break !is_short;
            }
            is_cut = true;
            rounds += 1;
            for (vertex, part) in now.iter().enumerate() {
                shorten_one(from, to, parts, vertex, *part);
            }
            std::mem::swap(&mut before, &mut now);
        };
        self.fractions = [before, now];
        if !is_done {
            let cap = self.safe_part(near, from, to, obstacles);
            shorten_all(from, to, parts, cap);
        }
        is_cut
    }
}

/// As [`time_of_pair`], of a vertex on its path from `a` to `b` (m) before an obstacle.
fn time_of_obstacle(obstacle: &Obstacle, thickness: Real, a: Vec3, b: Vec3) -> Real {
    let gap = obstacle.signed_distance(a, 0.0).value;
    let keep = SLACK * gap.min(thickness);
    if keep <= ROUNDING * a.amax().max(b.amax()) {
        return if a == b { 1.0 } else { 0.0 };
    }
    if (b - a).norm() * obstacle.shape().lipschitz() < gap - keep {
        return 1.0;
    }
    let path = VertexPath::straight(a, b, 1.0);
    first_contact(obstacle, &path, 0.0, 1.0, keep).map_or(1.0, |hit| hit.time)
}

/// Shortens the path of one vertex to a part of itself.
fn shorten_one(from: &[Vec3], to: &mut [Vec3], parts: &mut [Real], vertex: usize, part: Real) {
    if part < 1.0 {
        parts[vertex] *= part;
        to[vertex] = from[vertex] + (to[vertex] - from[vertex]) * part;
    }
}

/// Shortens all paths to the same part of themselves.
pub(super) fn shorten_all(from: &[Vec3], to: &mut [Vec3], parts: &mut [Real], part: Real) {
    if part == 1.0 {
        return;
    }
    for vertex in 0..from.len() {
        shorten_one(from, to, parts, vertex, part);
    }
}

/// The time (dimensionless, 0..=1) at which a pair's distance is down to [`SLACK`] of that at the start, or of the
/// thickness; 1 if that does not happen.
fn time_of_pair(chosen: &ChosenPair, from: &[Vec3], to: &[Vec3]) -> Real {
    let near = &chosen.contact;
    let path = Query::of(near.pair, from, to);
    if chosen.stays_apart(&path, SLACK * near.law.range()) {
        return 1.0;
    }
    let distance = Gap::new(path.kind, &path.from).distance;
    let keep = SLACK * distance.min(near.law.range());
    if approach(&path) < distance - keep {
        return 1.0;
    }
    let places = path.from.iter().chain(&path.to);
    let size = places.map(Vec3::amax).fold(0.0, Real::max);
    if keep <= ROUNDING * size {
        return 0.0;
    }
    path.time_near(keep, EARLY).unwrap_or(1.0)
}

/// The most by which two pieces can have come nearer (m) on their path.
fn approach(path: &Query) -> Real {
    let displacements: [Vec3; 4] = std::array::from_fn(|k| path.to[k] - path.from[k]);
    let mean = displacements.iter().sum::<Vec3>() * 0.25;
    let sizes = displacements.map(|displacement| (displacement - mean).norm());
    let (first, second) = sizes.split_at(path.kind.split());
    let most = |sizes: &[Real]| sizes.iter().fold(0.0, |a: Real, b| a.max(*b));
    most(first) + most(second)
}

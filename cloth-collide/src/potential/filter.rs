//! How far a path is safe.
//!
//! For one fraction of all paths (`limit`) the pairs are tested once, and the least fraction counts. For a fraction of
//! each (`limit_each`) a cut calls for others: a vertex that stays behind may now be in the way of one that does not,
//! or be near pairs that were not chosen for the whole path. So it goes on in two loops, both of which end:
//!
//! 1. `NearPairs::shorten` cuts the vertices of the pairs that are not safe, tests the pairs around what it has cut,
//!    and so on, 20 times. What is not safe then is cut by one fraction for all vertices, which is safe for every pair.
//! 2. `Contacts::limit_each` (in `source`) chooses pairs anew for the paths that are left, and does 1 again if there
//!    are other pairs, 10 times. After that it cuts all vertices alike.
//!
//! Rounding. What 1 has cut is tested again where it then ends. After a cut by one fraction t, here or by who calls
//! `limit`, a coordinate of `from + t (to − from)` is off by up to 5 roundings of the largest coordinate S: 2 of the
//! difference and 2 of the product, as both may be 2 S large, and 1 of the sum. A rounding is ε/2, ε = 2⁻⁵²; so the
//! distance of two primitives is off by up to 2 √3 · 2.5 ε S < 9 ε S at the end of the path, and by less before. A pair
//! that needs the continuous test moves only if it is to keep more than 64 ε S ([`ROUNDING`]), so it stays apart.

use super::near::Near;
use super::near_pairs::{ChosenPair, NearPairs};
use crate::ccd::Query;
use crate::obstacle::{Obstacle, VertexPath, first_contact};
use crate::pair::Gap;
use cloth_core::math::{Real, Vec3};

/// The fraction of each distance, or of the thickness where that is less, that a path keeps. A continuous test that is
/// to keep more stops earlier; one that keeps less leaves the next iteration a stiffness A ψ″ that grows as 1/d².
const KEPT: Real = 0.2;
/// The continuous test may end when this fraction of what is above that is left.
const EARLY: Real = 0.1;
/// Distance (in ranges) below which a pair also keeps this fraction of what the linearised motion leaves it. What slides
/// along a bend comes nearer by the square of its way, and would be pressed far beyond its force before it has gone it.
const DEEP: Real = 0.25;
const CENTRAL: Real = 0.6;
/// What a fraction is shortened to that leaves less, and how often.
const SHORTER: Real = 0.7;
const MOST_SHORTENINGS: u32 = 12;
/// Distances below this fraction of the coordinates cannot be relied on: positions on the path are rounded.
const ROUNDING: Real = 64.0 * Real::EPSILON;
/// Rounds in which paths are shortened one by one, each because of a neighbour's in the round before. After that all
/// are shortened alike.
const ROUNDS: u32 = 20;

impl NearPairs {
    /// The fraction of a path (m) on which every near pair keeps [`KEPT`] of its distance.
    pub(super) fn safe_fraction(
        &self,
        near: &Near,
        from: &[Vec3],
        to: &[Vec3],
        obstacles: &[Obstacle],
    ) -> Real {
        let mut fraction: Real = 1.0;
        for pair in self.iter() {
            fraction = fraction.min(safe_fraction_of_pair(pair, from, to));
        }
        for &[vertex, number] in &self.vertex_obstacle {
            let (v, obstacle) = (vertex as usize, &obstacles[number as usize]);
            fraction = fraction.min(safe_fraction_at_obstacle(
                obstacle,
                near.law_at(v).range(),
                from[v],
                to[v],
            ));
        }
        fraction
    }

    /// Takes vertices back on their paths (m) until every near pair keeps [`KEPT`] of its distance: all vertices of a
    /// pair that does not by the same fraction, and again where that brings others too near. `fractions` is what is
    /// left of each path. Returns whether that changed anything.
    pub(super) fn shorten(
        &mut self,
        near: &Near,
        path: (&[Vec3], &mut [Vec3]),
        fractions: &mut [Real],
        obstacles: &[Obstacle],
    ) -> bool {
        let (from, to) = path;
        let mut is_cut = false;
        for &[vertex, number] in &self.vertex_obstacle {
            let v = vertex as usize;
            let obstacle = &obstacles[number as usize];
            let fraction =
                safe_fraction_at_obstacle(obstacle, near.law_at(v).range(), from[v], to[v]);
            is_cut |= fraction < 1.0;
            shorten_one(from, to, fractions, v, fraction);
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
            let mut take = |vertices: [u32; 4], fraction: Real| {
                is_short |= fraction < 1.0;
                for vertex in vertices {
                    let least = &mut now[vertex as usize];
                    *least = least.min(fraction);
                }
            };
            for chosen in self.iter() {
                let vertices = chosen.contact.pair.vertices;
                if was_cut(&vertices) {
                    take(vertices, safe_fraction_of_pair(chosen, from, to));
                }
            }
            if !is_short || rounds == ROUNDS {
                break !is_short;
            }
            is_cut = true;
            rounds += 1;
            for (vertex, fraction) in now.iter().enumerate() {
                shorten_one(from, to, fractions, vertex, *fraction);
            }
            std::mem::swap(&mut before, &mut now);
        };
        self.fractions = [before, now];
        if !is_done {
            let fraction = self.safe_fraction(near, from, to, obstacles);
            shorten_all(from, to, fractions, fraction);
        }
        is_cut
    }
}

/// As [`safe_fraction_of_pair`], of a vertex on its path from `a` to `b` (m) before an obstacle.
fn safe_fraction_at_obstacle(obstacle: &Obstacle, thickness: Real, a: Vec3, b: Vec3) -> Real {
    let gap = obstacle.signed_distance(a, 0.0).value;
    let keep = KEPT * gap.min(thickness);
    if keep <= ROUNDING * a.amax().max(b.amax()) {
        return if a == b { 1.0 } else { 0.0 };
    }
    if (b - a).norm() * obstacle.shape().lipschitz() < gap - keep {
        return 1.0;
    }
    let path = VertexPath::straight(a, b, 1.0);
    first_contact(obstacle, &path, 0.0, 1.0, keep).map_or(1.0, |hit| hit.time)
}

/// Shortens the path of one vertex to a fraction of itself.
fn shorten_one(
    from: &[Vec3],
    to: &mut [Vec3],
    fractions: &mut [Real],
    vertex: usize,
    fraction: Real,
) {
    if fraction < 1.0 {
        fractions[vertex] *= fraction;
        to[vertex] = from[vertex] + (to[vertex] - from[vertex]) * fraction;
    }
}

/// Shortens all paths to the same fraction of themselves.
pub(super) fn shorten_all(from: &[Vec3], to: &mut [Vec3], fractions: &mut [Real], fraction: Real) {
    if fraction == 1.0 {
        return;
    }
    for vertex in 0..from.len() {
        shorten_one(from, to, fractions, vertex, fraction);
    }
}

/// The fraction of its path at which a pair's distance is down to [`KEPT`] of that at the start, or of the
/// thickness; 1 if that does not happen. Of a pair that is pressed deep less, see [`DEEP`].
fn safe_fraction_of_pair(chosen: &ChosenPair, from: &[Vec3], to: &[Vec3]) -> Real {
    let near = &chosen.contact;
    let path = Query::of(near.pair, from, to);
    if chosen.stays_apart(&path, KEPT * near.law.range()) {
        return 1.0;
    }
    let gap = Gap::new(path.kind, &path.from);
    let (distance, range) = (gap.distance, near.law.range());
    let keep = KEPT * distance.min(range);
    let safe = if approach(&path) < distance - keep {
        1.0
    } else {
        let places = path.from.iter().chain(&path.to);
        let size = places.map(Vec3::amax).fold(0.0, Real::max);
        if keep <= ROUNDING * size {
            return 0.0;
        }
        path.time_near(keep, EARLY).unwrap_or(1.0)
    };
    match distance < DEEP * range {
        true => central_fraction(&path, &gap, safe),
        false => safe,
    }
}

/// The `fraction` of a path, or what is left of it, after which the distance is at least [`CENTRAL`] of what the
/// linearised motion leaves.
fn central_fraction(path: &Query, gap: &Gap, mut fraction: Real) -> Real {
    let [from, to] = [&path.from, &path.to];
    let closing = |k: usize| gap.normal.dot(&(from[k] - to[k])) * gap.weights[k];
    let closing = (0..4).map(closing).sum::<Real>().clamp(0.0, gap.distance);
    for _ in 0..MOST_SHORTENINGS {
        let there = std::array::from_fn(|k| from[k] + (to[k] - from[k]) * fraction);
        let left = gap.distance - fraction * closing;
        if Gap::new(path.kind, &there).distance >= CENTRAL * left {
            break;
        }
        fraction *= SHORTER;
    }
    fraction
}

/// The most by which two primitives can have come nearer (m) on their path.
fn approach(path: &Query) -> Real {
    let displacements: [Vec3; 4] = std::array::from_fn(|k| path.to[k] - path.from[k]);
    let mean = displacements.iter().sum::<Vec3>() * 0.25;
    let sizes = displacements.map(|displacement| (displacement - mean).norm());
    let (first, second) = sizes.split_at(path.kind.split());
    let most = |sizes: &[Real]| sizes.iter().fold(0.0, |a: Real, b| a.max(*b));
    most(first) + most(second)
}

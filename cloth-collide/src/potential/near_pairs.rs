//! Which pairs can be near each other on a path that a method is about to take, chosen again only when it has gone
//! elsewhere.
//!
//! For each two patches of the cloth there is a list of the pairs that can touch, complete until the two have moved too
//! far relative to each other. Of these, only the pairs are evaluated that can come as near as the thickness on the
//! path in question, and a little beyond it.

use super::culled::CulledPairs;
use super::near::Near;
use super::pair::PairContact;
use super::patches::Patches;
use crate::bounds::{Bounds, farthest, longest};
use crate::ccd::{Query, QueryKind};
use crate::obstacle::Obstacle;
use crate::pair::{Gap, Pair};
use cloth_core::math::{Real, Vec3, gather};

/// Path (in thicknesses) that a vertex may go beyond the paths at hand, before pairs are chosen anew. More finds more
/// pairs, and hardly any choice holds for the next path all the same.
const MARGIN: Real = 0.1;
/// A choice of n pairs costs as much as `AS_DEAR (n + MANY)` evaluations of one.
const AS_DEAR: usize = 4;
const MANY: usize = 500;

/// Two primitives that can come into contact, and the normal across a plane between them where they were chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChosenPair {
    pub(super) contact: PairContact,
    normal: Vec3,
}

impl ChosenPair {
    /// Whether the plane has the two farther apart than they push, at `x` (m): most that are chosen for a path are at
    /// most places on it, and this takes a tenth of the time that their distance takes.
    fn is_out_of_range(&self, x: &[Vec3]) -> bool {
        let PairContact { pair, law, .. } = &self.contact;
        pair.gap_along(&self.normal, x) > law.range()
    }

    /// Whether it has them farther apart than `keep` (m) on all of a path.
    pub(super) fn stays_apart(&self, path: &Query, keep: Real) -> bool {
        path.is_apart_along(&self.normal, keep)
    }
}

/// Pairs that can be near.
#[derive(Clone, Debug, Default)]
pub(super) struct NearPairs {
    /// None if the cloth cannot touch itself.
    pub(super) patches: Option<Patches>,
    /// Where the pairs were chosen (m), and how far each vertex may go from there (m).
    place: Vec<Vec3>,
    /// How far vertices of bodies, which have been put where they end since, are from there at most (m).
    behind: Option<Real>,
    /// How far (m) from contact a cloth that does not touch itself was there with all bodies, where it was so far that
    /// patches were not asked; and the box around bodies, where these stay.
    far: Option<Real>,
    around_bodies: Option<Bounds>,
    /// Whether they were chosen for where obstacles are now.
    is_chosen: bool,
    reach: Vec<Real>,
    /// Of a vertex and a triangle each, and of two edges.
    vertex_triangle: CulledPairs<ChosenPair>,
    edge_edge: CulledPairs<ChosenPair>,
    /// Evaluations of pairs since they were chosen.
    spent: usize,
    /// Of each obstacle and each vertex: where it was asked for the distance, in the frame of the obstacle (m), and
    /// that distance (m). It changes by no more than the displacement from there.
    distances: Vec<(Vec3, Real)>,
    pub(super) vertex_obstacle: Vec<[u32; 2]>,
    /// Scratch: the fractions of paths (dimensionless) that the last two rounds of [`NearPairs::shorten`] left.
    pub(super) fractions: [Vec<Real>; 2],
    /// Choices of pairs in this step.
    pub(super) choices: u32,
}

impl NearPairs {
    /// Those that can be in contact.
    pub(super) fn iter(&self) -> impl Iterator<Item = &ChosenPair> {
        self.vertex_triangle.iter().chain(self.edge_edge.iter())
    }

    /// Of those the ones that may push at `x` (m).
    pub(super) fn iter_at<'a>(&'a self, x: &'a [Vec3]) -> impl Iterator<Item = &'a PairContact> {
        let may_push = self.iter().filter(|chosen| !chosen.is_out_of_range(x));
        may_push.map(|chosen| &chosen.contact)
    }

    /// Begins a step at `x` (m): obstacles may have moved, and the cloth if it does not `go_on` from where it was.
    pub(super) fn begin(&mut self, x: &[Vec3], is_resting: &[bool], goes_on: bool) {
        self.is_chosen = false;
        self.choices = 0;
        if let Some(patches) = &mut self.patches {
            // Other steps may have been taken, without these pairs.
            if !goes_on || self.place.is_empty() {
                patches.forget(x, is_resting);
            }
        }
    }

    /// Makes sure that the pairs are those of the straight path between two positions (m). If `stay` is true, vertices
    /// of bodies do not move on any path from now on, and nothing needs to be asked of them.
    pub(super) fn prepare(
        &mut self,
        near: &Near,
        path: [&[Vec3]; 2],
        obstacles: &[Obstacle],
        stay: bool,
    ) {
        let margin = MARGIN * near.law.range();
        let count = if stay { near.cloth } else { path[0].len() };
        if self.is_chosen {
            let moved = path.map(|x| self.moved(x, count));
            // The end first: it is farther away.
            let ends = path.iter().zip(moved).rev();
            let bodies = !obstacles.is_empty();
            let holds = ends.fold(true, |holds, (x, moved)| {
                holds && self.holds(x, moved, margin, bodies)
            });
            let path = path.map(|x| &x[..count]);
            if holds && !self.is_elsewhere(path, moved[0], margin) {
                self.activate(moved);
                return;
            }
        }
        let [from, to] = path;
        let stayed = stay && self.behind == Some(0.0);
        if !stayed {
            self.around_bodies = None;
        }
        let goes = match stay && count < from.len() {
            true => farthest(&from[..count], &to[..count], Vec3::zeros()),
            false => longest(path),
        };
        self.choose(near, path, [goes, margin]);
        match stayed {
            true => self.place[..count].copy_from_slice(&from[..count]),
            false => from.clone_into(&mut self.place),
        }
        // Bodies that stay are on all paths where they are on this one.
        self.behind = (stay && count < from.len()).then_some(0.0);
        self.is_chosen = true;
        self.spent = 0;
        self.reach.clear();
        let displacements = near.own(from).iter().zip(to);
        self.reach
            .extend(displacements.map(|(a, b)| (b - a).norm() + margin));
        self.choose_obstacles(near, obstacles);
        self.choices += 1;
        self.activate([0.0, goes]);
    }

    /// How far (m) a vertex is from where pairs were chosen, at most. If `count` is that of all vertices, the mean
    /// motion is subtracted. If not, those beyond are of bodies that stay where they are: then nothing is subtracted,
    /// and theirs is found once and kept.
    fn moved(&mut self, x: &[Vec3], count: usize) -> Real {
        if count == x.len() {
            return longest([&self.place, x]);
        }
        let behind = self
            .behind
            .get_or_insert_with(|| farthest(&self.place[count..], &x[count..], Vec3::zeros()));
        farthest(&self.place[..count], &x[..count], Vec3::zeros()).max(*behind)
    }

    /// Whether a path is short beside how far the cloth has gone since pairs were chosen, so that few of them matter:
    /// as where a minimisation comes to its end, one step of the cloth away from where it began. They are chosen anew
    /// once evaluating them has cost as much as that.
    fn is_elsewhere(&mut self, path: [&[Vec3]; 2], moved: Real, margin: Real) -> bool {
        let (one, other) = (&self.vertex_triangle, &self.edge_edge);
        self.spent += one.active + other.active;
        let all = one.pairs.len() + other.pairs.len();
        let is_dear = self.spent > AS_DEAR * (MANY + all);
        is_dear && 2.0 * (longest(path) + margin) < moved
    }

    /// Looks after the pairs that the path can bring into contact, whose ends are so far (m) from where pairs were
    /// chosen.
    fn activate(&mut self, moved: [Real; 2]) {
        let nearer = 2.0 * moved[0].max(moved[1]);
        self.vertex_triangle.activate(nearer);
        self.edge_edge.activate(nearer);
    }

    /// Whether the pairs hold at a place (m), where a vertex has `moved` so far (m) relative to the mean
    /// motion; and what was found of bodies, if there are any.
    fn holds(&mut self, x: &[Vec3], moved: Real, margin: Real, bodies: bool) -> bool {
        let displacements = x.iter().zip(&self.place).zip(&self.reach);
        let mut displacements =
            displacements.map(|((x, place), reach)| (x - place).norm_squared() <= reach * reach);
        if bodies && !displacements.all(|holds| holds) {
            return false;
        }
        if let Some(far) = self.far {
            return 2.0 * moved <= far;
        }
        // Mostly this is enough: any two parts may come nearer by two margins, wherever they are.
        if moved <= margin {
            return true;
        }
        let patches = self.patches.as_mut();
        patches.is_none_or(|patches| patches.holds(x))
    }

    /// Keeps the pairs that can be nearer than their thickness.
    /// No vertex `goes` farther (m) on the path, relative to the mean motion.
    fn choose(&mut self, near: &Near, path: [&[Vec3]; 2], [goes, margin]: [Real; 2]) {
        self.vertex_triangle.clear();
        self.edge_edge.clear();
        let Some(patches) = &mut self.patches else {
            return;
        };
        let x = path[0];
        self.far = None;
        if !near.own.self_collision && near.cloth < x.len() {
            let (own, others) = x.split_at(near.cloth);
            let bodies = self.around_bodies.get_or_insert_with(|| Bounds::of(others));
            let far = Bounds::of(own).squared_gap(bodies).sqrt() - near.law.range();
            self.far = Some(far).filter(|far| 2.0 * (goes + margin) < *far);
            if self.far.is_some() {
                return;
            }
        }
        patches.choose(near, path, margin, |found, nearer| {
            let Pair { kind, vertices } = found.pair;
            let places = gather(x, vertices);
            let reach = found.range + nearer;
            let (one, other) = places.split_at(kind.split());
            let apart = Bounds::of(one).axis_gap(&Bounds::of(other));
            if apart > reach {
                return apart - found.range;
            }
            let Gap {
                distance, normal, ..
            } = Gap::new(kind, &places);
            if distance < reach {
                let (list, mollifier) = match kind {
                    QueryKind::VertexTriangle => (&mut self.vertex_triangle, None),
                    QueryKind::EdgeEdge => (&mut self.edge_edge, Some(near.mollifier(vertices))),
                };
                let contact = PairContact {
                    pair: found.pair,
                    area: found.area,
                    law: near.law.with_range(found.range),
                    mollifier,
                };
                list.push(distance - found.range, ChosenPair { contact, normal });
            }
            distance - found.range
        });
    }

    /// A lower bound (m) on the signed distance of a vertex at `x` (m) from an obstacle, by what was known of it when
    /// it was asked last.
    pub(super) fn known_distance(
        &self,
        [vertex, number]: [usize; 2],
        obstacles: &[Obstacle],
        x: Vec3,
    ) -> Real {
        let margin = self.distances.get(vertex * obstacles.len() + number);
        let obstacle = &obstacles[number];
        margin.map_or(Real::NEG_INFINITY, |(place, distance)| {
            let local = obstacle.motion().pose.to_local(x);
            distance - (local - place).norm() * obstacle.shape().lipschitz()
        })
    }

    fn choose_obstacles(&mut self, near: &Near, obstacles: &[Obstacle]) {
        self.vertex_obstacle.clear();
        let nowhere = (Vec3::repeat(Real::INFINITY), 0.0);
        self.distances.resize(near.cloth * obstacles.len(), nowhere);
        let h = near.law.range();
        let vertices = self.place[..near.cloth].iter().zip(&self.reach);
        let mut distances = self.distances.iter_mut();
        for (vertex, (x, reach)) in (0u32..).zip(vertices) {
            for ((number, obstacle), margin) in (0u32..).zip(obstacles).zip(&mut distances) {
                let (v, body) = (vertex as usize, number as usize);
                if !near.is_free[v] || near.is_inside(v) || near.pinched.passes(v, body) {
                    continue;
                }
                let lipschitz = obstacle.shape().lipschitz();
                let reach = h + reach * lipschitz;
                let local = obstacle.motion().pose.to_local(*x);
                let changed = (local - margin.0).norm() * lipschitz;
                if margin.1 - changed >= reach {
                    continue;
                }
                // What was known of the distance may be enough to say that it is near, too.
                if margin.1 + changed >= reach {
                    *margin = (local, obstacle.shape().signed_distance(local).value);
                    if margin.1 >= reach {
                        continue;
                    }
                }
                self.vertex_obstacle.push([vertex, number]);
            }
        }
    }
}

#[cfg(test)]
#[path = "../../tests/unit/potential_near_pairs.rs"]
mod tests;

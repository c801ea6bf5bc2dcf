//! Which pairs can be near each other on a path that a method is about to take, chosen again only when it has gone
//! elsewhere.
//!
//! Patches of the cloth know what can touch between two of them, until they have moved too far relative to each other.
//! Of those pairs the ones are evaluated that can come as near as the thickness on the path that is being looked at,
//! and a little beyond it.

use super::gap::Gap;
use super::near::Near;
use super::pair::{EdgeEdgeContact, VertexTriangleContact};
use super::patches::Patches;
use super::ranked::Ranked;
use crate::bounds::mean;
use crate::ccd::QueryKind;
use crate::obstacle::Obstacle;
use cloth_core::math::{Real, Vec3, gather};

/// Path (in thicknesses) that a vertex may go beyond the paths looked at, before pairs are chosen anew.
const ROOM: Real = 0.5;

/// Pairs that can be near.
#[derive(Debug, Default)]
pub(super) struct NearPairs {
    /// None if the cloth cannot touch itself.
    patches: Option<Patches>,
    /// Where the pairs were chosen (m), and how far each vertex may go from there (m).
    place: Vec<Vec3>,
    /// Whether they were chosen for where obstacles are now.
    is_chosen: bool,
    reach: Vec<Real>,
    pub(super) vertex_triangle: Ranked<VertexTriangleContact>,
    pub(super) edge_edge: Ranked<EdgeEdgeContact>,
    /// Of each obstacle and each vertex: where it was asked for the distance, in the frame of the obstacle (m), and
    /// that distance (m). It changes by no more than the displacement from there.
    rooms: Vec<(Vec3, Real)>,
    /// Vertex and obstacle.
    pub(super) vertex_obstacle: Vec<[u32; 2]>,
    /// Room to work in: the parts of paths (dimensionless) that the last two rounds of [`NearPairs::shorten`] left.
    pub(super) shares: [Vec<Real>; 2],
    /// Choices of pairs in this step.
    pub(super) choices: u32,
}

impl NearPairs {
    pub(super) fn new(patches: Option<Patches>) -> Self {
        Self {
            patches,
            ..Self::default()
        }
    }

    /// Begins a step at `x` (m): obstacles may have moved, and the cloth if it does not `go_on` from where it was.
    pub(super) fn begin(&mut self, x: &[Vec3], is_resting: &[bool], goes_on: bool) {
        self.is_chosen = false;
        self.choices = 0;
        if let Some(patches) = &mut self.patches {
            (patches.searches, patches.detections) = (0, 0);
            // Other steps may have been taken, without these pairs.
            if !goes_on || self.place.is_empty() {
                patches.forget(x, is_resting);
            }
        }
    }

    /// Searches among patches, and between two of them, in this step.
    pub(super) fn searches(&self) -> [u32; 2] {
        let patches = self.patches.as_ref();
        patches.map_or([0; 2], |patches| [patches.searches, patches.detections])
    }

    /// Makes sure that the pairs are those of the straight path between two positions (m).
    pub(super) fn prepare(&mut self, near: &Near, path: [&[Vec3]; 2], obstacles: &[Obstacle]) {
        let room = ROOM * near.law().range();
        if path.iter().all(|x| self.holds(x, room)) {
            self.wake(path);
            return;
        }
        let [from, to] = path;
        self.choose(near, path, room);
        self.place.clear();
        self.place.extend_from_slice(from);
        self.is_chosen = true;
        self.reach.clear();
        let displacements = from.iter().zip(to).map(|(a, b)| (b - a).norm() + room);
        self.reach.extend(displacements);
        self.choose_obstacles(near, obstacles);
        self.choices += 1;
        self.wake(path);
    }

    /// Looks after the pairs that the path can bring into contact.
    fn wake(&mut self, path: [&[Vec3]; 2]) {
        let nearer = 2.0 * self.moved(path[0]).max(self.moved(path[1]));
        self.vertex_triangle.wake(nearer);
        self.edge_edge.wake(nearer);
    }

    /// How far (m) a vertex is from where it was when pairs were chosen, at most, besides what all have done together.
    fn moved(&self, x: &[Vec3]) -> Real {
        let shift = mean(x) - mean(&self.place);
        let displacements = x.iter().zip(&self.place);
        let most = displacements.map(|(x, place)| (x - place - shift).norm_squared());
        most.fold(0.0, Real::max).sqrt()
    }

    /// Whether the pairs hold at a place (m).
    fn holds(&mut self, x: &[Vec3], room: Real) -> bool {
        if !self.is_chosen {
            return false;
        }
        if !self.vertex_obstacle_holds(x) {
            return false;
        }
        // Mostly this is enough: any two parts may come nearer by two rooms, wherever they are.
        if self.moved(x) <= room {
            return true;
        }
        let patches = self.patches.as_mut();
        patches.is_none_or(|patches| patches.holds(&self.place, x))
    }

    fn vertex_obstacle_holds(&self, x: &[Vec3]) -> bool {
        let displacements = x.iter().zip(&self.place).zip(&self.reach);
        let mut displacements =
            displacements.map(|((x, place), reach)| (x - place).norm_squared() <= reach * reach);
        displacements.all(|holds| holds)
    }

    /// Keeps the pairs that can be nearer than their thickness.
    fn choose(&mut self, near: &Near, path: [&[Vec3]; 2], room: Real) {
        self.vertex_triangle.clear();
        self.edge_edge.clear();
        let Some(patches) = &mut self.patches else {
            return;
        };
        let x = path[0];
        patches.choose(near, &self.place, path, room, |pair, nearer| {
            let vertices = pair.vertices;
            let places = gather(x, vertices);
            let reach = pair.range + nearer;
            let area = pair.area;
            let split = match pair.kind {
                QueryKind::VertexTriangle => 1,
                QueryKind::EdgeEdge => 2,
            };
            let apart = boxes_gap(&places, split);
            if apart > reach {
                return apart - pair.range;
            }
            let law = || near.law().with_range(pair.range);
            let distance = match pair.kind {
                QueryKind::VertexTriangle => Gap::vertex_triangle(&places).distance,
                QueryKind::EdgeEdge => Gap::edge_edge(&places).distance,
            };
            if distance < reach {
                let lack = distance - pair.range;
                match pair.kind {
                    QueryKind::VertexTriangle => {
                        let law = law();
                        let pair = VertexTriangleContact {
                            vertices,
                            area,
                            law,
                        };
                        self.vertex_triangle.push(lack, pair);
                    }
                    QueryKind::EdgeEdge => {
                        let pair = EdgeEdgeContact {
                            vertices,
                            area,
                            law: law(),
                            mollifier: near.mollifier(vertices),
                        };
                        self.edge_edge.push(lack, pair);
                    }
                }
            }
            distance - pair.range
        });
        self.vertex_triangle.sort();
        self.edge_edge.sort();
    }

    fn choose_obstacles(&mut self, near: &Near, obstacles: &[Obstacle]) {
        self.vertex_obstacle.clear();
        let nowhere = (Vec3::repeat(Real::INFINITY), 0.0);
        self.rooms.resize(near.cloth * obstacles.len(), nowhere);
        let h = near.law().range();
        let vertices = self.place[..near.cloth].iter().zip(&self.reach);
        let mut rooms = self.rooms.iter_mut();
        for (vertex, (x, reach)) in (0u32..).zip(vertices) {
            for ((number, obstacle), room) in (0u32..).zip(obstacles).zip(&mut rooms) {
                if !near.is_free[vertex as usize] {
                    continue;
                }
                let stretch = obstacle.shape().lipschitz();
                let reach = h + reach * stretch;
                let local = obstacle.motion().pose.to_local(*x);
                let displacement = (local - room.0).norm();
                let is_far = room.1 - displacement * stretch >= reach;
                if is_far {
                    continue;
                }
                let distance = obstacle.shape().signed_distance(local).value;
                *room = (local, distance);
                if distance < reach {
                    self.vertex_obstacle.push([vertex, number]);
                }
            }
        }
    }
}

/// The distance (m) along an axis, the farthest, between the boxes around the first `split` of four points and around
/// the others; not positive if they overlap.
#[inline(always)]
fn boxes_gap(x: &[Vec3; 4], split: usize) -> Real {
    let around = |points: &[Vec3]| {
        let first = (points[0], points[0]);
        points[1..]
            .iter()
            .fold(first, |(low, high), x| (low.inf(x), high.sup(x)))
    };
    let (a, b) = (around(&x[..split]), around(&x[split..]));
    (a.0 - b.1).max().max((b.0 - a.1).max())
}

#[cfg(test)]
mod tests {
    use super::super::near::Own;
    use super::*;
    use crate::incidence::edge_numbers;
    use crate::obstacle::PenaltyLaw;
    use crate::random::Random;
    use crate::shapes::{deformed, sheet};
    use std::collections::HashSet;

    /// Whatever paths a folded sheet takes, waved, turned, jerked and back again: every pair that is within its range
    /// at the start, halfway or at the end of a path is among the ones chosen for it, as a look at all pairs tells.
    #[test]
    fn no_near_pair_is_missed_on_any_path() {
        let mesh = sheet(9);
        let (edges, _) = edge_numbers(mesh.triangles());
        let law = PenaltyLaw::two_stage(1e6, 0.02).unwrap();
        let near = Near::new(&mesh, law, Vec::new(), true, 0.0, Own::default());
        let mut random = Random::new(5);
        let mut touching = 0;
        for (_, start) in deformed(&mesh).into_iter().take(5) {
            let mut pairs = NearPairs::new(Some(Patches::new(&mesh, &near)));
            pairs.begin(&start, &near.is_resting, false);
            let mut from = start.clone();
            let mut last = vec![Vec3::zeros(); start.len()];
            for round in 0..80 {
                let size = [1e-4, 1e-3, 0.01, 0.05][round % 4];
                let turn = random.point([0.0, 0.3][round / 4 % 2]);
                let (shift, jerk) = (random.point(0.3), round % 7 < 3);
                let noise =
                    |random: &mut Random| random.point(if jerk { size } else { 0.1 * size });
                let wave = random.point(10.0);
                let to: Vec<Vec3> = from
                    .iter()
                    .zip(start.iter().zip(&last))
                    .map(|(x, (rest, last))| {
                        if round % 2 == 1 {
                            return x + last * 1.5 + noise(&mut random);
                        }
                        let bent = Vec3::z() * (size * (wave.x * rest.x + wave.y * rest.y).sin());
                        x + shift + turn.cross(x) * 0.3 + bent + noise(&mut random)
                    })
                    .collect();
                pairs.prepare(&near, [&from, &to], &[]);
                let kept: HashSet<[u32; 4]> =
                    pairs.vertex_triangle.iter().map(|p| p.vertices).collect();
                let kept_edges: HashSet<[u32; 4]> =
                    pairs.edge_edge.iter().map(|p| p.vertices).collect();
                for part in [0.0, 0.5, 1.0] {
                    let x: Vec<Vec3> = from
                        .iter()
                        .zip(&to)
                        .map(|(a, b)| a + (b - a) * part)
                        .collect();
                    for &[a, b, c] in mesh.triangles() {
                        for vertex in (0..x.len() as u32).filter(|v| ![a, b, c].contains(v)) {
                            let vertices = [vertex, a, b, c];
                            let of = |x: &[Vec3; 4]| Gap::vertex_triangle(x).distance;
                            let range = near.law_of(vertices, true, of).range();
                            if of(&gather(&x, vertices)) < range {
                                touching += 1;
                                assert!(kept.contains(&vertices), "round {round}: {vertices:?}");
                            }
                        }
                    }
                    for (k, &[a, b]) in edges.iter().enumerate() {
                        for &[c, d] in &edges[k + 1..] {
                            if a == c || a == d || b == c || b == d {
                                continue;
                            }
                            let vertices = [a, b, c, d];
                            let of = |x: &[Vec3; 4]| Gap::edge_edge(x).distance;
                            let range = near.law_of(vertices, false, of).range();
                            if of(&gather(&x, vertices)) < range {
                                let other = [c, d, a, b];
                                let known =
                                    kept_edges.contains(&vertices) || kept_edges.contains(&other);
                                assert!(known, "round {round}: {vertices:?}");
                            }
                        }
                    }
                }
                last = from.iter().zip(&to).map(|(a, b)| b - a).collect();
                // Not all the way, as a search that is capped.
                let part = if round % 4 == 0 { 0.1 } else { 1.0 };
                from = from
                    .iter()
                    .zip(&to)
                    .map(|(a, b)| a + (b - a) * part)
                    .collect();
                if round % 11 == 0 {
                    from.clone_from(&start);
                }
            }
            assert!(pairs.choices < 130);
        }
        assert!(touching > 1000, "{touching}");
    }

    /// Cloth that falls, and turns, without coming near to itself is looked at once.
    #[test]
    fn cloth_that_flies_is_looked_at_once() {
        let mesh = sheet(33);
        let law = PenaltyLaw::two_stage(1e6, 2e-3).unwrap();
        let near = Near::new(&mesh, law, Vec::new(), true, 0.0, Own::default());
        let mut pairs = NearPairs::new(Some(Patches::new(&mesh, &near)));
        let mut x = mesh.positions().to_vec();
        pairs.begin(&x, &near.is_resting, false);
        let mut searches = [0; 2];
        for step in 0..100 {
            let fall = Vec3::z() * (-9.81 / 3600.0 * Real::from(step));
            let to: Vec<Vec3> = x.iter().map(|x| x + fall).collect();
            pairs.prepare(&near, [&x, &to], &[]);
            let [among, between] = pairs.searches();
            searches = [searches[0] + among, searches[1] + between];
            x = to;
            pairs.begin(&x, &near.is_resting, true);
        }
        assert_eq!(searches[0], 1);
        let patches = pairs.patches.as_ref().unwrap();
        assert_eq!(searches[1] as usize, patches.count());
    }
}

//! Which pairs can be near each other on a way, found again only when the cloth has moved too far for what is known.
//!
//! Two lists, one inside the other. The candidates of the broad phase hold as long as every vertex stays in a box; what all vertices do
//! together does not count, as it brings nothing nearer. Of them, the pairs that can come as near as the thickness on the way that is being
//! looked at, and a little beyond it, are the ones that are evaluated.

use super::gap::Gap;
use super::mollifier::Mollifier;
use super::pair::{EdgeEdgeContact, VertexTriangleContact};
use crate::broad_phase::{ClothCandidates, Hierarchy};
use crate::error::CollideError;
use crate::incidence::{edge_numbers, pieces};
use crate::obstacle::{Obstacle, PenaltyLaw};
use crate::response::mean;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// Way (in thicknesses) that a vertex may go beyond the ways looked at, before pairs are chosen anew; and before candidates are searched anew.
const PAIR_ROOM: Real = 0.5;
const CANDIDATE_ROOM: Real = 1.0;

/// Pairs that can be near.
#[derive(Debug)]
pub(super) struct Near {
    law: PenaltyLaw,
    /// A third of the rest area of the triangles around each vertex, and around each edge (m²).
    pub(super) vertex_area: Vec<Real>,
    pub(super) edge_area: Vec<Real>,
    rest: Vec<Vec3>,
    /// The connected piece that each vertex belongs to.
    pub(super) piece: Vec<u32>,
    pub(super) is_free: Vec<bool>,
    /// None if the cloth cannot touch itself.
    candidates: Option<ClothCandidates<Hierarchy>>,
    /// The mean (m) of all positions when the candidates were found.
    middle: Vec3,
    ends: Vec<Vec3>,
    /// Where the pairs were chosen (m), and how far each vertex may be from there, with and without what all do together (m).
    place: Vec<Vec3>,
    room: Vec<[Real; 2]>,
    pub(super) vertex_triangle: Vec<VertexTriangleContact>,
    pub(super) edge_edge: Vec<EdgeEdgeContact>,
    /// Vertex and obstacle.
    pub(super) vertex_obstacle: Vec<[u32; 2]>,
    /// Searches of the broad phase so far, and choices of pairs.
    pub(super) searches: u32,
    pub(super) choices: u32,
}

impl Near {
    pub(super) fn new(mesh: &TriMesh, law: PenaltyLaw, self_collision: bool) -> Self {
        let (edges, triangle_edges) = edge_numbers(mesh.triangles());
        let mut vertex_area = vec![0.0; mesh.vertex_count()];
        let mut edge_area = vec![0.0; edges.len()];
        let around = mesh.triangles().iter().zip(&triangle_edges);
        for ((corners, edges), area) in around.zip(mesh.areas()) {
            for (vertex, edge) in corners.iter().zip(edges) {
                vertex_area[*vertex as usize] += area / 3.0;
                edge_area[*edge as usize] += area / 3.0;
            }
        }
        Self {
            law,
            vertex_area,
            edge_area,
            rest: mesh.positions().to_vec(),
            piece: pieces(mesh),
            is_free: vec![true; mesh.vertex_count()],
            candidates: self_collision.then(|| ClothCandidates::new(mesh, Hierarchy::new())),
            middle: Vec3::zeros(),
            ends: Vec::new(),
            place: Vec::new(),
            room: Vec::new(),
            vertex_triangle: Vec::new(),
            edge_edge: Vec::new(),
            vertex_obstacle: Vec::new(),
            searches: 0,
            choices: 0,
        }
    }

    /// Takes over which vertices are prescribed, by their inverse masses (1/kg), and forgets the pairs: obstacles may have moved.
    pub(super) fn begin(&mut self, inverse_mass: &[Real]) {
        for (free, w) in self.is_free.iter_mut().zip(inverse_mass) {
            *free = *w > 0.0;
        }
        self.place.clear();
    }

    pub(super) fn law(&self) -> PenaltyLaw {
        self.law
    }

    /// Makes sure that the pairs are those of the straight way between two positions (m).
    pub(super) fn prepare(
        &mut self,
        from: &[Vec3],
        to: &[Vec3],
        obstacles: &[Obstacle],
    ) -> Result<(), CollideError> {
        if self.holds(from) && self.holds(to) {
            return Ok(());
        }
        let h = self.law.range();
        let shift = mean(to) - mean(from);
        self.place.clear();
        self.place.extend_from_slice(from);
        self.room.clear();
        let ways = from.iter().zip(to).map(|(a, b)| b - a);
        self.room.extend(ways.map(|way| {
            let beyond = PAIR_ROOM * h;
            [(way - shift).norm() + beyond, way.norm() + beyond]
        }));
        self.search(from, to)?;
        self.choose(from);
        self.choose_obstacles(from, obstacles);
        self.choices += 1;
        Ok(())
    }

    /// Whether the pairs hold at a place: no vertex is farther from where they were chosen than was allowed for.
    fn holds(&self, x: &[Vec3]) -> bool {
        if self.place.is_empty() {
            return false;
        }
        let shift = mean(x) - mean(&self.place);
        let places = x.iter().zip(&self.place).zip(&self.room);
        places.into_iter().all(|((x, place), [relative, whole])| {
            let way = x - place;
            (way - shift).norm() <= *relative && way.norm() <= *whole
        })
    }

    /// Finds candidates anew, if those that are known do not hold for the room of the pairs.
    fn search(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<(), CollideError> {
        let h = self.law.range();
        let Some(candidates) = &mut self.candidates else {
            return Ok(());
        };
        let middle = self.middle;
        let boxes = candidates.vertex_boxes();
        let shift = mean(from) - middle;
        let strayed = from
            .iter()
            .zip(boxes)
            .zip(&self.room)
            .any(|((x, bounds), room)| {
                let (x, reach) = (x - shift, Vec3::repeat(0.5 * h + room[0]));
                let inside = x - reach >= bounds.lower && x + reach <= bounds.upper;
                !inside
            });
        if !strayed && self.searches > 0 {
            return Ok(());
        }
        // What all vertices do together is left out.
        let both = mean(to) - mean(from);
        self.ends.clear();
        self.ends.extend(to.iter().map(|x| x - both));
        let room = self.room.iter().fold(0.0, |a: Real, r| a.max(r[0]));
        let room = (room.min(h) + h) * CANDIDATE_ROOM;
        candidates.update(from, &self.ends, h + 2.0 * room)?;
        self.middle = mean(from);
        self.searches += 1;
        Ok(())
    }

    /// Keeps the candidates that can be nearer than their thickness.
    fn choose(&mut self, x: &[Vec3]) {
        self.vertex_triangle.clear();
        self.edge_edge.clear();
        let Some(candidates) = &self.candidates else {
            return;
        };
        let h = self.law.range();
        let room = |v: u32| self.room[v as usize][0];
        let can_move = |vertices: &[u32; 4]| vertices.iter().any(|&v| self.is_free[v as usize]);
        for &[vertex, triangle] in candidates.vertex_triangle() {
            let [a, b, c] = candidates.triangles()[triangle as usize];
            let vertices = [vertex, a, b, c];
            let reach = h + room(vertex) + room(a).max(room(b)).max(room(c));
            let places = gather(x, vertices);
            if !can_move(&vertices) || are_farther(&places, 1, reach) {
                continue;
            }
            if Gap::vertex_triangle(&places).distance < reach {
                let rest = |x: &[Vec3; 4]| Gap::vertex_triangle(x).distance;
                self.vertex_triangle.push(VertexTriangleContact {
                    vertices,
                    area: self.vertex_area[vertex as usize],
                    law: self.law_of(vertices, rest),
                });
            }
        }
        for &pair in candidates.edge_edge() {
            let [[a, b], [c, d]] = pair.map(|e| candidates.edges()[e as usize]);
            let vertices = [a, b, c, d];
            let reach = h + room(a).max(room(b)) + room(c).max(room(d));
            let places = gather(x, vertices);
            if !can_move(&vertices) || are_farther(&places, 2, reach) {
                continue;
            }
            if Gap::edge_edge(&places).distance < reach {
                let rest = |x: &[Vec3; 4]| Gap::edge_edge(x).distance;
                let squared = |ends: [u32; 2]| {
                    let [a, b] = gather(&self.rest, ends);
                    (b - a).norm_squared()
                };
                let [first, second] = pair.map(|e| self.edge_area[e as usize]);
                self.edge_edge.push(EdgeEdgeContact {
                    vertices,
                    area: first.min(second),
                    law: self.law_of(vertices, rest),
                    mollifier: Mollifier::new([squared([a, b]), squared([c, d])]),
                });
            }
        }
    }

    /// m of two edges at `x` (m).
    pub(super) fn mollified(&self, vertices: [u32; 4], x: &[Vec3; 4]) -> Real {
        let [a, b, c, d] = gather(&self.rest, vertices);
        let lengths = [(b - a).norm_squared(), (d - c).norm_squared()];
        Mollifier::new(lengths).at(x).value
    }

    /// Finds all candidates of a cloth that rests at `x` (m).
    pub(super) fn find_all(&mut self, x: &[Vec3]) -> Result<(), CollideError> {
        let h = self.law.range();
        self.searches = 0;
        let candidates = self.candidates.as_mut();
        candidates.map_or(Ok(()), |candidates| candidates.update(x, x, h))
    }

    /// How many pairs of near triangles `meet` at `x` (m), the place of the last search.
    pub(super) fn crossing(
        &self,
        x: &[Vec3],
        meet: impl Fn([[u32; 3]; 2], &[Vec3]) -> bool,
    ) -> usize {
        let crossing = self.candidates.iter().flat_map(|candidates| {
            let triangles = candidates.triangles();
            let pairs = candidates.triangle_pairs().iter();
            pairs.filter(|pair| meet(pair.map(|t| triangles[t as usize]), x))
        });
        crossing.count()
    }

    /// The law of a pair: for two parts of one piece it begins no farther than they are apart at rest, so that nothing is pushed away from its
    /// rest.
    pub(super) fn law_of(
        &self,
        vertices: [u32; 4],
        distance: impl Fn(&[Vec3; 4]) -> Real,
    ) -> PenaltyLaw {
        let [a, .., d] = vertices.map(|v| self.piece[v as usize]);
        if a != d {
            return self.law;
        }
        let rest = distance(&gather(&self.rest, vertices));
        if rest >= self.law.range() || rest <= 0.0 {
            self.law
        } else {
            self.law.with_range(rest)
        }
    }

    fn choose_obstacles(&mut self, x: &[Vec3], obstacles: &[Obstacle]) {
        self.vertex_obstacle.clear();
        let h = self.law.range();
        for (vertex, (x, room)) in (0u32..).zip(x.iter().zip(&self.room)) {
            if !self.is_free[vertex as usize] {
                continue;
            }
            for (number, obstacle) in (0u32..).zip(obstacles) {
                let reach = h + room[1] * obstacle.shape().lipschitz();
                if obstacle.clearance(*x, 0.0).value < reach {
                    self.vertex_obstacle.push([vertex, number]);
                }
            }
        }
    }
}

/// Whether the boxes around the first `split` of four points and around the others are farther apart than `reach` (m) along an axis.
#[inline(always)]
fn are_farther(x: &[Vec3; 4], split: usize, reach: Real) -> bool {
    let around = |points: &[Vec3]| {
        let first = (points[0], points[0]);
        points[1..]
            .iter()
            .fold(first, |(low, high), x| (low.inf(x), high.sup(x)))
    };
    let (a, b) = (around(&x[..split]), around(&x[split..]));
    (a.0 - b.1).max() > reach || (b.0 - a.1).max() > reach
}

//! Distances within the cloth at rest.

use crate::math::{Real, Vec3};
use crate::mesh::TriMesh;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Shortest paths over a triangle mesh from one vertex to some others.
///
/// Dijkstra's method over the edges, in which a triangle with two corners done also reaches the third straight across:
/// the source is unfolded into the plane of the triangle from the distances of the two, and the straight line to the
/// third corner is taken if it passes between them (M. Novotni, R. Klein, "Computing geodesic distances on triangular
/// meshes", WSCG 2002). On a flat or a folded sheet the result is exact wherever the straight path lies within the
/// sheet and no obtuse triangle hides it, and elsewhere too long: round a hole or a slit, never across.
#[derive(Debug)]
pub struct Geodesics<'a> {
    positions: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    /// Triangles at vertex v: `around[starts[v]..starts[v + 1]]`.
    around: Vec<u32>,
    starts: Vec<u32>,
    distance: Vec<Real>,
    done: Vec<bool>,
    /// Vertices whose entries have to be reset.
    touched: Vec<u32>,
    queue: BinaryHeap<Reverse<(Order, u32)>>,
}

/// A distance (m) as something to sort by.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Order(Real);

impl Eq for Order {}

impl Ord for Order {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Order {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<'a> Geodesics<'a> {
    /// Over a mesh at rest.
    #[must_use]
    pub fn new(mesh: &'a TriMesh) -> Self {
        let count = mesh.vertex_count();
        let mut starts = vec![0_u32; count + 1];
        for &v in mesh.triangles().iter().flatten() {
            starts[v as usize + 1] += 1;
        }
        for v in 0..count {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut around = vec![0; 3 * mesh.triangle_count()];
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            for &v in triangle {
                around[next[v as usize] as usize] = t as u32;
                next[v as usize] += 1;
            }
        }
        Self {
            positions: mesh.positions(),
            triangles: mesh.triangles(),
            around,
            starts,
            distance: vec![Real::INFINITY; count],
            done: vec![false; count],
            touched: Vec::new(),
            queue: BinaryHeap::new(),
        }
    }

    /// The distances (m) from `source` to each of `targets`; infinite where there is no path.
    ///
    /// # Panics
    /// If one of them is not a vertex of the mesh.
    pub fn from(&mut self, source: u32, targets: &[u32]) -> Vec<Real> {
        self.reach(source, 0.0);
        let mut open = targets.len();
        while open > 0 {
            let Some(Reverse((Order(distance), v))) = self.queue.pop() else {
                break;
            };
            if self.done[v as usize] || distance > self.distance[v as usize] {
                continue;
            }
            self.done[v as usize] = true;
            open -= targets.iter().filter(|&&target| target == v).count();
            self.spread_from(v);
        }
        let result = targets.iter().map(|&t| self.distance[t as usize]).collect();
        for v in self.touched.drain(..) {
            self.distance[v as usize] = Real::INFINITY;
            self.done[v as usize] = false;
        }
        self.queue.clear();
        result
    }

    /// Notes a path to `v`, if it is shorter than those known.
    fn reach(&mut self, v: u32, distance: Real) {
        let known = &mut self.distance[v as usize];
        if distance < *known {
            if known.is_infinite() {
                self.touched.push(v);
            }
            *known = distance;
            self.queue.push(Reverse((Order(distance), v)));
        }
    }

    /// To the other corners of all triangles at `v`.
    fn spread_from(&mut self, v: u32) {
        let range = self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize;
        for place in range {
            let triangle = self.triangles[self.around[place] as usize];
            let others = triangle.into_iter().filter(|&other| other != v);
            for p in others.clone() {
                let along = (self.positions[p as usize] - self.positions[v as usize]).norm();
                self.reach(p, self.distance[v as usize] + along);
                if self.done[p as usize] {
                    for q in others.clone().filter(|&q| q != p) {
                        if let Some(distance) = self.straight_across(v, p, q) {
                            self.reach(q, distance);
                        }
                    }
                }
            }
        }
    }

    /// The length of the straight line to q that passes between v and p, if there is one.
    fn straight_across(&self, v: u32, p: u32, q: u32) -> Option<Real> {
        let [to_v, to_p] = [v, p].map(|i| self.distance[i as usize]);
        let [v, p, q] = [v, p, q].map(|i| self.positions[i as usize]);
        // The edge from v to p as first axis, q above it, the source below.
        let (edge, side) = (p - v, q - v);
        let length = edge.norm();
        let foot = side.dot(&edge) / length;
        let height = edge.cross(&side).norm() / length;
        let source = (to_v * to_v - to_p * to_p + length * length) / (2.0 * length);
        let depth = (to_v * to_v - source * source).max(0.0).sqrt();
        let crossing = source + (foot - source) * depth / (depth + height);
        (depth + height > 0.0 && (0.0..=length).contains(&crossing))
            .then(|| (foot - source).hypot(height + depth))
    }
}

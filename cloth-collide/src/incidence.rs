//! Who has which vertex and which edge, and who faces whom across an edge.

use crate::ccd::QueryKind;
use crate::pair::Pair;
use cloth_core::mesh::TriMesh;

/// The vertices and edges of the triangles of a mesh, each *represented* by the first triangle that has it, so that a
/// pair of primitives is met in one pair of triangles only.
#[derive(Clone, Debug)]
pub(crate) struct Incidence {
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The two vertices of each edge, in rising order.
    pub(crate) edges: Vec<[u32; 2]>,
    /// The three edges of each triangle: edge k goes from corner k to the next one.
    pub(crate) triangle_edges: Vec<[u32; 3]>,
    /// Which of its corners and edges a triangle represents.
    owned: Vec<[[bool; 3]; 2]>,
}

impl Incidence {
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let triangles = mesh.triangles().to_vec();
        let (edges, triangle_edges) = edge_numbers(&triangles);
        let (mut vertex_taken, mut edge_taken) =
            (vec![false; mesh.vertex_count()], vec![false; edges.len()]);
        let first = |taken: &mut [bool], all: [u32; 3]| {
            all.map(|number| !std::mem::replace(&mut taken[number as usize], true))
        };
        let owned = triangles.iter().zip(&triangle_edges);
        let owned = owned.map(|(corners, edges)| {
            [
                first(&mut vertex_taken, *corners),
                first(&mut edge_taken, *edges),
            ]
        });
        Self {
            owned: owned.collect(),
            triangles,
            edges,
            triangle_edges,
        }
    }

    /// A vertex and a triangle, by their numbers.
    pub(crate) fn vertex_triangle(&self, vertex: u32, triangle: u32) -> Pair {
        let [a, b, c] = self.triangles[triangle as usize];
        Pair {
            kind: QueryKind::VertexTriangle,
            vertices: [vertex, a, b, c],
        }
    }

    /// Two edges, by their numbers.
    pub(crate) fn edge_edge(&self, e: u32, f: u32) -> Pair {
        let [[a, b], [c, d]] = [e, f].map(|edge| self.edges[edge as usize]);
        Pair {
            kind: QueryKind::EdgeEdge,
            vertices: [a, b, c, d],
        }
    }

    /// Hands `visit` the pairs of primitives without a common vertex that two triangles represent, and their numbers.
    /// Edges of the first triangle, given by their ends, are left out that do not reach the other one.
    #[inline]
    pub(crate) fn visit(
        &self,
        [a, b]: [u32; 2],
        reaches: impl Fn([u32; 2], u32) -> bool,
        mut visit: impl FnMut(Pair, [u32; 2]),
    ) {
        for (one, other) in [(a, b), (b, a)] {
            let corners = &self.triangles[other as usize];
            let vertices = self.triangles[one as usize].iter();
            for (vertex, is_own) in vertices.zip(self.owned[one as usize][0]) {
                if is_own && !corners.contains(vertex) {
                    visit(self.vertex_triangle(*vertex, other), [*vertex, other]);
                }
            }
        }
        let own = |t: u32| {
            let edges = self.triangle_edges[t as usize].iter();
            let edges = edges.zip(self.owned[t as usize][1]);
            edges.filter_map(|(edge, is_own)| is_own.then_some(*edge))
        };
        for e in own(a) {
            let ends = self.edges[e as usize];
            if reaches(ends, b) {
                for f in own(b) {
                    if !self.edges[f as usize].iter().any(|v| ends.contains(v)) {
                        visit(self.edge_edge(e, f), [e, f]);
                    }
                }
            }
        }
    }
}

/// The two corners of edge k of a triangle.
pub(crate) fn ends(k: usize) -> [usize; 2] {
    [k, (k + 1) % 3]
}

/// The two vertices of each edge, in rising order, and the three edges of each triangle.
pub(crate) fn edge_numbers(triangles: &[[u32; 3]]) -> (Vec<[u32; 2]>, Vec<[u32; 3]>) {
    let mut sides = Vec::with_capacity(3 * triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            let [a, b] = ends(k).map(|k| corners[k]);
            sides.push(([a.min(b), a.max(b)], triangle, k));
        }
    }
    sides.sort_unstable();
    let mut edges = Vec::new();
    let mut of_triangle = vec![[0; 3]; triangles.len()];
    for (number, same) in (0..).zip(sides.chunk_by(|a, b| a.0 == b.0)) {
        edges.push(same[0].0);
        for &(_, triangle, k) in same {
            of_triangle[triangle][k] = number;
        }
    }
    (edges, of_triangle)
}

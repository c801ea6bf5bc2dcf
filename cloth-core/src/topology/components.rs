//! Which vertices are connected, and where surfaces are connected by a single vertex only.

use super::edges::EdgeTable;
use crate::mesh::TriMesh;

/// The connected component of each vertex, numbered from 0 in the order of their lowest vertices.
///
/// Triangles that share as much as one vertex are in one component: a force passes through a
/// single vertex, so for mechanics this is one body.
///
/// # Panics
/// If an edge names a vertex that is not below `vertex_count`.
#[must_use]
pub fn components(vertex_count: usize, edges: &EdgeTable) -> Vec<u32> {
    let mut sets = DisjointSets::new(vertex_count);
    for &[a, b] in edges.ends() {
        sets.join(a, b);
    }
    let mut count = 0;
    let mut label = vec![0; vertex_count];
    for vertex in 0..vertex_count {
        // The root is the lowest vertex of its set, so it has its label before the others ask.
        let root = sets.root(vertex as u32) as usize;
        if root == vertex {
            label[vertex] = count;
            count += 1;
        } else {
            label[vertex] = label[root];
        }
    }
    label
}

/// The lowest of the vertices that are joined to each of `count` vertices by pairs, itself among them.
///
/// # Panics
/// If a pair names a vertex that is not below `count`.
#[must_use]
pub fn joined(count: usize, pairs: impl IntoIterator<Item = [u32; 2]>) -> Vec<u32> {
    let mut sets = DisjointSets::new(count);
    for [a, b] in pairs {
        sets.join(a, b);
    }
    (0..count as u32).map(|vertex| sets.root(vertex)).collect()
}

/// Vertices, in ascending order, whose triangles form more than one fan: pieces of surface that
/// touch in a point only. Such a vertex is not manifold, because its surroundings are no disk.
///
/// # Panics
/// If `edges` was built from another mesh.
#[must_use]
pub fn bow_tie_vertices(mesh: &TriMesh, edges: &EdgeTable) -> Vec<u32> {
    // Corner 3t + k stands for triangle t as seen from its corner k.
    let corner = |triangle: u32, vertex: u32| {
        let corners = mesh.triangles()[triangle as usize];
        let k = corners.iter().position(|&c| c == vertex);
        3 * triangle + k.expect("the edge table belongs to this mesh") as u32
    };
    let mut fans = DisjointSets::new(3 * mesh.triangle_count());
    for edge in (0..edges.len()).filter(|&edge| !edges.is_boundary(edge)) {
        let [first, second] = edges.sides()[edge];
        for vertex in edges.ends()[edge] {
            fans.join(corner(first, vertex), corner(second, vertex));
        }
    }
    let mut fan_count = vec![0_u32; mesh.vertex_count()];
    for (index, &vertex) in mesh.triangles().as_flattened().iter().enumerate() {
        let is_root = fans.root(index as u32) as usize == index;
        fan_count[vertex as usize] += u32::from(is_root);
    }
    let numbered = fan_count.iter().enumerate();
    numbered
        .filter(|&(_, &count)| count > 1)
        .map(|(vertex, _)| vertex as u32)
        .collect()
}

/// Disjoint sets of numbers; the root of a set is its lowest number.
#[derive(Clone, Debug, Default)]
pub struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Each of `count` numbers on its own.
    #[must_use]
    pub fn new(count: usize) -> Self {
        let mut sets = Self::default();
        sets.reset(count);
        sets
    }

    /// The same again, in the memory that there is.
    pub fn reset(&mut self, count: usize) {
        self.parent.clear();
        self.parent.extend(0..count as u32);
    }

    /// The lowest number of the set of a number.
    pub fn root(&mut self, mut of: u32) -> u32 {
        while self.parent[of as usize] != of {
            // Halve the path on the way, which keeps later searches short.
            let above = self.parent[self.parent[of as usize] as usize];
            self.parent[of as usize] = above;
            of = above;
        }
        of
    }

    /// Joins the sets of two numbers.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

//! What the contour cuts off a cloth: the components that are probably on the wrong side.

use super::crossing::Crossing;
use crate::incidence::edge_numbers;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::topology::{DisjointSets, joined};

/// Connected components of the mesh, when the edges that pass through a triangle are taken away.
///
/// Each connected mesh has a largest component outside of bodies, taken to be right, and the others are to go back
/// through the surface that cut them off. This is the global analysis of Baraff et al. (2003), with the number of
/// vertices for the size of a component.
#[derive(Debug)]
pub(super) struct Components {
    edges: Vec<[u32; 2]>,
    /// What joins vertices besides.
    sewn: Vec<[u32; 2]>,
    /// The number of each vertex's mesh, if several are one.
    mesh_of: Vec<u32>,
    sets: DisjointSets,
    /// The lowest vertex of the component of each vertex: its root.
    parent: Vec<u32>,
    /// Vertices of the component of each root, and the largest root of each mesh.
    sizes: Vec<u32>,
    largest: Vec<u32>,
    /// Edges and triangles that cross, each pair once.
    crossings: Vec<Crossing>,
    cut: Vec<bool>,
    /// Direction back of each root's component (m², not of unit length).
    back: Vec<Vec3>,
}

impl Components {
    /// Of a mesh with pairs of vertices that are sewn together.
    pub(super) fn new(mesh: &TriMesh, sewn: &[[u32; 2]]) -> Self {
        let (edges, _) = edge_numbers(mesh.triangles());
        let count = mesh.vertex_count();
        Self {
            mesh_of: joined(count, edges.iter().chain(sewn).copied()),
            sewn: sewn.to_vec(),
            cut: vec![false; edges.len()],
            edges,
            sets: DisjointSets::default(),
            parent: vec![0; count],
            sizes: vec![0; count],
            largest: vec![0; count],
            crossings: Vec::new(),
            back: vec![Vec3::zeros(); count],
        }
    }

    /// Finds the root of each vertex.
    fn join_uncut(&mut self) {
        self.sets.reset(self.parent.len());
        for (&[a, b], _) in self.edges.iter().zip(&self.cut).filter(|(_, cut)| !**cut) {
            self.sets.join(a, b);
        }
        for &[a, b] in &self.sewn {
            self.sets.join(a, b);
        }
        for (vertex, parent) in (0..).zip(&mut self.parent) {
            *parent = self.sets.root(vertex);
        }
    }

    /// Takes over where edges pass through triangles, and which vertices are inside of a body: a component is all
    /// inside or all outside, and what is inside is not right. Whether anything is cut off.
    pub(super) fn divide(
        &mut self,
        crossings: impl Iterator<Item = Crossing>,
        is_inside: impl Fn(u32) -> bool,
    ) -> bool {
        self.crossings.clear();
        self.crossings.extend(crossings);
        let name = |c: &Crossing| (c.sorted_edge(), c.triangle);
        self.crossings.sort_unstable_by_key(name);
        self.crossings.dedup_by_key(|c| name(c));
        self.cut.fill(false);
        for crossing in &self.crossings {
            if let Ok(edge) = self.edges.binary_search(&crossing.sorted_edge()) {
                // Through and back again is on the same side.
                self.cut[edge] = !self.cut[edge];
            }
        }
        self.join_uncut();
        self.sizes.fill(0);
        for root in &self.parent {
            self.sizes[*root as usize] += 1;
        }
        self.largest.copy_from_slice(&self.mesh_of);
        let mut cut_off = false;
        for (vertex, root) in (0u32..).zip(&self.parent) {
            if vertex == *root {
                let mesh = self.mesh_of[vertex as usize] as usize;
                cut_off |= vertex != mesh as u32;
                if is_inside(vertex) {
                    self.sizes[vertex as usize] = 0;
                }
                if self.sizes[vertex as usize] > self.sizes[self.largest[mesh] as usize] {
                    self.largest[mesh] = vertex;
                }
            }
        }
        cut_off
    }

    /// Whether a vertex is in a component that was cut off.
    pub(super) fn is_cut_off(&self, vertex: u32) -> bool {
        let root = self.parent[vertex as usize];
        root != self.largest[self.mesh_of[vertex as usize] as usize]
    }

    /// Replaces `out` by the direction away from where the components should go (dimensionless), so that going against
    /// it, as against a gradient, pushes them back through the triangles that cut them off, and these in the other
    /// direction.
    pub(super) fn push(
        &mut self,
        positions: &[Vec3],
        is_body: impl Fn(u32) -> bool,
        out: &mut [Vec3],
    ) {
        out.fill(Vec3::zeros());
        self.back.fill(Vec3::zeros());
        for crossing in &self.crossings {
            let Some((inside, n)) = self.direction_back(crossing, positions) else {
                continue;
            };
            self.back[self.parent[inside as usize] as usize] += n;
            for (vertex, weight) in crossing.triangle.iter().zip(crossing.weights) {
                out[*vertex as usize] += n * weight;
                // What a component of a body has cut off goes where that goes through.
                if is_body(inside) && self.is_cut_off(*vertex) {
                    let root = self.parent[*vertex as usize];
                    self.back[root as usize] -= n * weight;
                }
            }
        }
        for (vertex, root) in self.parent.iter().enumerate() {
            out[vertex] -= self.back[*root as usize];
        }
    }

    /// The end of a crossing edge that is on the wrong side, and the unit normal of the triangle that leads to the
    /// other.
    fn direction_back(&self, crossing: &Crossing, positions: &[Vec3]) -> Option<(u32, Vec3)> {
        let [a, b] = crossing.edge;
        let (inside, outside) = match (self.is_cut_off(a), self.is_cut_off(b)) {
            (true, false) => (a, b),
            (false, true) => (b, a),
            _ => return None,
        };
        let n = crossing.normal.try_normalize(0.0)?;
        let displacement = positions[outside as usize] - positions[inside as usize];
        let side: Real = n.dot(&displacement).signum();
        Some((inside, n * side))
    }
}

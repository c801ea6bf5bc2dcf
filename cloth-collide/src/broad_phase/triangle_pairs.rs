//! Pairs of triangles of a cloth with overlapping boxes.

use super::order::PairSorter;
use super::{BroadPhase, Hierarchy};
use crate::bounds::Bounds;
use crate::error::NonFinite;
use cloth_core::math::{Vec3, gather, is_finite};
use cloth_core::mesh::TriMesh;

/// Finds the pairs of triangles of one cloth whose boxes overlap, from a tree that is made once, from the rest
/// positions; or by another broad phase.
///
/// So a result depends on the mesh and the positions, not on what was asked before, and nothing is allocated once the
/// list of pairs has grown to its size.
///
/// Limits: where the rest shape has many pieces in one place (a garment as a stack of flat patterns), the
/// tree mixes the pieces and is slow, not wrong.
#[derive(Clone, Debug)]
pub(crate) struct TrianglePairs<B = Hierarchy> {
    pub(crate) triangles: Vec<[u32; 3]>,
    vertex_count: usize,
    pub(crate) bounds: Vec<Bounds>,
    pub(crate) broad_phase: B,
    /// Pairs `[a, b]` of triangle numbers, a < b, whose boxes overlap: in rising order, each once, neighbours in the
    /// mesh included.
    pub(crate) pairs: Vec<[u32; 2]>,
    sorter: PairSorter,
}

impl TrianglePairs {
    /// Builds the tree over the rest shape of `mesh`.
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        Self::with(mesh, Hierarchy::default())
    }

    /// Finds the pairs at `positions` (m), one per vertex; what was found stays where one is not finite.
    pub(crate) fn find(&mut self, positions: &[Vec3]) -> Result<(), NonFinite> {
        assert_eq!(
            positions.len(),
            self.vertex_count,
            "the number of positions is not the number of vertices"
        );
        if let Some(vertex) = positions.iter().position(|p| !is_finite(p)) {
            return Err(NonFinite { vertex });
        }
        for (bounds, &corners) in self.bounds.iter_mut().zip(&self.triangles) {
            *bounds = Bounds::around(gather(positions, corners));
        }
        self.search();
        Ok(())
    }
}

impl<B: BroadPhase> TrianglePairs<B> {
    pub(crate) fn with(mesh: &TriMesh, broad_phase: B) -> Self {
        let corners = |&t: &[u32; 3]| Bounds::around(gather(mesh.positions(), t));
        let mut pairs = Self {
            triangles: mesh.triangles().to_vec(),
            vertex_count: mesh.vertex_count(),
            bounds: mesh.triangles().iter().map(corners).collect(),
            broad_phase,
            pairs: Vec::new(),
            sorter: PairSorter::default(),
        };
        // A tree keeps the shape of its first boxes, and those of the rest shape are best.
        pairs.search();
        pairs
    }

    /// The vertices of the pairs that were found last.
    pub(crate) fn corners(&self) -> impl Iterator<Item = [[u32; 3]; 2]> + '_ {
        let pairs = self.pairs.iter();
        pairs.map(|pair| pair.map(|t| self.triangles[t as usize]))
    }

    pub(crate) fn search(&mut self) {
        self.broad_phase.overlapping(&self.bounds, &mut self.pairs);
        // What comes next reads the triangles of each pair; in this order most are still in the cache.
        self.sorter.sort_pairs(&mut self.pairs, self.bounds.len());
    }
}

#[cfg(test)]
#[path = "../../tests/unit/broad_phase_triangle_pairs.rs"]
mod tests;

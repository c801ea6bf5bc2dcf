//! Which triangles of a cloth have overlapping boxes?

use super::order::PairSorter;
use super::{BroadPhase, Hierarchy};
use crate::bounds::Bounds;
use crate::error::CollideError;
use cloth_core::math::{Real, Vec3, gather, is_finite};
use cloth_core::mesh::TriMesh;
use std::cell::Cell;

/// Finds the pairs of triangles of one cloth whose boxes overlap, from a tree that is made once, from the rest
/// positions.
///
/// So a result depends on the mesh and the positions, not on what was asked before, and nothing is allocated once the
/// list of pairs has grown to its size.
///
/// Limits: where the rest shape has many pieces in one place (a garment as a stack of flat patterns), the
/// tree mixes the pieces and is slow, not wrong.
#[derive(Debug)]
pub(crate) struct TrianglePairs {
    triangles: Vec<[u32; 3]>,
    vertex_count: usize,
    bounds: Vec<Bounds>,
    tree: Hierarchy,
    pairs: Vec<[u32; 2]>,
    sorter: PairSorter,
}

impl TrianglePairs {
    /// Builds the tree over the rest shape of `mesh`.
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let corners = |&t: &[u32; 3]| Bounds::around(gather(mesh.positions(), t));
        let bounds: Vec<_> = mesh.triangles().iter().map(corners).collect();
        let (mut tree, mut pairs) = (Hierarchy::new(), Vec::new());
        // The tree keeps the shape of its first boxes.
        tree.overlapping(&bounds, &mut pairs);
        Self {
            triangles: mesh.triangles().to_vec(),
            vertex_count: mesh.vertex_count(),
            tree,
            bounds,
            pairs,
            sorter: PairSorter::default(),
        }
    }

    /// Finds the pairs `[a, b]` of triangle numbers, a < b, whose boxes overlap at `positions` (m), one per vertex; in
    /// rising order, each once, neighbours in the mesh included.
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`] if a coordinate is NaN or infinite. What was found then stays.
    ///
    /// # Panics
    /// If there are not as many positions as the mesh has vertices.
    pub(crate) fn find(&mut self, positions: &[Vec3]) -> Result<&[[u32; 2]], CollideError> {
        assert_eq!(
            positions.len(),
            self.vertex_count,
            "the number of positions is not the number of vertices"
        );
        if let Some(vertex) = positions.iter().position(|p| !is_finite(p)) {
            return Err(CollideError::NonFinitePosition { vertex });
        }
        for (bounds, &corners) in self.bounds.iter_mut().zip(&self.triangles) {
            *bounds = Bounds::around(gather(positions, corners));
        }
        self.tree.overlapping(&self.bounds, &mut self.pairs);
        self.sorter.sort(&mut self.pairs, self.bounds.len());
        Ok(&self.pairs)
    }

    /// Hands `visit` every pair of triangles a < b whose boxes, at the last positions, are nearer than the distance whose
    /// square is `limit` (m²), which `visit` may lower on the way.
    pub(crate) fn visit_within(&self, limit: &Cell<Real>, mut visit: impl FnMut([u32; 2])) {
        self.tree.visit_near(limit, |a, b| visit([a, b]));
    }

    /// What [`TrianglePairs::find`] has found last.
    pub(crate) fn found(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The triangles of the mesh, as vertex numbers.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The box of each triangle.
    pub(crate) fn bounds(&self) -> &[Bounds] {
        &self.bounds
    }
}

#[cfg(test)]
#[path = "../../tests/unit/broad_phase_triangle_pairs.rs"]
mod tests;

//! Which triangles of a cloth can be near each other? Candidates from a tree of boxes.

use super::Hierarchy;
use super::order::PairSorter;
use crate::bounds::Bounds;
use crate::error::CollideError;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use std::cell::Cell;
use std::fmt;

/// Finds the pairs of triangles of one cloth that are possibly within a given distance of each other: the pairs
/// whose axis-aligned boxes are.
///
/// The boxes are the leaves of a bounding volume hierarchy (parry's). Its shape is made once, from
/// the rest positions, since neighbours in the cloth stay neighbours however it moves; afterwards only the
/// sizes of its boxes follow the cloth. So a result depends on the mesh, the positions and the distance, not on
/// what was asked before, and nothing is allocated once the list of pairs has grown to its size.
///
/// Limits: where the rest shape has many pieces in one place (a garment as a stack of flat patterns), the
/// tree mixes the pieces and is slow, not wrong.
pub struct TrianglePairs {
    triangles: Vec<[u32; 3]>,
    vertex_count: usize,
    bounds: Vec<Bounds>,
    /// The largest coordinate in size (m): rounding of a box is a fraction of it.
    reach: Real,
    tree: Hierarchy,
    pairs: Vec<[u32; 2]>,
    sorter: PairSorter,
}

impl TrianglePairs {
    /// Builds the tree over the rest shape of `mesh`, at which the cloth is also taken to be until
    /// [`TrianglePairs::move_to`] says otherwise.
    #[must_use]
    pub fn new(mesh: &TriMesh) -> Self {
        let triangles = mesh.triangles().to_vec();
        let bounds = bounds_of(&triangles, mesh.positions());
        Self {
            tree: Hierarchy::over(&bounds),
            vertex_count: mesh.vertex_count(),
            reach: reach(mesh.positions()),
            triangles,
            bounds,
            pairs: Vec::new(),
            sorter: PairSorter::default(),
        }
    }

    /// Takes the cloth to be at `positions` (m), one per vertex.
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`] if a coordinate is NaN or infinite. The cloth then stays where it was.
    ///
    /// # Panics
    /// If there are not as many positions as the mesh has vertices.
    pub fn move_to(&mut self, positions: &[Vec3]) -> Result<(), CollideError> {
        assert_eq!(
            positions.len(),
            self.vertex_count,
            "the number of positions is not the number of vertices"
        );
        if let Some(vertex) = positions
            .iter()
            .position(|p| !cloth_core::math::is_finite(p))
        {
            return Err(CollideError::NonFinitePosition { vertex });
        }
        for (bounds, &corners) in self.bounds.iter_mut().zip(&self.triangles) {
            *bounds = Bounds::around(gather(positions, corners));
        }
        self.reach = reach(positions);
        Ok(())
    }

    /// All pairs `[a, b]` of triangle numbers, a < b, whose boxes are at most `distance` (m) apart; in rising order,
    /// each once, neighbours in the mesh included. Triangles that are closer than `distance` are among them.
    ///
    /// # Panics
    /// If `distance` is negative or NaN.
    pub fn within(&mut self, distance: Real) -> &[[u32; 2]] {
        assert!(distance >= 0.0, "the distance is {distance}");
        // Half of the distance for each of the two boxes, and enough that rounding here loses no pair; the squared
        // gap decides below.
        let margin = 0.5 * distance + 4.0 * Real::EPSILON * (self.reach + distance);
        let Self {
            tree,
            bounds,
            pairs,
            sorter,
            ..
        } = self;
        tree.refit(bounds.iter().map(|b| b.loosened(margin)));
        pairs.clear();
        let squared = distance * distance;
        tree.visit_overlapping(|a, b| {
            if bounds[a as usize].squared_gap(&bounds[b as usize]) <= squared {
                pairs.push([a.min(b), a.max(b)]);
            }
        });
        sorter.sort(pairs, bounds.len());
        pairs
    }

    /// Hands `visit` every pair of triangles a < b whose boxes are nearer than the distance whose square is `limit`
    /// (m²), which `visit` may lower on the way. The tree has to be as [`TrianglePairs::within`] leaves it.
    pub(crate) fn visit_within(&self, limit: &Cell<Real>, mut visit: impl FnMut([u32; 2])) {
        self.tree.visit_near(limit, |a, b| visit([a, b]));
    }

    /// What [`TrianglePairs::within`] has found last.
    pub(crate) fn found(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The triangles of the mesh, as vertex numbers.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The box of each triangle.
    pub(crate) fn bounds(&self) -> &[Bounds] {
        &self.bounds
    }
}

impl fmt::Debug for TrianglePairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The tree alone would be thousands of lines.
        f.debug_struct("TrianglePairs")
            .field("triangle_count", &self.triangles.len())
            .field("vertex_count", &self.vertex_count)
            .finish_non_exhaustive()
    }
}

fn bounds_of(triangles: &[[u32; 3]], positions: &[Vec3]) -> Vec<Bounds> {
    let corners = triangles.iter().map(|&t| gather(positions, t));
    corners.map(Bounds::around).collect()
}

/// The largest coordinate in size (m).
fn reach(positions: &[Vec3]) -> Real {
    positions.iter().map(Vec3::amax).fold(0.0, Real::max)
}

#[cfg(test)]
mod tests;

//! Vertex numbers that keep neighbours close in memory, and the way back.
//!
//! A solver walks over elements and reads their vertices. If neighbouring vertices have numbers
//! far apart, every read is a cache miss: a shuffled 512 × 512 sheet costs about three times
//! the sorted one. Generated grids are sorted already; meshes from files often are not.
//!
//! | order | function | good for |
//! |---|---|---|
//! | along a space-filling curve | [`Order::morton`] | sweeps over elements; needs positions |
//! | by distance from an end of the mesh | [`Order::reverse_cuthill_mckee`] | small bandwidth; needs edges only |
//!
//! An [`Order`] keeps both directions, so what was computed in the new order goes back to the
//! caller in the order the caller knows:
//!
//! ```
//! use cloth_core::mesh::generate::{Diagonals, grid};
//! use cloth_core::method::ordering::Order;
//!
//! let sheet = grid(20, 10, 2.0, 1.0, Diagonals::Alternating)?;
//! let order = Order::morton(sheet.positions());
//! let sorted = order.reorder_mesh(&sheet);
//! assert_eq!(order.restore(sorted.positions()), sheet.positions());
//! # Ok::<(), cloth_core::mesh::MeshError>(())
//! ```
//!
//! References: G. M. Morton, *A computer oriented geodetic data base*, IBM, 1966; E. Cuthill and
//! J. McKee, *Reducing the bandwidth of sparse symmetric matrices*, 1969,
//! doi:10.1145/800195.805928; A. George and J. W. H. Liu, *An implementation of a
//! pseudoperipheral node finder*, 1979, doi:10.1145/355841.355845.

mod cuthill_mckee;
pub(crate) mod graph;
#[cfg(feature = "cholesky")]
pub(crate) mod nested_dissection;

use crate::math::{Real, Vec3};
use crate::mesh::TriMesh;
use crate::topology::EdgeTable;

/// A permutation of the vertices with both directions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    new_of_old: Vec<u32>,
    old_of_new: Vec<u32>,
}

impl Order {
    /// Every vertex keeps its number.
    #[must_use]
    pub fn identity(vertex_count: usize) -> Self {
        Self::from_sequence((0..vertex_count as u32).collect())
    }

    /// Vertices along the Morton curve through their positions (m).
    ///
    /// The bounding cube is divided into 2²¹ steps each way; interleaving the bits of the three
    /// coordinates gives the place along the curve. Vertices in the same cell keep their order,
    /// and so do those whose position is not finite, which come first.
    #[must_use]
    pub fn morton(positions: &[Vec3]) -> Self {
        let finite = || positions.iter().filter(|p| crate::math::is_finite(p));
        let low = finite().fold(Vec3::repeat(Real::INFINITY), |low, p| low.inf(p));
        let high = finite().fold(Vec3::repeat(Real::NEG_INFINITY), |high, p| high.sup(p));
        // One scale for all three axes: the curve should not see a thin sheet as a cube.
        let cell = (high - low).max() / Real::from((1_u32 << 21) - 1);
        // A cast to an integer takes NaN to 0 and cuts off what is out of range.
        let code = |p: &Vec3| {
            let steps = (p - low).map(|d| spread((d / cell) as u32));
            steps.x | (steps.y << 1) | (steps.z << 2)
        };
        let mut keyed: Vec<(u64, u32)> = positions.iter().map(code).zip(0..).collect();
        keyed.sort_unstable();
        Self::from_sequence(keyed.into_iter().map(|(_, vertex)| vertex).collect())
    }

    /// Vertices ring by ring from one end of the mesh to the other, then reversed (Cuthill and
    /// McKee 1969): the numbers of neighbours differ by about the width of the mesh.
    ///
    /// Each piece starts at a vertex that is nearly as far out as possible (George and Liu 1979).
    /// Ties are decided by vertex number, so the same edges give the same order.
    ///
    /// # Panics
    /// If an edge names a vertex that is not below `vertex_count`.
    #[must_use]
    pub fn reverse_cuthill_mckee(vertex_count: usize, edges: &EdgeTable) -> Self {
        let mut sequence = cuthill_mckee::sequence(vertex_count, edges);
        sequence.reverse();
        Self::from_sequence(sequence)
    }

    /// From the old numbers in their new order, each exactly once.
    fn from_sequence(old_of_new: Vec<u32>) -> Self {
        let mut new_of_old = vec![0; old_of_new.len()];
        for (new, &old) in old_of_new.iter().enumerate() {
            new_of_old[old as usize] = new as u32;
        }
        Self {
            new_of_old,
            old_of_new,
        }
    }

    /// New number of each vertex, indexed by its old one.
    #[must_use]
    pub fn new_of_old(&self) -> &[u32] {
        &self.new_of_old
    }

    /// Old number of each vertex, indexed by its new one.
    #[must_use]
    pub fn old_of_new(&self) -> &[u32] {
        &self.old_of_new
    }

    /// Number of vertices.
    #[must_use]
    pub fn len(&self) -> usize {
        self.new_of_old.len()
    }

    /// Whether there is no vertex.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.new_of_old.is_empty()
    }

    /// Takes the vertex numbers of one element from old to new.
    ///
    /// # Panics
    /// If a number is not below [`Order::len`].
    #[must_use]
    pub fn renumber<const N: usize>(&self, vertices: [u32; N]) -> [u32; N] {
        vertices.map(|old| self.new_of_old[old as usize])
    }

    /// Values per vertex from the old order to the new one.
    ///
    /// # Panics
    /// If there are not [`Order::len`] values.
    #[must_use]
    pub fn apply<T: Clone>(&self, values: &[T]) -> Vec<T> {
        picked(values, &self.old_of_new)
    }

    /// Values per vertex from the new order back to the old one.
    ///
    /// # Panics
    /// If there are not [`Order::len`] values.
    #[must_use]
    pub fn restore<T: Clone>(&self, values: &[T]) -> Vec<T> {
        picked(values, &self.new_of_old)
    }

    /// The mesh with vertices in the new order and triangles sorted by their smallest new vertex.
    ///
    /// The order of the *triangles changes*, and no way back is kept: values per triangle or per
    /// edge have to be computed from the new mesh. Corners are not rotated, so every triangle
    /// keeps its winding, its first corner and the bits of its area.
    ///
    /// # Panics
    /// If the mesh does not have [`Order::len`] vertices.
    #[must_use]
    pub fn reorder_mesh(&self, mesh: &TriMesh) -> TriMesh {
        let renumbered = mesh.triangles().iter().map(|&t| self.renumber(t));
        let mut triangles: Vec<[u32; 3]> = renumbered.collect();
        // The sort is stable: triangles at the same vertex keep their order.
        triangles.sort_by_key(|&[a, b, c]| a.min(b).min(c));
        TriMesh::unchecked(self.apply(mesh.positions()), triangles)
    }

    /// Largest difference of the new numbers of two neighbours; for the numbers as they are use
    /// [`Order::identity`].
    ///
    /// # Panics
    /// If an edge names a vertex that is not below [`Order::len`].
    #[must_use]
    pub fn bandwidth(&self, edges: &EdgeTable) -> usize {
        let renumbered = edges.ends().iter().map(|&ends| self.renumber(ends));
        let differences = renumbered.map(|[a, b]| a.abs_diff(b) as usize);
        differences.max().unwrap_or(0)
    }
}

fn picked<T: Clone>(values: &[T], from: &[u32]) -> Vec<T> {
    assert_eq!(values.len(), from.len(), "one value per vertex");
    from.iter().map(|&i| values[i as usize].clone()).collect()
}

/// Moves bit k of the lowest 21 bits to bit 3k, to leave room for two other coordinates.
fn spread(coordinate: u32) -> u64 {
    let mut x = u64::from(coordinate.min((1 << 21) - 1));
    x = (x | (x << 32)) & 0x001F_0000_0000_FFFF;
    x = (x | (x << 16)) & 0x001F_0000_FF00_00FF;
    x = (x | (x << 8)) & 0x100F_00F0_0F00_F00F;
    x = (x | (x << 4)) & 0x10C3_0C30_C30C_30C3;
    (x | (x << 2)) & 0x1249_2492_4924_9249
}

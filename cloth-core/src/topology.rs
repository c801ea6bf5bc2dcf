//! Edges, hinges, boundary and counts, all derived from the triangles alone.
//!
//! A mesh in memory is positions and triangles. What an energy needs beyond that is derived here,
//! one table at a time, so that what nobody asks for does not exist: springs need [`EdgeTable`],
//! bending needs [`HingeTable`], the rest is for reports and checks.
//!
//! All tables come from the *sorted edge list*: write down the three sides of every triangle
//! with the lower vertex number first, sort, and equal neighbours are the two triangles of one
//! edge. No hashing takes part, so the same triangles give the same tables on every machine.
//!
//! # Counting
//!
//! With V vertices, E edges, F triangles and E_b boundary edges, every triangle has three sides
//! and every inner edge is met twice, 3F = 2E − E_b. With χ = V − E + F this gives
//!
//! 3V − E = 3χ + E_b,
//!
//! the number of coordinates left when every edge length is one independent condition. A tube has only E_b of them, a
//! closed sphere only its 6 rigid motions: that is why stiff edges *lock* a triangle mesh.
//!
//! | quantity | function |
//! |---|---|
//! | edges and their triangles | [`EdgeTable::build`] |
//! | edges of a triangle | [`triangle_edges`] |
//! | pairs of triangles that bend against each other | [`HingeTable::build`] |
//! | boundary as loops | [`boundary_loops`] |
//! | connected components | [`components`] |
//! | V, E, F, E_b, χ, 3V − E | [`Topology::of`] |
//! | edges across which the winding turns over | [`inconsistently_oriented_edges`] |
//! | vertices where separate fans touch | [`bow_tie_vertices`] |
//! | the middles of edges, and the triangles between them | [`Midpoints::of`] |
//! | edges that can be left out without a triangle losing two | [`removable_edges`] |
//! | coarser levels of a mesh | [`crate::method::multigrid::coarse_levels`] |
//!
//! # Limits
//!
//! An edge with three or more triangles is refused when the table is built. A *bow-tie* vertex and
//! an inconsistent winding are not: springs do not mind either, and a Möbius band has no
//! consistent winding at all. They are reported instead.

mod boundary;
mod components;
mod edges;
mod hinges;
mod midpoints;
mod removable;

pub use boundary::boundary_loops;
pub use components::{DisjointSets, bow_tie_vertices, components, joined};
pub use edges::{EdgeTable, NONE, inconsistently_oriented_edges, triangle_edges};
pub use hinges::HingeTable;
pub use midpoints::Midpoints;
pub use removable::removable_edges;

use crate::mesh::TriMesh;

/// The counts of a mesh (all dimensionless), see the [module](self) for how they depend on each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topology {
    /// Number of vertices V.
    pub vertices: usize,
    /// Number of edges E.
    pub edges: usize,
    /// Number of triangles F.
    pub faces: usize,
    /// Number of edges with one triangle only, E_b.
    pub boundary_edges: usize,
    /// Euler characteristic χ = V − E + F.
    pub euler: i64,
    /// Number of connected components; triangles that share a vertex are in one.
    pub components: usize,
    /// Number of loops of the boundary.
    pub boundary_loops: usize,
    /// 3V − E = 3χ + E_b: coordinates minus edge lengths.
    pub count_3v_e: i64,
}

impl Topology {
    /// Counts the mesh; `edges` is its own table.
    ///
    /// # Panics
    /// May panic if `edges` was built from another mesh.
    #[must_use]
    pub fn of(mesh: &TriMesh, edges: &EdgeTable) -> Self {
        let [v, e, f] = [mesh.vertex_count(), edges.len(), mesh.triangle_count()];
        let labels = components(mesh.vertex_count(), edges);
        Self {
            vertices: v,
            edges: e,
            faces: f,
            boundary_edges: edges.boundary_edge_count(),
            euler: v as i64 - e as i64 + f as i64,
            components: labels.iter().max().map_or(0, |&last| last as usize + 1),
            boundary_loops: boundary_loops(mesh, edges).len(),
            count_3v_e: 3 * v as i64 - e as i64,
        }
    }
}

//! Coarser levels of a mesh: some of its vertices, what links them over the cloth, and how the others follow (Müller
//! 2008, section 4).

mod geodesic;
mod selection;

use super::prolongation::Prolongation;
use crate::math::{Real, Vec3};
use crate::mesh::TriMesh;
use crate::topology::EdgeTable;
pub use geodesic::Geodesics;
use selection::{Coarsening, Graph, coarsen};

/// A level made of a finer one: the mesh, or a level that has been made before.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarseLevel {
    /// Number in the mesh of each vertex, ascending.
    pub vertices: Vec<u32>,
    /// Number in the next finer level of each vertex, ascending.
    pub kept: Vec<u32>,
    /// To the next finer level: a vertex that was kept has the value of its own, every other one the weighted mean of
    /// its parents.
    pub prolongation: Prolongation,
    /// Vertices, by their numbers in this level, that a finer link joins, themselves or by vertices whose nearest
    /// parents they are; ascending, the lower number first.
    pub links: Vec<[u32; 2]>,
    /// Length (m) of each link: the shortest path over the cloth at rest, not through the air. No folding, bending or
    /// unrolling without stretch makes one longer.
    pub lengths: Vec<Real>,
}

impl CoarseLevel {
    /// The ends of every link, numbered as in the mesh.
    pub fn ends(&self) -> impl Iterator<Item = [u32; 2]> {
        let of_mesh = |v: u32| self.vertices[v as usize];
        self.links.iter().map(move |ends| ends.map(of_mesh))
    }
}

/// Coarser levels than this are none.
const SMALLEST: usize = 4;

/// At most `most` levels of a mesh at rest, from fine to coarse, each of about half as many vertices as the one before,
/// or fewer; fewer levels where one more would gain nothing.
///
/// Vertices are left out one after another as long as every one left out keeps at least `parent_count` neighbours on
/// the coarse level, its parents, and lies among them. On a boundary, of the sheet or of a hole, its two neighbours
/// there are needed and are the parents. Vertices for which `keep` is true are kept.
///
/// # Panics
/// If `edges` was built from another mesh.
#[must_use]
pub fn coarse_levels(
    mesh: &TriMesh,
    edges: &EdgeTable,
    keep: impl Fn(u32) -> bool,
    parent_count: usize,
    most: usize,
) -> Vec<CoarseLevel> {
    let mut geodesics = Geodesics::new(mesh);
    let mut graph = Graph::of_mesh(mesh.positions(), edges);
    let mut vertices: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    let mut levels = Vec::new();
    while levels.len() < most {
        let of_mesh = |v: u32| vertices[v as usize];
        let positions = vertices.iter().map(|&v| mesh.positions()[v as usize]);
        let place: Vec<Vec3> = positions.collect();
        let Coarsening {
            kept,
            prolongation,
            links,
            boundary_links,
        } = coarsen(&graph, |v| keep(of_mesh(v)), &place, parent_count);
        let count = kept.len();
        if count < SMALLEST || 10 * count > 8 * graph.len() {
            break;
        }
        vertices = kept.iter().map(|&v| vertices[v as usize]).collect();
        let lengths = lengths(&mut geodesics, &links, &vertices);
        let measured = links.iter().copied().zip(lengths.iter().copied());
        graph = Graph::new(count, measured, boundary_links.into_iter());
        levels.push(CoarseLevel {
            vertices: vertices.clone(),
            kept,
            prolongation,
            links,
            lengths,
        });
    }
    levels
}

/// Lengths (m) of links between coarse vertices that stand for the vertices `of_mesh`.
fn lengths(geodesics: &mut Geodesics<'_>, links: &[[u32; 2]], of_mesh: &[u32]) -> Vec<Real> {
    let mut lengths = Vec::with_capacity(links.len());
    for from_one in links.chunk_by(|a, b| a[0] == b[0]) {
        let targets: Vec<u32> = from_one.iter().map(|l| of_mesh[l[1] as usize]).collect();
        lengths.extend(geodesics.from(of_mesh[from_one[0][0] as usize], &targets));
    }
    lengths
}

//! The mesh of edge midpoints: triangles that are connected at the middles of their edges only.

use super::edges::{EdgeTable, NONE, triangle_edges};
use crate::math::{Vec3, gather};
use crate::mesh::{MeshError, TriMesh};

/// A mesh seen from the middles of its edges: E points with F small triangles, a quarter as large as those of the mesh,
/// that touch in their corners.
///
/// A rigid triangle is as rigid as the small one between its midpoints, so `3E` coordinates stand against `3F` lengths:
/// `3E − 3F = E + E_b` motions are left, where the mesh itself has only `3χ + E_b`. That is the freedom of
/// nonconforming elements (E. English, R. Bridson, "Animating developable surfaces using nonconforming elements", 2008,
/// <https://doi.org/10.1145/1360612.1360665>).
///
/// Limits: neighbouring triangles agree at one point of their edge, so the surface has gaps; [`Midpoints::vertices`]
/// closes them for display and contact, by a mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Midpoints {
    mesh: TriMesh,
    ends: Vec<[u32; 2]>,
    /// Triangles of the whole mesh; corner k of the small one lies between corners k and k + 1.
    triangles: Vec<[u32; 3]>,
    vertex_count: usize,
}

impl Midpoints {
    /// The midpoints of a mesh, numbered as its edges are.
    ///
    /// # Errors
    /// [`MeshError`] if a small triangle is no triangle to rounding.
    ///
    /// # Panics
    /// If `edges` was built from another mesh.
    pub fn of(mesh: &TriMesh, edges: &EdgeTable) -> Result<Self, MeshError> {
        let middles = middles(mesh.positions(), edges.ends());
        Ok(Self {
            mesh: TriMesh::new(middles, triangle_edges(mesh, edges))?,
            ends: edges.ends().to_vec(),
            triangles: mesh.triangles().to_vec(),
            vertex_count: mesh.vertex_count(),
        })
    }

    /// The small triangles between midpoints: E vertices, F triangles, in the order of the edges and the triangles.
    #[must_use]
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Where the midpoints (m) are when the vertices are at `positions` (m).
    ///
    /// # Panics
    /// If there is not one position per vertex of the mesh.
    #[must_use]
    pub fn between(&self, positions: &[Vec3]) -> Vec<Vec3> {
        assert_eq!(
            positions.len(),
            self.vertex_count,
            "one position per vertex"
        );
        middles(positions, &self.ends)
    }

    /// Positions (m), one per vertex of the mesh, when the midpoints are at `midpoints` (m): each triangle says where
    /// its corner is, and the mean of all that meet there is taken. Exact if they agree.
    ///
    /// # Panics
    /// If there is not one position per edge.
    #[must_use]
    pub fn vertices(&self, midpoints: &[Vec3]) -> Vec<Vec3> {
        assert_eq!(midpoints.len(), self.ends.len(), "one position per edge");
        let mut sum = vec![(Vec3::zeros(), 0.0); self.vertex_count];
        for (&corners, &middles) in self.triangles.iter().zip(self.mesh.triangles()) {
            let [ab, bc, ca] = gather(midpoints, middles);
            let extrapolated = [ab + ca - bc, ab + bc - ca, bc + ca - ab];
            for (vertex, corner) in corners.into_iter().zip(extrapolated) {
                let (sum, count) = &mut sum[vertex as usize];
                *sum += corner;
                *count += 1.0;
            }
        }
        sum.into_iter().map(|(sum, count)| sum / count).collect()
    }

    /// The five midpoints of the hinge at an inner edge, as [`crate::energy::MidpointHinge`] takes them, and the four
    /// vertices around it: the ends of the edge, then the tips. None at the boundary.
    pub(crate) fn hinge(&self, edge: usize, edges: &EdgeTable) -> Option<([u32; 5], [u32; 4])> {
        if edges.sides()[edge][1] == NONE {
            return None;
        }
        let ends = edges.ends()[edge];
        let wings = edges.sides()[edge].map(|t| {
            let corners = self.triangles[t as usize];
            let sides = self.mesh.triangles()[t as usize];
            // Side k runs from corner k to corner k + 1; the one opposite to corner k is number k + 1.
            let tip = (0..3).find(|&k| !ends.contains(&corners[k])).unwrap_or(0);
            let [after, before] = [sides[tip], sides[(tip + 2) % 3]];
            let next = corners[(tip + 1) % 3];
            // `after` joins the tip to the next corner, `before` to the one before.
            let of_ends = if next == ends[0] {
                [after, before]
            } else {
                [before, after]
            };
            (corners[tip], of_ends)
        });
        let [(x2, [m02, m12]), (x3, [m03, m13])] = wings;
        Some((
            [edge as u32, m02, m12, m03, m13],
            [ends[0], ends[1], x2, x3],
        ))
    }
}

fn middles(positions: &[Vec3], ends: &[[u32; 2]]) -> Vec<Vec3> {
    let middle = |&pair: &[u32; 2]| {
        let [a, b] = gather(positions, pair);
        a + (b - a) * 0.5
    };
    ends.iter().map(middle).collect()
}

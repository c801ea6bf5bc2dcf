//! Cutting triangles out of a mesh and putting meshes together.

use crate::math::Vec3;
use crate::mesh::{MeshError, TriMesh};

/// The mesh without the triangles for which `remove` returns `true`: a sheet with holes, for
/// instance. `remove` is given the number of the triangle and its corners (m).
///
/// Triangles and vertices keep their order; vertices that lose all their triangles are dropped
/// and the others are renumbered without gaps. Removing neighbours can leave two parts that
/// touch in one vertex, see [`bow_tie_vertices`](crate::topology::bow_tie_vertices).
///
/// # Errors
/// [`MeshError::Empty`] if no triangle is left.
pub fn without_triangles(
    mesh: &TriMesh,
    remove: impl Fn(usize, [Vec3; 3]) -> bool,
) -> Result<TriMesh, MeshError> {
    let corners = |t| crate::math::gather(mesh.positions(), t);
    let numbered = mesh.triangles().iter().enumerate();
    let mut triangles: Vec<[u32; 3]> = numbered
        .filter(|&(index, &t)| !remove(index, corners(t)))
        .map(|(_, &t)| t)
        .collect();
    let mut used = vec![false; mesh.vertex_count()];
    for &vertex in triangles.as_flattened() {
        used[vertex as usize] = true;
    }
    let mut positions = Vec::new();
    let mut renumbered = vec![0_u32; mesh.vertex_count()];
    for (vertex, position) in mesh.positions().iter().enumerate() {
        if used[vertex] {
            renumbered[vertex] = positions.len() as u32;
            positions.push(*position);
        }
    }
    for vertex in triangles.as_flattened_mut() {
        *vertex = renumbered[*vertex as usize];
    }
    TriMesh::new(positions, triangles)
}

/// Several meshes as one, vertices and triangles of the first one first. They are not sewn
/// together where they touch.
///
/// # Errors
/// [`MeshError::Empty`] if `pieces` is, [`MeshError::TooManyTriangles`] if a vertex or triangle
/// number would not fit.
pub fn join(pieces: &[TriMesh]) -> Result<TriMesh, MeshError> {
    let limit = u32::MAX as usize / 3;
    // Vertices of sheets are in triangles, three in each; those inside of solids are in none.
    let [mut count, mut vertices] = [0; 2];
    for piece in pieces {
        count += piece.triangle_count();
        vertices += piece.vertex_count();
    }
    let count = count.max(vertices / 3);
    if count > limit {
        return Err(MeshError::TooManyTriangles { count, limit });
    }
    let mut positions = Vec::new();
    let mut triangles = Vec::with_capacity(count);
    for piece in pieces {
        let base = positions.len() as u32;
        positions.extend_from_slice(piece.positions());
        triangles.extend(piece.triangles().iter().map(|t| t.map(|v| v + base)));
    }
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    Ok(TriMesh::unchecked(positions, triangles))
}

//! Where a cloth passes through itself, in words.

use crate::bounds::bounds;
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;

/// Where the cloth `mesh` at `x` (m) still passes through itself, in these pairs of triangles.
pub(crate) fn describe(mesh: &TriMesh, x: &[Vec3], pairs: &[[u32; 2]]) -> String {
    let corners = |t: u32| mesh.triangles()[t as usize];
    let places = pairs.iter().flatten().flat_map(|&t| corners(t));
    let [low, high] = bounds(places.map(|v| x[v as usize]));
    let point = |p: Vec3| format!("({:.4}, {:.4}, {:.4})", p.x, p.y, p.z);
    let (count, [a, b]) = (pairs.len(), pairs.first().copied().unwrap_or_default());
    format!(
        "{count} pairs of triangles still pass through each other, all between {} and {} m; \
         the first are triangles {a} and {b} (from 0)",
        point(low),
        point(high)
    )
}

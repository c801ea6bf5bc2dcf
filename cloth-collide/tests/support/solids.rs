//! Closed meshes.

use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;

/// The box with half extents `b` (m), as twelve triangles.
pub(crate) fn box_mesh(b: Vec3) -> TriMesh {
    let corner = |i: u32| {
        let side = |k: u32| if i >> k & 1 == 1 { 1.0 } else { -1.0 };
        b.component_mul(&Vec3::new(side(0), side(1), side(2)))
    };
    // Corner i has x, y, z as its bits 0, 1, 2.
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let triangles = quads.into_iter().flat_map(halves).collect();
    TriMesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

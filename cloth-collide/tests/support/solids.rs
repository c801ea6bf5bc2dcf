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

/// A spike of 1 m along x on a small triangle, one of its three sides cut into slivers that all end in the tip, vertex
/// 0.
pub(crate) fn spike() -> TriMesh {
    let corner = |k: i32| {
        let angle = std::f64::consts::TAU / 3.0 * f64::from(k);
        Vec3::new(0.0, 0.1 * angle.cos(), 0.1 * angle.sin())
    };
    let slivers = 30;
    let along = |i: i32| corner(0).lerp(&corner(1), f64::from(i) / f64::from(slivers));
    let mut positions = vec![Vec3::x(), Vec3::zeros()];
    positions.extend((0..slivers).map(along));
    positions.extend([corner(1), corner(2)]);
    let ring = positions.len() as u32 - 2;
    let sides = (0..ring).map(|i| [2 + i, 2 + (i + 1) % ring]);
    let triangles = sides.flat_map(|[a, b]| [[0, a, b], [1, b, a]]).collect();
    TriMesh::new(positions, triangles).unwrap()
}

//! Closed meshes.

use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;

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

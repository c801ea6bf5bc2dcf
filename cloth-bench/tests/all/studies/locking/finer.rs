//! A drape taken to a finer grid.

use cloth_bench::studies::locking::finer::refined;
use cloth_bench::studies::locking::sheet::square;
use cloth_core::math::{Vec3, gather};
use cloth_core::mesh::TriMesh;

/// Linear functions of the place at rest are kept, every second point is a point of the coarse grid, and the surface is
/// the same one, whose area no other with its points has.
#[test]
fn a_finer_grid_lies_on_the_coarser_one() {
    let cells = 6;
    let coarse = square("alternating", cells).unwrap();
    let fine = square("alternating", 2 * cells).unwrap();
    let linear = |p: &Vec3| Vec3::new(p.x + 0.2 * p.y, p.y - 0.3 * p.x, p.x - p.y + 0.1);
    let placed: Vec<Vec3> = coarse.positions().iter().map(linear).collect();
    let found = refined(&placed, cells).unwrap();
    assert_eq!(found.len(), fine.vertex_count());
    for (x, p) in found.iter().zip(fine.positions()) {
        assert!((x - linear(p)).norm() < 1e-15);
    }
    let bent = |p: &Vec3| p + Vec3::z() * (5.0 * p.x - 3.0 * p.y * p.y).sin();
    let placed: Vec<Vec3> = coarse.positions().iter().map(bent).collect();
    let found = refined(&placed, cells).unwrap();
    for (p, x) in coarse.positions().iter().zip(&placed) {
        let same = fine.positions().iter().position(|q| (q - p).norm() < 1e-12);
        assert!((found[same.unwrap()] - x).norm() < 1e-14);
    }
    let area = |mesh: &TriMesh, x: &[Vec3]| -> f64 {
        let areas = mesh.triangles().iter().map(|corners| {
            let [a, b, c] = gather(x, *corners);
            0.5 * (b - a).cross(&(c - a)).norm()
        });
        areas.sum()
    };
    let [before, after] = [area(&coarse, &placed), area(&fine, &found)];
    assert!((after / before - 1.0).abs() < 1e-13, "{before} {after}");
}

//! Distances within the cloth at rest.

use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, irregular, without_triangles};
use cloth_core::method::multigrid::Geodesics;

fn all(mesh: &TriMesh, source: u32) -> Vec<Real> {
    let targets: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    Geodesics::new(mesh).from(source, &targets)
}

fn straight(mesh: &TriMesh, a: u32, b: u32) -> Real {
    (mesh.positions()[a as usize] - mesh.positions()[b as usize]).norm()
}

#[test]
fn on_a_flat_sheet_the_way_is_straight() {
    for pattern in [Diagonals::OneWay, Diagonals::Alternating] {
        let mesh = grid(9, 7, 1.0, 1.0, pattern).unwrap();
        for source in [0, 4, 31, 62] {
            for (v, distance) in all(&mesh, source).into_iter().enumerate() {
                let error = distance - straight(&mesh, source, v as u32);
                assert!(error.abs() < 1e-14, "{pattern:?} {source} {v}: {error:e}");
            }
        }
    }
    // With obtuse triangles the way can be a little too long, never too short.
    let crossed = grid(9, 7, 1.0, 1.0, Diagonals::Crossed).unwrap();
    for (v, distance) in all(&crossed, 31).into_iter().enumerate() {
        let ratio = distance / straight(&crossed, 31, v as u32).max(1e-9);
        assert!(v == 31 || (1.0 - 1e-14..1.03).contains(&ratio), "{ratio}");
    }
    let mesh = irregular(12, 1.0, 1.0, 8).unwrap();
    for (v, distance) in all(&mesh, 70).into_iter().enumerate() {
        let ratio = distance / straight(&mesh, 70, v as u32).max(1e-9);
        assert!(v == 70 || (1.0 - 1e-14..1.01).contains(&ratio), "{ratio}");
    }
}

#[test]
fn folding_changes_no_distance() {
    let flat = grid(9, 9, 1.0, 1.0, Diagonals::OneWay).unwrap();
    // By a right angle, along the middle line.
    let fold = |p: &Vec3| match p.x > 0.5 {
        true => Vec3::new(0.5, p.y, p.x - 0.5),
        false => *p,
    };
    let folded = flat.positions().iter().map(fold).collect();
    let folded = TriMesh::new(folded, flat.triangles().to_vec()).unwrap();
    for (a, b) in all(&flat, 3).into_iter().zip(all(&folded, 3)) {
        assert!((a - b).abs() < 1e-14, "{a} {b}");
    }
}

#[test]
fn round_a_slit_and_never_across() {
    let mesh = grid(11, 11, 1.0, 1.0, Diagonals::Alternating).unwrap();
    // Without the cells of a column, but for the topmost.
    let cut = |_, corners: [Vec3; 3]| {
        let centre = corners.iter().sum::<Vec3>() / 3.0;
        (0.4..0.5).contains(&centre.x) && centre.y < 0.9
    };
    let slit = without_triangles(&mesh, cut).unwrap();
    let find = |x: Real, y: Real| {
        let near = |p: &Vec3| (p - Vec3::new(x, y, 0.0)).norm() < 1e-9;
        slit.positions().iter().position(near).unwrap() as u32
    };
    let (left, right) = (find(0.4, 0.0), find(0.5, 0.0));
    let distance = Geodesics::new(&slit).from(left, &[right])[0];
    assert!((distance - (0.9 + 0.1 + 0.9)).abs() < 1e-14, "{distance}");
}

//! Cloths in awkward places, for tests.

use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};

/// A square of 1 m with n × n vertices and alternating diagonals, in the plane z = 0.
pub(crate) fn sheet(n: usize) -> TriMesh {
    grid(n, n, 1.0, 1.0, Diagonals::Alternating).unwrap()
}

/// The sheet at the same place, along the axes and tilted; wavy; folded in zigzag into layers 5 mm apart; crumpled
/// so that it goes through itself; and collapsed to a line and to a point.
pub(crate) fn deformed(mesh: &TriMesh) -> Vec<(&'static str, Vec<Vec3>)> {
    let each = |f: &dyn Fn(Vec3) -> Vec3| mesh.positions().iter().map(|&x| f(x)).collect();
    let zigzag = |x: Vec3| {
        let layer = (4.0 * x.x).floor();
        let part = 4.0 * x.x - layer;
        let back_and_forth = if layer % 2.0 == 0.0 { part } else { 1.0 - part };
        Vec3::new(0.25 * back_and_forth, x.y, 0.005 * (layer + part))
    };
    vec![
        ("flat", each(&|x| x)),
        (
            "tilted",
            each(&|x| Vec3::new(0.8 * x.x - 0.36 * x.y, 0.6 * x.x + 0.48 * x.y, 0.8 * x.y)),
        ),
        (
            "wavy",
            each(&|x| Vec3::new(0.7 * x.x, 0.7 * x.y, 0.1 * (12.0 * x.x + 3.0 * x.y).sin())),
        ),
        ("zigzag", each(&zigzag)),
        (
            "crumpled",
            each(&|x| {
                let wave = |a: f64, b: f64| 0.3 * (a * x.x + b * x.y).sin();
                Vec3::new(wave(5.0, 2.0), wave(1.0, 4.0), wave(3.0, -4.0))
            }),
        ),
        ("line", each(&|x| Vec3::new(x.x, 0.0, 0.0))),
        ("point", each(&|_| Vec3::new(0.1, 0.2, 0.3))),
    ]
}

//! Pins that a scene is asked for.

use cloth_bench::scene::pins::{chosen, corners};
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};

#[test]
fn corners_of_a_grid_are_two_ends_of_one_side() {
    let mesh = grid(5, 4, 1.0, 0.75, Diagonals::OneWay).unwrap();
    let held = corners(mesh.positions(), Vec3::z());
    assert_eq!(held.len(), 2);
    let span = mesh.positions()[held[0]] - mesh.positions()[held[1]];
    assert!((span.norm() - 1.0).abs() < 1e-15, "{span}");
}

/// As the keys say: the largest y, where up is y the smallest z, and where up is x the largest z.
#[test]
fn corners_are_at_the_end_that_is_documented() {
    let mesh = grid(5, 4, 1.0, 0.75, Diagonals::OneWay).unwrap();
    for (up, place) in [
        (Vec3::z(), (|x, y| Vec3::new(x, y, 0.0)) as fn(_, _) -> Vec3),
        (Vec3::y(), |x, y| Vec3::new(x, 0.0, -y)),
        (Vec3::x(), |x, y| Vec3::new(0.0, x, y)),
    ] {
        let ends: Vec<_> = mesh.positions().iter().map(|p| place(p.x, p.y)).collect();
        let mut held = corners(&ends, up);
        held.sort_unstable();
        let highest = chosen("highest", mesh.positions(), Vec3::y()).unwrap();
        assert_eq!(held, [highest[0], highest[highest.len() - 1]], "{up}");
    }
}

#[test]
fn a_pin_that_does_not_exist_is_named() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let error = chosen("0,99", mesh.positions(), Vec3::z()).unwrap_err();
    assert!(error.to_string().contains("vertex 99"), "{error}");
    assert!(chosen("0,x", mesh.positions(), Vec3::z()).is_err());
}

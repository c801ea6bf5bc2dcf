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

#[test]
fn a_pin_that_does_not_exist_is_named() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let error = chosen("0,99", mesh.positions(), Vec3::z()).unwrap_err();
    assert!(error.to_string().contains("vertex 99"), "{error}");
    assert!(chosen("0,x", mesh.positions(), Vec3::z()).is_err());
}

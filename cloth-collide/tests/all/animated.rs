//! Surfaces that change their shape in a given way.

use cloth_collide::obstacle::{AnimatedMesh, ObstacleError};
use cloth_core::math::{Real, Vec3};

#[test]
fn goes_straight_from_shape_to_shape_and_stays_at_the_ends() {
    let at = |x: Real| vec![Vec3::x() * x, Vec3::y() * x];
    let mesh = AnimatedMesh::new(vec![at(1.0), at(2.0), at(4.0)], 0.5).unwrap();
    assert_eq!(mesh.vertex_count(), 2);
    for (time, expected) in [
        (-1.0, 1.0),
        (0.0, 1.0),
        (0.25, 1.5),
        (0.5, 2.0),
        (0.875, 3.5),
        (1.0, 4.0),
        (9.0, 4.0),
    ] {
        let mut out = vec![Vec3::zeros(); 2];
        mesh.place(time, &mut out).unwrap();
        assert_eq!(out, at(expected), "at {time} s");
    }
    let one = AnimatedMesh::new(vec![at(3.0)], 1.0).unwrap();
    let mut out = vec![Vec3::zeros(); 2];
    one.place(7.0, &mut out).unwrap();
    assert_eq!(out, at(3.0));
    one.place(Real::INFINITY, &mut out).unwrap();
    assert_eq!(out, at(3.0));
}

#[test]
fn an_animated_surface_has_one_place_per_vertex_at_times_that_are_numbers() {
    let one = AnimatedMesh::new(vec![vec![Vec3::zeros(); 2]], 1.0).unwrap();
    let refused = |time, count| {
        let mut out = vec![Vec3::x(); count];
        let refused = one.place(time, &mut out).unwrap_err();
        assert_eq!(out, vec![Vec3::x(); count]);
        refused.to_string()
    };
    assert!(refused(Real::NAN, 2).contains("time of an animated surface (s) is NaN"));
    assert!(refused(0.0, 3).contains("places of an animated surface is 3"));
}

#[test]
fn what_is_no_animation_is_named() {
    let one = || vec![Vec3::zeros()];
    let made = |shapes, interval| AnimatedMesh::new(shapes, interval).unwrap_err();
    assert!(made(vec![], 1.0).to_string().contains("number of shapes"));
    let (shape, found, expected) = (1, 2, 1);
    let size = ObstacleError::ShapeSize {
        shape,
        found,
        expected,
    };
    assert_eq!(made(vec![one(), vec![Vec3::zeros(); 2]], 1.0), size);
    let nan = vec![Vec3::x() * Real::NAN];
    assert!(matches!(
        made(vec![nan], 1.0),
        ObstacleError::NonFinite { .. }
    ));
    assert!(matches!(
        made(vec![one()], 0.0),
        ObstacleError::OutOfRange(_)
    ));
}

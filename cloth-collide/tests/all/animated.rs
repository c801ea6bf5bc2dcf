//! Surfaces that change their shape in a given way.

use cloth_collide::obstacle::{AnimatedMesh, ObstacleError, Pose};
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

/// A tetrahedron that turns and shifts, one shape every 0.1 s.
fn turning() -> (AnimatedMesh, Vec<[u32; 3]>, impl Fn(Real, Vec3) -> Vec3) {
    let place = |time: Real, x: Vec3| {
        Pose::at(Vec3::new(0.3, -0.2, 1.0) * time)
            .turned(Vec3::new(2.0, 1.0, -3.0) * time)
            .to_world(x)
    };
    let corners = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
    let shapes = (0..4).map(|k| corners.map(|x| place(0.1 * Real::from(k), x)).to_vec());
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let animation = AnimatedMesh::new(shapes.collect(), 0.1).unwrap();
    (animation, triangles, place)
}

/// Above a face, beside an edge and beyond a corner, from any shape on.
#[test]
fn an_attached_point_goes_along_as_if_the_body_were_rigid() {
    let (animation, triangles, place) = turning();
    let points = [
        Vec3::new(0.4, 0.4, 0.4),
        Vec3::new(-0.2, -0.1, 0.5),
        Vec3::new(1.5, -0.1, 0.1),
        Vec3::new(0.2, 0.1, 0.1),
    ];
    for point in points {
        for since in [0.0, 0.2] {
            let start = place(since, point);
            let fixed = animation.attach(&triangles, start, since).unwrap();
            for shape in 0..4 {
                let time = 0.1 * Real::from(shape);
                let error = (fixed.position(time) - place(time, point)).norm();
                assert!(
                    error < 1e-14,
                    "{point:?} from {since} s, {time} s: {error:e} m"
                );
            }
        }
    }
}

/// Stretched to the double, the foot of the point stays at its share of the edges, and its height is the same.
#[test]
fn an_attached_point_keeps_its_height_above_a_triangle_that_is_stretched() {
    let shape = |size: Real| vec![Vec3::zeros(), Vec3::x() * size, Vec3::y() * size];
    let growing = AnimatedMesh::new(vec![shape(1.0), shape(2.0)], 1.0).unwrap();
    let point = Vec3::new(0.25, 0.5, 0.125);
    let fixed = growing.attach(&[[0, 1, 2]], point, 0.0).unwrap();
    assert_eq!(fixed.position(1.0), Vec3::new(0.5, 1.0, 0.125));
}

#[test]
fn what_a_point_cannot_be_attached_to_is_named() {
    let (animation, triangles, _) = turning();
    let refused = |triangles: &[[u32; 3]], point, time| {
        let refused = animation.attach(triangles, point, time);
        refused.unwrap_err().to_string()
    };
    let error = refused(&triangles, Vec3::x() * Real::NAN, 0.0);
    assert!(error.contains("point that goes with a surface"), "{error}");
    let error = refused(&triangles, Vec3::x(), Real::INFINITY);
    assert!(
        error.contains("time of an attachment (s) is inf"),
        "{error}"
    );
    let error = refused(&[[0, 1, 4]], Vec3::x(), 0.0);
    assert!(error.contains("vertex of a triangle is 4"), "{error}");
    for without_area in [&[][..], &[[0, 1, 1], [2, 2, 2]]] {
        let error = refused(without_area, Vec3::x(), 0.0);
        assert!(error.contains("triangles with an area is 0"), "{error}");
    }
}

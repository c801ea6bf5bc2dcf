//! Signed distances are what they say: against each other, against sampling, against the solid angle.

use crate::random::Random;
use crate::solids::spike;
use cloth_collide::obstacle::*;
use cloth_core::math::{Mat3, Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Every exact shape, none larger than 1 m.
fn shapes() -> Vec<(&'static str, Box<dyn SignedDistance>)> {
    let mesh = |m: &TriMesh| Box::new(ClosedMesh::new(m).unwrap());
    vec![
        (
            "half-space",
            Box::new(HalfSpace::new(v(1.0, -2.0, 0.5)).unwrap()),
        ),
        ("sphere", Box::new(Sphere::new(0.7).unwrap())),
        ("box", Box::new(Cuboid::new(v(0.3, 0.5, 0.1)).unwrap())),
        ("capsule", Box::new(Capsule::new(0.4, 0.25).unwrap())),
        ("torus", mesh(&generate::torus(24, 12, 0.5, 0.2).unwrap())),
        (
            "ball of triangles",
            mesh(&generate::sphere(4, 0.6).unwrap()),
        ),
    ]
}

/// If p is d away from the surface along n, then going back by d leads to the surface, and nothing nearer exists
/// because φ changes by no more than the way.
#[test]
fn going_back_along_the_normal_by_the_distance_leads_to_the_surface() {
    for (name, shape) in shapes() {
        let mut random = Random::new(1);
        for _ in 0..2000 {
            let p = random.point(1.5);
            let at = shape.signed_distance(p);
            assert!((at.normal.norm() - 1.0).abs() < 1e-14, "{name}");
            assert_eq!(at.slope, 1.0);
            let foot = shape.signed_distance(p - at.normal * at.value).value;
            assert!(foot.abs() < 2e-15, "{name} {p}: {foot:e}");
        }
    }
}

#[test]
fn distance_changes_by_no_more_than_the_way() {
    for (name, shape) in shapes() {
        let mut random = Random::new(2);
        for i in 0..20_000 {
            let p = random.point(1.5);
            let q = p + random.point(0.1f64.powi(i % 4));
            let change = shape.signed_distance(p).value - shape.signed_distance(q).value;
            assert!(change.abs() <= (p - q).norm() + 1e-15, "{name} {p} {q}");
        }
    }
}

#[test]
fn normal_is_the_gradient_of_the_distance() {
    for (name, shape) in shapes() {
        let mut random = Random::new(3);
        let mut compared = 0;
        for _ in 0..2000 {
            let p = random.point(1.5);
            let along = |d: Vec3| shape.signed_distance(p + d).value;
            let at = shape.signed_distance(p);
            let h = 1e-5;
            // At a crest of φ, where the nearest point jumps, there is no gradient.
            let kink = (along(at.normal * h) + along(-at.normal * h) - 2.0 * at.value).abs() / h;
            let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|e| e * h);
            let bend = axes.map(|e| (along(e) + along(-e) - 2.0 * at.value).abs() / h);
            if kink > 1e-6 || bend.iter().any(|&b| b > 1e-3) {
                continue;
            }
            let differences = Vec3::from(axes.map(|e| (along(e) - along(-e)) / (2.0 * h)));
            let error = (differences - at.gradient()).norm();
            assert!(error < 1e-7, "{name} {p}: {error:e}");
            compared += 1;
        }
        assert!(compared > 1500, "{name}: {compared} compared");
    }
}

#[test]
fn mesh_of_a_box_is_the_box() {
    let b = v(0.3, 0.5, 0.1);
    let (mesh, exact) = (
        ClosedMesh::new(&generate::cuboid(b.into()).unwrap()).unwrap(),
        Cuboid::new(b).unwrap(),
    );
    let mut random = Random::new(4);
    for i in 0..20_000 {
        // Also on the planes of the faces and on the axes, where signs are easily wrong.
        let mut p = random.point(1.0);
        match i % 4 {
            1 => p[i % 3] = b[i % 3] * if i % 8 == 1 { 1.0 } else { -1.0 },
            2 => p = p.map(|x| x.signum()).component_mul(&b) * (1.0 + 0.1f64.powi(i as i32 % 12)),
            _ => {}
        }
        let (found, expected) = (mesh.signed_distance(p), exact.signed_distance(p));
        assert!((found.value - expected.value).abs() < 1e-15, "{p}");
        // Where the nearest point is unique, the normals agree, too.
        if expected.value > 1e-6 {
            assert!((found.normal - expected.normal).norm() < 1e-8, "{p}");
        }
    }
}

/// How much of the sphere of directions the mesh covers, seen from p (van Oosterom and Strackee 1983): 4π inside, 0
/// outside.
fn solid_angle(mesh: &TriMesh, p: Vec3) -> Real {
    let one = |&t: &[u32; 3]| {
        let [a, b, c] = gather(mesh.positions(), t).map(|x| x - p);
        let [l, m, n] = [a, b, c].map(|x| x.norm());
        let dots = l * m * n + a.dot(&b) * n + b.dot(&c) * l + c.dot(&a) * m;
        2.0 * a.dot(&b.cross(&c)).atan2(dots)
    };
    mesh.triangles().iter().map(one).sum()
}

#[test]
fn mesh_distance_has_the_sign_of_the_solid_angle() {
    let long_needles = {
        // A star: every other vertex of a sphere pulled out, so that edges and vertices of all kinds are met.
        let ball = generate::sphere(3, 0.3).unwrap();
        let pulled = (0..).zip(ball.positions());
        let positions = pulled.map(|(i, x)| if i % 5 == 0 { x * 3.0 } else { *x });
        TriMesh::new(positions.collect(), ball.triangles().to_vec()).unwrap()
    };
    let torus = generate::torus(17, 9, 0.5, 0.2).unwrap();
    for (mesh, least_inside) in [(long_needles, 100), (torus, 100), (spike(), 4)] {
        let body = ClosedMesh::new(&mesh).unwrap();
        let mut random = Random::new(5);
        let mut inside = 0;
        for i in 0..4000 {
            // Half of them around a vertex.
            let p = match i % 2 {
                0 => random.point(0.7),
                _ => mesh.positions()[0] + random.point(0.1),
            };
            let nearest = mesh
                .triangles()
                .iter()
                .map(|&t| cloth_collide::point_triangle(p, gather(mesh.positions(), t)).distance())
                .fold(Real::INFINITY, Real::min);
            let found = body.signed_distance(p).value;
            // Nearest points on a common edge are computed from either triangle.
            assert!((found.abs() - nearest).abs() < 1e-15, "{p}");
            let is_inside = solid_angle(&mesh, p) > std::f64::consts::TAU;
            assert_eq!(found < 0.0, is_inside, "{p}: {found}");
            inside += u32::from(is_inside);
        }
        assert!(inside > least_inside, "only {inside} points inside");
    }
}

#[test]
fn meshes_without_an_inside_are_refused_by_name() {
    let ball = generate::sphere(2, 1.0).unwrap();
    let (x, t) = (ball.positions().to_vec(), ball.triangles().to_vec());
    let body = |x: &[Vec3], t: &[[u32; 3]]| {
        ClosedMesh::new(&TriMesh::new(x.to_vec(), t.to_vec()).unwrap()).unwrap_err()
    };
    let holed = generate::without_triangles(&ball, |t, _| t == 3).unwrap();
    assert!(matches!(
        ClosedMesh::new(&holed),
        Err(ObstacleError::NotClosed {
            boundary_edge_count: 3,
            ..
        })
    ));
    let mut turned = t.clone();
    turned[5].swap(0, 1);
    assert!(matches!(
        body(&x, &turned),
        ObstacleError::MixedWinding { .. }
    ));
    let inside_out: Vec<_> = t.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(matches!(body(&x, &inside_out), ObstacleError::InsideOut { volume } if volume < -3.0));
    let shifted = TriMesh::new(x.iter().map(|x| x * 0.9 + v(1.0, 0.0, 0.0)).collect(), t).unwrap();
    let crossing = generate::join(&[ball, shifted]).unwrap();
    assert!(matches!(
        ClosedMesh::new(&crossing),
        Err(ObstacleError::SelfIntersecting { .. })
    ));
}

#[test]
fn samples_are_within_their_bound_everywhere() {
    for (name, shape) in shapes().into_iter().skip(1) {
        let grid = SampledDistance::new(&*shape, 0.07, 0.1).unwrap();
        let bound = grid.error_bound();
        let steep = grid.lipschitz();
        // Coefficients are sums of samples with weights whose sizes add up to 2.5.
        assert!((1.0..=2.5 * 3f64.sqrt()).contains(&steep), "{name} {steep}");
        let mut worst: Real = 0.0;
        let mut random = Random::new(6);
        for _ in 0..5000 {
            let p = random.point(1.5);
            let (found, exact) = (grid.signed_distance(p), shape.signed_distance(p).value);
            assert!(found.value <= exact + bound, "{name} {p}: too far");
            // Outside the grid it is allowed to be less, but not less than the distance from the grid.
            let q = p + random.point(0.05);
            let change = (grid.signed_distance(q).value - found.value).abs();
            assert!(change <= steep * (p - q).norm() + 1e-12, "{name} {p}");
            let inner = shape.bounds().unwrap();
            let within = (0..3).all(|k| p[k] >= inner.lower[k] && p[k] <= inner.upper[k]);
            if within {
                worst = worst.max((found.value - exact).abs());
                assert!(found.value >= exact - bound, "{name} {p}: too near");
            }
            assert!(found.slope <= steep);
        }
        assert!(worst < 0.25 * 0.07, "{name}: {worst} m off");
    }
}

#[test]
fn samples_converge_with_the_third_power_of_the_spacing() {
    let ball = Sphere::new(0.5).unwrap();
    let worst = |spacing: Real| {
        let grid = SampledDistance::new(&ball, spacing, 0.2).unwrap();
        let mut random = Random::new(7);
        (0..4000)
            .map(|_| random.point(1.0))
            .filter(|p| (0.4..0.6).contains(&p.norm()))
            .map(|p| (grid.signed_distance(p).value - ball.signed_distance(p).value).abs())
            .fold(0.0, Real::max)
    };
    let (coarse, fine) = (worst(0.04), worst(0.02));
    assert!((7.0..9.0).contains(&(coarse / fine)), "{coarse} {fine}");
    assert!(coarse < 1e-5, "{coarse} m");
}

#[test]
fn gradient_of_samples_is_that_of_what_is_interpolated() {
    let grid = SampledDistance::new(&Cuboid::new(v(0.3, 0.2, 0.4)).unwrap(), 0.1, 0.15).unwrap();
    let mut random = Random::new(8);
    let mut compared = 0;
    for _ in 0..3000 {
        let p = random.point(0.9);
        let h = 1e-6;
        let along = |d: Vec3| grid.signed_distance(p + d).value;
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|e| e * h);
        let here = along(Vec3::zeros());
        if axes
            .iter()
            .any(|&e| (along(e) + along(-e) - 2.0 * here).abs() > 1e-10)
        {
            continue; // across the border of two cells
        }
        let differences = Vec3::from(axes.map(|e| (along(e) - along(-e)) / (2.0 * h)));
        assert!(
            (differences - grid.signed_distance(p).gradient()).norm() < 1e-8,
            "{p}"
        );
        compared += 1;
    }
    assert!(compared > 2800, "{compared} compared");
}

#[test]
fn numbers_out_of_range_are_refused_by_name() {
    let says = |error: ObstacleError, words: &str| {
        let text = error.to_string();
        assert!(text.contains(words), "{text}");
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        says(Sphere::new(bad).unwrap_err(), "radius of the sphere");
        says(Capsule::new(1.0, bad).unwrap_err(), "radius of the capsule");
        says(
            Cuboid::new(v(1.0, bad, 1.0)).unwrap_err(),
            "half extent of the box",
        );
        says(PenaltyLaw::new(bad, 1.0).unwrap_err(), "stiffness");
        says(PenaltyLaw::new(1.0, bad).unwrap_err(), "range");
        let ball = Sphere::new(1.0).unwrap();
        says(
            SampledDistance::new(&ball, bad, 0.1).unwrap_err(),
            "spacing",
        );
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        says(Capsule::new(bad, 1.0).unwrap_err(), "half length");
        says(
            HalfSpace::new(v(bad.sqrt(), 0.0, 0.0)).unwrap_err(),
            "normal",
        );
    }
    says(
        HalfSpace::new(Vec3::zeros()).unwrap_err(),
        "normal of the half-space is 0",
    );
    let floor = HalfSpace::new(Vec3::z()).unwrap();
    says(
        SampledDistance::new(&floor, 0.1, 0.1).unwrap_err(),
        "without end",
    );
    says(
        SampledDistance::new(&Sphere::new(1.0).unwrap(), 1e-4, 0.1).unwrap_err(),
        "samples",
    );
    let nowhere = RigidMotion::still(Pose::at(v(0.0, f64::NAN, 0.0)));
    says(Obstacle::moving(floor, nowhere).unwrap_err(), "position");
}

/// To the last digit: contact that is told of another start looks for crossings anew, and for all pairs.
#[test]
fn a_turning_obstacle_begins_a_step_where_the_last_one_has_ended() {
    let (shape, turn) = (Sphere::new(1.0).unwrap(), Vec3::new(0.3, -0.7, 2.0));
    let motion = RigidMotion {
        angular_velocity: turn,
        ..RigidMotion::default()
    };
    let mut obstacle = Obstacle::moving(shape, motion).unwrap();
    for _ in 0..1000 {
        let end = obstacle.motion().pose_at(0.01);
        obstacle.advance(0.01).unwrap();
        assert_eq!(obstacle.motion().pose_at(0.0), end);
    }
}

#[test]
fn an_obstacle_moves_as_a_rigid_body() {
    let shape = Cuboid::new(v(0.3, 0.5, 0.1)).unwrap();
    let motion = RigidMotion {
        pose: Pose::at(v(1.0, -2.0, 0.5)).turned(v(0.3, -0.7, 1.1)),
        velocity: v(0.4, 1.5, -0.2),
        angular_velocity: v(-2.0, 0.5, 1.0),
    };
    let obstacle = Obstacle::moving(shape, motion).unwrap();
    let mut random = Random::new(9);
    for _ in 0..200 {
        let (body, time) = (random.point(1.0), random.real(3.0));
        let world = |t: Real| motion.pose_at(t).to_world(body);
        let (moved, still) = (
            obstacle.signed_distance(world(time), time),
            shape.signed_distance(body),
        );
        assert!((moved.value - still.value).abs() < 1e-14);
        let turned = motion.pose_at(time).orientation * still.normal;
        assert!((moved.normal - turned).norm() < 1e-12);
        // The velocity of a point of the body is the derivative of its place.
        let h = 1e-5;
        let slope = (world(time + h) - world(time - h)) / (2.0 * h);
        assert!((slope - obstacle.motion().velocity_at(world(time), time)).norm() < 1e-8);
        // To let time pass is to ask later.
        let mut later = obstacle.clone();
        later.advance(time).unwrap();
        let p = random.point(2.0);
        let (one, other) = (
            later.signed_distance(p, 0.0),
            obstacle.signed_distance(p, time),
        );
        assert!((one.value - other.value).abs() < 1e-14);
    }
    let mut still = obstacle;
    assert!(still.advance(f64::NAN).is_err());
    assert_eq!(still.motion(), &motion);
}

/// Nothing that is no number, or of no size, is a rigid body.
#[test]
fn rigid_bodies_of_no_size_or_of_no_number_are_refused() {
    let g = Vec3::zeros();
    let mut inertia = Mat3::identity() * 0.01;
    inertia[(0, 1)] = Real::NAN;
    let all = [
        RigidBody::new(1.0, inertia, g),
        RigidBody::new(1.0, Mat3::identity() * Real::NAN, g),
        RigidBody::sphere(-1.0, -1.0, g),
        RigidBody::cuboid(1.0, Vec3::new(-1.0, -1.0, 1.0), g),
        RigidBody::capsule(-1.0, 0.5, -1.0, g),
        RigidBody::capsule(1.0, -0.5, 1.0, g),
    ];
    let words = ["moment", "moment", "radius", "edge", "radius", "length"];
    for (built, word) in all.into_iter().zip(words) {
        let said = built.unwrap_err().to_string();
        assert!(said.contains(word), "{word}: {said}");
    }
}

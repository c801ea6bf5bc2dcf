//! The swept vertex meets what it has to meet, never late.

use crate::random::Random;
use cloth_collide::obstacle::*;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

fn straight(from: Vec3, velocity: Vec3) -> VertexPath {
    VertexPath { from, velocity }
}

#[test]
fn a_thin_box_is_not_tunnelled_through_at_100_metres_per_second() {
    let dt = 1.0 / 60.0;
    let half = v(1.0, 1.0, 0.0005);
    let boxes: [(&str, Obstacle); 2] = [
        ("box", Obstacle::new(Cuboid::new(half).unwrap())),
        (
            "mesh",
            Obstacle::new(ClosedMesh::new(&generate::cuboid(half.into()).unwrap()).unwrap()),
        ),
    ];
    for (name, thin) in boxes {
        let mut random = Random::new(1);
        for _ in 0..1000 {
            let (from, speed) = (v(0.0, 0.0, 0.8) + random.point(0.05), v(1.0, -2.0, -100.0));
            let path = straight(from, speed);
            let end = thin.signed_distance(path.position(dt), dt).value;
            assert!(end > 0.7, "the end says nothing: {end}");
            let hit = first_contact(&thin, &path, 0.0, dt, 0.001).expect(name);
            let exact = (from.z - 0.0015) / 100.0;
            assert!((hit.time - exact).abs() < 1e-15, "{name} {hit:?} {exact}");
            assert!(hit.certain && (hit.distance.normal - Vec3::z()).norm() < 1e-12);
        }
    }
}

#[test]
fn times_of_impact_are_those_of_the_closed_forms_in_a_few_evaluations() {
    let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let ball = Obstacle::new(Sphere::new(0.5).unwrap());
    let mut random = Random::new(2);
    for _ in 0..2000 {
        let height = 0.1 + random.real(1.0).abs();
        let speed = 0.2 + random.real(50.0).abs();
        let path = straight(v(random.real(1.0), 0.0, height), v(3.0, 1.0, -speed));
        let hit = first_contact(&floor, &path, 0.0, 100.0, 0.01).unwrap();
        let exact = (height - 0.01) / speed;
        assert!(
            (hit.time - exact).abs() < 1e-14 * (1.0 + exact),
            "{hit:?} {exact}"
        );
        assert!(hit.evaluations <= 3, "{hit:?}");

        // Past the ball at the distance b of the straight path from its centre: hit if b < r + h.
        let b = random.real(0.51).abs() * (1.0 - 1e-6);
        let path = straight(v(-2.0, b, 0.0), v(speed, 0.0, 0.0));
        let hit = first_contact(&ball, &path, 0.0, 100.0, 0.01).unwrap();
        let exact = (2.0 - (0.51f64.powi(2) - b * b).sqrt()) / speed;
        assert!((hit.time - exact).abs() < 1e-11 * exact && hit.time <= exact * (1.0 + 1e-15));
        assert!(hit.evaluations < 30, "{hit:?}");
        let beside = straight(v(-2.0, 0.51 + 1e-9, 0.0), v(speed, 0.0, 0.0));
        assert_eq!(first_contact(&ball, &beside, 0.0, 100.0, 0.01), None);
    }
}

/// All shapes, all kinds of motion, against dense sampling of the path.
#[test]
fn contact_is_never_late_and_never_missed() {
    let ball = Sphere::new(0.3).unwrap();
    let shapes: Vec<(&str, Obstacle)> = vec![
        (
            "half-space",
            Obstacle::new(HalfSpace::new(v(1.0, 1.0, -1.0)).unwrap()),
        ),
        ("sphere", Obstacle::new(ball)),
        (
            "box",
            Obstacle::new(Cuboid::new(v(0.3, 0.02, 0.2)).unwrap()),
        ),
        ("capsule", Obstacle::new(Capsule::new(0.4, 0.1).unwrap())),
        (
            "torus",
            Obstacle::new(ClosedMesh::new(&generate::torus(12, 8, 0.4, 0.15).unwrap()).unwrap()),
        ),
        (
            "samples",
            Obstacle::new(SampledDistance::new(&ball, 0.05, 0.1).unwrap()),
        ),
    ];
    let thickness = 0.01;
    for (name, mut obstacle) in shapes {
        let mut random = Random::new(3);
        let (mut hits, mut uncertain) = (0, 0);
        for i in 0..1500 {
            let motion = RigidMotion {
                pose: Pose::at(random.point(0.3)).turned(random.point(3.0)),
                velocity: random.point(1.0),
                angular_velocity: random.point(if i % 3 == 0 { 0.0 } else { 6.0 }),
            };
            obstacle.set_motion(motion).unwrap();
            let from = random.point(1.5);
            let speed = 2.0 + random.real(1.0);
            let path = straight(from, (random.point(0.3) - from) * speed);
            let start = random.real(0.5);
            let gap =
                |t: Real| obstacle.signed_distance(path.position(t), start + t).value - thickness;
            if gap(0.0) <= 0.0 {
                continue;
            }
            let hit = first_contact(&obstacle, &path, start, 1.0, thickness);
            let free_until = hit.map_or(1.0, |hit| hit.time);
            for k in 0..400 {
                let t = free_until * f64::from(k) / 400.0;
                assert!(
                    gap(t) > 0.0,
                    "{name} {i}: inside at {t}, but contact at {hit:?}"
                );
            }
            if let Some(hit) = hit {
                hits += 1;
                assert!(hit.time > 0.0 && hit.evaluations <= 512);
                uncertain += u32::from(!hit.certain);
                // One that spends its evaluations grazes the surface.
                let near = if hit.certain { 1e-13 } else { 1e-4 };
                assert!(gap(hit.time) < near, "{name} {i} {hit:?}");
            }
        }
        assert!(hits > 100, "{name}: {hits} contacts");
        assert!(
            uncertain * 25 < hits,
            "{name}: {uncertain} of {hits} uncertain"
        );
    }
}

#[test]
fn a_start_in_contact_is_a_contact_at_zero_unless_it_leaves() {
    let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let at = |z: Real, speed: Real| {
        first_contact(
            &floor,
            &straight(v(0.0, 0.0, z), v(1.0, 0.0, speed)),
            0.0,
            1.0,
            0.01,
        )
    };
    assert_eq!(at(0.01, -1.0).unwrap().time, 0.0);
    assert_eq!(at(0.01, 0.0).unwrap().time, 0.0);
    assert_eq!(at(0.005, -1.0).unwrap().time, 0.0);
    assert_eq!(at(0.01, 1.0), None);
    assert_eq!(at(0.02, 0.0), None);
    // Touching at the very end counts.
    let end = at(1.01, -1.0).unwrap().time;
    assert!(end <= 1.0 && end > 1.0 - 1e-14);
    assert_eq!(at(1.02, -1.0), None);
}

#[test]
fn arguments_that_are_not_finite_end_the_search_at_once() {
    let ball = Obstacle::new(Sphere::new(1.0).unwrap());
    for bad in [f64::NAN, f64::INFINITY] {
        let hit = first_contact(&ball, &straight(v(bad, 0.0, 3.0), Vec3::x()), 0.0, 1.0, 0.0);
        let hit = hit.unwrap();
        assert!(hit.time == 0.0 && !hit.certain && hit.evaluations == 1);
        let path = straight(Vec3::z() * 3.0, Vec3::x());
        for (start, duration, thickness) in [(bad, 1.0, 0.0), (0.0, bad, 0.0), (0.0, 1.0, bad)] {
            let hit = first_contact(&ball, &path, start, duration, thickness).unwrap();
            assert!(hit.time == 0.0 && !hit.certain, "{hit:?}");
        }
    }
}

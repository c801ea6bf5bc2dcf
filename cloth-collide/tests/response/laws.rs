//! Exact answers: impulses, momentum, friction.

use super::flight::{Flight, together};
use cloth_collide::ClothContacts;
use cloth_collide::obstacle::{HalfSpace, ImpactLaw, Obstacle, ObstacleContacts, RigidMotion};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};

const DT: f64 = 1.0 / 60.0;

/// A sheet that lies on `ground` at the thickness of 1 mm, with contact by `law`.
fn sheet_on(ground: Obstacle, law: ImpactLaw, lie: impl Fn(&Vec3) -> Vec3) -> Flight {
    let mesh = super::flight::moved(&grid(4, 3, 0.3, 0.2, Diagonals::Alternating).unwrap(), lie);
    let obstacles = ObstacleContacts::new(1e-3, 1e-3).unwrap().with(ground, law);
    let contacts = ClothContacts::builder(&mesh)
        .obstacles(obstacles)
        .build()
        .unwrap();
    Flight::new(&mesh, contacts)
}

fn triangle(z: f64, size: f64) -> TriMesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (0.25, 1.0)];
    let positions = corners.map(|(x, y)| Vec3::new(size * x, size * y, z));
    TriMesh::new(positions.to_vec(), vec![[0, 1, 2]]).unwrap()
}

/// A vertex p against the inside of a triangle: the impulse is −vₙ / (w_p + Σ bᵢ² wᵢ).
#[test]
fn one_contact_has_the_impulse_of_two_bodies() {
    let (h, dt) = (1e-3, 0.01);
    // The second triangle stands on its tip above the first.
    let mut tip = vec![Vec3::new(0.1, -0.3, h)];
    tip.extend([Vec3::new(-0.5, -0.3, 2.0), Vec3::new(0.5, 0.3, 2.0)]);
    let mesh = together(&[
        triangle(0.0, 1.0),
        TriMesh::new(tip, vec![[0, 1, 2]]).unwrap(),
    ]);
    let contacts = ClothContacts::builder(&mesh).thickness(h).build().unwrap();
    let mut flight = Flight::new(&mesh, contacts);
    flight.inverse_mass = vec![1.0, 0.5, 2.0, 0.25, 1.0, 1.0];
    let v = Vec3::new(0.3, -0.1, -2.0);
    flight.velocities[3] = v;
    flight.step(dt).unwrap();
    let corners = [0, 1, 2].map(|k: usize| mesh.positions()[k]);
    let at = cloth_collide::point_triangle(mesh.positions()[3], corners);
    let b = at.weights;
    let w = &flight.inverse_mass;
    let effective = w[3] + (0..3).map(|k| b[k] * b[k] * w[k]).sum::<f64>();
    let impulse = 2.0 / effective;
    let report = flight.contacts.report();
    assert_eq!(report.contacts, 1, "{report:?}");
    let expected = v + Vec3::z() * (impulse * w[3]);
    assert!((flight.velocities[3] - expected).norm() < 1e-14);
    for k in 0..3 {
        let expected = Vec3::z() * (-impulse * b[k] * w[k]);
        assert!((flight.velocities[k] - expected).norm() < 1e-14);
    }
    assert_eq!(flight.crossings(), 0);
}

/// It slides exactly if tan α > μ, and then by ½ g (sin α − μ cos α) t², where symplectic Euler has t² + t Δt.
#[test]
fn sheet_on_a_slope_slides_by_the_law_of_coulomb() {
    let friction = 0.4;
    for degrees in [5.0f64, 15.0, 21.0, 21.7, 22.0, 30.0, 60.0] {
        let angle = degrees.to_radians();
        let slope = HalfSpace::inclined(angle).unwrap();
        let downhill = Vec3::new(angle.cos(), 0.0, -angle.sin());
        let lie = |x: &Vec3| downhill * x.x + Vec3::y() * x.y + slope.normal() * 1e-3;
        let law = ImpactLaw::new(friction, 0.0).unwrap();
        let mut flight = sheet_on(Obstacle::new(slope), law, lie);
        flight.gravity = Vec3::z() * -9.81;
        let start = flight.positions.clone();
        for step in 1..=60 {
            flight.step(DT).unwrap();
            let t = f64::from(step) * DT;
            let rate = 9.81 * (angle.sin() - friction * angle.cos());
            let way = 0.5 * rate.max(0.0) * (t * t + t * DT);
            for (x, from) in flight.positions.iter().zip(&start) {
                let error = (x - from - downhill * way).norm();
                assert!(error < 1e-12, "{degrees}°, step {step}: {error:e}");
            }
        }
    }
}

/// A belt takes along what lies on it, with at most μ g.
#[test]
fn sheet_on_a_belt_is_taken_along() {
    let belt = RigidMotion {
        velocity: Vec3::x() * 0.5,
        ..RigidMotion::default()
    };
    let belt = Obstacle::moving(HalfSpace::new(Vec3::z()).unwrap(), belt).unwrap();
    let law = ImpactLaw::new(0.2, 0.0).unwrap();
    let mut flight = sheet_on(belt, law, |x| x + Vec3::z() * 1e-3);
    flight.gravity = Vec3::z() * -9.81;
    for step in 1..=60 {
        flight.step(DT).unwrap();
        let speed = (0.2 * 9.81 * f64::from(step) * DT).min(0.5);
        for v in &flight.velocities {
            assert!((v - Vec3::x() * speed).norm() < 1e-12, "step {step}: {v}");
        }
    }
    let belt = flight
        .contacts
        .obstacles()
        .unwrap()
        .obstacles()
        .next()
        .unwrap();
    assert!((belt.motion().pose.position - Vec3::x() * 0.5).norm() < 1e-12);
}

/// The rebound is e times the speed of impact; so the height is e² times the height.
#[test]
fn sheet_bounces_by_the_restitution() {
    for restitution in [0.0, 0.5, 1.0] {
        let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
        let law = ImpactLaw::new(0.0, restitution).unwrap();
        let mut flight = sheet_on(floor, law, |x| x + Vec3::z() * 0.02);
        flight.velocities.fill(Vec3::new(0.3, 0.0, -2.0));
        flight.step(DT).unwrap();
        let weight = flight.positions.len() as f64;
        for v in &flight.velocities {
            assert!((v - Vec3::new(0.3, 0.0, 2.0 * restitution)).norm() < 1e-14);
        }
        let impulse = flight.contacts.report().obstacle_impulse;
        let expected = Vec3::z() * (2.0 * (1.0 + restitution) * weight);
        assert!((impulse - expected).norm() < 1e-12);
    }
}

/// Friction between two sheets: the upper one, at 0.2 m/s, is slowed by μ N and the lower one gets what it loses.
#[test]
fn sheet_that_slides_on_a_sheet_gives_it_its_momentum() {
    let lower = grid(7, 7, 0.6, 0.6, Diagonals::Alternating).unwrap();
    let upper = grid(4, 4, 0.2, 0.2, Diagonals::Alternating).unwrap();
    let upper = super::flight::moved(&upper, |x| x + Vec3::new(0.13, 0.21, 1e-3));
    let mesh = together(&[lower, upper]);
    let build = |friction| {
        ClothContacts::builder(&mesh)
            .friction(friction)
            .build()
            .unwrap()
    };
    for friction in [0.0, 0.3] {
        let mut flight = Flight::new(&mesh, build(friction));
        // Pressed together once, at 0.1 m/s.
        for v in &mut flight.velocities[49..] {
            *v = Vec3::new(0.2, 0.0, -0.1);
        }
        let before = flight.momentum();
        flight.step(DT).unwrap();
        let after: Vec3 = flight.velocities[49..].iter().sum();
        let below: Vec3 = flight.velocities[..49].iter().sum();
        assert!((flight.momentum() - before).norm() < 1e-13);
        let (lost, pressed) = (before.x - after.x, -below.z);
        assert!(pressed > 0.1, "{pressed}");
        // Every contact slips, so together they are on the cone.
        assert!(
            (lost - friction * pressed).abs() < 1e-2 * pressed,
            "{lost} of {pressed}"
        );
        assert!((after.x + below.x - before.x).abs() < 1e-13);
    }
}

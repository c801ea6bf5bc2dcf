//! Input that nobody should give: refused by name, or answered with numbers.

use super::flight::{Flight, moved, together};
use super::random::Random;
use cloth_collide::obstacle::{HalfSpace, Obstacle, RigidBody};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactStep, Projection};
use cloth_core::error::OutOfRange;
use cloth_core::math::{Vec3, is_finite};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::step::BuildError;

fn sheet() -> TriMesh {
    grid(4, 4, 0.3, 0.3, Diagonals::Alternating).unwrap()
}

/// Two sheets, `gap` (m) apart.
fn layers(gap: f64) -> TriMesh {
    let upper = moved(&sheet(), |x| x + Vec3::new(0.013, 0.017, gap));
    together(&[sheet(), upper])
}

fn floor() -> Obstacle {
    Obstacle::new(HalfSpace::new(Vec3::z()).unwrap())
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let mesh = sheet();
    let build = |thickness, friction| {
        let builder = PotentialContacts::builder(&mesh).thickness(thickness);
        builder.friction(friction).build().map(drop)
    };
    assert_eq!(build(1e-3, 0.0), Ok(()));
    let named = |result: Result<(), BuildError>, wanted: &str| match result {
        Err(BuildError::OutOfRange(OutOfRange { name, .. })) => assert_eq!(name, wanted),
        other => panic!("{other:?}"),
    };
    for bad in [0.0, -0.0, -1e-3, f64::NAN, f64::INFINITY] {
        named(build(bad, 0.3), "thickness of contact (m)");
    }
    for bad in [-0.1, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        named(build(1e-3, bad), "friction of contact");
        let builder = PotentialContacts::builder(&mesh).obstacle(floor(), bad);
        named(builder.build().map(drop), "friction of a body");
    }
    let ball = RigidBody::sphere(100.0, 0.1, Vec3::zeros()).unwrap();
    for twice in [0, 1] {
        let builder = PotentialContacts::builder(&mesh).obstacle(floor(), 0.0);
        let builder = builder.free(0, ball).free(twice, ball);
        named(builder.build().map(drop), "number of a free obstacle");
    }
}

#[test]
fn numbers_that_are_none_are_refused_and_change_nothing() {
    let mesh = layers(0.01);
    let from = mesh.positions();
    let mut contacts = PotentialContacts::builder(&mesh)
        .obstacle(floor(), 0.3)
        .build()
        .unwrap();
    let inverse_mass = vec![1.0; from.len()];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for list in 0..2 {
            let mut lists = [from.to_vec(), from.to_vec()];
            lists[list][7].y = bad;
            let [from, mut positions] = lists;
            let mut velocities = vec![Vec3::zeros(); 32];
            let step = ContactStep {
                from: &from,
                inverse_mass: &inverse_mass,
                dt: 0.01,
            };
            let kept = format!("{positions:?}{velocities:?}");
            let (x, v) = (&mut positions, &mut velocities);
            let end = Projection::default().step(&mut contacts, &step, 4, x, v);
            assert_eq!(end, Err(ContactError::NonFinite { vertex: 7 }));
            assert_eq!(kept, format!("{positions:?}{velocities:?}"));
        }
    }
}

/// Triangles that have lost their area: a segment and a point, thrown onto a sheet, do not get through.
#[test]
fn triangles_without_area_are_kept_apart_too() {
    let corners = [(0.1, 0.1), (0.2, 0.1), (0.1, 0.2)];
    let triangle = |z: f64| {
        let positions = corners.map(|(x, y)| Vec3::new(x, y, z)).to_vec();
        TriMesh::new(positions, vec![[0, 1, 2]]).unwrap()
    };
    let mesh = together(&[sheet(), triangle(0.05), triangle(0.1)]);
    let contacts = PotentialContacts::builder(&mesh)
        .friction(0.3)
        .build()
        .unwrap();
    let mut flight = Flight::new(&mesh, contacts);
    for (v, x) in flight.positions[16..].iter_mut().enumerate() {
        // In one line, then in one place.
        x.y = 0.13;
        x.x = if v < 3 { 0.1 + 0.03 * v as f64 } else { 0.13 };
    }
    for v in &mut flight.velocities[16..] {
        *v = Vec3::z() * -20.0;
    }
    for step in 0..20 {
        flight.step(0.01).unwrap();
        assert!(flight.positions.iter().all(is_finite), "step {step}");
        assert_eq!(flight.crossings(), 0, "step {step}");
    }
}

/// Folded flat onto each other they touch, and that is said.
#[test]
fn sheet_pressed_into_a_line_is_tangled() {
    let mesh = sheet();
    let contacts = PotentialContacts::builder(&mesh).build().unwrap();
    let mut flight = Flight::new(&mesh, contacts);
    flight.positions.iter_mut().for_each(|x| x.y = 0.117);
    let pairs = flight.crossings();
    assert!(pairs > 0);
    let found = flight.step(0.01);
    assert!(
        matches!(found, Err(ContactError::IntersectingStart { pairs: n, body: None, .. }) if n == pairs),
        "{found:?}"
    );
}

/// Thicker than its edges are long: no part of a piece is pushed away from its rest, and two pieces keep the thickness.
#[test]
fn cloth_thicker_than_its_edges_stays_at_rest_and_apart_from_others() {
    // Edges of 0.1 m.
    let thickness = 0.35;
    let mesh = sheet();
    let contacts = PotentialContacts::builder(&mesh).thickness(thickness);
    let mut alone = Flight::new(&mesh, contacts.friction(0.3).build().unwrap());
    alone.gravity = Vec3::new(0.3, 0.0, -9.81);
    let start = alone.positions.clone();
    for step in 1..=30 {
        alone.step(0.01).unwrap();
        let fallen = alone.gravity * (0.5e-4 * f64::from(step * (step + 1)));
        for (x, from) in alone.positions.iter().zip(&start) {
            assert!((x - from - fallen).norm() < 1e-12, "step {step}");
        }
    }

    let mesh = layers(0.4);
    let contacts = PotentialContacts::builder(&mesh)
        .thickness(thickness)
        .build();
    let mut flight = Flight::new(&mesh, contacts.unwrap());
    for v in &mut flight.velocities[16..] {
        *v = Vec3::z() * -5.0;
    }
    for _ in 0..30 {
        flight.step(0.01).unwrap();
        assert_eq!(flight.crossings(), 0);
        let [low, high] =
            [0..16, 16..32].map(|v| flight.positions[v].iter().map(|x| x.z).sum::<f64>() / 16.0);
        assert!(high - low > 0.9 * thickness, "{}", high - low);
    }
}

/// Sizes of space, speed and time from 1e-300 to 1e300: every step is resolved or refused, and what is resolved is
/// finite and free.
#[test]
fn extreme_sizes_are_resolved_or_refused() {
    let mut random = Random::new(11);
    let mut resolved = [0, 0];
    for round in 0..60 {
        let power = |random: &mut Random, most: f64| 10f64.powf(random.point(most).x);
        let most = [3.0, 20.0, 150.0, 300.0][round % 4];
        let (size, offset) = (power(&mut random, most), power(&mut random, most));
        let (speed, dt) = (power(&mut random, most), power(&mut random, most));
        let thickness = size * power(&mut random, 3.0);
        let shift = Vec3::new(offset, -offset, 0.5 * offset);
        let mesh = layers(0.05);
        let noisy = mesh
            .positions()
            .iter()
            .map(|x| (x + random.point(0.01)) * size + shift);
        let Ok(mesh) = TriMesh::new(noisy.collect(), mesh.triangles().to_vec()) else {
            continue;
        };
        let contacts = PotentialContacts::builder(&mesh).thickness(thickness);
        let contacts = contacts
            .friction(0.3)
            .obstacle(floor(), 0.3)
            .build()
            .unwrap();
        let mut flight = Flight::new(&mesh, contacts);
        for v in &mut flight.velocities {
            *v = random.point(speed);
        }
        for w in &mut flight.inverse_mass {
            *w = power(&mut random, most.min(100.0));
        }
        let before = flight.positions.clone();
        match flight.step(dt) {
            Ok(()) => {
                let both = flight.positions.iter().chain(&flight.velocities);
                assert!(both.clone().all(is_finite), "round {round}");
                // At coordinates of 1e100 m volumes overflow, and no test is exact any more.
                if flight.positions.iter().all(|x| x.amax() < 1e90) {
                    assert_eq!(flight.crossings(), 0, "round {round}");
                }
                resolved[0] += 1;
            }
            Err(_) => {
                assert_eq!(flight.positions, before);
                resolved[1] += 1;
            }
        }
    }
    assert!(resolved[0] > 15, "{resolved:?}");
}

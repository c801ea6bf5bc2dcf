//! Nothing ever passes through anything.

use super::flight::{Flight, moved, together};
use super::random::Random;
use cloth_collide::obstacle::{HalfSpace, Obstacle, Pose, RigidMotion};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactPotential, ContactSource, ContactStep};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};

/// A few small sheets in a box, each turned somehow.
fn soup(random: &mut Random, count: usize) -> TriMesh {
    let sheet = grid(4, 4, 0.3, 0.3, Diagonals::Alternating).unwrap();
    let place = |k: usize, random: &mut Random| {
        let turn = nalgebra::Rotation3::new(random.point(3.0));
        let shift = Vec3::z() * (0.6 * k as f64) + random.point(0.05);
        moved(&sheet, |x| turn * (x - Vec3::new(0.15, 0.15, 0.0)) + shift)
    };
    let sheets: Vec<_> = (0..count).map(|k| place(k, random)).collect();
    together(&sheets)
}

/// Nothing crosses at the end of a step that began at `from`, nor on the path there.
fn assert_no_crossing_since(from: &[Vec3], flight: &mut Flight, seed: u64, step: u32) {
    let end = flight.positions.clone();
    for tenths in [1, 3, 5, 7, 9, 10] {
        let fraction = f64::from(tenths) / 10.0;
        let between = from.iter().zip(&end).map(|(a, b)| a.lerp(b, fraction));
        flight.positions = between.collect();
        assert_eq!(
            flight.crossings(),
            0,
            "seed {seed}, step {step}, {fraction}: {:?}",
            flight.contacts.constraint_report()
        );
    }
    flight.positions = end;
}

/// Steps of a soup whose vertices are kicked at random, by `kick` (m/s), and drawn together; nothing crosses at their
/// ends nor on the paths. Returns in how many steps there were constraints, impact zones and truncated paths.
fn stir(seeds: std::ops::Range<u64>, steps: u32, kick: f64) -> [u32; 3] {
    let mut counts = [0; 3];
    for seed in seeds {
        let mut random = Random::new(seed);
        let mesh = soup(&mut random, 4);
        let builder = PotentialContacts::builder(&mesh).thickness(5e-3);
        let mut flight = Flight::new(&mesh, builder.friction(0.3).build().unwrap());
        assert_eq!(flight.crossings(), 0);
        for step in 0..steps {
            let centre = flight.positions.iter().sum::<Vec3>() / flight.positions.len() as f64;
            for (v, x) in flight.velocities.iter_mut().zip(&flight.positions) {
                *v = *v * 0.9 + random.point(kick) + (centre - x) * (2.0 * kick).min(1.0 / 0.03);
            }
            let (before, from) = (flight.momentum(), flight.positions.clone());
            flight.step(0.03).unwrap();
            let report = flight.contacts.constraint_report();
            counts[0] += u32::from(report.constraints > 0);
            counts[1] += u32::from(report.zones > 0);
            counts[2] += u32::from(report.shortened > 0);
            if report.shortened == 0 {
                let change = (flight.momentum() - before).norm();
                let all: f64 = flight.velocities.iter().map(|v| v.norm()).sum();
                assert!(change < 1e-13 * all, "{change:e} of {all:e}");
            }
            assert_no_crossing_since(&from, &mut flight, seed, step);
        }
    }
    counts
}

#[test]
fn random_motions_of_random_pieces_never_cross() {
    let [constraints, ..] = stir(0..8, 40, 1.0);
    assert!(constraints > 200, "{constraints}");
}

/// So wild that impulses alone are not enough.
#[test]
fn wild_motions_of_random_pieces_never_cross() {
    for kick in [100.0, 3e3] {
        let [_, zones, shortened] = stir(100..103, 10, kick);
        assert!(zones + shortened > 0, "{kick} m/s");
    }
}

#[test]
fn sheets_shot_through_each_other_stay_on_their_sides() {
    for n in [4, 9, 12] {
        let sheet = grid(n, n, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let other = moved(&sheet, |x| Vec3::new(x.x + 0.31, x.y - 0.17, x.z + 0.8));
        let mesh = together(&[sheet, other]);
        let contacts = PotentialContacts::builder(&mesh).build().unwrap();
        let mut flight = Flight::new(&mesh, contacts);
        let count = mesh.vertex_count();
        for v in &mut flight.velocities[count / 2..] {
            *v = Vec3::new(3.0, 1.0, -100.0);
        }
        for step in 0..10 {
            flight.step(1.0 / 60.0).unwrap();
            assert_eq!(flight.crossings(), 0, "{n}, step {step}");
        }
    }
}

/// Both ends of a towel are turned, against each other.
#[test]
fn towel_twisted_by_four_turns_never_crosses_itself() {
    let (n, m) = (9, 25);
    let sheet = grid(n, m, 0.4, 1.2, Diagonals::Alternating).unwrap();
    let mesh = moved(&sheet, |x| x - Vec3::new(0.2, 0.6, 0.0));
    let contacts = PotentialContacts::builder(&mesh)
        .thickness(5e-3)
        .friction(0.2)
        .build()
        .unwrap();
    let mut flight = Flight::new(&mesh, contacts).with_edges(&mesh);
    let steps = 300;
    let dt = 1.0 / 60.0;
    let ends: Vec<_> = (0..mesh.vertex_count())
        .filter(|&v| mesh.positions()[v].y.abs() > 0.599)
        .collect();
    for &v in &ends {
        flight.inverse_mass[v] = 0.0;
    }
    for step in 1..=steps {
        let angle = step as f64 / steps as f64 * 4.0 * std::f64::consts::PI;
        for &v in &ends {
            let rest = mesh.positions()[v];
            let angle = angle * rest.y.signum();
            let at = Vec3::new(
                rest.x * angle.cos(),
                rest.y * (1.0 - 0.4 * step as f64 / steps as f64),
                rest.x * angle.sin(),
            );
            flight.velocities[v] = (at - flight.positions[v]) / dt;
        }
        flight.step(dt).unwrap();
        assert_eq!(
            flight.crossings(),
            0,
            "step {step} {:?}",
            flight.contacts.constraint_report()
        );
    }
}

/// A crumpled sheet between two walls that come together, and meet after a second.
fn squeezed(pinched_passes: bool) -> Flight {
    let sheet = grid(13, 13, 0.4, 0.4, Diagonals::Alternating).unwrap();
    let mesh = moved(&sheet, |x| {
        let fold = 0.02 * (40.0 * x.x).sin() + 0.01 * (31.0 * x.y).cos();
        Vec3::new(x.x, fold, x.y) - Vec3::new(0.2, 0.0, 0.2)
    });
    let wall = |side: f64| {
        let motion = RigidMotion {
            pose: Pose::at(Vec3::x() * (-0.25 * side)),
            velocity: Vec3::x() * (0.25 * side),
            ..RigidMotion::default()
        };
        Obstacle::moving(HalfSpace::new(Vec3::x() * side).unwrap(), motion).unwrap()
    };
    let contacts = PotentialContacts::builder(&mesh)
        .thickness(2e-3)
        .friction(0.2)
        .obstacle(wall(1.0), 0.3)
        .obstacle(wall(-1.0), 0.3)
        .pinched_cloth_passes(pinched_passes)
        .build()
        .unwrap();
    Flight::new(&mesh, contacts).with_edges(&mesh)
}

/// It is resolved as long as there is room, and then refused; it never crosses.
#[test]
fn sheet_squeezed_between_walls_is_resolved_or_refused() {
    let mut flight = squeezed(false);
    let mut refused = false;
    for step in 0..60 {
        let end = flight.step(1.0 / 60.0);
        assert_eq!(flight.crossings(), 0, "step {step}");
        let gap = 0.5 - 0.5 * (step + 1) as f64 / 60.0;
        match end {
            Ok(()) => {
                for x in &flight.positions {
                    assert!(x.x.abs() < 0.5 * gap, "step {step}: {} of {gap}", x.x);
                }
            }
            Err(error) => {
                let by_a_wall = matches!(
                    error,
                    ContactError::Infeasible {
                        is_prescribed: false,
                        body: Some(0 | 1),
                        ..
                    }
                );
                assert!(by_a_wall, "{error}");
                assert!(error.to_string().contains("before body"), "{error}");
                refused = true;
                break;
            }
        }
    }
    assert!(refused, "there is no room between walls that touch");
}

/// If it may pass it gets into one of the walls where there is no room, but never through itself, and goes on when the
/// walls have gone through each other.
#[test]
fn sheet_squeezed_between_walls_passes_if_it_may() {
    let mut flight = squeezed(true);
    let mut first = None;
    for step in 0..70 {
        flight.step(1.0 / 60.0).unwrap();
        assert_eq!(flight.crossings(), 0, "step {step}");
        let inside = |x: &Vec3, step: i32| x.x.abs() > 0.25 - 0.25 * f64::from(step) / 60.0;
        let gap_is_left = flight.positions.iter().any(|x| inside(x, step + 1));
        let pinched = flight.contacts.pinched();
        assert!(pinched > 0 || !gap_is_left, "step {step}");
        if pinched > 0 && first.is_none() {
            first = Some(step);
        }
    }
    // The sheet of 0.4 m is folded up to half of the room that is left before it has none.
    assert!(
        first.is_some_and(|step| (40..60).contains(&step)),
        "{first:?}"
    );
    assert!(flight.contacts.pinched() > 0);
}

#[test]
fn prescribed_sheets_that_cross_have_no_feasible_path() {
    let sheet = grid(3, 3, 0.2, 0.2, Diagonals::Alternating).unwrap();
    let other = moved(&sheet, |x| x + Vec3::new(0.013, 0.017, 0.1));
    let mesh = together(&[sheet, other]);
    let contacts = PotentialContacts::builder(&mesh).build().unwrap();
    let mut flight = Flight::new(&mesh, contacts);
    flight.inverse_mass.fill(0.0);
    for v in &mut flight.velocities[9..] {
        *v = Vec3::z() * -1.0;
    }
    for _ in 0..9 {
        flight.step(0.01).unwrap();
    }
    for _ in 0..3 {
        let end = flight.step(0.02);
        assert!(
            matches!(
                end,
                Err(ContactError::Infeasible {
                    is_prescribed: true,
                    body: None,
                    ..
                })
            ),
            "{end:?}"
        );
    }
    // Nothing has happened to the contacts: back is free.
    for v in &mut flight.velocities[9..] {
        *v = Vec3::z();
    }
    flight.step(0.02).unwrap();
}

#[test]
fn crossing_start_is_refused_with_its_count() {
    let sheet = grid(3, 3, 0.2, 0.2, Diagonals::Alternating).unwrap();
    let other = moved(&sheet, |x| Vec3::new(x.x + 0.013, 0.09, x.y - 0.1));
    let mesh = together(&[sheet, other]);
    let contacts = PotentialContacts::builder(&mesh).build().unwrap();
    let mut flight = Flight::new(&mesh, contacts);
    let pairs = flight.crossings();
    assert!(pairs > 0);
    let found = flight.step(0.01);
    assert!(
        matches!(found, Err(ContactError::IntersectingStart { pairs: n, body: None, .. }) if n == pairs),
        "{found:?}"
    );
}

/// A floor (`up` 1) or a roof (−1) at a height (m).
fn wall(height: f64, up: f64) -> Obstacle {
    let still = RigidMotion::still(Pose::at(Vec3::z() * height));
    Obstacle::moving(HalfSpace::new(Vec3::z() * up).unwrap(), still).unwrap()
}

/// Contact of a mesh with itself, a floor and a roof.
fn between_walls(mesh: &TriMesh, friction: f64) -> PotentialContacts {
    PotentialContacts::builder(mesh)
        .thickness(5e-3)
        .friction(friction)
        .obstacle(wall(-0.4, 1.0), friction)
        .obstacle(wall(2.2, -1.0), friction)
        .build()
        .unwrap()
}

/// Pieces so wild that they become rigid zones, which a floor below and a roof above do not let go where they would:
/// then paths are truncated, and the report says how many and how much.
#[test]
fn zones_that_an_obstacle_stops_are_truncated_and_the_report_says_so() {
    let mut truncated_steps = 0;
    for seed in 0..2 {
        let mut random = Random::new(seed);
        let mesh = soup(&mut random, 4);
        let mut flight = Flight::new(&mesh, between_walls(&mesh, 0.3));
        for step in 0..10 {
            for v in &mut flight.velocities {
                *v = random.point(1e3);
            }
            let from = flight.positions.clone();
            flight.step(0.03).unwrap();
            let report = flight.contacts.constraint_report();
            assert_eq!(flight.contacts.truncated_count(), report.shortened as usize);
            truncated_steps += u32::from(report.zones > 0 && report.shortened > 0);
            let mut heights = flight.positions.iter().map(|x| x.z);
            assert!(heights.all(|z| -0.4 < z && z < 2.2), "seed {seed}");
            assert_no_crossing_since(&from, &mut flight, seed, step);
        }
    }
    assert!(truncated_steps > 5, "{truncated_steps}");
}

/// A method that minimises holds nothing back by itself: what is held is what something else has moved after its step,
/// and is forgotten with the next.
#[test]
fn what_is_held_after_a_minimised_step_is_of_that_step_alone() {
    let mut held = 0;
    for seed in 0..2 {
        let mut random = Random::new(seed);
        let mesh = soup(&mut random, 4);
        let mut contacts = between_walls(&mesh, 0.0);
        let inverse_mass = vec![1.0; mesh.vertex_count()];
        let mut x = mesh.positions().to_vec();
        for _ in 0..10 {
            let from = x.clone();
            let step = ContactStep {
                from: &from,
                inverse_mass: &inverse_mass,
                dt: 0.01,
            };
            ContactPotential::begin(&mut contacts, &step, &mut x).unwrap();
            ContactPotential::end(&mut contacts, &x, &mut vec![Vec3::zeros(); x.len()]);
            assert_eq!(contacts.truncated_count(), 0, "seed {seed}");
            let from = x.clone();
            x.iter_mut().for_each(|x| *x += random.point(30.0));
            contacts.keep_free(&from, &inverse_mass, &mut x).unwrap();
            held += contacts.truncated_count();
        }
    }
    assert!(held > 0);
}

/// The last resort moves thin cloth by its own thickness, whatever else is thicker: of three triangles so fast that no
/// sweep resolves their paths two come out of it half a thickness apart, and one a thickness above a floor.
#[test]
fn last_resort_keeps_the_thickness_of_each_piece() {
    let (thin, thick) = (1e-3, 5e-2);
    let triangle = |x: f64, height: f64| {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        corners.map(|(along, y)| Vec3::new(x + along, y, height))
    };
    let starts = [(0.0, 0.2), (0.0, 0.6), (10.0, 0.4), (0.0, 1e3)];
    let places = starts.map(|(x, height)| triangle(x, height)).concat();
    let mesh = (0..4).map(|k| [0, 1, 2].map(|corner| 3 * k + corner));
    let mesh = TriMesh::new(places, mesh.collect()).unwrap();
    let contacts = PotentialContacts::builder(&mesh)
        .thickness_of_vertices([[thin; 9].to_vec(), vec![thick; 3]].concat())
        .obstacle(wall(0.0, 1.0), 0.0);
    let mut flight = Flight::new(&mesh, contacts.build().unwrap());
    for (v, speed) in flight.velocities.chunks_mut(3).zip([1e3, -1e3, -1e3]) {
        v.fill(Vec3::z() * speed);
    }
    flight.step(0.1).unwrap();
    let report = flight.contacts.constraint_report();
    assert!(report.zones == 1 && report.shortened == 0, "{report:?}");
    let [low, high, fallen] = [0, 3, 6].map(|v| flight.positions[v].z);
    for (gap, kept) in [(high - low, 0.5 * thin), (fallen, thin)] {
        assert!(
            (gap / kept - 1.0).abs() < 1e-6,
            "{gap} m instead of {kept} m"
        );
    }
}

/// What is thin comes as near to a floor as its own thickness lets it, from as far as the thick one keeps away.
#[test]
fn thin_cloth_lands_beside_thick_cloth() {
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
    let at = |height: f64| corners.map(|(x, y)| Vec3::new(x, y, height));
    let places = [at(0.05), at(1.0)].concat();
    let mesh = TriMesh::new(places, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let contacts = PotentialContacts::builder(&mesh)
        .thickness_of_vertices([[1e-3; 3], [0.05; 3]].concat())
        .obstacle(wall(0.0, 1.0), 0.0);
    let mut flight = Flight::new(&mesh, contacts.build().unwrap());
    flight.velocities[..3].fill(Vec3::z() * -0.5);
    flight.step(0.1).unwrap();
    let report = flight.contacts.constraint_report();
    assert_eq!((report.violated, report.shortened), (0, 0), "{report:?}");
    assert!((flight.positions[0].z - 1e-3).abs() < 1e-6);
}

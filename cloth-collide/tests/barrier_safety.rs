//! Nothing crosses anything, counted by an exact test that shares no code with the barrier.

#[path = "support/random.rs"]
mod random;

use cloth_collide::SeparationProbe;
use cloth_collide::barrier::BarrierContacts;
use cloth_collide::obstacle::{
    HalfSpace, ImpactLaw, Obstacle, ObstacleContacts, Pose, RigidMotion, Sphere,
};
use cloth_core::contact::{ContactError, ContactSource, ContactStep};
use cloth_core::math::{Vec3, is_finite};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join};
use cloth_core::step::BuildError;
use random::Random;

const DT: f64 = 1.0 / 60.0;

/// A sheet of n × n vertices (m), moved.
fn sheet(n: usize, size: f64, place: impl Fn(Vec3) -> Vec3) -> TriMesh {
    let flat = grid(n, n, size, size, Diagonals::Alternating).unwrap();
    let positions = flat.positions().iter().map(|x| place(*x)).collect();
    TriMesh::new(positions, flat.triangles().to_vec()).unwrap()
}

/// A step from `from` to `to` (m), resolved.
fn step(
    contacts: &mut BarrierContacts,
    from: &[Vec3],
    to: &[Vec3],
    inverse_mass: &[f64],
) -> Result<(Vec<Vec3>, Vec<Vec3>), ContactError> {
    let mut positions = to.to_vec();
    let mut velocities: Vec<Vec3> = from.iter().zip(to).map(|(a, b)| (b - a) / DT).collect();
    let step = ContactStep {
        from,
        inverse_mass,
        dt: DT,
    };
    contacts.resolve(&step, &mut positions, &mut velocities)?;
    Ok((positions, velocities))
}

fn crossings(mesh: &TriMesh, x: &[Vec3]) -> usize {
    let found = SeparationProbe::new(mesh).measure(x).unwrap();
    found.intersecting_pairs
}

#[test]
fn random_motions_never_cross() {
    let mut random = Random::new(11);
    let mut pushed = 0;
    for case in 0..40 {
        // Twelve triangles of 1 m in their own cells, which then go anywhere, three times.
        let cell = |k: u32| {
            let place = Vec3::new(f64::from(k % 3), f64::from(k / 3 % 2), f64::from(k / 6));
            place * 1.2
        };
        let x: Vec<Vec3> = (0..36).map(|v| cell(v / 3) + random.point(0.55)).collect();
        let triangles = (0..12).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let mesh = TriMesh::new(x.clone(), triangles).unwrap();
        let mut contacts = BarrierContacts::builder(&mesh)
            .distance(0.02)
            .build()
            .unwrap();
        let w: Vec<f64> = (0..36).map(|v| if v < 2 { 0.0 } else { 10.0 }).collect();
        let mut x = x;
        for _ in 0..3 {
            let mut to: Vec<Vec3> = x.iter().map(|x| x + random.point(1.0)).collect();
            to[..2].copy_from_slice(&x[..2]);
            let (next, _) = step(&mut contacts, &x, &to, &w).unwrap();
            assert_eq!(crossings(&mesh, &next), 0, "case {case}");
            assert_eq!(next[..2], x[..2]);
            pushed += contacts.report().contacts;
            x = next;
        }
    }
    assert!(pushed > 500, "{pushed}");
}

#[test]
fn sheet_at_100_metres_a_second_does_not_get_through_another() {
    let lower = sheet(8, 0.5, |x| x);
    let upper = sheet(8, 0.4, |x| {
        let turned = Vec3::new(0.8 * x.x - 0.6 * x.y, 0.6 * x.x + 0.8 * x.y, 0.0);
        turned + Vec3::new(0.03, 0.02, 0.3 + 0.1 * x.x)
    });
    let mesh = join(&[lower, upper]).unwrap();
    // The rim of the lower one is held.
    let inner = |k: usize| (1..7).contains(&k);
    let rim = |v: usize| v < 64 && !(inner(v % 8) && inner(v / 8));
    let w: Vec<f64> = (0..128).map(|v| if rim(v) { 0.0 } else { 1e4 }).collect();
    let mut contacts = BarrierContacts::builder(&mesh).build().unwrap();
    let mut x = mesh.positions().to_vec();
    let mut v: Vec<Vec3> = (0..128)
        .map(|k| {
            if k < 64 {
                Vec3::zeros()
            } else {
                Vec3::z() * -100.0
            }
        })
        .collect();
    let mut contact = false;
    for _ in 0..3 {
        let to: Vec<Vec3> = x.iter().zip(&v).map(|(x, v)| x + v * DT).collect();
        (x, v) = step(&mut contacts, &x, &to, &w).unwrap();
        assert_eq!(crossings(&mesh, &x), 0);
        contact |= contacts.report().contacts > 0;
    }
    assert!(contact);
}

/// Half of a sheet is turned over, on a circle around its middle line, and aimed to the far side of the other half.
#[test]
fn folded_sheet_does_not_get_through_itself() {
    let n = 11;
    let fold = |angle: f64| {
        move |x: Vec3| {
            if x.x <= 0.0 {
                return x;
            }
            // A bend of 10 cm of cloth, then straight.
            let bent = x.x.min(0.1);
            let (radius, part) = (0.1 / angle, angle * bent / 0.1);
            let straight = x.x - bent;
            let end = Vec3::new(radius * part.sin(), x.y, radius * (1.0 - part.cos()));
            end + Vec3::new(part.cos(), 0.0, part.sin()) * straight
        }
    };
    let flat = sheet(n, 1.0, |x| x);
    let offset = flat
        .positions()
        .iter()
        .map(|x| x.x)
        .fold(f64::INFINITY, f64::min);
    let centred = |x: &Vec3| x - Vec3::x() * (offset + 0.5);
    let w = vec![1e3; n * n];
    let mut contacts = BarrierContacts::builder(&flat)
        .distance(5e-3)
        .build()
        .unwrap();
    let start = fold(2.0);
    let mut x: Vec<Vec3> = flat.positions().iter().map(|x| start(centred(x))).collect();
    for angle in [2.6, 3.0, 3.6, 4.2] {
        let end = fold(angle);
        let to: Vec<Vec3> = flat.positions().iter().map(|x| end(centred(x))).collect();
        x = step(&mut contacts, &x, &to, &w).unwrap().0;
        assert_eq!(crossings(&flat, &x), 0, "{angle}");
        if angle > 3.5 {
            assert!(crossings(&flat, &to) > 0);
            assert!(contacts.report().contacts > 0);
        }
    }
}

#[test]
fn pins_that_cross_are_an_error_and_nothing_changes() {
    let triangle = |z: f64| [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z));
    let from = [triangle(0.0), triangle(0.5)].concat();
    let mesh = TriMesh::new(from.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let ball = Obstacle::moving(
        Sphere::new(0.1).unwrap(),
        RigidMotion {
            pose: Pose::at(Vec3::z() * 5.0),
            velocity: Vec3::x(),
            ..RigidMotion::default()
        },
    )
    .unwrap();
    let law = ImpactLaw::new(0.0, 0.0).unwrap();
    let obstacles = ObstacleContacts::new(0.0, 0.0).unwrap().with(ball, law);
    let mut contacts = BarrierContacts::builder(&mesh)
        .obstacles(obstacles)
        .build()
        .unwrap();
    let mut positions = [triangle(0.0), triangle(-0.5)].concat();
    let mut velocities = vec![Vec3::x(); 6];
    let before = (positions.clone(), velocities.clone());
    let step = ContactStep {
        from: &from,
        inverse_mass: &[0.0; 6],
        dt: DT,
    };
    let place = |contacts: &BarrierContacts| {
        let mut all = contacts.obstacles().unwrap().obstacles();
        all.next().unwrap().motion().pose.position
    };
    let result = contacts.resolve(&step, &mut positions, &mut velocities);
    assert!(
        matches!(result, Err(ContactError::NoWay { .. })),
        "{result:?}"
    );
    assert_eq!((positions, velocities), before);
    assert_eq!(place(&contacts), Vec3::z() * 5.0);
    // A step that can be made moves the ball on.
    let (mut positions, mut velocities) = (from.clone(), vec![Vec3::zeros(); 6]);
    contacts
        .resolve(&step, &mut positions, &mut velocities)
        .unwrap();
    assert_eq!(positions, from);
    assert_eq!(place(&contacts), Vec3::new(DT, 0.0, 5.0));
}

#[test]
fn tangled_start_and_start_inside_an_obstacle_are_errors() {
    let flat = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let standing = flat.map(|x| Vec3::new(0.2 + x.x * 0.1, 0.2, x.y - 0.5));
    let from = [flat, standing].concat();
    let mesh = TriMesh::new(from.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let mut contacts = BarrierContacts::builder(&mesh).build().unwrap();
    let found = step(&mut contacts, &from, &from, &[1.0; 6]);
    assert_eq!(found, Err(ContactError::Tangled { pairs: 1 }));

    let mesh = TriMesh::new(flat.to_vec(), vec![[0, 1, 2]]).unwrap();
    let plane = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let law = ImpactLaw::new(0.0, 0.0).unwrap();
    let obstacles = ObstacleContacts::new(1e-3, 0.0).unwrap().with(plane, law);
    let mut contacts = BarrierContacts::builder(&mesh)
        .obstacles(obstacles)
        .build()
        .unwrap();
    let found = step(&mut contacts, &flat, &flat, &[1.0; 3]);
    assert_eq!(found, Err(ContactError::NoWay { vertex: 0 }));
    let short = step(&mut contacts, &flat[..2], &flat[..2], &[1.0; 2]);
    assert_eq!(
        short,
        Err(ContactError::VertexCount {
            expected: 3,
            found: 2
        })
    );
}

/// A held rim carries a sheet through another that is free, which makes way; a ball pushes it back.
#[test]
fn what_is_held_pushes_what_is_free() {
    let lower = sheet(8, 0.5, |x| x - Vec3::new(0.1, 0.1, 0.0));
    let upper = sheet(8, 0.3, |x| x + Vec3::new(0.011, 0.007, 0.02));
    let mesh = join(&[lower, upper]).unwrap();
    let w: Vec<f64> = (0..128).map(|v| if v < 64 { 0.0 } else { 1e4 }).collect();
    let mut contacts = BarrierContacts::builder(&mesh).build().unwrap();
    let from = mesh.positions().to_vec();
    // All of the lower sheet rises by 10 cm: the upper one is carried along.
    let to: Vec<Vec3> = from
        .iter()
        .zip(&w)
        .map(|(x, w)| if *w == 0.0 { x + Vec3::z() * 0.1 } else { *x })
        .collect();
    let (x, v) = step(&mut contacts, &from, &to, &w).unwrap();
    assert_eq!(crossings(&mesh, &x), 0);
    assert_eq!(x[..64], to[..64]);
    assert!(x[64..].iter().all(|x| x.z > 0.1 && x.z < 0.101 + 1e-3));
    assert!(v[64..].iter().all(|v| v.z > 4.0));

    // A ball comes down through the free sheet: its vertices, which nothing joins here, make way.
    let middle = x[64..].iter().sum::<Vec3>() / 64.0;
    let falling = RigidMotion {
        pose: Pose::at(middle + Vec3::z() * 0.3),
        velocity: Vec3::z() * -18.0,
        ..RigidMotion::default()
    };
    let ball = Obstacle::moving(Sphere::new(0.1).unwrap(), falling).unwrap();
    let law = ImpactLaw::new(0.0, 0.0).unwrap();
    let obstacles = ObstacleContacts::new(0.0, 0.0).unwrap().with(ball, law);
    let free = sheet(8, 0.3, |x| x + Vec3::z() * 0.1);
    let mut contacts = BarrierContacts::builder(&free)
        .obstacles(obstacles)
        .build()
        .unwrap();
    let from = free.positions().to_vec();
    let (x, _) = step(&mut contacts, &from, &from, &[1e4; 64]).unwrap();
    let ball = contacts.obstacles().unwrap().obstacles().next().unwrap();
    assert!(x.iter().all(|x| ball.clearance(*x, 0.0).value > 0.0));
    assert!(contacts.report().contacts > 10);
}

#[test]
fn result_is_the_same_in_every_run() {
    let run = || {
        let lower = sheet(9, 0.3, |x| x);
        let upper = sheet(9, 0.3, |x| x + Vec3::new(0.011, 0.007, 0.004));
        let mesh = join(&[lower, upper]).unwrap();
        let mut contacts = BarrierContacts::builder(&mesh).build().unwrap();
        let mut random = Random::new(5);
        let from = mesh.positions().to_vec();
        let to: Vec<Vec3> = from.iter().map(|x| x + random.point(0.03)).collect();
        let result = step(&mut contacts, &from, &to, &[1e4; 162]).unwrap();
        (result, contacts.report())
    };
    assert_eq!(run(), run());
}

/// A corner is fixed inside a ball that falls; the rest of the triangle goes along outside.
#[test]
fn prescribed_vertex_may_be_inside_an_obstacle() {
    let falling = RigidMotion {
        velocity: Vec3::z() * -3.0,
        ..RigidMotion::default()
    };
    let ball = Obstacle::moving(Sphere::new(0.1).unwrap(), falling).unwrap();
    let law = ImpactLaw::new(0.0, 0.0).unwrap();
    let obstacles = ObstacleContacts::new(0.0, 0.0).unwrap().with(ball, law);
    let from = vec![
        Vec3::zeros(),
        Vec3::new(0.02, 0.0, -0.101),
        Vec3::new(-0.02, 0.01, -0.101),
    ];
    let mesh = TriMesh::new(from.clone(), vec![[0, 1, 2]]).unwrap();
    let mut contacts = BarrierContacts::builder(&mesh)
        .obstacles(obstacles)
        .build()
        .unwrap();
    let mut to = from.clone();
    to[0] -= Vec3::z() * (3.0 * DT);
    let (x, _) = step(&mut contacts, &from, &to, &[0.0, 1e3, 1e3]).unwrap();
    assert_eq!(x[0], to[0]);
    let mut balls = contacts.obstacles().unwrap().obstacles();
    let ball = balls.next().unwrap();
    assert!(x[1..].iter().all(|x| ball.clearance(*x, 0.0).value > 0.0));
    assert!(x[1..].iter().all(|x| x.z < -0.12));
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    // Cells of 5 cm: the height onto a diagonal is 3.5 cm.
    let mesh = sheet(5, 0.2, |x| x);
    let builder = || BarrierContacts::builder(&mesh);
    let name = |result: Result<BarrierContacts, BuildError>| match result {
        Err(BuildError::InvalidSetting { name, .. }) => name,
        other => panic!("{other:?}"),
    };
    assert!(name(builder().distance(0.036).build()).starts_with("distance"));
    assert!(name(builder().distance(f64::NAN).build()).starts_with("distance"));
    assert!(name(builder().stiffness(0.0).build()).starts_with("stiffness"));
    assert!(name(builder().accuracy(-1.0).build()).starts_with("accuracy"));
    assert!(builder().distance(0.035).build().is_ok());
    let obstacles_only = builder().distance(0.036).self_collision(false);
    assert!(obstacles_only.build().is_ok());
}

/// Sizes of space, speed and time from 1e-300 to 1e300: every step is resolved or refused, and what is resolved is finite and free.
#[test]
fn extreme_sizes_are_resolved_or_refused() {
    let mut random = Random::new(17);
    let mut resolved = [0, 0];
    for round in 0..160 {
        let mut power = |most: f64| 10f64.powf(random.point(most).x);
        let most: f64 = [3.0, 20.0, 150.0, 300.0][round % 4];
        let (size, dt) = (power(most.min(70.0)), power(most));
        // What rests inside the range of the barrier is pushed all the same.
        let speed = if round % 8 < 4 { power(most) } else { 0.0 };
        let distance = size * power(2.0);
        let inverse_mass = vec![power(most.min(100.0)); 18];
        let layer = |z: f64| sheet(3, 1.0, |x| x + Vec3::z() * z);
        let layers = join(&[layer(0.0), layer(0.3)]).unwrap();
        let scaled = layers.positions().iter().map(|x| x * size).collect();
        let Ok(mesh) = TriMesh::new(scaled, layers.triangles().to_vec()) else {
            continue;
        };
        let Ok(mut contacts) = BarrierContacts::builder(&mesh).distance(distance).build() else {
            continue;
        };
        let from = mesh.positions();
        let mut velocities: Vec<Vec3> = from.iter().map(|_| random.point(speed)).collect();
        let mut positions: Vec<Vec3> = from
            .iter()
            .zip(&velocities)
            .map(|(x, v)| x + v * dt)
            .collect();
        let step = ContactStep {
            from,
            inverse_mass: &inverse_mass,
            dt,
        };
        match contacts.resolve(&step, &mut positions, &mut velocities) {
            Ok(()) => {
                let mut both = positions.iter().chain(&velocities);
                assert!(both.all(is_finite), "round {round}");
                // At coordinates of 1e100 m volumes overflow, and no test is exact any more.
                if positions.iter().all(|x| x.amax() < 1e90) {
                    assert_eq!(crossings(&mesh, &positions), 0, "round {round}");
                }
                resolved[0] += 1;
            }
            Err(_) => resolved[1] += 1,
        }
    }
    assert!(resolved[0] > 10 && resolved[1] > 0, "{resolved:?}");
}

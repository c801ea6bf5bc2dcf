//! Bodies as triangles: nothing of the cloth goes through their edges, corners and faces, in either view of contact.

use cloth_collide::BodyProbe;
use cloth_collide::obstacle::{
    AnimatedMesh, Cuboid, HalfSpace, Obstacle, Pose, RigidMotion, Sphere,
};
use cloth_collide::potential::PotentialContacts;
use cloth_collide::untangle::StepUntangler;
use cloth_core::contact::{ContactError, ContactSource, ContactStep, Projection};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, cuboid, grid, sphere};
use cloth_core::mesh::{TriMesh, generate};

const THICKNESS: Real = 2e-3;
const DT: Real = 1.0 / 600.0;

/// A sheet of `n` × `n` cells of `cell` (m) in the plane z = 0 around the origin.
fn sheet(n: usize, cell: Real) -> TriMesh {
    let size = n as Real * cell;
    let flat = grid(n + 1, n + 1, size, size, Diagonals::Alternating).unwrap();
    let shift = Vec3::new(size, size, 0.0) / 2.0;
    let positions = flat.positions().iter().map(|x| x - shift).collect();
    TriMesh::new(positions, flat.triangles().to_vec()).unwrap()
}

fn rising(position: Vec3, speed: Real) -> RigidMotion {
    RigidMotion {
        pose: Pose::at(position),
        velocity: Vec3::z() * speed,
        ..RigidMotion::default()
    }
}

/// Free vertices of 1 g that fly into whatever comes, `steps` times, in the view of constraints. Hands each place to
/// `after`.
fn fly(
    contacts: &mut PotentialContacts,
    x: &mut [Vec3],
    v: &mut [Vec3],
    w: &[Real],
    steps: u32,
    mut after: impl FnMut(u32, &[Vec3]),
) -> Result<(), ContactError> {
    let mut projection = Projection::default();
    for step in 1..=steps {
        let from = x.to_vec();
        let taken = ContactStep {
            from: &from,
            inverse_mass: w,
            dt: DT,
        };
        for ((x, v), w) in x.iter_mut().zip(&*v).zip(w) {
            if *w > 0.0 {
                *x += v * DT;
            }
        }
        projection.step(contacts.constraints(), &taken, 4, x, v)?;
        after(step, x);
    }
    Ok(())
}

/// A ball of 2 cm goes through the middle of a triangle of 0.5 m if only vertices feel it. As triangles it takes the
/// triangle along.
#[test]
fn a_ball_smaller_than_a_triangle_pushes_it() {
    let corners = [(-0.25, -0.2), (0.25, -0.2), (0.0, 0.3)];
    let corners = corners.map(|(x, y)| Vec3::new(x, y, 0.0));
    let cloth = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    let ball = sphere(4, 0.02).unwrap();
    let below = Vec3::new(0.01, 0.02, -0.03);
    for has_surface in [false, true] {
        let body = Obstacle::moving(Sphere::new(0.02).unwrap(), rising(below, 1.0)).unwrap();
        let builder = PotentialContacts::builder(&cloth)
            .thickness(THICKNESS)
            .obstacle(body, 0.0);
        let builder = match has_surface {
            true => builder.surface(0, ball.clone()),
            false => builder,
        };
        let mut contacts = builder.build().unwrap();
        let mut probe = BodyProbe::new(&cloth, &[&ball]).unwrap();
        let (mut x, mut v) = (corners.to_vec(), vec![Vec3::zeros(); 3]);
        let mut most = 0;
        fly(&mut contacts, &mut x, &mut v, &[1e3; 3], 60, |step, x| {
            let centre = below + Vec3::z() * (Real::from(step) * DT);
            let surface: Vec<Vec3> = ball.positions().iter().map(|x| x + centre).collect();
            most = most.max(probe.count(x, [&surface[..]]).unwrap());
        })
        .unwrap();
        // 0.1 s of 1 m/s, from 3 cm below.
        let top: Vec3 = x.iter().sum::<Vec3>() / 3.0;
        if has_surface {
            assert_eq!(most, 0);
            assert!(top.z > 0.07 + 0.02 - 1e-3, "{top}");
        } else {
            assert!(most > 0 && top.z == 0.0);
        }
    }
}

/// A ball that keeps its velocity u does the work u·p on a free triangle that it gives the momentum p; projections lose
/// some of it, and make none.
#[test]
fn work_of_a_body_is_its_velocity_times_the_momentum_it_gives() {
    let corners = [(-0.25, -0.2), (0.25, -0.2), (0.0, 0.3)];
    let corners = corners.map(|(x, y)| Vec3::new(x, y, 0.0));
    let cloth = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    let below = Vec3::new(0.0, -0.1 / 3.0, -0.03);
    let body = Obstacle::moving(Sphere::new(0.02).unwrap(), rising(below, 1.0)).unwrap();
    let mut contacts = PotentialContacts::builder(&cloth)
        .thickness(THICKNESS)
        .obstacle(body, 0.0)
        .surface(0, sphere(4, 0.02).unwrap())
        .build()
        .unwrap();
    let (mut x, mut v) = (corners.to_vec(), vec![Vec3::zeros(); 3]);
    let mut work = 0.0;
    for step in 0..60 {
        fly(&mut contacts, &mut x, &mut v, &[1e3; 3], 1, |_, _| ()).unwrap();
        work += contacts.work();
        let momentum: Real = v.iter().map(|v| 1e-3 * v.z).sum();
        assert!(
            (work - momentum).abs() < 1e-15,
            "step {step}: {work} J, {momentum} kg m/s"
        );
        let kinetic: Real = v.iter().map(|v| 0.5e-3 * v.norm_squared()).sum();
        assert!(kinetic + contacts.potential_energy() <= work, "step {step}");
    }
    // Taken along, 3 g.
    assert!(work > 3e-3, "{work}");
}

/// Sheets of large cells fall on the corner of a box, which no vertex of theirs is near to.
#[test]
fn a_corner_pierces_no_triangle() {
    let cloth = sheet(4, 0.12);
    let body = cuboid([0.1; 3]).unwrap();
    // On its corner: the diagonal of the cube upright, its top √3/10 m above its middle.
    let turn = Vec3::new(-0.5, 0.5, 0.0).normalize() * (1.0 / Real::sqrt(3.0)).acos();
    let pose = Pose::at(Vec3::new(0.03, 0.02, -0.1 * Real::sqrt(3.0) - 0.01)).turned(turn);
    let obstacle = Obstacle::moving(
        Cuboid::new(Vec3::repeat(0.1)).unwrap(),
        RigidMotion::still(pose),
    );
    let mut contacts = PotentialContacts::builder(&cloth)
        .thickness(THICKNESS)
        .obstacle(obstacle.unwrap(), 0.0)
        .surface(0, body.clone())
        .build()
        .unwrap();
    let mut probe = BodyProbe::new(&cloth, &[&body]).unwrap();
    let surface: Vec<Vec3> = body.positions().iter().map(|&x| pose.to_world(x)).collect();
    let top = surface
        .iter()
        .map(|x| x.z)
        .fold(Real::NEG_INFINITY, Real::max);
    assert!((top + 0.01).abs() < 1e-12, "{top}");
    let mut x = cloth.positions().to_vec();
    let mut v = vec![Vec3::z() * -1.0; x.len()];
    let w = vec![1e3; x.len()];
    fly(&mut contacts, &mut x, &mut v, &w, 60, |step, x| {
        let found = probe.count(x, [&surface[..]]).unwrap();
        assert_eq!(found, 0, "after step {step}");
    })
    .unwrap();
    // Without anything that holds it together all but what the corner has met has fallen on.
    let lowest = x.iter().map(|x| x.z).fold(Real::INFINITY, Real::min);
    assert!(lowest < -0.09, "{lowest}");
}

/// The pressure of cloth that lies flat is that of its vertices alone, to rounding: triangles of the body add none,
/// however fine.
#[test]
fn flat_contact_is_that_of_the_signed_distance() {
    let cloth = sheet(6, 0.02);
    let fine = sheet(40, 0.005);
    let gap = 0.7 * THICKNESS;
    let floor = || Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let place: Vec<Vec3> = cloth
        .positions()
        .iter()
        .map(|x| x + Vec3::z() * gap)
        .collect();
    let w = vec![1e3; place.len()];
    let step = ContactStep {
        from: &place,
        inverse_mass: &w,
        dt: DT,
    };
    let builder = || {
        PotentialContacts::builder(&cloth)
            .thickness(THICKNESS)
            .obstacle(floor(), 0.0)
    };
    let force = |mut contacts: PotentialContacts| {
        let mut start = place.clone();
        let potential = contacts.potential();
        potential.begin(&step, &mut start).unwrap();
        let mut gradient = vec![Vec3::zeros(); place.len()];
        let energy = potential.add_gradient(&start, &mut gradient);
        let mut rows = Vec::new();
        potential.linearize(&start, &mut rows);
        assert!(
            rows.iter()
                .all(|row| row.vertices.iter().all(|&v| (v as usize) < place.len()))
        );
        (energy, gradient, rows.len())
    };
    let alone = force(builder().build().unwrap());
    assert_eq!(alone, force(builder().surface(0, fine).build().unwrap()));
    // κ (h − d) per area, all in all.
    let sum: Real = alone.1.iter().map(|g| -g.z).sum();
    let expected = 1e6 * 0.3 * THICKNESS * 0.12 * 0.12;
    assert!(
        (sum / expected - 1.0).abs() < 1e-12,
        "{sum} N of {expected} N"
    );

    // The same of a surface that has no signed distance, with triangles larger than the cloth.
    let triangle = [(-1.0, -1.1), (1.2, -1.0), (0.1, 1.3)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let surface = TriMesh::new(triangle.to_vec(), vec![[0, 1, 2]]).unwrap();
    let still = AnimatedMesh::new(vec![triangle.to_vec()], 1.0).unwrap();
    let without = PotentialContacts::builder(&cloth).thickness(THICKNESS);
    let open = force(without.animated(surface, still, 0.0).build().unwrap());
    let sum: Real = open.1.iter().map(|g| -g.z).sum();
    assert!(
        (sum / expected - 1.0).abs() < 1e-12,
        "{sum} N of {expected} N"
    );
}

/// An open sheet that is moved from below, shape by shape, lifts a cloth that rests on nothing else, and lets nothing
/// through while it bends.
#[test]
fn an_open_surface_that_changes_its_shape_lifts_cloth() {
    let cloth = sheet(8, 0.03);
    let below = sheet(5, 0.08);
    let shape = |k: u32| -> Vec<Vec3> {
        let height = -0.02 + 0.02 * Real::from(k);
        let wave = 0.004 * Real::from(k % 3);
        let bent = |x: &Vec3| x + Vec3::z() * (height + wave * (20.0 * x.x).sin());
        below.positions().iter().map(bent).collect()
    };
    let animation = AnimatedMesh::new((0..8).map(shape).collect(), 0.02).unwrap();
    let mut contacts = PotentialContacts::builder(&cloth)
        .thickness(THICKNESS)
        .animated(below.clone(), animation.clone(), 0.2)
        .build()
        .unwrap();
    let mut probe = BodyProbe::new(&cloth, &[&below]).unwrap();
    let mut x = cloth.positions().to_vec();
    let mut v = vec![Vec3::zeros(); x.len()];
    let w = vec![1e3; x.len()];
    let mut surface = below.positions().to_vec();
    fly(&mut contacts, &mut x, &mut v, &w, 84, |step, x| {
        let time = Real::from(step) * DT;
        animation.place(time, &mut surface).unwrap();
        let found = probe.count(x, [&surface[..]]).unwrap();
        assert_eq!(found, 0, "after step {step}");
    })
    .unwrap();
    let lowest = x.iter().map(|x| x.z).fold(Real::INFINITY, Real::min);
    let highest = surface
        .iter()
        .map(|x| x.z)
        .fold(Real::NEG_INFINITY, Real::max);
    assert!(
        lowest > 0.11,
        "{lowest} m above a surface up to {highest} m"
    );
}

/// A body that goes through itself, and one inside another, are in nobody's way.
#[test]
fn bodies_do_not_touch_each_other() {
    let cloth = sheet(3, 0.05);
    let [one, other] = [0.05, 0.04].map(|half| cuboid([half; 3]).unwrap());
    let crossed = generate::join(&[one.clone(), other]).unwrap();
    let body = Obstacle::moving(
        Cuboid::new(Vec3::repeat(0.05)).unwrap(),
        rising(-Vec3::z() * 0.06, 0.5),
    );
    let second = Obstacle::moving(
        Cuboid::new(Vec3::repeat(0.05)).unwrap(),
        rising(Vec3::new(0.02, 0.01, -0.07), 0.6),
    );
    let mut contacts = PotentialContacts::builder(&cloth)
        .thickness(THICKNESS)
        .obstacle(body.unwrap(), 0.0)
        .obstacle(second.unwrap(), 0.0)
        .surface(0, crossed)
        .surface(1, one)
        .build()
        .unwrap();
    let mut x = cloth.positions().to_vec();
    let mut v = vec![Vec3::zeros(); x.len()];
    let w = vec![1e3; x.len()];
    fly(&mut contacts, &mut x, &mut v, &w, 60, |_, _| ()).unwrap();
    // All that is above one of them has been lifted.
    let above = |x: &&Vec3| x.x.abs().max(x.y.abs()) < 0.03;
    let lifted = x.iter().filter(above).map(|x| x.z);
    let lowest = lifted.fold(Real::INFINITY, Real::min);
    assert!(lowest > 0.03 && lowest < 1.0, "{lowest}");
}

/// What is wrong with a surface is said when contact is built, and crossings at the start of a step.
#[test]
fn what_does_not_fit_is_named() {
    let cloth = sheet(2, 0.1);
    let ball = || Obstacle::new(Sphere::new(0.02).unwrap());
    let surface = || sphere(2, 0.02).unwrap();
    let builder = || PotentialContacts::builder(&cloth).obstacle(ball(), 0.0);
    let error = builder().surface(1, surface()).build().unwrap_err();
    assert!(
        error.to_string().contains("below the number of obstacles"),
        "{error}"
    );
    let one = AnimatedMesh::new(vec![vec![Vec3::zeros(); 3]], 1.0).unwrap();
    let error = builder().animated(surface(), one, 0.0).build().unwrap_err();
    assert!(error.to_string().contains("that of its mesh"), "{error}");
    let one = AnimatedMesh::new(vec![surface().positions().to_vec()], 1.0).unwrap();
    let error = builder()
        .animated(surface(), one, -1.0)
        .build()
        .unwrap_err();
    assert!(error.to_string().contains("friction of a body"), "{error}");

    // The ball is in the middle of the sheet, and in the middle of a triangle if it is moved.
    let position = Vec3::new(0.05, 0.03, 0.0);
    let inside = Obstacle::moving(Sphere::new(0.02).unwrap(), rising(position, 0.0)).unwrap();
    let mut contacts = PotentialContacts::builder(&cloth)
        .obstacle(inside, 0.0)
        .surface(0, surface())
        .build()
        .unwrap();
    let x = cloth.positions().to_vec();
    let step = ContactStep {
        from: &x,
        inverse_mass: &[1.0; 9],
        dt: DT,
    };
    let begun = contacts.constraints().begin_step(&step);
    assert!(
        matches!(
            begun,
            Err(ContactError::IntersectingStart { body: Some(0), .. })
        ),
        "{begun:?}"
    );
}

/// Two balls that are nothing but their distance close on a corner of the cloth: there is no feasible path, unless
/// pinched cloth may pass.
#[test]
fn cloth_pinched_by_bodies_without_triangles_is_refused_or_passes() {
    let corners = [(0.0, 0.0), (0.3, 0.0), (0.0, 0.3)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let cloth = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    let closed = |passes: bool| {
        let mut builder = PotentialContacts::builder(&cloth).thickness(THICKNESS);
        for side in [-1.0, 1.0] {
            let motion = rising(Vec3::z() * (0.11 * side), -side);
            let ball = Obstacle::moving(Sphere::new(0.1).unwrap(), motion).unwrap();
            builder = builder.obstacle(ball, 0.0);
        }
        let mut contacts = builder.pinched_cloth_passes(passes).build().unwrap();
        let (mut x, mut v) = (corners.to_vec(), vec![Vec3::zeros(); 3]);
        // The other two corners are held, so that the first cannot leave between the balls.
        let w = [1e3, 0.0, 0.0];
        let ended = fly(&mut contacts, &mut x, &mut v, &w, 12, |_, _| ());
        (ended.is_ok(), contacts.pinched() > 0)
    };
    assert_eq!(closed(false), (false, false));
    assert_eq!(closed(true), (true, true));
}

/// Regions are of the cloth: whatever may pass through each other there, bodies keep out all.
#[test]
fn regions_that_may_pass_through_each_other_pass_through_no_body() {
    let corners = [(-0.25, -0.2), (0.25, -0.2), (0.0, 0.3)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let cloth = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    let crossing = |region: u32, pair: [u32; 2]| {
        let mut contacts = PotentialContacts::builder(&cloth)
            .thickness(THICKNESS)
            .exclude(vec![region; 3], vec![pair])
            .obstacle(Obstacle::new(Sphere::new(0.02).unwrap()), 0.0)
            .surface(0, sphere(4, 0.02).unwrap())
            .build()
            .unwrap();
        let step = ContactStep {
            from: &corners,
            inverse_mass: &[1.0; 3],
            dt: DT,
        };
        let refused = contacts.constraints().begin_step(&step);
        let Err(ContactError::IntersectingStart { pairs, .. }) = refused else {
            panic!("region {region}, {pair:?}: {refused:?}");
        };
        let mut untangler = StepUntangler::new(&contacts).unwrap();
        let (mut x, mut v) = (corners, [Vec3::zeros(); 3]);
        let found = untangler.begin_step(&mut contacts, &[1.0; 3], &mut x, &mut v);
        assert_eq!(found.unwrap().bodies, pairs);
        pairs
    };
    let all = crossing(1, [2, 3]);
    assert!(all > 0);
    for (region, pair) in [(0, [0, 0]), (0, [0, 1]), (1, [0, 1]), (1, [1, 1])] {
        assert_eq!(crossing(region, pair), all);
    }
}

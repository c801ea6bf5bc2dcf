//! Bodies that move by themselves: the time of the state they belong to, and shapes that are not known in advance.

use cloth_collide::obstacle::{
    AnimatedMesh, HalfSpace, Obstacle, Pose, RigidBody, RigidMotion, Sphere,
};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactPotential, ContactSource, ContactStep, Projection};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{StepError, StepInput};

const DT: Real = 1.0 / 64.0;
const THICKNESS: Real = 2e-3;

fn sheet(n: usize, height: Real) -> TriMesh {
    let flat = grid(n, n, 0.2, 0.2, Diagonals::Alternating).unwrap();
    let positions = flat.positions().iter().map(|x| x + Vec3::z() * height);
    TriMesh::new(positions.collect(), flat.triangles().to_vec()).unwrap()
}

fn taken<'a>(from: &'a [Vec3], inverse_mass: &'a [Real], dt: Real) -> ContactStep<'a> {
    ContactStep {
        from,
        inverse_mass,
        dt,
    }
}

/// One step of free vertices of 1 g in the view of constraints, in `substeps`, after the check that a method does.
fn step(
    contacts: &mut PotentialContacts,
    state: &mut State,
    substeps: u32,
) -> Result<(), StepError> {
    let count = state.positions.len();
    StepInput::new(DT).contacts(contacts).check(state, count)?;
    let (w, dt) = (vec![1e3; count], DT / Real::from(substeps));
    let contacts = contacts.constraints();
    contacts
        .begin_step(&taken(&state.positions, &w, DT))
        .unwrap();
    let mut projection = Projection::default();
    for _ in 0..substeps {
        let from = state.positions.clone();
        let moves = state.positions.iter_mut().zip(&state.velocities);
        moves.for_each(|(x, v)| *x += v * dt);
        let (x, v) = (&mut state.positions, &mut state.velocities);
        let ended = projection.substep(contacts, &taken(&from, &w, dt), 4, x, v);
        ended.unwrap();
    }
    contacts.end_step(&state.positions);
    state.time += DT;
    state.steps += 1;
    Ok(())
}

fn over_a_rising_ball(cloth: &TriMesh) -> PotentialContacts {
    let rising = RigidMotion {
        velocity: Vec3::z() * 0.1,
        ..RigidMotion::default()
    };
    let ball = Obstacle::moving(Sphere::new(0.05).unwrap(), rising).unwrap();
    let builder = PotentialContacts::builder(cloth).obstacle(ball, 0.0);
    builder.build().unwrap()
}

#[test]
fn a_state_that_was_put_back_alone_is_refused_by_both_times() {
    let cloth = sheet(3, 1.0);
    let mut contacts = over_a_rising_ball(&cloth);
    let start = State::at_rest(cloth.positions().to_vec());
    let mut state = start.clone();
    for _ in 0..3 {
        step(&mut contacts, &mut state, 5).unwrap();
    }
    let mut early = start.clone();
    let error = step(&mut contacts, &mut early, 5).unwrap_err();
    let (time, expected) = (0.0, 3.0 * DT);
    let StepError::Contact { reason, .. } = &error else {
        panic!("{error}");
    };
    let ContactError::WrongTime {
        time: t,
        expected: e,
    } = reason
    else {
        panic!("{error}");
    };
    assert_eq!(*t, time);
    assert!((e - expected).abs() < 1e-12);
    assert!(error.to_string().contains("begins at 0 s"), "{error}");
    assert!(error.to_string().contains("0.046875"), "{error}");
    assert_eq!(early, start);
    // The state that belongs to the bodies goes on, and a clock may be set on purpose.
    step(&mut contacts, &mut state, 5).unwrap();
    contacts.continue_at(0.0);
    step(&mut contacts, &mut early, 5).unwrap();
    step(&mut contacts, &mut early, 5).unwrap();
}

#[test]
fn the_time_is_not_asked_where_nothing_moves() {
    let cloth = sheet(3, 1.0);
    let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let builder = PotentialContacts::builder(&cloth).obstacle(floor, 0.0);
    let mut contacts = builder.build().unwrap();
    let start = State::at_rest(cloth.positions().to_vec());
    for _ in 0..2 {
        step(&mut contacts, &mut start.clone(), 1).unwrap();
    }
}

/// Neither a step that has begun and not ended, nor one that was taken back, moves the time on.
#[test]
fn a_step_that_was_not_taken_is_begun_again_at_its_time() {
    let cloth = sheet(3, 1.0);
    let mut contacts = over_a_rising_ball(&cloth);
    let x = cloth.positions().to_vec();
    let w = vec![1e3; x.len()];
    let taken = taken(&x, &w, DT);
    let check = |contacts: &PotentialContacts, time| contacts.check_time(time, DT).is_ok();
    assert!(check(&contacts, 0.5), "the first step begins at any time");
    ContactPotential::begin(&mut contacts, &taken, &mut x.clone()).unwrap();
    assert!(check(&contacts, 0.5) && !check(&contacts, 0.5 + DT));
    ContactPotential::begin(&mut contacts, &taken, &mut x.clone()).unwrap();
    ContactPotential::end(&mut contacts, &x, &mut x.clone());
    assert!(check(&contacts, 0.5 + DT) && !check(&contacts, 0.5));
    contacts.take_back();
    assert!(check(&contacts, 0.5) && !check(&contacts, 0.5 + DT));
}

/// A sheet that bends and rises under the cloth, which it presses from the beginning: known in advance, or handed shape
/// by shape.
#[test]
fn handed_shapes_are_those_of_an_animation() {
    let (cloth, below) = (sheet(7, 1e-3), sheet(5, 0.0));
    let shape = |k: u32| -> Vec<Vec3> {
        let (height, wave) = (1e-3 * Real::from(k), 4e-4 * Real::from(k % 3));
        let bent = |x: &Vec3| x + Vec3::z() * (height + wave * (20.0 * x.x).sin());
        below.positions().iter().map(bent).collect()
    };
    let with = |animation| {
        let builder = PotentialContacts::builder(&cloth).thickness(THICKNESS);
        let builder = builder.animated(below.clone(), animation, 0.3);
        builder.build().unwrap()
    };
    let animation = AnimatedMesh::new((0..9).map(shape).collect(), DT).unwrap();
    let one = AnimatedMesh::new(vec![shape(0)], DT).unwrap();
    let (mut known, mut handed) = (with(animation), with(one));
    let start = State::at_rest(cloth.positions().to_vec());
    let (mut a, mut b) = (start.clone(), start.clone());
    for k in 1..10 {
        if k < 9 {
            handed.set_shape(0, &shape(k), DT).unwrap();
        }
        step(&mut known, &mut a, 4).unwrap();
        step(&mut handed, &mut b, 4).unwrap();
        let both = a.positions.iter().zip(&b.positions);
        let off = both.map(|(a, b)| (a - b).norm()).fold(0.0, Real::max);
        assert!(off < 1e-10, "{off} m after step {k}");
    }
    let rise = a.positions[24].z - start.positions[24].z;
    assert!(rise > 6e-3, "it was lifted by {rise} m");
}

#[test]
fn shapes_that_do_not_fit_are_refused() {
    let (cloth, below) = (sheet(3, 1.0), sheet(3, 0.0));
    let one = AnimatedMesh::new(vec![below.positions().to_vec()], 1.0).unwrap();
    let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let builder = PotentialContacts::builder(&cloth).obstacle(floor, 0.0);
    let mut contacts = builder.animated(below.clone(), one, 0.0).build().unwrap();
    let x = below.positions();
    let mut refused = |body, x: &[Vec3], within| {
        let refused = contacts.set_shape(body, x, within);
        refused.unwrap_err().to_string()
    };
    assert!(refused(0, x, DT).contains("animated body is 0"));
    assert!(refused(2, x, DT).contains("animated body is 2"));
    assert!(refused(1, &x[1..], DT).contains("positions of a shape is 8"));
    assert!(refused(1, x, 0.0).contains("next shape (s) is 0"));
    let mut bad = x.to_vec();
    bad[3].y = Real::NAN;
    assert!(refused(1, &bad, DT).contains("not a finite number"));
    contacts.set_shape(1, x, DT).unwrap();
}

#[test]
fn an_orientation_that_is_no_rotation_is_refused() {
    let mut motion = RigidMotion::default();
    let doubled = motion.pose.orientation.into_inner() * 2.0;
    motion.pose.orientation = nalgebra::Unit::new_unchecked(doubled);
    let refused = Obstacle::moving(Sphere::new(1.0).unwrap(), motion).unwrap_err();
    assert!(
        refused
            .to_string()
            .contains("length of the quaternion of an obstacle is 2")
    );
}

/// A sheet that lies on a ball that rises and turns, and slides on it with friction, beside a body that is handed its
/// shapes and one that the cloth pushes: from a snapshot on, the same steps give the same numbers, in both views.
#[test]
fn a_restored_snapshot_repeats_the_same_steps_bit_for_bit() {
    let (cloth, beside) = (sheet(7, 1.2e-3), sheet(3, -0.3));
    let turning = RigidMotion {
        pose: Pose::at(Vec3::new(0.1, 0.1, -0.05)),
        velocity: Vec3::z() * 0.1,
        angular_velocity: Vec3::z() * 2.0,
    };
    let pushed = RigidMotion {
        pose: Pose::at(Vec3::new(0.05, 0.1, 0.03)),
        velocity: Vec3::z() * -0.2,
        ..RigidMotion::default()
    };
    let ball = Obstacle::moving(Sphere::new(0.05).unwrap(), turning).unwrap();
    let free = Obstacle::moving(Sphere::new(0.02).unwrap(), pushed).unwrap();
    let body = RigidBody::sphere(0.05, 0.02, Vec3::z() * -9.81).unwrap();
    let one = AnimatedMesh::new(vec![beside.positions().to_vec()], 1.0).unwrap();
    let builder = PotentialContacts::builder(&cloth).obstacle(ball, 0.5);
    let builder = builder.obstacle(free, 0.3).free(1, body);
    let mut contacts = builder.animated(beside.clone(), one, 0.2).build().unwrap();
    let raised: Vec<Vec3> = beside
        .positions()
        .iter()
        .map(|x| x + Vec3::z() * 0.05)
        .collect();
    contacts.set_shape(2, &raised, 0.3).unwrap();
    let mut state = State::at_rest(cloth.positions().to_vec());
    state.velocities.fill(Vec3::new(0.05, 0.0, -0.1));
    for _ in 0..6 {
        step(&mut contacts, &mut state, 3).unwrap();
    }
    let snapshot = (state.clone(), contacts.clone());
    let run = |state: &mut State, contacts: &mut PotentialContacts| {
        let mut told = Vec::new();
        for k in 0..12 {
            match k % 3 {
                2 => minimise(contacts, state),
                _ => step(contacts, state, 3).unwrap(),
            }
            told.push((state.clone(), contacts.work(), contacts.potential_energy()));
        }
        (told, contacts.free_motions().collect::<Vec<_>>())
    };
    let first = run(&mut state, &mut contacts);
    assert!(first.0.iter().any(|(_, work, _)| *work != 0.0));
    let (mut state, mut contacts) = snapshot;
    assert!(run(&mut state, &mut contacts) == first);
}

/// One step in the view of an energy: ten steps down its gradient.
fn minimise(contacts: &mut PotentialContacts, state: &mut State) {
    let count = state.positions.len();
    let input = StepInput::new(DT).contacts(contacts);
    input.check(state, count).unwrap();
    let (w, from) = (vec![1e3; count], state.positions.clone());
    let moves = from.iter().zip(&state.velocities);
    let free: Vec<Vec3> = moves.map(|(x, v)| x + v * DT).collect();
    let mut x = free.clone();
    ContactPotential::begin(contacts, &taken(&from, &w, DT), &mut x).unwrap();
    for _ in 0..10 {
        let inertia = 1e-3 / (DT * DT);
        let mut gradient: Vec<Vec3> = (0..count).map(|k| (x[k] - free[k]) * inertia).collect();
        contacts.add_gradient(&x, &mut gradient);
        let to: Vec<Vec3> = (0..count).map(|k| x[k] - gradient[k] * 1e-4).collect();
        let safe = contacts.limit(&x, &to).unwrap();
        x.iter_mut()
            .zip(&to)
            .for_each(|(x, to)| *x += (to - *x) * safe);
    }
    state.velocities = (0..count).map(|k| (x[k] - from[k]) / DT).collect();
    ContactPotential::end(contacts, &x, &mut state.velocities);
    state.positions = x;
    state.time += DT;
    state.steps += 1;
}

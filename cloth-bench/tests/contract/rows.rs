//! The laws of contact, where a method projects positions and feels it in every substep.

use crate::common::allocations_once_warm;
use cloth_collide::SeparationProbe;
use cloth_collide::obstacle::{HalfSpace, Obstacle, Pose, RigidMotion, Sphere};
use cloth_collide::potential::PotentialContacts;
use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::contact::{ContactError, ContactSource};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{gravitational_energy, kinetic_energy};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, irregular, sphere};
use cloth_core::particles::State;
use cloth_core::step::{StepError, StepInput, Stepper};
use cloth_massspring::{ExplicitConfig, SymplecticEuler};
use cloth_pbd::{PbdConfig, PbdSolver};
use cloth_xpbd::direct::{DirectConfig, DirectXpbd};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

const DENSITY: Real = 0.2;
const GRAVITY: Real = 9.81;
const THICKNESS: Real = 2e-3;
/// κ (Pa/m).
const STIFFNESS: Real = 1e6;
const DT: Real = 1.0 / 60.0;

fn model(mesh: &TriMesh) -> ClothModel {
    let cloth = Cloth {
        areal_density: DENSITY,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    cloth.on(mesh).unwrap()
}

fn xpbd(model: &ClothModel, substeps: u32) -> Box<dyn Stepper> {
    let builder = XpbdSolver::builder(&model.particles).config(XpbdConfig {
        substeps,
        ..XpbdConfig::default()
    });
    let builder = builder.energy(model.springs.clone());
    Box::new(builder.energy(model.hinges.clone()).build().unwrap())
}

fn pbd(model: &ClothModel, substeps: u32) -> Box<dyn Stepper> {
    let builder = PbdSolver::builder(&model.particles).config(PbdConfig {
        substeps,
        ..PbdConfig::default()
    });
    let builder = builder.energy(model.springs.clone());
    Box::new(builder.energy(model.hinges.clone()).build().unwrap())
}

fn direct(model: &ClothModel, substeps: u32) -> Box<dyn Stepper> {
    let builder = DirectXpbd::builder(&model.particles).config(DirectConfig {
        substeps,
        ..DirectConfig::default()
    });
    let builder = builder.energy(model.springs.clone());
    Box::new(builder.energy(model.hinges.clone()).build().unwrap())
}

fn symplectic(model: &ClothModel, substeps: u32) -> Box<dyn Stepper> {
    let builder = SymplecticEuler::builder(&model.particles).config(ExplicitConfig {
        substeps,
        ..ExplicitConfig::default()
    });
    let builder = builder.energy(model.springs.clone());
    let builder = builder.energy(model.hinges.clone());
    Box::new(builder.build().unwrap())
}

type Make = fn(&ClothModel, u32) -> Box<dyn Stepper>;

fn contacts_of(
    mesh: &TriMesh,
    obstacle: Option<Obstacle>,
    friction: Real,
    thickness: Real,
) -> PotentialContacts {
    let builder = PotentialContacts::builder(mesh)
        .thickness(thickness)
        .stiffness(STIFFNESS)
        .friction(friction);
    let builder = match obstacle {
        Some(obstacle) => builder.obstacle(obstacle, friction),
        None => builder,
    };
    builder.build().unwrap()
}

fn contacts(mesh: &TriMesh, obstacle: Option<Obstacle>, friction: Real) -> PotentialContacts {
    contacts_of(mesh, obstacle, friction, THICKNESS)
}

fn step(
    stepper: &mut dyn Stepper,
    contacts: &mut PotentialContacts,
    state: &mut State,
    gravity: Real,
) {
    let input = StepInput::new(DT).gravity(Vec3::z() * -gravity);
    stepper.step(state, input.contacts(contacts)).unwrap();
}

fn floor() -> Obstacle {
    Obstacle::new(HalfSpace::new(Vec3::z()).unwrap())
}

fn lifted(mesh: &TriMesh, by: Real) -> State {
    State::at_rest(
        mesh.positions()
            .iter()
            .map(|x| x + Vec3::z() * by)
            .collect(),
    )
}

fn sheets(one: &TriMesh, shifts: &[Vec3]) -> TriMesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for shift in shifts {
        let first = positions.len() as u32;
        positions.extend(one.positions().iter().map(|x| x + shift));
        triangles.extend(one.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    TriMesh::new(positions, triangles).unwrap()
}

/// The gap of a sheet at rest is h − ρ g/κ, whatever the pattern, the resolution, the method and the substeps, and the
/// potential holds ½ (ρ g)²/κ per area.
#[test]
fn sheet_rests_where_its_weight_says() {
    let gap = THICKNESS - DENSITY * GRAVITY / STIFFNESS;
    for (n, pattern, substeps) in [
        (9, Diagonals::Alternating, 60),
        (13, Diagonals::OneWay, 5),
        (17, Diagonals::Alternating, 20),
    ] {
        let mesh = grid(n, n, 0.5, 0.5, pattern).unwrap();
        let model = model(&mesh);
        let mut cases = vec![(xpbd as Make, substeps), (pbd, substeps)];
        if n == 9 {
            // A factorisation in every substep, and a step that the springs allow.
            cases.extend([(direct as Make, 20), (symplectic, 200)]);
        }
        for (make, substeps) in cases {
            let mut stepper = make(&model, substeps);
            let mut contacts = contacts(&mesh, Some(floor()), 0.0);
            let mut state = lifted(&mesh, THICKNESS);
            for _ in 0..60 {
                step(&mut *stepper, &mut contacts, &mut state, GRAVITY);
            }
            let error = |x: &Vec3| (x.z - gap).abs();
            let worst = state.positions.iter().map(error).fold(0.0, Real::max);
            assert!(worst < 1e-14, "{n} vertices a side: {worst:e}");
            let energy = 0.5 * (DENSITY * GRAVITY).powi(2) / STIFFNESS * 0.25;
            let stored = contacts.potential_energy();
            assert!((stored / energy - 1.0).abs() < 1e-9, "{stored:e} J");
        }
    }
}

/// A sheet on a slope of 30° slides by a h² n (n + 1)/2 in n substeps of h with a = g (sin α − μ cos α) if that is
/// positive, and does not move at all otherwise.
#[test]
fn sheet_on_a_slope_slides_or_sticks() {
    let angle = 30f64.to_radians();
    let (sin, cos) = angle.sin_cos();
    let mesh = grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let model = model(&mesh);
    let gap = THICKNESS - DENSITY * GRAVITY * cos / STIFFNESS;
    let place = |x: &Vec3| Vec3::new(x.x * cos - gap * sin, x.y, x.x * sin + gap * cos);
    let start: Vec<Vec3> = mesh.positions().iter().map(place).collect();
    let way = |state: &State| {
        let ways = state.positions.iter().zip(&start);
        let sum: Real = ways
            .map(|(x, from)| (from - x).dot(&Vec3::new(cos, 0.0, sin)))
            .sum();
        sum / start.len() as Real
    };
    for friction in [0.0, 0.3, 0.58] {
        for (make, substeps) in [(xpbd as Make, 7), (xpbd, 20), (symplectic, 100)] {
            let mut stepper = make(&model, substeps);
            let slope = Obstacle::new(HalfSpace::new(Vec3::new(-sin, 0.0, cos)).unwrap());
            let mut contacts = contacts(&mesh, Some(slope), friction);
            let mut state = State::at_rest(start.clone());
            let (steps, pull) = (30, GRAVITY * (sin - friction * cos));
            for _ in 0..steps {
                step(&mut *stepper, &mut contacts, &mut state, GRAVITY);
            }
            let (n, h) = (Real::from(steps * substeps), DT / Real::from(substeps));
            let expected = (pull * h * h * n * (n + 1.0) / 2.0).max(0.0);
            let found = way(&state);
            assert!(
                (found - expected).abs() < 1e-10,
                "μ = {friction}: {found:e} m for {expected:e} m"
            );
        }
    }
}

/// Cloth that sticks to cloth does not creep: the upper of two sheets on a slope of 15° with μ = 0.3 stays where it is.
#[test]
fn sheet_sticks_to_a_sheet() {
    let one = grid(9, 9, 0.4, 0.4, Diagonals::Alternating).unwrap();
    let shift = Vec3::new(0.013, 0.007, THICKNESS);
    let mesh = sheets(&one, &[Vec3::zeros(), shift]);
    let model = model(&mesh);
    let mut stepper = xpbd(&model, 20);
    let mut contacts = contacts(&mesh, Some(floor()), 0.3);
    let mut state = lifted(&mesh, THICKNESS);
    let (sin, cos) = 15f64.to_radians().sin_cos();
    let gravity = Vec3::new(-sin, 0.0, -cos) * GRAVITY;
    let mut ways = Vec::new();
    for _ in 0..8 {
        for _ in 0..30 {
            let input = StepInput::new(DT).gravity(gravity);
            stepper
                .step(&mut state, input.contacts(&mut contacts))
                .unwrap();
        }
        let moved = state.positions.iter().zip(mesh.positions());
        ways.push(moved.map(|(x, from)| x.x - from.x).fold(0.0, Real::min));
    }
    // It slides as long as it is not pressed yet; the farther, the softer contact is.
    assert!(ways[0] > -3e-5, "{ways:?}");
    assert!((ways[7] - ways[0]).abs() < 1e-12, "{ways:?}");
}

/// Sheets that fall freely, onto a floor or a ball with triangles, are not looked at: after the first step one pass
/// over the positions tells in every substep that nothing is near. Of one that spins some patches are looked into, and
/// no pair of primitives.
#[test]
fn free_fall_is_hardly_looked_at() {
    let flat = grid(33, 33, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let rough = irregular(33, 1.0, 1.0, 5).unwrap();
    let ball = || {
        let builder = PotentialContacts::builder(&flat).thickness(THICKNESS);
        let obstacle = Obstacle::new(Sphere::new(0.3).unwrap());
        let builder = builder.obstacle(obstacle, 0.3);
        builder
            .surface(0, sphere(12, 0.3).unwrap())
            .build()
            .unwrap()
    };
    for (mesh, spin, mut contacts, least) in [
        (&flat, 0.0, contacts(&flat, Some(floor()), 0.3), 100),
        (&rough, 0.0, contacts(&rough, Some(floor()), 0.3), 100),
        (&flat, 1.0, contacts(&flat, Some(floor()), 0.3), 1),
        (&flat, 0.0, ball(), 100),
    ] {
        let model = model(mesh);
        let mut stepper = xpbd(&model, 100);
        let mut state = lifted(mesh, 20.0);
        for (v, x) in state.velocities.iter_mut().zip(mesh.positions()) {
            *v = Vec3::new(3.0, 0.0, spin * (x.x - 0.5));
        }
        step(&mut *stepper, &mut contacts, &mut state, GRAVITY);
        for _ in 0..30 {
            step(&mut *stepper, &mut contacts, &mut state, GRAVITY);
            let report = contacts.constraint_report();
            assert!(report.culled_substeps >= least, "{spin} 1/s: {report:?}");
            assert!(report.queries == 0 && (spin > 0.0 || report.detections == 0));
        }
    }
}

/// Three sheets above each other come to rest, the floor carries all of them, and nothing crosses.
#[test]
fn stack_carries_its_weight() {
    let one = grid(7, 7, 0.3, 0.3, Diagonals::Alternating).unwrap();
    let count = one.vertex_count();
    let ups = [1.0, 2.0, 3.0].map(|up| Vec3::z() * (THICKNESS * up));
    let mesh = sheets(&one, &ups);
    let model = model(&mesh);
    // With 20 substeps it trembles by some mm/s.
    let mut stepper = xpbd(&model, 40);
    let mut contacts = contacts(&mesh, Some(floor()), 0.3);
    let mut state = State::at_rest(mesh.positions().to_vec());
    let mut probe = SeparationProbe::new(&mesh);
    for _ in 0..240 {
        step(&mut *stepper, &mut contacts, &mut state, GRAVITY);
        let seen = probe.measure(&state.positions).unwrap();
        assert_eq!(seen.intersecting_pairs, 0);
    }
    let lowest = state.positions[..count].iter().zip(model.particles.mass());
    let force: Real = lowest
        .map(|(x, m)| STIFFNESS * (THICKNESS - x.z) * m / DENSITY)
        .sum();
    let weight = model.particles.mass().iter().sum::<Real>() * GRAVITY;
    let speed = state.velocities.iter().map(Vec3::norm).fold(0.0, Real::max);
    println!(
        "stack: {:e} of the force, {speed:e} m/s",
        force / weight - 1.0
    );
    assert!((force / weight - 1.0).abs() < 1e-11, "{force} N");
    assert!(speed < 1e-12, "{speed} m/s");
}

/// A sheet falls on a ball and wraps it: without a crossing and with all vertices outside after every step, and, with
/// enough substeps, without energy from nowhere.
#[test]
fn sheet_falls_on_a_ball() {
    let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let mesh = sheets(&mesh, &[Vec3::new(-0.5, -0.5, 0.15)]);
    let model = model(&mesh);
    let energies = model.energies().unwrap();
    let gravity = Vec3::z() * -GRAVITY;
    let total = |state: &State, stored: Real| {
        kinetic_energy(&model.particles, &state.velocities)
            + gravitational_energy(&model.particles, &state.positions, gravity)
            + energies.value(&state.positions)
            + stored
    };
    let ball = Obstacle::new(Sphere::new(0.1).unwrap());
    // With the most energy from nowhere (J), of which few substeps and the sweeps of PBD make some.
    let cases: [(&str, Make, u32, Real); 5] = [
        ("symplectic-euler", symplectic, 200, 2e-5),
        ("pbd", pbd, 1, Real::INFINITY),
        ("pbd", pbd, 10, Real::INFINITY),
        ("xpbd", xpbd, 20, Real::INFINITY),
        ("xpbd", xpbd, 240, 0.0),
    ];
    for (name, make, substeps, allowed) in cases {
        let mut stepper = make(&model, substeps);
        let mut contacts = contacts(&mesh, Some(ball.clone()), 0.3);
        let mut state = State::at_rest(mesh.positions().to_vec());
        let mut probe = SeparationProbe::new(&mesh);
        let start = total(&state, 0.0);
        let mut most = Real::NEG_INFINITY;
        for step_number in 1..=45 {
            step(&mut *stepper, &mut contacts, &mut state, GRAVITY);
            let at = format!("{name}, {substeps} substeps, step {step_number}");
            let seen = probe.measure(&state.positions).unwrap();
            assert_eq!(seen.intersecting_pairs, 0, "{at}");
            let clearance = |x: &Vec3| ball.signed_distance(*x, 0.0).value;
            let least = state.positions.iter().map(clearance).fold(1.0, Real::min);
            assert!(least > 0.0, "{at}: {least} m");
            let now = total(&state, contacts.potential_energy()) - start;
            most = most.max(now);
        }
        println!("{name}, {substeps} substeps: {most:e} J");
        assert!(most <= allowed, "{name}, {substeps} substeps: {most} J");
    }
}

/// Two sheets meet in free flight, and come apart slower than they met: linear momentum is kept in every step in which
/// no displacement is truncated. What is truncated, at 60 m/s, gives its momentum to nobody.
#[test]
fn sheets_that_meet_keep_their_momentum() {
    let one = grid(9, 9, 0.4, 0.4, Diagonals::Alternating).unwrap();
    let count = one.vertex_count();
    let mesh = sheets(&one, &[Vec3::zeros(), Vec3::new(0.013, 0.007, 0.02)]);
    let model = model(&mesh);
    for (make, speed, substeps, most) in [
        (xpbd as Make, 1.0, 20, 0.035),
        (xpbd, 60.0, 20, 3.0),
        (xpbd, 60.0, 1, 3.0),
        // It loses nothing: what has stored the blow gives it back.
        (symplectic, 1.0, 200, 0.67),
    ] {
        let mut stepper = make(&model, substeps);
        let mut contacts = contacts(&mesh, None, 0.2);
        let mut state = State::at_rest(mesh.positions().to_vec());
        state.velocities[count..].fill(Vec3::z() * -speed);
        let momentum = |state: &State| -> Vec3 {
            let both = state.velocities.iter().zip(model.particles.mass());
            both.map(|(v, m)| v * *m).sum()
        };
        let whole = momentum(&state).norm();
        let kinetic = |state: &State| kinetic_energy(&model.particles, &state.velocities);
        let start = kinetic(&state);
        let mut probe = SeparationProbe::new(&mesh);
        for _ in 0..10 {
            let before = momentum(&state);
            step(&mut *stepper, &mut contacts, &mut state, 0.0);
            let seen = probe.measure(&state.positions).unwrap();
            assert_eq!(seen.intersecting_pairs, 0, "{speed} m/s");
            let change = (momentum(&state) - before).norm() / whole;
            let is_held = contacts.truncated_count() > 0;
            assert!(is_held || change < 2e-13, "{speed} m/s: {change:e}");
            assert!(!is_held || speed > 1.0, "{speed} m/s");
        }
        assert!(kinetic(&state) <= start);
        let mean = |v: &[Vec3]| v.iter().map(|v| v.z).sum::<Real>() / v.len() as Real;
        let apart = mean(&state.velocities[count..]) - mean(&state.velocities[..count]);
        assert!((0.0..most).contains(&apart), "{speed} m/s: {apart} m/s");
    }
}

/// A floor that moves sideways takes a sheet along, and works what becomes of its motion and of friction; a floor that
/// rises carries it.
#[test]
fn moving_floor_takes_a_sheet_along() {
    let mesh = grid(9, 9, 0.4, 0.4, Diagonals::Alternating).unwrap();
    let model = model(&mesh);
    let gap = THICKNESS - DENSITY * GRAVITY / STIFFNESS;
    for velocity in [Vec3::new(0.05, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.02)] {
        let motion = RigidMotion {
            velocity,
            ..RigidMotion::still(Pose::default())
        };
        let floor = Obstacle::moving(HalfSpace::new(Vec3::z()).unwrap(), motion).unwrap();
        let mut contacts = contacts(&mesh, Some(floor), 0.3);
        let mut stepper = xpbd(&model, 20);
        let mut state = lifted(&mesh, gap);
        let (steps, mut work) = (60, 0.0);
        for _ in 0..steps {
            step(&mut *stepper, &mut contacts, &mut state, GRAVITY);
            work += contacts.work();
        }
        let mass: Real = model.particles.mass().iter().sum();
        let off = state.velocities.iter().map(|v| (v - velocity).norm());
        let off = off.fold(0.0, Real::max);
        let speed = velocity.norm();
        let lift = velocity.z * DT * Real::from(steps);
        let expected = mass * (speed * speed + GRAVITY * lift);
        assert!(off < 1e-9 * speed, "{off:e} m/s");
        assert!(
            (work / expected - 1.0).abs() < 0.01,
            "{work:e} J for {expected:e} J"
        );
    }
}

/// A thickness larger than the edges pushes nothing away from its rest.
#[test]
fn thick_sheet_at_rest_stays() {
    let mesh = grid(17, 17, 0.4, 0.4, Diagonals::Alternating).unwrap();
    let model = model(&mesh);
    let mut contacts = contacts_of(&mesh, None, 0.3, 0.04);
    let mut stepper = xpbd(&model, 5);
    let mut state = State::at_rest(mesh.positions().to_vec());
    for _ in 0..5 {
        step(&mut *stepper, &mut contacts, &mut state, 0.0);
    }
    let moved = state.positions.iter().zip(mesh.positions());
    let most = moved
        .map(|(x, from)| (x - from).norm())
        .fold(0.0, Real::max);
    assert!(most < 1e-15, "{most:e} m");
}

/// A start that passes through itself is refused, and leaves no trace; nothing is allocated once warm.
#[test]
fn tangled_starts_are_refused_and_nothing_is_allocated() {
    let one = grid(5, 5, 0.2, 0.2, Diagonals::Alternating).unwrap();
    let mesh = sheets(
        &one,
        &[Vec3::z() * THICKNESS, Vec3::z() * (2.0 * THICKNESS)],
    );
    let model = model(&mesh);
    let mut contacts = contacts(&mesh, Some(floor()), 0.3);
    let mut stepper = xpbd(&model, 10);
    let mut state = State::at_rest(mesh.positions().to_vec());
    for _ in 0..3 {
        step(&mut *stepper, &mut contacts, &mut state, GRAVITY);
    }
    let mut crossed = state.clone();
    crossed.positions[12].z += 2.0 * THICKNESS;
    let input = StepInput::new(DT).contacts(&mut contacts);
    let refused = stepper.step(&mut crossed, input).unwrap_err();
    let tangled = matches!(
        refused,
        StepError::Contact {
            reason: ContactError::IntersectingStart { .. },
            ..
        }
    );
    assert!(tangled, "{refused}");
    let count = allocations_once_warm(|| step(&mut *stepper, &mut contacts, &mut state, GRAVITY));
    assert_eq!(count, 0);
}

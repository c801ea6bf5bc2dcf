//! The work of prescribed vertices that move, against the momentum that they give.

use cloth_core::element::Constraint;
use cloth_core::energy::{Attachment, CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, DirectXpbd};
use cloth_xpbd::single::{SingleConfig, SingleXpbd};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

const VELOCITY: Vec3 = Vec3::new(0.7, 0.0, 1.9);
const MASS: Real = 0.03;
/// In single precision positions are rounded to 6e-8 of the size of the cloth, which a substep turns into some
/// 5e-5 m/s; relative to what the first step gives.
const SINGLE: Real = 6e-4;

/// Vertex 0 is prescribed and moves with [`VELOCITY`], all others are at rest.
fn pulled(positions: Vec<Vec3>) -> (Particles, State) {
    let mut particles = Particles::new(vec![MASS; positions.len()]).unwrap();
    particles.prescribe(0).unwrap();
    let mut state = State::at_rest(positions);
    state.velocities[0] = VELOCITY;
    (particles, state)
}

/// Seven springs in a row, along which they are pulled.
fn chain(stiffness: Real) -> (Particles, State, Vec<Spring>) {
    let along = VELOCITY.normalize() * -0.1;
    let (particles, state) = pulled((0..8).map(|i| along * Real::from(i)).collect());
    let spring = |i| Spring {
        vertices: [i, i + 1],
        rest_length: 0.1,
        stiffness,
    };
    (particles, state, (0..7).map(spring).collect())
}

/// Forces that act between vertices give no momentum but that of the pin, and the pin does the work `V·p` in
/// giving it: the largest error over 30 steps, relative to that.
fn error(solver: &mut dyn Stepper, mut state: State) -> Real {
    let (mut work, mut error) = (0.0, 0.0);
    for _ in 0..30 {
        let report = solver.step(&mut state, StepInput::new(1.0 / 60.0)).unwrap();
        work += report.pin_work.expect("it is added up");
        let momentum: Vec3 = state.velocities[1..].iter().map(|v| v * MASS).sum();
        let given = VELOCITY.dot(&momentum);
        assert!(given > 1e-6, "{given}");
        error = Real::max(error, (work / given - 1.0).abs());
    }
    error
}

fn xpbd<const N: usize, E: Constraint<N>>(
    (particles, state, elements): (Particles, State, Vec<E>),
    config: XpbdConfig,
) -> Real {
    let builder = XpbdSolver::builder(&particles).energy(elements);
    error(&mut builder.config(config).build().unwrap(), state)
}

#[test]
fn what_a_pin_gives_a_chain_is_the_work_it_does() {
    for stiffness in [50.0, 2e3, Real::INFINITY] {
        for (substeps, iterations, damping) in [(1, 1, 0.0), (20, 1, 0.0), (5, 3, 0.01)] {
            let config = XpbdConfig {
                substeps,
                iterations,
                damping,
                ..XpbdConfig::default()
            };
            let swept = xpbd(chain(stiffness), config);
            assert!(swept < 1e-11, "{stiffness} {config:?}: {swept:e}");
        }
        let (particles, state, springs) = chain(stiffness);
        let config = SingleConfig {
            substeps: 20,
            iterations: 1,
        };
        let builder = SingleXpbd::builder(&particles).springs(&springs);
        let single = error(&mut builder.config(config).build().unwrap(), state.clone());
        assert!(single < SINGLE, "{stiffness}: single precision: {single:e}");
        let builder = DirectXpbd::builder(&particles).energy(springs);
        let config = DirectConfig::default();
        let direct = error(&mut builder.config(config).build().unwrap(), state);
        assert!(direct < 1e-9, "{stiffness}: direct: {direct:e}");
        println!("{stiffness}: single {single:e}, direct {direct:e}");
    }
}

#[test]
fn what_a_pin_gives_through_a_hinge_is_the_work_it_does() {
    let corners = [[0.0, 1.0], [0.0, -1.0], [-1.0, 0.0], [1.0, 0.0]];
    let corners = corners.map(|[x, y]| Vec3::new(0.1 * x, 0.1 * y, 0.0));
    let (particles, state) = pulled(corners.to_vec());
    let hinge = CurvatureHinge::new([0, 1, 2, 3], &corners, 0.5);
    let swept = xpbd(
        (particles.clone(), state.clone(), vec![hinge]),
        XpbdConfig::default(),
    );
    assert!(swept < 1e-12, "{swept:e}");
    let builder = SingleXpbd::builder(&particles).vector_rows(&[hinge]);
    let single = error(&mut builder.build().unwrap(), state);
    assert!(single < SINGLE, "{single:e}");
    println!("hinge: {swept:e}, single {single:e}");
}

#[test]
fn pins_that_stand_still_do_no_work() {
    let (particles, mut state, springs) = chain(2e3);
    state.velocities[0] = Vec3::zeros();
    let mut solver = XpbdSolver::builder(&particles)
        .energy(springs)
        .build()
        .unwrap();
    let input = StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, -9.81, 0.0));
    assert_eq!(solver.step(&mut state, input).unwrap().pin_work, Some(0.0));
}

/// No force is found between two pins that a rigid spring ties, however they move.
#[test]
fn pins_that_a_rigid_spring_ties_do_no_work_in_either_precision() {
    let mut particles = Particles::new(vec![MASS; 2]).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(1).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 0.1,
        stiffness: Real::INFINITY,
    };
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x() * 0.1]);
    state.velocities[0] = VELOCITY;
    let mut double = XpbdSolver::builder(&particles)
        .energy(vec![spring])
        .build()
        .unwrap();
    let attachment = Attachment {
        vertex: 0,
        target: Vec3::zeros(),
        stiffness: Real::INFINITY,
    };
    let mut single = SingleXpbd::builder(&particles)
        .springs(&[spring])
        .vector_rows(&[attachment])
        .build()
        .unwrap();
    let solvers: [&mut dyn Stepper; 2] = [&mut double, &mut single];
    for solver in solvers {
        let mut state = state.clone();
        let report = solver.step(&mut state, StepInput::new(1.0 / 60.0)).unwrap();
        assert_eq!(report.pin_work, Some(0.0));
    }
}

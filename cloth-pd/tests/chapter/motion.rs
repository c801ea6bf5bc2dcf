//! Laws of motion that do not ask for convergence.

use crate::cloth::{
    DT, GRAVITY, distance, falling, hanging, iterations, noise, shake, sheet, solver,
};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::linear_momentum;
use cloth_core::particles::{Particles, State};
use cloth_core::pin::Pins;
use cloth_core::step::{StepInput, Stepper};
use cloth_pd::{PdConfig, PdSolver, StartGuess};

#[test]
fn free_fall_does_not_deform() {
    let (model, mut state) = sheet(9, 1e4);
    let rest = state.positions.clone();
    let mut solver = solver(&model, iterations(3));
    for n in 1..=60 {
        solver.step(&mut state, falling()).unwrap();
        // Implicit Euler: the velocity after n steps is n Δt g.
        let fall = GRAVITY * (DT * DT * Real::from(n * (n + 1)) / 2.0);
        let expected: Vec<Vec3> = rest.iter().map(|x| x + fall).collect();
        let error = distance(&state.positions, &expected);
        assert!(error < 1e-14 * Real::from(n), "step {n}: {error:e}");
    }
    assert_eq!(state.steps, 60);
    assert!((state.time - 1.0).abs() < 1e-14);
}

#[test]
fn momentum_of_a_free_cloth_is_conserved_by_every_iteration() {
    for count in [1, 2, 10] {
        let (model, mut state) = sheet(9, 1e4);
        shake(&model, &mut state, 0.05);
        state.velocities = noise(state.positions.len());
        let momentum = linear_momentum(&model.particles, &state.velocities);
        let mut solver = solver(&model, iterations(count));
        for _ in 0..20 {
            solver.step(&mut state, StepInput::new(DT)).unwrap();
        }
        let change = linear_momentum(&model.particles, &state.velocities) - momentum;
        assert!(
            change.norm() < 1e-12,
            "{count} iterations: {:e} kg m/s",
            change.norm()
        );
    }
}

#[test]
fn a_load_accelerates_the_centre_of_mass_by_force_over_mass() {
    let (model, mut state) = sheet(5, 1e3);
    let load = noise(state.positions.len());
    let input = StepInput::new(DT).gravity(GRAVITY).load(&load);
    solver(&model, iterations(2))
        .step(&mut state, input)
        .unwrap();
    let mass: Real = model.particles.mass().iter().sum();
    let expected = (load.iter().sum::<Vec3>() + GRAVITY * mass) * DT;
    let momentum = linear_momentum(&model.particles, &state.velocities);
    assert!((momentum - expected).norm() < 1e-14);
}

#[test]
fn held_vertices_do_not_move_by_a_bit() {
    let (model, mut state) = hanging(9, 1e4);
    let rest = state.positions.clone();
    let mut solver = solver(&model, iterations(5));
    for _ in 0..10 {
        solver.step(&mut state, falling()).unwrap();
    }
    for vertex in [72, 80] {
        assert_eq!(state.positions[vertex], rest[vertex]);
        assert_eq!(state.velocities[vertex], Vec3::zeros());
    }
    assert!(state.positions[4].z < -0.05);
}

#[test]
fn moving_pins_are_followed_and_keep_their_velocity() {
    let (mut model, mut state) = sheet(9, 1e3);
    let mut pins = Pins::new();
    let path = |t: Real| Vec3::new(0.3 * t, 1.0 + 0.2 * (5.0 * t).sin(), t);
    pins.add_path(&mut model.particles, 72, path).unwrap();
    let mut solver = solver(&model, iterations(5));
    for _ in 0..30 {
        pins.set_velocities(&mut state, DT).unwrap();
        let velocity = state.velocities[72];
        let goal = state.positions[72] + velocity * DT;
        solver.step(&mut state, falling()).unwrap();
        assert_eq!(state.positions[72], goal);
        assert_eq!(state.velocities[72], velocity);
        assert!((state.positions[72] - path(state.time)).norm() < 1e-14);
    }
}

#[test]
fn a_cloth_that_travels_with_its_pins_does_not_deform() {
    let (model, mut state) = hanging(9, 1e4);
    let rest = state.positions.clone();
    let velocity = Vec3::new(1.0, -2.0, 0.5);
    state.velocities.fill(velocity);
    let mut solver = solver(&model, iterations(1));
    for _ in 0..10 {
        solver.step(&mut state, StepInput::new(DT)).unwrap();
    }
    let expected: Vec<Vec3> = rest.iter().map(|x| x + velocity * (10.0 * DT)).collect();
    assert!(distance(&state.positions, &expected) < 3e-15);
    assert!(distance(&state.velocities, &vec![velocity; rest.len()]) < 3e-14);
}

#[test]
fn far_from_the_origin_an_error_is_the_rounding_of_the_positions() {
    // Coordinates that are multiples of 1/64 are exact near and far, and so are the differences.
    let (model, mut near) = hanging(9, 1e4);
    for (vertex, shift) in noise(81).into_iter().enumerate() {
        near.positions[vertex] += (shift * 3.0).map(|c| c.round() / 64.0);
    }
    let mut far = near.clone();
    let offset = Vec3::new(8192.0, -4096.0, 16384.0);
    far.positions.iter_mut().for_each(|x| *x += offset);
    let step = |state| {
        solver(&model, iterations(1))
            .step(state, falling())
            .unwrap()
    };
    step(&mut near);
    step(&mut far);
    // x̃ is rounded to 2e-12 m far away.
    let error = distance(&near.velocities, &far.velocities) * DT;
    assert!(error < 4e-12, "{error:e} m");
}

#[test]
fn the_first_projection_sees_pins_where_they_will_be() {
    let (mass, stiffness, rest_length) = (0.3, 50.0, 1.0);
    let mut particles = Particles::new(vec![1.0, mass]).unwrap();
    particles.prescribe(0).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length,
        stiffness,
    };
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
    state.velocities[0] = Vec3::y() / DT;
    let config = PdConfig {
        start: StartGuess::Previous,
        ..iterations(1)
    };
    let builder = PdSolver::builder(&particles).energy(vec![spring]);
    builder
        .config(config)
        .build()
        .unwrap()
        .step(&mut state, StepInput::new(DT))
        .unwrap();
    // The pin moves to (0, 1, 0) and wants the other end at a distance L in its present direction.
    let wanted = Vec3::y() + (Vec3::x() - Vec3::y()).normalize() * rest_length;
    let pull = DT * DT * stiffness;
    let expected = (Vec3::x() * mass + wanted * pull) / (mass + pull);
    assert!((state.positions[1] - expected).norm() < 1e-15);
}

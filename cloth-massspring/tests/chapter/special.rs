//! Pins, and the odd cases: nothing to do, nothing to move, springs without length.

use crate::{DOWN, all, chain, hang, noise};
use cloth_core::math::Vec3;
use cloth_core::particles::{Particles, State};
use cloth_core::pin::Pins;
use cloth_core::step::StepInput;

#[test]
fn pins_hold_to_the_bit() {
    let (particles, springs, positions) = chain(4, 1e3);
    for solver in &mut all(&particles, &springs) {
        let mut state = State::at_rest(positions.clone());
        for _ in 0..20 {
            solver
                .step(&mut state, StepInput::new(1e-3).gravity(DOWN))
                .unwrap();
        }
        assert_eq!(state.positions[0], positions[0]);
        assert_eq!(state.velocities[0], Vec3::zeros());
        assert_eq!(state.steps, 20);
        assert!((state.time - 0.02).abs() < 1e-15);
    }
}

#[test]
fn moving_pins_follow_their_path_and_keep_their_velocity() {
    let (mut particles, springs, positions) = chain(4, 1e3);
    let mut pins = Pins::new();
    let path = |time: f64| Vec3::new(time, 3.0 * time * time, 0.0);
    pins.add_path(&mut particles, 0, path).unwrap();
    for solver in &mut all(&particles, &springs) {
        let mut state = State::at_rest(positions.clone());
        for _ in 0..50 {
            pins.set_velocities(&mut state, 1e-3).unwrap();
            let velocity = state.velocities[0];
            solver
                .step(&mut state, StepInput::new(1e-3).gravity(DOWN))
                .unwrap();
            assert_eq!(state.velocities[0], velocity);
            assert!((state.positions[0] - path(state.time)).amax() < 1e-15);
        }
        assert!(state.positions[1].x > 0.0, "the chain is dragged along");
    }
}

#[test]
fn the_velocity_of_a_pin_is_not_computed_from_where_it_went() {
    // At these coordinates the difference of two positions has lost half of its digits.
    let (particles, springs, positions) = chain(1, 1e3);
    for solver in &mut all(&particles, &springs) {
        let shift = Vec3::repeat(1e8 / 3.0);
        let mut state = State::at_rest(positions.iter().map(|x| x + shift).collect());
        state.velocities[0] = Vec3::new(0.1, 0.2, 0.3);
        solver.step(&mut state, StepInput::new(1e-3)).unwrap();
        assert_eq!(state.velocities[0], Vec3::new(0.1, 0.2, 0.3));
    }
}

#[test]
fn a_cloth_collapsed_to_a_point_stays_finite_and_unfolds() {
    let (_, model) = hang(5);
    for solver in &mut all(&model.particles, &model.springs) {
        let mut state = State::at_rest(vec![Vec3::new(0.3, 0.2, 0.1); 25]);
        for _ in 0..5 {
            solver.step(&mut state, StepInput::new(1e-4)).unwrap();
        }
        let spread = (state.positions[0] - state.positions[12]).norm();
        assert!(spread > 1e-4, "{}: {spread}", solver.name());
    }
}

#[test]
fn a_vertex_without_springs_falls_freely() {
    let (particles, springs, mut positions) = chain(2, 1e3);
    let mut mass = particles.mass().to_vec();
    mass.push(7.0);
    let mut particles = Particles::new(mass).unwrap();
    particles.prescribe(0).unwrap();
    positions.push(Vec3::x());
    let bdf2 = 0.5 * (16.0 + 1.5 * (1.0 - (1.0 / 3.0_f64).powi(4)));
    let sums = [6.0, 10.0, 10.0, 10.0, 8.0, bdf2];
    for (solver, sum) in all(&particles, &springs).iter_mut().zip(sums) {
        let mut state = State::at_rest(positions.clone());
        for _ in 0..4 {
            solver
                .step(&mut state, StepInput::new(0.01).gravity(DOWN))
                .unwrap();
        }
        let expected = Vec3::x() + DOWN * (1e-4 * sum);
        assert!(
            (state.positions[3] - expected).amax() < 1e-14,
            "{}",
            solver.name()
        );
    }
}

#[test]
fn without_energies_everything_falls_freely() {
    let particles = Particles::new(vec![1.0, 1e-6, 1e6]).unwrap();
    for solver in &mut all(&particles, &[]) {
        let mut state = State::at_rest((0..3).map(noise).collect());
        solver
            .step(&mut state, StepInput::new(0.1).gravity(DOWN))
            .unwrap();
        for v in &state.velocities {
            assert!((v - DOWN * 0.1).amax() < 1e-14, "{}: {v}", solver.name());
        }
    }
}

#[test]
fn with_all_vertices_prescribed_only_they_move() {
    let (mut particles, springs, positions) = chain(2, 1e3);
    (0..3).for_each(|vertex| particles.prescribe(vertex).unwrap());
    for solver in &mut all(&particles, &springs) {
        let mut state = State::at_rest(positions.clone());
        state.velocities[1] = Vec3::x();
        solver
            .step(&mut state, StepInput::new(0.5).gravity(DOWN))
            .unwrap();
        assert_eq!(state.positions[0], positions[0]);
        assert_eq!(state.positions[1], positions[1] + Vec3::x() * 0.5);
        assert_eq!(state.velocities[1], Vec3::x());
    }
}

//! Cloths at the edge of what is a cloth.

use crate::cloth::{
    DT, GRAVITY, distance, falling, hanging, iterations, potential, sheet, solver, to_tolerance,
};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepError, StepInput, Stepper};
use cloth_pd::{PdConfig, PdSolver};

#[test]
fn without_elements_everything_falls_freely() {
    let particles = Particles::new(vec![0.1, 20.0]).unwrap();
    let fall = GRAVITY * (DT * DT);
    for config in [iterations(2), to_tolerance(1e-9)] {
        let mut solver = PdSolver::builder(&particles)
            .config(config)
            .build()
            .unwrap();
        let mut state = State::at_rest(vec![Vec3::zeros(); 2]);
        solver.step(&mut state, falling()).unwrap();
        assert!(state.positions.iter().all(|x| (x - fall).norm() < 1e-18));
    }
}

#[test]
fn nothing_is_iterated_where_the_prediction_is_the_solution() {
    let particles = Particles::new(vec![0.1, 20.0]).unwrap();
    let mut solver = PdSolver::builder(&particles)
        .config(to_tolerance(1e-9))
        .build()
        .unwrap();
    let report = solver
        .step(&mut State::at_rest(vec![Vec3::zeros(); 2]), falling())
        .unwrap();
    assert_eq!((report.outcome, report.iterations), (Outcome::Converged, 0));
    assert_eq!(report.residual, Some(0.0));
}

#[test]
fn with_all_vertices_prescribed_each_follows_its_velocity() {
    let (mut model, mut state) = sheet(5, 1e4);
    (0..25).for_each(|vertex| model.particles.prescribe(vertex).unwrap());
    for config in [PdConfig::default(), to_tolerance(1e-9)] {
        state.velocities = crate::cloth::noise(25);
        let before = state.clone();
        let report = solver(&model, config).step(&mut state, falling()).unwrap();
        assert_eq!(
            (report.outcome, report.iterations, report.factorizations),
            (Outcome::Converged, 0, 0)
        );
        for vertex in 0..25 {
            assert_eq!(
                state.positions[vertex],
                before.positions[vertex] + before.velocities[vertex] * DT
            );
        }
        assert_eq!(state.velocities, before.velocities);
    }
}

#[test]
fn an_empty_cloth_takes_a_step() {
    let particles = Particles::new(Vec::new()).unwrap();
    let mut state = State::default();
    PdSolver::builder(&particles)
        .build()
        .unwrap()
        .step(&mut state, falling())
        .unwrap();
    assert_eq!(state.steps, 1);
}

#[test]
fn disconnected_pieces_do_not_feel_each_other() {
    let particles = Particles::new(vec![0.1, 0.2, 0.3, 0.4, 0.5]).unwrap();
    let spring = |vertices| Spring {
        vertices,
        rest_length: 1.0,
        stiffness: 30.0,
    };
    let positions: Vec<Vec3> = [0.0, 2.0, 10.0, 10.5, 20.0]
        .map(|x| Vec3::new(x, 0.0, 0.0))
        .into();
    let step = |springs: Vec<Spring>| {
        let mut solver = PdSolver::builder(&particles)
            .energy(springs)
            .build()
            .unwrap();
        let mut state = State::at_rest(positions.clone());
        solver.step(&mut state, falling()).unwrap();
        state.positions
    };
    let both = step(vec![spring([0, 1]), spring([2, 3])]);
    let (first, second) = (step(vec![spring([0, 1])]), step(vec![spring([2, 3])]));
    assert!(distance(&both[..2], &first[..2]) < 1e-15);
    assert!(distance(&both[2..4], &second[2..4]) < 1e-15);
    assert!((both[4] - second[4]).norm() < 1e-15);
}

#[test]
fn springs_without_stiffness_are_no_springs() {
    let (model, mut state) = hanging(5, 0.0);
    let mut without = state.clone();
    solver(&model, iterations(5))
        .step(&mut state, falling())
        .unwrap();
    let mut other = PdSolver::builder(&model.particles)
        .energy(model.hinges.clone())
        .config(iterations(5))
        .build()
        .unwrap();
    other.step(&mut without, falling()).unwrap();
    assert_eq!(state, without);
}

#[test]
fn very_stiff_springs_hold_or_are_refused() {
    for stiffness in [1e6, 1e8, 1e10, 1e12, 1e14, 1e16, 1e18, 1e300] {
        for (model, mut state) in [hanging(9, stiffness), sheet(9, stiffness)] {
            let before = state.clone();
            let mut solver = solver(&model, iterations(10));
            match solver.step(&mut state, falling()) {
                Ok(_) => assert!(distance(&state.positions, &before.positions) < 0.01),
                Err(error) => {
                    assert_eq!(
                        error,
                        StepError::NotPositiveDefinite {
                            iteration: 1,
                            step: 1
                        }
                    );
                    assert_eq!(state, before);
                    assert!(stiffness > 1e12, "{stiffness:e}");
                }
            }
        }
    }
}

#[test]
fn a_cloth_collapsed_to_a_point_unfolds() {
    let (model, mut state) = hanging(7, 1e3);
    let rest = state.positions.clone();
    state.positions.fill(rest[48]);
    let mut solver = solver(&model, iterations(10));
    for _ in 0..100 {
        solver.step(&mut state, falling()).unwrap();
    }
    assert_eq!(state.first_non_finite(), None);
    let longest = state
        .positions
        .iter()
        .map(|x| (x - rest[48]).norm())
        .fold(0.0, Real::max);
    assert!(longest > 0.5, "{longest}");
}

#[test]
fn springs_of_no_length_pull_their_ends_together() {
    let particles = Particles::new(vec![0.1, 0.1]).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 0.0,
        stiffness: 1e3,
    };
    let mut solver = PdSolver::builder(&particles)
        .energy(vec![spring])
        .build()
        .unwrap();
    let mut together = State::at_rest(vec![Vec3::zeros(); 2]);
    let mut apart = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
    solver.step(&mut together, falling()).unwrap();
    assert_eq!(together.positions[0], together.positions[1]);
    solver.step(&mut apart, falling()).unwrap();
    // Two masses m: the distance falls by 1/(1 + 2 Δt² k/m).
    let expected = 1.0 / (1.0 + 2.0 * DT * DT * 1e3 / 0.1);
    let gap = (apart.positions[1] - apart.positions[0]).norm();
    assert!((gap / expected - 1.0).abs() < 1e-13, "{gap}");
}

#[test]
fn masses_may_differ_a_millionfold() {
    let (mut model, mut state) = hanging(5, 1e3);
    for vertex in (0..25).step_by(3) {
        let mass = model.particles.mass()[vertex];
        model.particles.set_mass(vertex, mass * 1e6).unwrap();
    }
    let before = state.clone();
    solver(&model, to_tolerance(1e-10))
        .step(&mut state, falling())
        .unwrap();
    let (_, gradient) = potential(&model, &before, &falling(), &state.positions);
    assert!(gradient < 1e-9, "{gradient:e}");
}

#[test]
fn a_pin_that_leaves_the_numbers_is_an_error() {
    let mut particles = Particles::new(vec![0.1, 0.1]).unwrap();
    particles.prescribe(1).unwrap();
    let mut solver = PdSolver::builder(&particles).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::repeat(1.7e308)]);
    state.velocities[1] = Vec3::repeat(1e308);
    let before = state.clone();
    let error = solver.step(&mut state, StepInput::new(1.0)).unwrap_err();
    assert_eq!(error, StepError::NonFinite { vertex: 1, step: 1 });
    assert_eq!(state, before);
}

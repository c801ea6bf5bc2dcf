//! Input that makes no sense: an error that names the thing and a state left alone, or a step that is finite.
//! Never a panic, never a number that is none.

use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepError, StepInput, Stepper};
use cloth_pbd::{PbdConfig, PbdSolver};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

fn spring(rest_length: Real, stiffness: Real) -> Vec<Spring> {
    let vertices = [0, 1];
    vec![Spring {
        vertices,
        rest_length,
        stiffness,
    }]
}

fn solver(springs: Vec<Spring>, particles: &Particles) -> PbdSolver {
    PbdSolver::builder(particles)
        .energy(springs)
        .build()
        .unwrap()
}

fn apart(distance: Real) -> State {
    State::at_rest(vec![Vec3::zeros(), Vec3::new(distance, 0.0, 0.0)])
}

/// Takes a step; finite, or refused with the state as it was.
fn finite_or_refused(solver: &mut PbdSolver, mut state: State, dt: Real) {
    let before = state.clone();
    let step = solver.step(&mut state, StepInput::new(dt).gravity(GRAVITY));
    match step {
        Ok(_) => assert_eq!(state.first_non_finite(), None, "{solver:?}"),
        Err(error) => assert!(state == before, "{error}"),
    }
}

#[test]
fn the_largest_and_smallest_numbers_end_in_finite_steps_or_errors() {
    let numbers = [
        0.0,
        Real::MIN_POSITIVE,
        1e-200,
        1e-30,
        1.0,
        1e30,
        1e200,
        Real::MAX,
    ];
    for rest_length in numbers {
        for stiffness in numbers.into_iter().chain([Real::INFINITY]) {
            for mass in [1e-30, 1.0, 1e30] {
                for dt in [1e-200, 1e-12, 1.0, 1e12] {
                    for distance in [0.0, 1e-200, 1.0, 1e150] {
                        let particles = Particles::new(vec![mass, 1.0]).unwrap();
                        let mut solver = solver(spring(rest_length, stiffness), &particles);
                        finite_or_refused(&mut solver, apart(distance), dt);
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_not_a_number_is_refused() {
    let particles = Particles::new(vec![1.0; 2]).unwrap();
    for (rest_length, stiffness, name) in [
        (Real::NAN, 1.0, "rest length"),
        (1.0, Real::NAN, "stiffness"),
        (Real::INFINITY, 1.0, "rest length"),
    ] {
        let springs = [spring(1.0, 1.0), spring(rest_length, stiffness)].concat();
        let builder = PbdSolver::builder(&particles).energy(spring(1.0, 1.0));
        let error = builder.energy(springs).build().unwrap_err().to_string();
        let begins = format!("element 1 of family 1 (Spring): the {name}");
        assert!(error.starts_with(&begins), "{error}");
    }
    let mut solver = solver(spring(1.0, 1.0), &particles);
    for dt in [0.0, -1.0, Real::NAN, Real::INFINITY] {
        let error = solver
            .step(&mut apart(2.0), StepInput::new(dt))
            .unwrap_err();
        assert!(matches!(error, StepError::InvalidTimeStep { .. }), "{dt}");
    }
    let error = solver
        .step(&mut apart(Real::NAN), StepInput::new(0.1))
        .unwrap_err();
    assert!(matches!(
        error,
        StepError::NonFiniteInput {
            vertex: Some(1),
            ..
        }
    ));
    let input = StepInput::new(0.1).gravity(Vec3::new(0.0, Real::INFINITY, 0.0));
    let error = solver.step(&mut apart(2.0), input).unwrap_err();
    assert!(matches!(
        error,
        StepError::NonFiniteInput {
            what: "gravity",
            ..
        }
    ));
    let load = [Vec3::zeros(), Vec3::repeat(Real::NAN)];
    let error = solver
        .step(&mut apart(2.0), StepInput::new(0.1).load(&load))
        .unwrap_err();
    assert!(matches!(
        error,
        StepError::NonFiniteInput {
            vertex: Some(1),
            ..
        }
    ));
    // And it still works.
    solver.step(&mut apart(2.0), StepInput::new(0.1)).unwrap();
}

#[test]
fn a_negative_stiffness_pushes_away_or_the_result_is_refused() {
    let particles = Particles::new(vec![1.0; 2]).unwrap();
    let dt = 0.01;
    let mut weak = solver(spring(1.0, -1.0), &particles);
    let mut state = apart(2.0);
    weak.step(&mut state, StepInput::new(dt)).unwrap();
    // k h² w̃ = −2·10⁻⁴.
    let length = (state.positions[1] - state.positions[0]).norm();
    assert!(
        (length - 1.0 - 1.0 / (1.0 - 2e-4)).abs() < 1e-12,
        "{length}"
    );
    for stiffness in [-1e4, -1e6, Real::NEG_INFINITY] {
        let mut solver = solver(spring(1.0, stiffness), &particles);
        let mut state = apart(2.0);
        let error = solver.step(&mut state, StepInput::new(dt)).unwrap_err();
        assert!(matches!(error, StepError::NonFinite { .. }), "{stiffness}");
        assert!(state == apart(2.0));
    }
}

#[test]
fn nothing_at_all_and_nothing_that_moves_are_steps_too() {
    let empty = Particles::new(Vec::new());
    if let Ok(particles) = empty {
        let mut solver = solver(Vec::new(), &particles);
        let mut state = State::at_rest(Vec::new());
        solver.step(&mut state, StepInput::new(0.1)).unwrap();
    }
    let mut particles = Particles::new(vec![1.0; 2]).unwrap();
    (0..2).for_each(|v| particles.prescribe(v).unwrap());
    for stiffness in [0.0, 1.0, Real::INFINITY] {
        let mut solver = solver(spring(1.0, stiffness), &particles);
        let mut state = apart(3.0);
        state.velocities[1].y = 2.0;
        let input = StepInput::new(0.5).gravity(GRAVITY);
        solver.step(&mut state, input).unwrap();
        assert_eq!(state.positions[0], Vec3::zeros());
        assert!((state.positions[1] - Vec3::new(3.0, 1.0, 0.0)).norm() < 1e-15);
        assert_eq!(state.velocities[1], Vec3::y() * 2.0);
    }
}

#[test]
fn elements_and_settings_that_do_not_fit_are_named() {
    let particles = Particles::new(vec![1.0; 2]).unwrap();
    let stray = Spring {
        vertices: [0, 7],
        rest_length: 1.0,
        stiffness: 1.0,
    };
    let error = PbdSolver::builder(&particles).energy(vec![stray]).build();
    assert!(matches!(
        error,
        Err(BuildError::NoSuchVertex { vertex: 7, .. })
    ));
    let loops = [
        spring(1.0, 1.0)[0],
        Spring {
            vertices: [1, 1],
            ..stray
        },
    ];
    for sweep in [
        Sweep::Colored,
        Sweep::Sequential,
        Sweep::Jacobi,
        Sweep::PlainJacobi,
    ] {
        let config = PbdConfig {
            sweep,
            ..PbdConfig::default()
        };
        let builder = PbdSolver::builder(&particles).energy(loops.to_vec());
        let twice = BuildError::RepeatedVertex {
            kind: "Spring",
            family: Some(0),
            element: 1,
            vertex: 1,
        };
        assert_eq!(builder.config(config).build().unwrap_err(), twice);
    }
    let chebyshev = |radius, delay| Acceleration {
        chebyshev: Some(Chebyshev { radius, delay }),
        ..Acceleration::default()
    };
    let relaxed = |relaxation| Acceleration {
        relaxation,
        chebyshev: None,
    };
    for acceleration in [
        relaxed(0.0),
        relaxed(2.0),
        relaxed(Real::NAN),
        chebyshev(Radius::Given(1.0), 3),
        chebyshev(Radius::Given(Real::NAN), 3),
        chebyshev(Radius::Given(0.5), 0),
        chebyshev(Radius::Estimated, 1),
    ] {
        for sweep in [Sweep::Colored, Sweep::Jacobi] {
            let config = PbdConfig {
                acceleration,
                sweep,
                ..PbdConfig::default()
            };
            let error = PbdSolver::builder(&particles).config(config).build();
            assert!(
                matches!(error, Err(BuildError::OutOfRange(_))),
                "{config:?}"
            );
        }
    }
}

//! What the accelerations change, and what they do not.

use crate::cloth::{
    DT, GRAVITY, accelerated, coarse_solver, distance, falling, hanging, iterations, noise,
    potential, shake, sheet, solver, to_tolerance,
};
use cloth_core::cloth::ClothModel;
use cloth_core::error::OutOfRange;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{Strain, center_of_mass, linear_momentum};
use cloth_core::particles::State;
use cloth_core::step::{BuildError, Observer, Outcome, StepInput, Stepper};
use cloth_pd::{Acceleration, PdConfig, PdSolver, StartGuess};

#[test]
fn every_acceleration_ends_at_the_same_minimum() {
    let (model, mut state) = hanging(8, 200.0);
    let rest = state.positions.clone();
    shake(&model, &mut state, 0.02);
    let before = state.clone();
    let mut reference = None;
    for config in accelerated(to_tolerance(3e-13)) {
        for mut solver in [solver(&model, config), coarse_solver(&model, &rest, config)] {
            let mut after = before.clone();
            let report = solver.step(&mut after, falling()).unwrap();
            assert_eq!(report.outcome, Outcome::Converged, "{config:?}");
            let (_, gradient) = potential(&model, &before, &falling(), &after.positions);
            assert!(gradient <= 4e-13, "{config:?}: {gradient:e}");
            let reference = reference.get_or_insert_with(|| after.positions.clone());
            let apart = distance(&after.positions, reference);
            assert!(apart < 1e-11, "{config:?}: {apart:e} m");
        }
    }
}

/// Counts iterations until `G` has come within a part of its first distance to the minimum.
struct Until<'a> {
    value: &'a dyn Fn(&[Vec3]) -> Real,
    goal: Real,
    count: Option<u32>,
}

impl Observer for Until<'_> {
    fn iteration(&mut self, iteration: u32, positions: &[Vec3]) {
        if self.count.is_none() && (self.value)(positions) <= self.goal {
            self.count = Some(iteration);
        }
    }
}

#[test]
fn each_acceleration_needs_fewer_iterations_than_the_one_before() {
    // The ninth step of a falling sheet.
    let (model, mut state) = hanging(17, 1e4);
    let rest = state.positions.clone();
    let precise = PdConfig {
        iterations: Some(100_000),
        tolerance: Some(1e-9),
        ..PdConfig::default()
    };
    let mut reference = coarse_solver(&model, &rest, precise);
    for _ in 0..8 {
        reference.step(&mut state, falling()).unwrap();
    }
    let mut after = state.clone();
    reference.step(&mut after, falling()).unwrap();
    let value = |x: &[Vec3]| potential(&model, &state, &falling(), x).0;
    let mut predicted = state.positions.clone();
    cloth_core::measure::predict(&model.particles, &state, &falling(), &mut predicted);
    let (first, least) = (value(&predicted), value(&after.positions));
    let count = |mut solver: PdSolver| {
        let mut until = Until {
            value: &value,
            goal: least + 1e-4 * (first - least),
            count: None,
        };
        let input = falling().observer(&mut until);
        solver.step(&mut state.clone(), input).unwrap();
        until.count.unwrap()
    };
    let with = |acceleration| PdConfig {
        acceleration,
        ..iterations(4000)
    };
    let chebyshev = Acceleration::Chebyshev {
        spectral_radius: Some(0.999),
    };
    let quasi_newton = Acceleration::QuasiNewton { history: 5 };
    let counts = [
        count(solver(&model, with(Acceleration::None))),
        count(solver(&model, with(chebyshev))),
        count(solver(&model, with(quasi_newton))),
        count(coarse_solver(&model, &rest, with(quasi_newton))),
    ];
    // 3412, 156, 103 and 50.
    assert!(counts.is_sorted_by(|a, b| *a > b + b / 3), "{counts:?}");
}

/// Fall of the centre of mass (m) after half a second, and the largest strain, in the mean over the last five steps.
fn half_a_second(model: &ClothModel, start: &State, mut solver: PdSolver) -> [Real; 2] {
    let mut state = start.clone();
    let mut strain = 0.0;
    for step in 1..=30 {
        solver.step(&mut state, falling()).unwrap();
        if step > 25 {
            strain += 0.2 * Strain::of(&model.springs, &state.positions).max;
        }
    }
    let height = |x: &[Vec3]| center_of_mass(&model.particles, x).z;
    [height(&start.positions) - height(&state.positions), strain]
}

#[test]
fn a_few_iterations_fall_and_stretch_as_converged_ones_do() {
    let (model, start) = hanging(33, 1e4);
    let rest = &start.positions;
    let default = PdConfig::default();
    let ten = PdConfig {
        iterations: Some(10),
        ..default
    };
    let precise = PdConfig {
        iterations: Some(10_000),
        tolerance: Some(1e-6),
        ..default
    };
    let expected = half_a_second(&model, &start, coarse_solver(&model, rest, precise));
    for config in [ten, default] {
        let [fall, stretch] = half_a_second(&model, &start, coarse_solver(&model, rest, config));
        assert!(
            (fall / expected[0] - 1.0).abs() < 0.005,
            "{fall} {expected:?}"
        );
        assert!(
            (stretch / expected[1] - 1.0).abs() < 0.03,
            "{stretch} {expected:?}"
        );
    }
    // Without the coarse grid ten do not.
    let [fall, _] = half_a_second(&model, &start, solver(&model, ten));
    assert!(fall < 0.97 * expected[0], "{fall} {expected:?}");
}

#[test]
fn a_free_cloth_keeps_its_momentum_with_every_acceleration() {
    let (model, mut start) = sheet(9, 1e4);
    let rest = start.positions.clone();
    shake(&model, &mut start, 0.02);
    start.velocities = noise(start.positions.len());
    let before = linear_momentum(&model.particles, &start.velocities);
    let mass: Real = model.particles.mass().iter().sum();
    for at in [StartGuess::Inertial, StartGuess::Predicted] {
        for config in accelerated(iterations(3)) {
            let config = PdConfig {
                start: at,
                ..config
            };
            for mut solver in [solver(&model, config), coarse_solver(&model, &rest, config)] {
                let mut state = start.clone();
                for _ in 0..10 {
                    solver.step(&mut state, falling()).unwrap();
                }
                let after = linear_momentum(&model.particles, &state.velocities);
                let error = (after - before - GRAVITY * (10.0 * DT * mass)).norm();
                assert!(error < 1e-12, "{config:?}: {error:e} kg m/s");
            }
        }
    }
}

#[test]
fn a_coarse_grid_takes_any_rest_shape() {
    let (model, state) = hanging(9, 1e3);
    let flat = state.positions.clone();
    let tilted = |x: &Vec3| Vec3::new(x.x + 0.3 * x.y, x.y - 0.2 * x.x, 0.7 * x.x + x.y);
    let shapes: [Vec<Vec3>; 4] = [
        flat.iter().map(tilted).collect(),
        vec![Vec3::repeat(1e4); 81],
        noise(81),
        flat.iter().map(|x| Vec3::new(x.x, 0.0, 0.0)).collect(),
    ];
    let config = PdConfig {
        iterations: Some(10_000),
        // Rounding alone leaves about 1e-11.
        tolerance: Some(1e-10),
        ..PdConfig::default()
    };
    let mut expected = state.clone();
    solver(&model, config)
        .step(&mut expected, falling())
        .unwrap();
    for rest in &shapes {
        for cells in [1, 3, 50] {
            let mut after = state.clone();
            let mut solver = PdSolver::builder(&model.particles)
                .energy(model.springs.clone())
                .energy(model.hinges.clone())
                .coarse_grid(rest, cells)
                .config(config)
                .build()
                .unwrap();
            let report = solver.step(&mut after, falling()).unwrap();
            assert_eq!(report.outcome, Outcome::Converged);
            let apart = distance(&after.positions, &expected.positions);
            assert!(apart < 1e-12, "{cells} cells: {apart:e} m");
        }
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let (model, state) = sheet(3, 1e3);
    let refused = |config: PdConfig, rest: &[Vec3], cells| {
        let builder = PdSolver::builder(&model.particles).config(config);
        match builder.coarse_grid(rest, cells).build() {
            Err(BuildError::OutOfRange(OutOfRange { name, .. })) => name,
            other => panic!("{other:?}"),
        }
    };
    let rest = &state.positions[..];
    let default = PdConfig::default();
    assert_eq!(refused(default, rest, 0), "coarse cells");
    assert_eq!(refused(default, rest, 1001), "coarse cells");
    assert_eq!(
        refused(default, &rest[1..], 4),
        "the number of rest positions"
    );
    let mut bad = rest.to_vec();
    bad[4].y = Real::INFINITY;
    assert_eq!(refused(default, &bad, 4), "a rest position");
    for radius in [-0.1, 1.0, Real::NAN] {
        let acceleration = Acceleration::Chebyshev {
            spectral_radius: Some(radius),
        };
        let config = PdConfig {
            acceleration,
            ..default
        };
        assert_eq!(refused(config, rest, 4), "spectral_radius");
    }
    let acceleration = Acceleration::QuasiNewton { history: 33 };
    let config = PdConfig {
        acceleration,
        ..default
    };
    assert_eq!(refused(config, rest, 4), "history");
}

#[test]
fn gravity_over_a_very_long_step_leads_to_the_state_of_rest() {
    // One mass on a spring below a pin: at rest it hangs m g/k below the length of the spring.
    let mut particles = cloth_core::particles::Particles::new(vec![1.0, 0.3]).unwrap();
    particles.prescribe(0).unwrap();
    let spring = cloth_core::energy::Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: 50.0,
    };
    let expected = -1.0 - 0.3 * 9.81 / 50.0;
    for dt in [1e5, 1e9, 1e12] {
        for config in accelerated(PdConfig {
            start: StartGuess::Inertial,
            ..iterations(20)
        }) {
            let mut solver = PdSolver::builder(&particles)
                .energy(vec![spring])
                .config(config)
                .build()
                .unwrap();
            let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(0.0, 0.0, -1.2)]);
            let input = StepInput::new(dt).gravity(GRAVITY);
            solver.step(&mut state, input).unwrap();
            let error = state.positions[1] - Vec3::new(0.0, 0.0, expected);
            assert!(error.norm() < 1e-8, "{dt:e} {config:?}: {:e}", error.norm());
        }
    }
}

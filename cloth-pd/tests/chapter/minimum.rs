//! What the iteration converges to, and how.

use crate::cloth::{
    DT, GRAVITY, accelerated, coarse_solver, distance, falling, hanging, iterations, potential,
    shake, sheet, solver, to_tolerance,
};
use cloth_core::energy::{Attachment, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::predict;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Observer, Outcome, StepInput, Stepper};
use cloth_pd::{PdConfig, PdSolver, StartGuess};

#[test]
fn a_converged_step_is_a_stationary_point_of_the_incremental_potential() {
    let (model, mut state) = hanging(8, 200.0);
    shake(&model, &mut state, 0.02);
    let before = state.clone();
    let report = solver(&model, to_tolerance(1e-11))
        .step(&mut state, falling())
        .unwrap();
    assert_eq!(report.outcome, Outcome::Converged);
    let (_, gradient) = potential(&model, &before, &falling(), &state.positions);
    assert!(gradient <= 1.1e-11, "{gradient:e}");
}

/// The default ends once the change of velocity is right to its tolerance, by its own estimate; here as it is, beside
/// the step to the last digit.
#[test]
fn the_default_has_converged_where_its_estimate_meets_the_tolerance() {
    let (model, start) = hanging(16, 1e4);
    let mut state = start.clone();
    let step = |state: &State, config: PdConfig| {
        let mut end = state.clone();
        let mut solver = coarse_solver(&model, &start.positions, config);
        let report = solver.step(&mut end, falling()).unwrap();
        (end.positions, report.outcome, report.unfinished)
    };
    for _ in 0..30 {
        solver(&model, PdConfig::default())
            .step(&mut state, falling())
            .unwrap();
    }
    let mass = model.particles.mass();
    let apart = |a: &[Vec3], b: &[Vec3]| -> Real {
        let squares = a
            .iter()
            .zip(b)
            .zip(mass)
            .map(|((a, b), m)| m * (a - b).norm_squared());
        squares.sum::<Real>().sqrt()
    };
    let mut predicted = state.positions.clone();
    predict(&model.particles, &state, &falling(), &mut predicted);
    let sharp = PdConfig {
        tolerance: Some(1e-11),
        most_iterations: 20_000,
        ..PdConfig::default()
    };
    let (minimum, outcome, _) = step(&state, sharp);
    assert_eq!(outcome, Outcome::Converged);
    for velocity_tolerance in [0.1, 1e-2, 1e-3, 1e-4] {
        let asked = PdConfig {
            velocity_tolerance,
            most_iterations: 3000,
            ..PdConfig::default()
        };
        let (end, outcome, unfinished) = step(&state, asked);
        assert_eq!((outcome, unfinished), (Outcome::Converged, 0));
        let error = apart(&end, &minimum) / apart(&minimum, &predicted);
        assert!(
            error < 10.0 * velocity_tolerance,
            "{velocity_tolerance:e}: {error:e}"
        );
    }
    // Where it has to end before, it says so.
    let short = PdConfig {
        most_iterations: 11,
        velocity_tolerance: 1e-3,
        ..PdConfig::default()
    };
    let (_, outcome, unfinished) = step(&state, short);
    assert_eq!((outcome, unfinished), (Outcome::BudgetSpent, 1));
    let (_, outcome, unfinished) = step(&state, iterations(10));
    assert_eq!((outcome, unfinished), (Outcome::BudgetSpent, 0));
}

#[test]
fn the_residual_is_the_relative_gradient_of_the_objective() {
    for (start, count) in [
        (StartGuess::Predicted, 1),
        (StartGuess::Predicted, 7),
        (StartGuess::Previous, 3),
    ] {
        let (model, mut state) = hanging(8, 1e4);
        shake(&model, &mut state, 0.02);
        let before = state.clone();
        let config = PdConfig {
            iterations: Some(count),
            tolerance: Some(0.0),
            start,
            ..PdConfig::plain()
        };
        let report = solver(&model, config).step(&mut state, falling()).unwrap();
        assert_eq!(
            (report.outcome, report.iterations),
            (Outcome::BudgetSpent, count)
        );
        let (_, expected) = potential(&model, &before, &falling(), &state.positions);
        let error = report.residual.unwrap() / expected - 1.0;
        assert!(error.abs() < 1e-12, "{start:?} {count}: {error:e}");
    }
}

/// Vectors this long are worked on in two parts.
#[test]
fn a_cloth_of_thousands_of_vertices_converges_to_the_same_conditions() {
    let (model, mut state) = hanging(60, 1e4);
    let rest = state.positions.clone();
    shake(&model, &mut state, 0.002);
    let before = state.clone();
    let config = PdConfig {
        iterations: Some(2_000),
        tolerance: Some(1e-6),
        ..PdConfig::default()
    };
    let mut solver = coarse_solver(&model, &rest, config);
    let report = solver.step(&mut state, falling()).unwrap();
    let (_, gradient) = potential(&model, &before, &falling(), &state.positions);
    let error = report.residual.unwrap() / gradient - 1.0;
    assert!(
        gradient <= 1.01e-6 && error.abs() < 1e-9,
        "{gradient:e} {error:e}"
    );
    // 776; where an end of one part were lost, or the sum of a part, no direction would be any good.
    assert!(report.iterations < 1000, "{report:?}");
}

#[test]
fn a_tolerance_watches_and_does_not_change_the_iteration() {
    let run = |tolerance| {
        let (model, mut state) = hanging(8, 1e4);
        let config = PdConfig {
            tolerance,
            ..iterations(12)
        };
        solver(&model, config).step(&mut state, falling()).unwrap();
        state
    };
    assert_eq!(run(None), run(Some(0.0)));
}

/// By hand, with one end held and z = x: A = m/Δt² + k, here 30 + 50 N/m. Where p has its final direction n, an
/// iteration is exact. The Hessian is m/Δt² + k (I − (L/ℓ)(I − n nᵀ)), ℓ the length at the minimum, so an iteration
/// leaves nothing of an error along n, and across it k (L/ℓ)/(m/Δt² + k) = 0.625 L/ℓ: nearer to 1 the larger k Δt²/m.
#[test]
fn one_spring_ends_at_implicit_euler_in_closed_form() {
    let (mass, stiffness, rest_length, dt) = (0.3, 50.0, 1.0, 0.1);
    let mut particles = Particles::new(vec![1.0, mass]).unwrap();
    particles.prescribe(0).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length,
        stiffness,
    };
    let position = Vec3::new(1.5, 0.2, -0.3);
    let velocity = Vec3::new(-2.0, 3.0, 1.0);
    let predicted = position + (velocity + GRAVITY * dt) * dt;
    // By symmetry the minimum lies on the line from the fixed end to x̃.
    let length = (mass * predicted.norm() + dt * dt * stiffness * rest_length)
        / (mass + dt * dt * stiffness);
    let expected = predicted.normalize() * length;
    for start in [StartGuess::Previous, StartGuess::Predicted] {
        let config = PdConfig {
            iterations: Some(200),
            start,
            ..PdConfig::plain()
        };
        let mut solver = PdSolver::builder(&particles)
            .energy(vec![spring])
            .config(config)
            .build()
            .unwrap();
        let mut state = State::at_rest(vec![Vec3::zeros(), position]);
        state.velocities[1] = velocity;
        solver
            .step(&mut state, StepInput::new(dt).gravity(GRAVITY))
            .unwrap();
        assert!((state.positions[1] - expected).norm() < 1e-15, "{start:?}");
        let speed = (expected - position) / dt;
        assert!((state.velocities[1] - speed).norm() < 1e-13, "{start:?}");
    }
}

#[test]
fn two_starts_end_at_the_same_minimum() {
    let run = |start| {
        let (model, mut state) = hanging(8, 200.0);
        let config = PdConfig {
            start,
            ..to_tolerance(1e-12)
        };
        solver(&model, config).step(&mut state, falling()).unwrap();
        state.positions
    };
    let apart = distance(&run(StartGuess::Previous), &run(StartGuess::Predicted));
    assert!(apart < 1e-14, "{apart:e}");
}

/// Collects G after every iteration.
struct Values<'a, F: Fn(&[Vec3]) -> Real> {
    potential: &'a F,
    seen: Vec<Real>,
}

impl<F: Fn(&[Vec3]) -> Real> Observer for Values<'_, F> {
    fn iteration(&mut self, iteration: u32, positions: &[Vec3]) {
        self.seen.push((self.potential)(positions));
        assert_eq!(iteration as usize, self.seen.len());
    }
}

#[test]
fn the_incremental_potential_falls_in_every_iteration_from_any_start() {
    for (stiffness, shake_by) in [(10.0, 0.3), (1e4, 0.0), (1e4, 0.3), (1e6, 0.01)] {
        let (model, mut state) = hanging(8, stiffness);
        let rest = state.positions.clone();
        shake(&model, &mut state, shake_by);
        let before = state.clone();
        let value = |x: &[Vec3]| potential(&model, &before, &falling(), x).0;
        for config in accelerated(iterations(60)) {
            for mut solver in [solver(&model, config), coarse_solver(&model, &rest, config)] {
                let mut observer = Values {
                    potential: &value,
                    seen: Vec::new(),
                };
                let input = falling().observer(&mut observer);
                solver.step(&mut before.clone(), input).unwrap();
                assert_eq!(observer.seen.len(), 60);
                let rounding = 1e-12 * observer.seen[0];
                for pair in observer.seen.windows(2) {
                    assert!(
                        pair[1] <= pair[0] + rounding,
                        "k {stiffness}, {config:?}: {pair:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn quadratic_energies_are_solved_by_one_iteration() {
    let (model, mut state) = hanging(8, 1.0);
    shake(&model, &mut state, 0.1);
    let ties: Vec<Attachment> = (0..20)
        .map(|i| Attachment {
            vertex: 3 * i,
            target: Vec3::new(0.1, 0.2, 0.3),
            stiffness: 70.0,
        })
        .collect();
    let build = |config| {
        PdSolver::builder(&model.particles)
            .energy(model.hinges.clone())
            .energy(ties.clone())
            .config(config)
            .build()
            .unwrap()
    };
    let model = cloth_core::cloth::ClothModel {
        springs: Vec::new(),
        ..model.clone()
    };
    let before = state.clone();
    build(iterations(1)).step(&mut state, falling()).unwrap();
    let energies = model.energies().unwrap().with(ties.clone()).unwrap();
    let mut predicted = before.positions.clone();
    predict(&model.particles, &before, &falling(), &mut predicted);
    let potential = cloth_core::measure::IncrementalPotential {
        particles: &model.particles,
        energies: &energies,
        predicted: &predicted,
        dt: DT,
    };
    let norm = |x: &[Vec3]| {
        let mut gradient = x.to_vec();
        potential.gradient_into(x, &mut gradient);
        potential.gradient_norm(&gradient)
    };
    let ratio = norm(&state.positions) / norm(&predicted);
    assert!(ratio < 2e-15, "{ratio:e}");

    // And the solver notices.
    let mut watched = before;
    let report = build(to_tolerance(1e-14))
        .step(&mut watched, falling())
        .unwrap();
    assert_eq!((report.outcome, report.iterations), (Outcome::Converged, 1));
    assert_eq!(watched, state);
}

#[test]
fn one_step_has_the_same_result_with_elements_in_another_order() {
    let (model, mut state) = sheet(8, 200.0);
    shake(&model, &mut state, 0.05);
    let mut reversed = state.clone();
    let mut model_reversed = model.clone();
    model_reversed.springs.reverse();
    model_reversed.hinges.reverse();
    solver(&model, iterations(30))
        .step(&mut state, falling())
        .unwrap();
    solver(&model_reversed, iterations(30))
        .step(&mut reversed, falling())
        .unwrap();
    let apart = distance(&state.positions, &reversed.positions);
    assert!(apart < 4e-15, "{apart:e}");
}

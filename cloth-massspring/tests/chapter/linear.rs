//! The linear solvers of Newton's method lead to the same minimum: Cholesky, and the iterative ones but for multigrid,
//! which `tests/light.rs` has.

use crate::newton::{DT, norms};
use crate::{DOWN, chain, hang, largest_difference, noise, sharp, solver};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::family::Energies;
use cloth_core::method::linear::{LinearMethod, StoppingCriteria};
use cloth_core::particles::State;
use cloth_core::step::{BuildError, Outcome, StepInput, StepReport, Stepper};
use cloth_massspring::{Accept, ImplicitConfig, ImplicitEuler, Solve};

/// All but multigrid.
fn iterative(tolerance: Real) -> [LinearMethod; 4] {
    let budget = StoppingCriteria {
        tolerance,
        max_iterations: 20_000,
    };
    [
        LinearMethod::ConjugateGradients(budget),
        LinearMethod::ChebyshevJacobi(budget),
        LinearMethod::Jacobi(budget),
        LinearMethod::GaussSeidel(budget),
    ]
}

/// One step of a sheet that falls fast enough for its springs to be stretched: the minimum is the only one.
fn step(config: ImplicitConfig) -> (State, StepReport) {
    let (mesh, model) = hang(8);
    let mut state = State::at_rest(mesh.positions().to_vec());
    for (vertex, v) in state.velocities.iter_mut().enumerate() {
        if !model.particles.is_prescribed(vertex) {
            *v = Vec3::new(0.0, -3.0, -3.0) + noise(vertex);
        }
    }
    let mut solver = solver!(ImplicitEuler, &model.particles, model.springs, config);
    let input = StepInput::new(DT).gravity(DOWN);
    let report = solver.step(&mut state, input).unwrap();
    (state, report)
}

#[test]
fn every_linear_solver_leads_newton_to_the_same_minimum() {
    let (expected, direct) = step(sharp());
    assert_eq!(direct.linear_iterations, direct.linear_solves);
    for linear in iterative(1e-3) {
        let (found, report) = step(ImplicitConfig {
            linear,
            solve: Solve::Newton,
            tolerance: 1e-9,
            ..ImplicitConfig::default()
        });
        let difference = largest_difference(&found.positions, &expected.positions);
        assert_eq!(report.outcome, Outcome::Converged, "{linear:?}");
        assert!(difference < 1e-9, "{linear:?}: {difference:e}");
        assert!(report.linear_iterations > report.linear_solves);
    }
}

#[test]
fn each_newton_step_leaves_as_much_of_the_gradient_as_the_tolerance_says() {
    // On springs without rest length Newton's method is exact after one step, but for the linear solver.
    let (particles, mut springs, positions) = chain(10, 1e4);
    for spring in &mut springs {
        spring.rest_length = 0.0;
    }
    let rest = State::at_rest(positions.clone());
    let energies = Energies::new(particles.len())
        .with(springs.clone())
        .unwrap();
    // Newton's method starts at x[0], as nothing moves.
    let start = norms(&particles, &energies, &rest, &positions).gradient;
    for tolerance in [1e-1, 1e-3, 1e-6] {
        for linear in iterative(tolerance) {
            let config = ImplicitConfig {
                linear,
                solve: Solve::Newton,
                max_iterations: 1,
                tolerance: 0.0,
                ..ImplicitConfig::default()
            };
            let mut solver = solver!(ImplicitEuler, &particles, springs.clone(), config);
            let input = || StepInput::new(DT).gravity(DOWN);
            let mut state = rest.clone();
            solver.step(&mut state, input()).unwrap();
            let left = norms(&particles, &energies, &rest, &state.positions).gradient / start;
            assert!(left <= tolerance * 1.001, "{linear:?}: {left:e}");
            // Ten masses have ten eigenvalues: conjugate gradients may end exactly.
            let exact = matches!(linear, LinearMethod::ConjugateGradients(_));
            assert!(exact || left >= 0.1 * tolerance, "{linear:?}: {left:e}");
        }
    }
}

#[test]
fn a_minimum_is_promised_only_by_a_solver_that_can_prove_it() {
    let (particles, springs, _) = chain(3, 1e4);
    for linear in iterative(1e-3) {
        let config = ImplicitConfig {
            linear,
            accept: Accept::Minimum,
            ..ImplicitConfig::default()
        };
        let builder = ImplicitEuler::builder(&particles).energy(springs.clone());
        let refused = builder.config(config).build().unwrap_err();
        assert!(
            matches!(refused, BuildError::SettingsConflict { .. }),
            "{refused}"
        );
    }
}

#[test]
fn every_iterative_solver_solves_the_linearised_step_too() {
    let linearized = ImplicitConfig::linearized();
    let (expected, _) = step(linearized);
    for linear in iterative(1e-12) {
        let (found, report) = step(ImplicitConfig {
            linear,
            ..linearized
        });
        let difference = largest_difference(&found.positions, &expected.positions);
        assert!(difference < 1e-10, "{linear:?}: {difference:e}");
        assert_eq!(report.linear_solves, 1);
    }
}

/// A linearised step of a cloth that moves along with its pins is that of one at rest: with the pins ahead of the cloth
/// where it is linearised, springs at them were strained by the way of a step.
#[test]
fn linearised_steps_do_not_feel_a_common_velocity() {
    let (mesh, model) = hang(9);
    let velocity = Vec3::new(3.0, -2.0, 1.0);
    let dt = 1.0 / 60.0;
    let end = |v: Vec3, linear| {
        let config = ImplicitConfig {
            linear,
            ..ImplicitConfig::linearized()
        };
        let mut solver = solver!(
            ImplicitEuler,
            &model.particles,
            model.springs.clone(),
            config
        );
        let mut state = State::at_rest(mesh.positions().to_vec());
        state.velocities.fill(v);
        for _ in 0..30 {
            let input = StepInput::new(dt).gravity(DOWN);
            solver.step(&mut state, input).unwrap();
        }
        state.positions
    };
    for linear in [ImplicitConfig::linearized().linear, LinearMethod::Cholesky] {
        let carried = end(velocity, linear)
            .iter()
            .map(|x| x - velocity * (30.0 * dt))
            .collect::<Vec<_>>();
        let difference = largest_difference(&carried, &end(Vec3::zeros(), linear));
        assert!(difference < 1e-5, "{linear:?}: {difference:e}");
    }
}

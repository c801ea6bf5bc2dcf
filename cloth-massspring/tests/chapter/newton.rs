//! Implicit Euler as a minimisation.

use crate::refusals::buckling;
use crate::{DOWN, chain, hang, largest_difference, noise, sharp};
use cloth_core::element::Convexity;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, center_of_mass, predict};
use cloth_core::method::family::Energies;
use cloth_core::method::linear::{LinearMethod, StoppingCriteria};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Observer, Outcome, StepInput, Stepper};
use cloth_massspring::{Accept, HessianPolicy, ImplicitConfig, ImplicitEuler, Solve, StartGuess};

pub(crate) const DT: Real = 1.0 / 60.0;

fn hanging(n: usize, config: ImplicitConfig) -> (ImplicitEuler, State) {
    let (mesh, model) = hang(n);
    let builder = ImplicitEuler::builder(&model.particles).energy(model.springs);
    let solver = builder.energy(model.hinges).config(config).build().unwrap();
    (solver, State::at_rest(mesh.positions().to_vec()))
}

/// Positions after every iteration.
#[derive(Default)]
struct Recorder(Vec<Vec<Vec3>>);

impl Observer for Recorder {
    fn iteration(&mut self, iteration: u32, positions: &[Vec3]) {
        self.0.push(positions.to_vec());
        assert_eq!(self.0.len(), iteration as usize);
    }
}

/// Norms at x in a step of [`DT`] from `state`, computed apart from the solver (N/√kg).
pub(crate) struct Norms {
    /// `‖∇G(x)‖`.
    pub(crate) gradient: Real,
    /// `‖∇G(x̃)‖`.
    predicted: Real,
}

/// Those of the scene `hang`.
fn norms_of_hang(n: usize, state: &State, x: &[Vec3]) -> Norms {
    let (_, model) = hang(n);
    norms(&model.particles, &model.energies().unwrap(), state, x)
}

pub(crate) fn norms(
    particles: &Particles,
    energies: &Energies,
    state: &State,
    x: &[Vec3],
) -> Norms {
    let input = StepInput::new(DT).gravity(DOWN);
    let mut predicted = vec![Vec3::zeros(); x.len()];
    predict(particles, state, &input, &mut predicted);
    let potential = IncrementalPotential {
        particles,
        energies,
        predicted: &predicted,
        dt: DT,
    };
    let norm = |x: &[Vec3]| {
        let mut gradient = vec![Vec3::zeros(); x.len()];
        potential.gradient_into(x, &mut gradient);
        potential.gradient_norm(&gradient)
    };
    Norms {
        gradient: norm(x),
        predicted: norm(&predicted),
    }
}

/// However far the iteration goes: it ends no farther from the minimum, in the metric of the masses, than a small
/// multiple of the tolerance of what the forces have moved the cloth. The minimum is found by steps to the last digit
/// from the same state.
#[test]
fn the_change_of_velocity_is_right_to_the_tolerance() {
    let (_, model) = hang(12);
    let distance = |a: &[Vec3], b: &[Vec3]| -> Real {
        let displacements = a.iter().zip(b).zip(model.particles.mass());
        displacements
            .map(|((a, b), m)| m * (a - b).norm_squared())
            .sum::<Real>()
            .sqrt()
    };
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-6] {
        let config = ImplicitConfig {
            tolerance,
            ..ImplicitConfig::default()
        };
        let (mut solver, mut state) = hanging(12, config);
        let mut worst: Real = 0.0;
        for _ in 0..20 {
            let (mut exact_solver, mut exact) = hanging(12, ImplicitConfig::reference());
            exact.clone_from(&state);
            let mut predicted = vec![Vec3::zeros(); state.positions.len()];
            let input = || StepInput::new(DT).gravity(DOWN);
            predict(&model.particles, &state, &input(), &mut predicted);
            let report = solver.step(&mut state, input()).unwrap();
            assert_eq!(report.outcome, Outcome::Converged);
            assert!(report.residual.unwrap() <= tolerance);
            exact_solver.step(&mut exact, input()).unwrap();
            let way = distance(&exact.positions, &predicted);
            worst = worst.max(distance(&state.positions, &exact.positions) / way);
        }
        println!("{tolerance:e}: {worst:e}");
        assert!(worst < 3.0 * tolerance, "{tolerance:e}: {worst:e}");
    }
}

#[test]
fn the_reference_settings_reach_the_last_digits_in_every_step() {
    let (mut solver, mut state) = hanging(16, ImplicitConfig::reference());
    let mut worst: Real = 0.0;
    for _ in 0..30 {
        let before = state.clone();
        let report = solver
            .step(&mut state, StepInput::new(DT).gravity(DOWN))
            .unwrap();
        assert_eq!(report.outcome, Outcome::Converged);
        let norms = norms_of_hang(16, &before, &state.positions);
        worst = worst.max(norms.gradient / norms.predicted);
    }
    // Positions of 1 m are stored to 1.1e-16 m, and springs of 1e4 N/m feel that: less than this is noise.
    assert!(worst < 2e-11, "{worst:e}");
    let (_, model) = hang(16);
    let fall = -center_of_mass(&model.particles, &state.positions).z;
    assert!(
        (0.487..0.502).contains(&fall),
        "the sheet has fallen {fall} m"
    );
}

#[test]
fn convergence_is_quadratic_in_the_end() {
    let (mut solver, mut state) = stretched_chain(StartGuess::Inertial);
    let mut checked = 0;
    for _ in 0..10 {
        let mut recorder = Recorder::default();
        let input = StepInput::new(DT).gravity(DOWN).observer(&mut recorder);
        solver.step(&mut state, input).unwrap();
        let error = |x: &Vec<Vec3>| largest_difference(x, &state.positions);
        let errors: Vec<Real> = recorder.0.iter().map(error).collect();
        for e in errors.windows(3) {
            if e[0] < 0.1 && e[2] > 1e-13 {
                let order = (e[2] / e[1]).ln() / (e[1] / e[0]).ln();
                assert!(order > 1.7, "{e:?}: {order}");
                checked += 1;
            }
        }
    }
    assert!(checked >= 5, "{checked} triples to compare");
}

#[test]
fn every_iteration_leads_down_from_a_crumpled_state() {
    let (mut solver, mut state) = hanging(8, ImplicitConfig::default());
    let (_, model) = hang(8);
    for (i, x) in state.positions.iter_mut().enumerate() {
        if !model.particles.is_prescribed(i) {
            *x += noise(i) * 0.5;
        }
    }
    let (mut recorder, input) = (Recorder::default(), StepInput::new(DT).gravity(DOWN));
    let mut predicted = vec![Vec3::zeros(); state.positions.len()];
    predict(&model.particles, &state, &input, &mut predicted);
    let potential = IncrementalPotential {
        particles: &model.particles,
        energies: &model.energies().unwrap(),
        predicted: &predicted,
        dt: DT,
    };
    let mut before = potential.value(&state.positions);
    let report = solver
        .step(&mut state, input.observer(&mut recorder))
        .unwrap();
    assert!(
        report.backtracks > 0,
        "the full step would do everywhere: {report:?}"
    );
    for (iteration, x) in recorder.0.iter().enumerate() {
        let after = potential.value(x);
        assert!(
            after <= before * (1.0 + 1e-10),
            "{iteration}: {before} to {after} J"
        );
        before = after;
    }
}

#[test]
fn dropping_the_indefinite_part_costs_the_quadratic_convergence() {
    let count = |hessian| {
        let config = ImplicitConfig {
            hessian,
            solve: Solve::Newton,
            tolerance: 1e-9,
            ..ImplicitConfig::default()
        };
        let (mut solver, mut state) = hanging(12, config);
        let mut iterations = 0;
        for step in 0..20 {
            let (before, mut recorder) = (state.clone(), Recorder::default());
            let input = StepInput::new(DT).gravity(DOWN).observer(&mut recorder);
            iterations += solver.step(&mut state, input).unwrap().iterations;
            if step == 9 {
                let residual = |x: &Vec<Vec3>| {
                    let norms = norms_of_hang(12, &before, x);
                    norms.gradient / norms.predicted
                };
                let residuals = recorder.0.iter().map(residual);
                let residuals: Vec<String> = residuals.map(|r| format!("{r:.0e}")).collect();
                println!("{hessian:?}: {}", residuals.join(" "));
            }
        }
        iterations
    };
    let (blended, clamped) = (
        count(HessianPolicy::ExactFirst),
        count(HessianPolicy::Always(Convexity::Clamp)),
    );
    assert!(
        blended * 3 < clamped * 2,
        "{blended} against {clamped} iterations"
    );
}

/// Ten springs pulled to 1.3 times their length between two prescribed ends, moving.
fn stretched_chain(start: StartGuess) -> (ImplicitEuler, State) {
    let (mut particles, springs, mut positions) = chain(10, 2e3);
    positions
        .iter_mut()
        .for_each(|x| *x = Vec3::new(-x.z * 1.3, 0.0, 0.0));
    particles.prescribe(10).unwrap();
    let config = ImplicitConfig {
        start,
        solve: Solve::Newton,
        ..sharp()
    };
    let builder = ImplicitEuler::builder(&particles).energy(springs);
    let mut state = State::at_rest(positions);
    for (i, v) in state.velocities.iter_mut().enumerate().take(10).skip(1) {
        *v = noise(i) * 20.0;
    }
    (builder.config(config).build().unwrap(), state)
}

#[test]
fn the_start_does_not_matter_where_springs_are_stretched() {
    let starts = [
        StartGuess::Previous,
        StartGuess::Inertial,
        StartGuess::Extrapolated,
        StartGuess::Predicted,
    ];
    let solutions = starts.map(|start| {
        let (mut solver, mut state) = stretched_chain(start);
        for _ in 0..5 {
            solver
                .step(&mut state, StepInput::new(DT).gravity(DOWN))
                .unwrap();
        }
        state.positions
    });
    assert!(largest_difference(&solutions[0], &solutions[1]) < 1e-12);
    assert!(largest_difference(&solutions[0], &solutions[2]) < 1e-12);
    assert!(largest_difference(&solutions[0], &solutions[3]) < 1e-12);
}

#[test]
fn a_minimum_is_found_where_a_stationary_point_is_not_enough() {
    // Pressed straight together, the middle vertex feels no force, but the way out is downhill.
    let deflection = |accept| {
        let (particles, springs, positions) = buckling();
        let config = ImplicitConfig { accept, ..sharp() };
        let builder = ImplicitEuler::builder(&particles).energy(springs);
        let mut solver = builder.config(config).build().unwrap();
        let mut state = State::at_rest(positions);
        solver.step(&mut state, StepInput::new(1e6)).unwrap();
        state.positions[1] - Vec3::x()
    };
    assert_eq!(deflection(Accept::Stationary), Vec3::zeros());
    // Both springs at rest: an isosceles triangle with legs of 2 m over a base of 2 m.
    let found = deflection(Accept::Minimum);
    assert!((found.norm() - 3.0_f64.sqrt()).abs() < 1e-9, "{found}");
    assert!(found.x.abs() < 1e-9);
}

#[test]
fn a_step_that_is_already_solved_takes_no_factorisation() {
    let (particles, springs, positions) = chain(10, 2e3);
    let builder = ImplicitEuler::builder(&particles).energy(springs);
    let mut solver = builder.build().unwrap();
    let mut state = State::at_rest(positions);
    let report = solver.step(&mut state, StepInput::new(DT)).unwrap();
    assert_eq!((report.iterations, report.factorizations), (0, 0));
    assert_eq!(report.residual, Some(0.0));
}

#[test]
fn a_spent_budget_is_an_outcome_and_the_best_point_is_kept() {
    let config = ImplicitConfig {
        max_iterations: 2,
        tolerance: 1e-9,
        ..ImplicitConfig::default()
    };
    let (mut solver, mut state) = hanging(12, config);
    let report = solver
        .step(&mut state, StepInput::new(DT).gravity(DOWN))
        .unwrap();
    assert_eq!(
        (report.outcome, report.iterations),
        (Outcome::BudgetSpent, 2)
    );
    assert_eq!(state.steps, 1);
}

#[test]
fn far_from_the_origin_it_still_converges() {
    let (mesh, model) = hang(10);
    let builder = ImplicitEuler::builder(&model.particles).energy(model.springs);
    let mut solver = builder.config(ImplicitConfig::reference()).build().unwrap();
    let shift = Vec3::repeat(1e4);
    let mut state = State::at_rest(mesh.positions().iter().map(|x| x + shift).collect());
    for _ in 0..10 {
        let report = solver
            .step(&mut state, StepInput::new(DT).gravity(DOWN))
            .unwrap();
        assert_eq!(report.outcome, Outcome::Converged);
    }
}

/// Newton's method tries the whole Hessian before it clamps it, and conjugate gradients find out that it is indefinite.
/// The direction that they had by then was not finite, and no solve after it was.
#[test]
fn an_indefinite_matrix_leaves_nothing_behind_in_conjugate_gradients() {
    let (mesh, mut model) = hang(33);
    for spring in &mut model.springs {
        spring.stiffness = 1e7;
    }
    let config = ImplicitConfig {
        solve: Solve::Newton,
        linear: LinearMethod::Multigrid(StoppingCriteria::default()),
        max_iterations: 60,
        ..ImplicitConfig::default()
    };
    let builder = ImplicitEuler::builder(&model.particles).energy(model.springs);
    let mut solver = builder.energy(model.hinges).config(config).build().unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    for _ in 0..4 {
        let input = StepInput::new(DT).gravity(DOWN);
        let taken = solver.step(&mut state, input);
        assert!(taken.is_ok(), "{taken:?}");
    }
}

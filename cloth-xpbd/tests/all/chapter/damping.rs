//! Damping acts on the rate of a constraint and on nothing else.

use crate::chapter::{iterations, largest_distance};
use cloth_core::energy::{CurvatureHinge, SoftPin, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{angular_momentum, linear_momentum};
use cloth_core::particles::{Particles, State};
use cloth_core::pin::PinMotion;
use cloth_core::step::{BuildError, StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

const MASSES: [Real; 2] = [0.3, 0.7];
const WEIGHT: Real = 1.0 / MASSES[0] + 1.0 / MASSES[1];

fn damped(n: u32, damping: Real) -> XpbdConfig {
    XpbdConfig {
        damping,
        ..iterations(n)
    }
}

fn pair(k: Real, config: XpbdConfig) -> (Particles, XpbdSolver) {
    let particles = Particles::new(MASSES.to_vec()).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: k,
    };
    let builder = XpbdSolver::builder(&particles).energy(vec![spring]);
    let solver = builder.config(config).build().unwrap();
    (particles, solver)
}

/// Implicit Euler of `C″ = −w (k C + c C′)`: with `C̃ = C⁰ + h Ċ⁰`, `C = (C̃ + w h c C⁰)/(1 + w (h² k + h c))`.
fn law(k: Real, c: Real, h: Real, before: Real, predicted: Real) -> Real {
    (predicted + WEIGHT * h * c * before) / (1.0 + WEIGHT * (h * h * k + h * c))
}

#[test]
fn one_damped_constraint_is_implicit_eulers_damped_oscillator() {
    for k in [0.0, 3.0, 700.0, 2e4] {
        for beta in [1e-4, 0.02, 3.0] {
            for n in [1, 7] {
                let h = 0.01;
                let (_, mut solver) = pair(k, damped(n, beta));
                let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(1.5, 0.0, 0.0)]);
                state.velocities[0].x = 1.0;
                state.velocities[1].x = -0.7;
                for _ in 0..50 {
                    let value = |s: &State| (s.positions[1] - s.positions[0]).norm() - 1.0;
                    let before = value(&state);
                    let rate = (state.velocities[1] - state.velocities[0]).x;
                    let expected = law(k, beta * k, h, before, before + h * rate);
                    solver.step(&mut state, StepInput::new(h)).unwrap();
                    let error = value(&state) - expected;
                    assert!(error.abs() < 1e-12, "k {k}, β {beta}, n {n}: {error:e}");
                    assert!(solver.compliance_residual(&state.positions) < 1e-13);
                    let mut multipliers = Vec::new();
                    solver.multipliers_into(0, &mut multipliers);
                    let force = -k * expected - beta * k * (expected - before) / h;
                    let error = multipliers[0] - h * h * force;
                    let size = h * h * k * (1.0 + beta / h);
                    assert!(error.abs() <= 1e-14 * size, "{k} {beta}: {error:e}");
                }
            }
        }
    }
}

/// A free pair keeps its momentum and is pulled along its own line only, so that its angular momentum shrinks
/// as its length from x̃ to the end of the step: implicit Euler's loss, that of a rigid link where β is large,
/// and no more.
#[test]
fn rigid_motion_is_not_damped() {
    let h = 0.01;
    for beta in [0.0, 0.1, 1e4] {
        let k = 500.0;
        let (particles, mut solver) = pair(k, damped(3, beta));
        // Turning by 5 rad/s about its centre of mass, which moves.
        let mut state = State::at_rest(vec![Vec3::new(-0.7, 0.0, 0.0), Vec3::new(0.3, 0.0, 0.0)]);
        let drift = Vec3::new(1.0, 2.0, -3.0);
        for (x, v) in state.positions.iter().zip(&mut state.velocities) {
            *v = drift + Vec3::new(0.0, 0.0, 5.0).cross(x);
        }
        let momentum = linear_momentum(&particles, &state.velocities);
        for _ in 0..20 {
            let arm = |s: &State| s.positions[1] - s.positions[0];
            let predicted = arm(&state) + (state.velocities[1] - state.velocities[0]) * h;
            let before = arm(&state).norm() - 1.0;
            let expected = 1.0 + law(k, beta * k, h, before, predicted.norm() - 1.0);
            let about_center = |s: &State| {
                let shift = (s.positions[0] * MASSES[0] + s.positions[1] * MASSES[1]) / 1.0;
                let mut moved = s.clone();
                moved.positions.iter_mut().for_each(|x| *x -= shift);
                angular_momentum(&particles, &moved).z
            };
            let turning = about_center(&state);
            solver.step(&mut state, StepInput::new(h)).unwrap();
            let length = arm(&state).norm();
            assert!((length - expected).abs() < 1e-13, "β {beta}");
            let kept = about_center(&state) / turning;
            let law = expected / predicted.norm();
            assert!((kept - law).abs() < 1e-12, "β {beta}: {kept} {law}");
            let now = linear_momentum(&particles, &state.velocities);
            assert!((now - momentum).norm() < 1e-13);
        }
    }
}

#[test]
fn a_hard_constraint_is_met_to_round_off_however_it_is_damped() {
    for beta in [0.0, 1e-3, 1e3] {
        let (_, mut solver) = pair(Real::INFINITY, damped(1, beta));
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(1.0, 2.0, 2.0)]);
        solver.step(&mut state, StepInput::new(0.01)).unwrap();
        let length = (state.positions[1] - state.positions[0]).norm();
        assert!((length - 1.0).abs() < 5e-16, "β {beta}: {length}");
    }
}

#[test]
fn the_rows_of_a_hinge_are_damped_by_the_same_law() {
    let particles = Particles::new(vec![0.1, 0.2, 0.3, 0.4]).unwrap();
    let rest = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8], [0.5, -0.9]];
    let rest = rest.map(|[x, y]| Vec3::new(x, y, 0.0));
    let hinge = CurvatureHinge::new([0, 1, 2, 3], &rest, 5.0);
    let z = |x: &[Vec3]| -> Vec3 { (0..4).map(|i| x[i] * hinge.coefficients[i]).sum() };
    let weights = (0..4).map(|i| particles.inverse_mass()[i] * hinge.coefficients[i].powi(2));
    let (w, h, beta): (Real, Real, Real) = (weights.sum(), 0.02, 0.05);
    let (k, c) = (hinge.stiffness, hinge.stiffness * beta);
    let mut state = State::at_rest(rest.to_vec());
    state.positions[2] = Vec3::new(0.4, 0.2, 0.7);
    state.velocities[1] = Vec3::new(1.0, -2.0, 3.0);
    let predicted: Vec<Vec3> = (0..4)
        .map(|i| state.positions[i] + state.velocities[i] * h)
        .collect();
    let law = (z(&predicted) + z(&state.positions) * (w * h * c)) / (1.0 + w * (h * h * k + h * c));
    let builder = XpbdSolver::builder(&particles).energy(vec![hinge]);
    let mut solver = builder.config(damped(4, beta)).build().unwrap();
    solver.step(&mut state, StepInput::new(h)).unwrap();
    let error = (z(&state.positions) - law).norm() / law.norm();
    assert!(error < 1e-13, "{error:e}");
}

#[test]
fn damping_survives_a_restart_and_negative_damping_is_refused() {
    let run = |solvers: usize, steps: usize| {
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(0.0, 1.4, 0.1)]);
        for _ in 0..solvers {
            let (_, mut solver) = pair(200.0, damped(2, 0.01));
            for _ in 0..steps {
                solver.step(&mut state, StepInput::new(0.01)).unwrap();
            }
        }
        state.positions
    };
    assert_eq!(largest_distance(&run(1, 6), &run(6, 1)), 0.0);
    let particles = Particles::new(vec![1.0]).unwrap();
    for damping in [-1.0, Real::NAN, Real::INFINITY] {
        let built = XpbdSolver::builder(&particles)
            .config(damped(1, damping))
            .build();
        assert!(matches!(built, Err(BuildError::OutOfRange(_))));
    }
}

/// Implicit Euler of `C″ = −ω² C` divides `½ μ (Ċ² + ω² C²)` by `1 + (hω)²`, μ the reduced mass.
#[test]
fn undamped_a_substep_divides_the_energy_by_one_plus_h_omega_squared() {
    for (k, h) in [(3.0, 0.01), (700.0, 0.01), (700.0, 0.1), (2e4, 0.02)] {
        let (_, mut solver) = pair(k, iterations(1));
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x() * 1.1]);
        state.velocities[1].x = 0.5;
        let energy = |state: &State| {
            let c = state.positions[1].x - state.positions[0].x - 1.0;
            let rate = state.velocities[1].x - state.velocities[0].x;
            0.5 * (rate * rate / WEIGHT + k * c * c)
        };
        let before = energy(&state);
        solver.step(&mut state, StepInput::new(h)).unwrap();
        let law = 1.0 / (1.0 + h * h * k * WEIGHT);
        let error = (energy(&state) / before / law - 1.0).abs();
        assert!(error < 1e-11, "{k}, {h}: {error:e}");
    }
}

/// A vertex tied to a point that moves by 0.3 m/s, as fast as the point: neither spring nor dashpot pulls.
fn tied() -> (Particles, [SoftPin; 1], State) {
    let shift = Vec3::new(0.6, 0.0, 0.0);
    let motion = PinMotion {
        shift,
        duration: 2.0,
        ..PinMotion::NONE
    };
    let mut state = State::at_rest(vec![Vec3::y()]);
    state.velocities[0] = shift / motion.duration;
    let pin = SoftPin::new(0, 50.0, Vec3::y(), motion, 0.0);
    (Particles::new(vec![0.3]).unwrap(), [pin], state)
}

fn stays_tied(solver: &mut dyn Stepper, mut state: State) {
    for _ in 0..10 {
        solver.step(&mut state, StepInput::new(0.1)).unwrap();
    }
    let error = state.positions[0] - Vec3::new(0.3, 1.0, 0.0);
    assert!(error.norm() < 1e-13, "{}: {error:?}", solver.name());
}

#[test]
fn a_tie_that_moves_along_is_not_damped() {
    let (particles, pins, state) = tied();
    let config = XpbdConfig {
        substeps: 3,
        damping: 0.2,
        ..XpbdConfig::default()
    };
    let builder = XpbdSolver::builder(&particles).energy(pins.to_vec());
    let mut solver = builder.config(config).build().unwrap();
    stays_tied(&mut solver, state);
    let mut multipliers = Vec::new();
    solver.multipliers_into(0, &mut multipliers);
    assert!(multipliers.iter().all(|lambda| lambda.abs() < 1e-15));
}

#[cfg(feature = "direct")]
#[test]
fn a_tie_that_moves_along_is_not_damped_by_the_direct_solver() {
    let (particles, pins, state) = tied();
    let config = cloth_xpbd::direct::DirectConfig {
        substeps: 3,
        damping: 0.2,
        ..Default::default()
    };
    let builder = cloth_xpbd::direct::DirectXpbd::builder(&particles).energy(pins.to_vec());
    stays_tied(&mut builder.config(config).build().unwrap(), state);
}

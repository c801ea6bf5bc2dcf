//! One oscillator against the closed forms.

use crate::{oscillator, sharp, unwatched};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::{ExplicitEuler, ImplicitEuler, SymplecticEuler};

const OMEGA: Real = 7.0;

/// Position and velocity/ω after each step of size `z/ω`, from position 0.3 m and velocity 1.1 m/s.
fn orbit(mut solver: impl Stepper, z: Real, steps: usize) -> Vec<[Real; 2]> {
    let mut state = State::at_rest(vec![Vec3::new(0.3, 0.0, 0.0)]);
    state.velocities[0].x = 1.1;
    let phase = |state: &State| [state.positions[0].x, state.velocities[0].x / OMEGA];
    let mut orbit = vec![phase(&state)];
    for _ in 0..steps {
        solver.step(&mut state, StepInput::new(z / OMEGA)).unwrap();
        orbit.push(phase(&state));
    }
    orbit
}

fn explicit() -> ExplicitEuler {
    let (particles, springs) = oscillator(OMEGA);
    let builder = ExplicitEuler::builder(&particles).energy(springs);
    builder.config(unwatched()).build().unwrap()
}

fn symplectic() -> SymplecticEuler {
    let (particles, springs) = oscillator(OMEGA);
    let builder = SymplecticEuler::builder(&particles).energy(springs);
    builder.config(unwatched()).build().unwrap()
}

fn implicit() -> ImplicitEuler {
    let (particles, springs) = oscillator(OMEGA);
    let builder = ImplicitEuler::builder(&particles).energy(springs);
    builder.config(sharp()).build().unwrap()
}

/// Growth and clockwise angle from one point of an orbit to the next.
fn growth_and_angle([x0, v0]: [Real; 2], [x1, v1]: [Real; 2]) -> (Real, Real) {
    let growth = x1.hypot(v1) / x0.hypot(v0);
    (growth, (x1 * v0 - x0 * v1).atan2(x0 * x1 + v0 * v1))
}

#[test]
fn explicit_euler_grows_and_turns_as_the_closed_form_says() {
    for z in [0.01, 0.3, 1.0, 3.0] {
        for pair in orbit(explicit(), z, 20).windows(2) {
            let (growth, angle) = growth_and_angle(pair[0], pair[1]);
            assert!(
                (growth / z.hypot(1.0) - 1.0).abs() < 1e-14,
                "z {z}: {growth}"
            );
            assert!((angle - z.atan()).abs() < 1e-14, "z {z}: {angle}");
        }
    }
}

#[test]
fn implicit_euler_shrinks_and_turns_as_the_closed_form_says() {
    for z in [0.01, 0.3, 1.0, 30.0] {
        for pair in orbit(implicit(), z, 8).windows(2) {
            let (growth, angle) = growth_and_angle(pair[0], pair[1]);
            assert!(
                (growth * z.hypot(1.0) - 1.0).abs() < 1e-12,
                "z {z}: {growth}"
            );
            assert!((angle - z.atan()).abs() < 1e-12, "z {z}: {angle}");
        }
    }
}

#[test]
fn symplectic_euler_keeps_its_invariant_below_two() {
    for z in [0.01, 0.5, 1.0, 1.9] {
        let invariant = |[x, v]: [Real; 2]| v * v + x * x - z * x * v;
        let orbit = orbit(symplectic(), z, 10_000);
        let first = invariant(orbit[0]);
        let worst = orbit.iter().map(|&p| (invariant(p) / first - 1.0).abs());
        let worst = worst.fold(0.0, Real::max);
        assert!(worst < 1e-11, "z {z}: {worst:e}");
    }
}

#[test]
fn symplectic_euler_turns_by_twice_the_arc_sine() {
    for z in [0.01, 0.5, 1.0, 1.9] {
        let twice_cosine = 2.0 * (2.0 * (0.5 * z as Real).asin()).cos();
        for p in orbit(symplectic(), z, 50).windows(3) {
            let error = p[2][0] + p[0][0] - twice_cosine * p[1][0];
            assert!(error.abs() < 1e-14, "z {z}: {error:e}");
        }
    }
}

#[test]
fn symplectic_euler_grows_as_the_closed_form_says_above_two() {
    for z in [2.2, 2.5, 4.0] {
        let half_trace: Real = z * z / 2.0 - 1.0;
        let growth = half_trace + (half_trace * half_trace - 1.0).sqrt();
        let orbit = orbit(symplectic(), z, 60);
        let measured = -orbit[60][0] / orbit[59][0];
        assert!((measured / growth - 1.0).abs() < 1e-13, "z {z}: {measured}");
    }
}

#[test]
fn substeps_are_steps() {
    let (particles, springs) = oscillator(OMEGA);
    let mut config = unwatched();
    config.substeps = 5;
    let builder = SymplecticEuler::builder(&particles).energy(springs);
    let cut = orbit(builder.config(config).build().unwrap(), 1.5, 4);
    let whole = orbit(symplectic(), 0.3, 20);
    for (step, point) in cut.iter().enumerate() {
        assert!((point[0] - whole[5 * step][0]).abs() < 1e-14);
    }
}

#[test]
fn one_implicit_step_is_the_weighted_mean_of_prediction_and_target() {
    let (particles, springs) = oscillator(OMEGA);
    let builder = ImplicitEuler::builder(&particles).energy(springs);
    let mut solver = builder.config(sharp()).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::new(1.0, 2.0, 3.0)]);
    state.velocities[0] = Vec3::new(-4.0, 5.0, 0.5);
    let (dt, g) = (0.05, Vec3::new(0.0, 0.0, -9.81));
    let predicted = state.positions[0] + (state.velocities[0] + g * dt) * dt;
    let expected = predicted / (1.0 + (OMEGA * dt) * (OMEGA * dt));
    let before = state.positions[0];
    solver
        .step(&mut state, StepInput::new(dt).gravity(g))
        .unwrap();
    assert!((state.positions[0] - expected).amax() < 1e-14);
    assert!((state.velocities[0] - (expected - before) / dt).amax() < 1e-12);
}

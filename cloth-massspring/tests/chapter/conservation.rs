//! Momenta of a free sheet.

use crate::{all, hang, noise, solver};
use cloth_core::energy::Spring;
use cloth_core::math::Vec3;
use cloth_core::measure::{angular_momentum, linear_momentum};
use cloth_core::method::linear::{LinearMethod, StoppingCriteria};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::{ImplicitConfig, ImplicitEuler};

/// A sheet without pins, crumpled and moving.
fn crumpled() -> (Particles, Vec<Spring>, State) {
    let (mesh, mut model) = hang(9);
    for vertex in 0..model.particles.len() {
        model.particles.release(vertex).unwrap();
    }
    let positions = mesh.positions().iter().enumerate();
    let positions = positions.map(|(i, x)| x * 1.1 + noise(i) * 0.01).collect();
    let mut state = State::at_rest(positions);
    for (i, v) in state.velocities.iter_mut().enumerate() {
        *v = noise(i + 1000) + Vec3::new(0.5, 0.0, 1.0);
    }
    (model.particles, model.springs, state)
}

#[test]
fn linear_momentum_is_kept_by_all() {
    let (particles, springs, start) = crumpled();
    let before = linear_momentum(&particles, &start.velocities);
    for solver in &mut all(&particles, &springs) {
        let mut state = start.clone();
        for _ in 0..40 {
            solver.step(&mut state, StepInput::new(1e-4)).unwrap();
        }
        let change = linear_momentum(&particles, &state.velocities) - before;
        assert!(
            change.norm() < 1e-11 * before.norm(),
            "{}: {change}",
            solver.name()
        );
    }
}

#[test]
fn angular_momentum_is_kept_by_symplectic_euler_and_midpoint_alone() {
    let (particles, springs, start) = crumpled();
    let before = angular_momentum(&particles, &start);
    let changes = all(&particles, &springs).map(|mut solver| {
        let mut state = start.clone();
        for _ in 0..40 {
            solver.step(&mut state, StepInput::new(1e-4)).unwrap();
        }
        (angular_momentum(&particles, &state) - before).norm() / before.norm()
    });
    let [forward, symplectic, implicit, linear, midpoint, bdf2] = changes;
    assert!(
        symplectic < 1e-13 && midpoint < 1e-10,
        "symplectic and midpoint: {changes:?}"
    );
    assert!(
        forward > 1e-6 && implicit > 1e-6 && linear > 1e-6 && bdf2 > 1e-9,
        "the others: {changes:?}"
    );
}

#[test]
fn a_linear_solver_cut_short_costs_no_linear_momentum() {
    let (particles, springs, start) = crumpled();
    let before = linear_momentum(&particles, &start.velocities);
    let config = ImplicitConfig {
        linear: LinearMethod::ConjugateGradients(StoppingCriteria {
            tolerance: 1e-2,
            ..StoppingCriteria::default()
        }),
        ..ImplicitConfig::linearized()
    };
    let mut solver = solver!(ImplicitEuler, &particles, springs, config);
    let mut state = start;
    for _ in 0..40 {
        solver.step(&mut state, StepInput::new(1.0 / 60.0)).unwrap();
    }
    let change = linear_momentum(&particles, &state.velocities) - before;
    println!("relative change {:e}", change.norm() / before.norm());
    assert!(change.norm() < 1e-11 * before.norm(), "{change}");
}

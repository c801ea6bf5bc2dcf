//! Hanging chains at rest, and free fall.

use crate::{DOWN, all, chain, hang, largest_difference, sharp};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::ImplicitEuler;

/// A step so long that inertia has no say: a Newton solver for statics.
const FOR_EVER: Real = 1e8;

#[test]
fn a_hanging_chain_stretches_by_the_closed_form() {
    for (count, tip) in [(1, 0.0), (10, 0.0), (10, 25.0), (60, 3.0)] {
        let k = 5e3;
        let (mut particles, springs, positions) = chain(count, k);
        particles.set_mass(count, 1.0 + tip).unwrap();
        let builder = ImplicitEuler::builder(&particles).energy(springs.clone());
        let mut solver = builder.config(sharp()).build().unwrap();
        let mut state = State::at_rest(positions);
        solver
            .step(&mut state, StepInput::new(FOR_EVER).gravity(DOWN))
            .unwrap();
        let (n, g) = (count as Real, 9.81);
        let drop = -state.positions[count].z - n;
        let expected = n * (n + 1.0) * g / (2.0 * k) + n * tip * g / k;
        assert!(
            (drop - expected).abs() < 1e-10,
            "{count}: {drop} against {expected}"
        );
        for (above, spring) in springs.iter().enumerate() {
            let [a, b] = spring.vertices.map(|v| state.positions[v as usize]);
            let force = k * ((a - b).norm() - spring.rest_length);
            let weight = ((count - above) as Real + tip) * g;
            assert!(
                (force / weight - 1.0).abs() < 1e-10,
                "spring {above}: {force} N"
            );
        }
    }
}

#[test]
fn free_fall_does_not_deform_and_follows_the_sum_of_its_steps() {
    let (mesh, mut model) = hang(9);
    for vertex in 0..model.particles.len() {
        model.particles.release(vertex).unwrap();
    }
    let (dt, steps) = (1e-4, 50);
    let n = steps as Real;
    // Forward Euler moves with the velocity before the step, symplectic and both implicit Eulers with the one after it,
    // midpoint with their mean. BDF2 is exact but for what its first step, of implicit Euler, leaves: a third of it is
    // left after each further one.
    let after = n * (n + 1.0) / 2.0;
    let sums = [
        n * (n - 1.0) / 2.0,
        after,
        after,
        after,
        n * n / 2.0,
        n * n / 2.0 + 0.75 * (1.0 - (-n * 3.0_f64.ln()).exp()),
    ];
    let mut solvers = all(&model.particles, &model.springs);
    assert_eq!(solvers.len(), sums.len());
    for (solver, sum) in solvers.iter_mut().zip(sums) {
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..steps {
            solver
                .step(&mut state, StepInput::new(dt).gravity(DOWN))
                .unwrap();
        }
        let expected: Vec<Vec3> = mesh
            .positions()
            .iter()
            .map(|x| x + DOWN * (dt * dt * sum))
            .collect();
        let error = largest_difference(&state.positions, &expected);
        assert!(error < 2e-13, "{}: {error:e}", solver.name());
    }
}

#[test]
fn a_load_acts_like_a_weight() {
    let (particles, springs, positions) = chain(3, 100.0);
    let builder = ImplicitEuler::builder(&particles).energy(springs);
    let mut solver = builder.config(sharp()).build().unwrap();
    let mut state = State::at_rest(positions);
    let load = vec![Vec3::new(0.0, 0.0, -2.0); 4];
    solver
        .step(&mut state, StepInput::new(FOR_EVER).load(&load))
        .unwrap();
    assert!((state.positions[3].z + 3.0 + 2.0 * 6.0 / 100.0).abs() < 1e-10);
}

//! One sheet of cloth in sixteen materials at three sizes of step each, and of one material by three further laws of
//! springs at one size of step: does every implicit step converge, by which method, and in what time?
//!
//! `cargo run --release -p cloth-massspring --example materials [-- SIDE STEPS]`. It panics if a step does not
//! converge.

use cloth_core::cloth::{Cloth, Discretization, Membrane, SpringLaw};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{Outcome, StepInput, Stepper};
use cloth_massspring::ImplicitEuler;
use std::time::Instant;

/// What the steps of one run took.
#[derive(Debug, Default)]
struct Cost {
    /// Mean over the steps (ms).
    milliseconds: Real,
    /// Mean over the steps, and the most of one.
    iterations: Real,
    most_iterations: u32,
    /// Steps that Newton's method had to finish.
    fallbacks: u32,
    /// Steps that did not converge.
    failures: u32,
}

/// A sheet of 1 m × 1 m, held by two corners, falls from the horizontal.
fn hang(cloth: Cloth, law: SpringLaw, side: usize, dt: Real, steps: u32) -> Cost {
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating).expect("a valid grid");
    let discretization = Discretization {
        law,
        ..Discretization::default()
    };
    let mut model = cloth
        .discretized_with(&discretization, &mesh)
        .expect("a valid cloth");
    for corner in [side * (side - 1), side * side - 1] {
        model.particles.prescribe(corner).expect("a vertex");
    }
    let builder = ImplicitEuler::builder(&model.particles).elements(model.families());
    let mut solver = builder
        .build()
        .expect("elements of this mesh, valid settings");
    let mut state = State::at_rest(mesh.positions().to_vec());
    let mut cost = Cost::default();
    let start = Instant::now();
    for _ in 0..steps {
        let input = StepInput::new(dt).gravity(Vec3::new(0.0, 0.0, -9.81));
        match solver.step(&mut state, input) {
            Ok(report) => {
                cost.iterations += Real::from(report.iterations) / Real::from(steps);
                cost.most_iterations = cost.most_iterations.max(report.iterations);
                cost.fallbacks += report.newton_fallbacks;
                cost.failures += u32::from(report.outcome != Outcome::Converged);
            }
            Err(error) => {
                println!("{error}");
                cost.failures += 1;
            }
        }
    }
    cost.milliseconds = start.elapsed().as_secs_f64() * 1e3 / Real::from(steps);
    cost
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default| {
        arguments
            .next()
            .map_or(default, |a| a.parse().expect("a number"))
    };
    let (side, steps) = (number(33), number(20) as u32);
    println!("{side} vertices a side, {steps} steps");
    println!("k N/m   D N m  law       dt s     ms/step  iterations   most  Newton  failed");
    let mut failures = 0;
    let mut row = |k: Real, rigidity: Real, law: SpringLaw, name: &str, dt: Real| {
        let cloth = Cloth {
            areal_density: 0.2,
            membrane: Membrane::SpringStiffness(k),
            bending_rigidity: rigidity,
        };
        let cost = hang(cloth, law, side, dt, steps);
        println!(
            "{k:<7.0e} {rigidity:<6.0e} {name:<9} {dt:<7.4} {:>8.2}  {:>10.1}  {:>5}  {:>6}  {:>6}",
            cost.milliseconds, cost.iterations, cost.most_iterations, cost.fallbacks, cost.failures
        );
        failures += cost.failures;
    };
    for k in [1e2, 1e4, 1e6, 1e8] {
        for rigidity in [1e-8, 1e-6, 1e-5, 1e-3] {
            for dt in [1e-3, 1.0 / 60.0, 0.1] {
                row(k, rigidity, SpringLaw::Linear, "linear", dt);
            }
        }
    }
    for (name, law) in [
        ("tension", SpringLaw::DeadZone([0.0, 1.0])),
        ("slack 2%", SpringLaw::DeadZone([0.98, 1.02])),
        ("half", SpringLaw::Compression(0.5)),
    ] {
        row(1e4, 1e-5, law, name, 1.0 / 60.0);
    }
    assert_eq!(failures, 0, "steps that did not converge");
}

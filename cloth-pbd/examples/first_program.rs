//! PBD as plain loops over arrays: the naive method, beside the real solver, which takes the same step.
//!
//! `cargo run --release -p cloth-pbd --example first_program`

use cloth_pbd::cloth_core::mesh::generate::{Diagonals, grid};
use cloth_pbd::cloth_core::topology::EdgeTable;
use cloth_pbd::{Particles, Spring, State, StepInput, Stepper, Sweep};
use cloth_pbd::{PbdConfig, PbdSolver, Vec3};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81); // m/s²
const DT: f64 = 1.0 / 60.0; // s
const SUBSTEPS: u32 = 4;
const ITERATIONS: u32 = 10;

/// One step of PBD: positions `x` (m), velocities `v` (m/s), inverse masses `w` (1/kg, 0 where prescribed).
fn step(x: &mut [Vec3], v: &mut [Vec3], w: &[f64], springs: &[Spring]) {
    let h = DT / f64::from(SUBSTEPS);
    for _ in 0..SUBSTEPS {
        // Inertial prediction.
        for i in 0..x.len() {
            if w[i] > 0.0 {
                v[i] += GRAVITY * h;
            }
            x[i] += v[i] * h;
        }
        let predicted = x.to_vec();
        // Sweeps.
        for _ in 0..ITERATIONS {
            for spring in springs {
                let [a, b] = spring.vertices.map(|vertex| vertex as usize);
                let d = x[a] - x[b];
                let value = d.norm() - spring.rest_length; // C
                let gradient = d / d.norm(); // ∂C/∂xₐ; that of the other end is its negative
                let weight = w[a] + w[b]; // w̃
                if weight > 0.0 {
                    // The fraction of C that n visits of one spring alone need for its stiffness k.
                    let ratio = 1.0 + spring.stiffness * h * h * weight;
                    let s = 1.0 - ratio.powf(-1.0 / f64::from(ITERATIONS));
                    let change = -s * value / weight; // Δλ
                    x[a] += gradient * (w[a] * change);
                    x[b] -= gradient * (w[b] * change);
                }
            }
        }
        // Velocities from positions.
        for i in 0..x.len() {
            v[i] += (x[i] - predicted[i]) / h;
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let side = 12;
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating)?;
    let springs = Spring::along(mesh.positions(), EdgeTable::build(&mesh)?.ends(), 1e4);
    let mut particles = Particles::new(vec![0.2 / (side * side) as f64; side * side])?;
    particles.prescribe(0)?;
    particles.prescribe(side - 1)?;
    let mut solver = PbdSolver::builder(&particles)
        .energy(springs.clone())
        .config(PbdConfig {
            iterations: ITERATIONS,
            substeps: SUBSTEPS,
            sweep: Sweep::Sequential, // the order of the loop above
            ..PbdConfig::default()
        })
        .build()?;
    let mut real = State::at_rest(mesh.positions().to_vec());
    let mut naive = real.clone();
    for _ in 0..30 {
        let (x, v) = (&mut naive.positions, &mut naive.velocities);
        step(x, v, particles.inverse_mass(), &springs);
        solver.step(&mut real, StepInput::new(DT).gravity(GRAVITY))?;
    }
    let distance = |a: &[Vec3], b: &[Vec3]| {
        let pairs = a.iter().zip(b);
        pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    };
    let apart = distance(&naive.positions, &real.positions);
    let fall = distance(&naive.positions, mesh.positions());
    println!(
        "after 30 steps the sheet has moved by {fall:.3} m; the two programs are {apart:.1e} m apart"
    );
    assert!(fall > 0.5 && apart < 1e-13, "{fall} {apart:e}");
    Ok(())
}

#[test]
fn the_naive_loop_and_the_solver_take_the_same_steps() {
    main().unwrap();
}

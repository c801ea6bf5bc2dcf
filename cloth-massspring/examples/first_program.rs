//! Implicit Euler by Newton's method as plain loops over arrays: the naive method, beside the real solver.
//!
//! `cargo run --release -p cloth-massspring --example first_program`

use cloth_massspring::cloth_core::mesh::generate::{Diagonals, grid};
use cloth_massspring::cloth_core::topology::EdgeTable;
use cloth_massspring::{ImplicitConfig, ImplicitEuler, Particles, Spring, State};
use cloth_massspring::{StepInput, Stepper, Vec3};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81); // m/s²
const DT: f64 = 1.0 / 60.0; // s

/// `G(x) = ‖x − x̃‖²_M/(2Δt²) + Σ ½ k (l − L)²` (J).
fn objective(x: &[Vec3], predicted: &[Vec3], mass: &[f64], springs: &[Spring]) -> f64 {
    let inertia = x.iter().zip(predicted).zip(mass);
    let inertia = inertia.map(|((x, to), m)| 0.5 * m * (x - to).norm_squared() / (DT * DT));
    let elastic = springs.iter().map(|spring| {
        let [i, j] = spring.vertices.map(|vertex| vertex as usize);
        0.5 * spring.stiffness * ((x[i] - x[j]).norm() - spring.rest_length).powi(2)
    });
    inertia.sum::<f64>() + elastic.sum::<f64>()
}

/// `∇G` (N) and its positive definite second derivative (N/m), dense; rows of prescribed vertices are those of the
/// identity. Their columns are left as they are: their displacements are 0, and with these the answer is the same.
fn derivatives(
    x: &[Vec3],
    predicted: &[Vec3],
    particles: &Particles,
    springs: &[Spring],
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = 3 * x.len();
    let (mut gradient, mut hessian) = (vec![0.0; n], vec![vec![0.0; n]; n]);
    for row in 0..n {
        let inertia = particles.mass()[row / 3] / (DT * DT);
        hessian[row][row] = inertia;
        gradient[row] = inertia * (x[row / 3][row % 3] - predicted[row / 3][row % 3]);
    }
    for spring in springs {
        let [i, j] = spring.vertices.map(|vertex| vertex as usize);
        let (d, k) = (x[i] - x[j], spring.stiffness);
        let (length, direction) = (d.norm(), d.normalize());
        let tension = k * (length - spring.rest_length);
        // Along the spring k, across it tension over length: negative where compressed, and then left out.
        let across = (tension / length).max(0.0);
        for a in 0..3 {
            gradient[3 * i + a] += tension * direction[a];
            gradient[3 * j + a] -= tension * direction[a];
            for b in 0..3 {
                let identity = if a == b { across } else { 0.0 };
                let block = identity + (k - across) * direction[a] * direction[b];
                hessian[3 * i + a][3 * i + b] += block;
                hessian[3 * j + a][3 * j + b] += block;
                hessian[3 * i + a][3 * j + b] -= block;
                hessian[3 * j + a][3 * i + b] -= block;
            }
        }
    }
    for row in (0..n).filter(|row| particles.is_prescribed(row / 3)) {
        gradient[row] = 0.0;
        hessian[row].fill(0.0);
        hessian[row][row] = 1.0;
    }
    (gradient, hessian)
}

/// Gauss elimination: `A⁻¹ b`.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    for k in 0..b.len() {
        let pivot_row = a[k].clone();
        for i in k + 1..b.len() {
            let factor = a[i][k] / pivot_row[k];
            if factor != 0.0 {
                b[i] -= factor * b[k];
                for j in k..pivot_row.len() {
                    a[i][j] -= factor * pivot_row[j];
                }
            }
        }
    }
    for i in (0..b.len()).rev() {
        let known: f64 = (i + 1..b.len()).map(|j| a[i][j] * b[j]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}

/// One step of implicit Euler: positions `x` (m) and velocities `v` (m/s).
fn step(x: &mut [Vec3], v: &mut [Vec3], particles: &Particles, springs: &[Spring]) {
    let before = x.to_vec();
    for i in 0..x.len() {
        x[i] += v[i] * DT; // the first iterate
    }
    let is_free = |i: &usize| !particles.is_prescribed(*i);
    let mut predicted = x.to_vec(); // x̃
    (0..x.len())
        .filter(is_free)
        .for_each(|i| predicted[i] += GRAVITY * (DT * DT));
    for _ in 0..100 {
        let (gradient, hessian) = derivatives(x, &predicted, particles, springs);
        if gradient.iter().map(|g| g * g).sum::<f64>().sqrt() < 1e-9 {
            break;
        }
        let direction = solve(hessian, gradient.clone());
        let slope: f64 = gradient.iter().zip(&direction).map(|(g, p)| -g * p).sum();
        let value = |x: &[Vec3]| objective(x, &predicted, particles.mass(), springs);
        let (from, start, mut length) = (x.to_vec(), value(x), 1.0);
        loop {
            for i in 0..x.len() {
                x[i] = from[i] - Vec3::from_fn(|a, _| direction[3 * i + a]) * length;
            }
            // Armijo's condition, up to the rounding of G.
            if value(x) <= start + 1e-4 * length * slope + 1e-14 * start.abs() {
                break;
            }
            length *= 0.5;
        }
    }
    for i in 0..x.len() {
        v[i] = (x[i] - before[i]) / DT;
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let side = 6;
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating)?;
    let springs = Spring::along(mesh.positions(), EdgeTable::build(&mesh)?.ends(), 1e2);
    let mut particles = Particles::new(vec![0.2 / (side * side) as f64; side * side])?;
    particles.prescribe(0)?;
    particles.prescribe(side - 1)?;
    let mut solver = ImplicitEuler::builder(&particles)
        .energy(springs.clone())
        .config(ImplicitConfig {
            tolerance: 0.0, // as far as rounding allows
            ..ImplicitConfig::default()
        })
        .build()?;
    let mut real = State::at_rest(mesh.positions().to_vec());
    let mut naive = real.clone();
    for _ in 0..30 {
        let (x, v) = (&mut naive.positions, &mut naive.velocities);
        step(x, v, &particles, &springs);
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
    assert!(fall > 0.5 && apart < 1e-9, "{fall} {apart:e}");
    Ok(())
}

#[test]
fn the_naive_loop_and_the_solver_take_the_same_steps() {
    main().unwrap();
}

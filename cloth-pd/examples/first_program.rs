//! Projective dynamics as plain loops over arrays: the naive method, beside the real solver, which takes the same step.
//!
//! `cargo run --release -p cloth-pd --example first_program`

use cloth_pd::cloth_core::mesh::generate::{Diagonals, grid};
use cloth_pd::cloth_core::topology::EdgeTable;
use cloth_pd::{Particles, PdConfig, PdSolver, Spring, State, StepInput, Stepper, Vec3};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81); // m/s²
const DT: f64 = 1.0 / 60.0; // s
const ITERATIONS: u32 = 10; // of a step, as PdConfig::plain() says

/// The global matrix `A = M/Δt² + Σ w SᵀS` (N/m), dense; the row of a prescribed vertex is that of the identity.
fn assemble(particles: &Particles, springs: &[Spring]) -> Vec<Vec<f64>> {
    let n = particles.len();
    let mut a = vec![vec![0.0; n]; n];
    for i in 0..n {
        a[i][i] = particles.mass()[i] / (DT * DT);
    }
    for spring in springs {
        // z = S x is the difference of the ends: S has the entries 1 and −1, and w is the spring's stiffness.
        for (i, g_i) in spring.vertices.into_iter().zip([1.0, -1.0]) {
            for (j, g_j) in spring.vertices.into_iter().zip([1.0, -1.0]) {
                a[i as usize][j as usize] += spring.stiffness * g_i * g_j;
            }
        }
    }
    // The columns stay, so A is not symmetric here, which LU allows; the solver drops both and takes Cholesky's.
    for i in (0..n).filter(|&i| particles.is_prescribed(i)) {
        a[i].fill(0.0);
        a[i][i] = 1.0;
    }
    a
}

/// Factorises `A = L U` in place, once for all iterations of all steps.
fn factorize(a: &mut [Vec<f64>]) {
    for k in 0..a.len() {
        let pivot_row = a[k].clone();
        for row in &mut a[k + 1..] {
            row[k] /= pivot_row[k];
            for j in k + 1..row.len() {
                row[j] -= row[k] * pivot_row[j];
            }
        }
    }
}

/// Solves `L U x = b`, in the place of b.
fn solve(lu: &[Vec<f64>], b: &mut [Vec3]) {
    for i in 0..b.len() {
        for j in 0..i {
            b[i] -= b[j] * lu[i][j];
        }
    }
    for i in (0..b.len()).rev() {
        for j in i + 1..b.len() {
            b[i] -= b[j] * lu[i][j];
        }
        b[i] /= lu[i][i];
    }
}

/// One step: positions `x` (m) and velocities `v` (m/s).
fn step(
    x: &mut [Vec3],
    v: &mut [Vec3],
    particles: &Particles,
    springs: &[Spring],
    lu: &[Vec<f64>],
) {
    let before = x.to_vec();
    for i in 0..x.len() {
        if !particles.is_prescribed(i) {
            v[i] += GRAVITY * DT;
        }
        x[i] += v[i] * DT; // x̃
    }
    let predicted = x.to_vec();
    for _ in 0..ITERATIONS {
        let inertia = predicted.iter().zip(particles.mass());
        let mut b: Vec<Vec3> = inertia.map(|(x, m)| x * (m / (DT * DT))).collect();
        // Local step: the vector of rest length nearest to z = S x, and b = M x̃/Δt² + Σ w Sᵀ p.
        for spring in springs {
            let [i, j] = spring.vertices.map(|vertex| vertex as usize);
            let p = (x[i] - x[j]).normalize() * spring.rest_length;
            b[i] += p * spring.stiffness;
            b[j] -= p * spring.stiffness;
        }
        for i in (0..x.len()).filter(|&i| particles.is_prescribed(i)) {
            b[i] = predicted[i];
        }
        // Global step: A x = b.
        solve(lu, &mut b);
        x.copy_from_slice(&b);
    }
    for i in 0..x.len() {
        v[i] = (x[i] - before[i]) / DT;
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let side = 12;
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating)?;
    let springs = Spring::along(mesh.positions(), EdgeTable::build(&mesh)?.ends(), 1e2);
    let mut particles = Particles::new(vec![0.2 / (side * side) as f64; side * side])?;
    particles.prescribe(0)?;
    particles.prescribe(side - 1)?;
    let mut lu = assemble(&particles, &springs);
    factorize(&mut lu);
    let mut solver = PdSolver::builder(&particles)
        .energy(springs.clone())
        .config(PdConfig::plain()) // the loop above; the default converges faster
        .build()?;
    let mut real = State::at_rest(mesh.positions().to_vec());
    let mut naive = real.clone();
    for _ in 0..30 {
        let (x, v) = (&mut naive.positions, &mut naive.velocities);
        step(x, v, &particles, &springs, &lu);
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
    assert!(fall > 0.5 && apart < 1e-12, "{fall} {apart:e}");
    Ok(())
}

#[test]
fn the_naive_loop_and_the_solver_take_the_same_steps() {
    main().unwrap();
}

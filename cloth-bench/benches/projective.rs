//! What a step of projective dynamics is made of, on the hanging sheet: the global solve against the library's, the
//! factorisation, the correction for changed rows, the local step, whole steps.

use cloth_bench::scene::{self, Scene};
use cloth_bench::settings::Settings;
use cloth_bench::studies::{constant_matrix, local_bytes, move_bytes};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::linear::Cholesky;
use cloth_core::step::{StepInput, Stepper};
use cloth_pd::{Acceleration, LocalStep, PdConfig, PdSolver};
use cloth_pd::{PanelFactor, WoodburyUpdate};
use criterion::{Criterion, Throughput};
use std::hint::black_box;
use support::limit;

fn sheet(side: u32) -> Scene {
    scene::build("hang", None, &Settings::default().with("n", side)).expect("a scene")
}

fn panels_of(cholesky: &Cholesky) -> PanelFactor {
    PanelFactor::new(cholesky.factor())
}

/// Bytes that a solve has to read: every number of the factor twice.
fn global_solve(criterion: &mut Criterion) {
    for side in [64, 128, 256, 512] {
        let scene = sheet(side);
        let count = scene.start.positions.len();
        let mut cholesky = constant_matrix(&scene).expect("a factor");
        let mut panels = panels_of(&cholesky);
        let mut group = criterion.benchmark_group(format!("projective solve, {side} a side"));
        group.sample_size(20);
        group.throughput(Throughput::Bytes(16 * cholesky.factor_len() as u64));
        let mut columns: Vec<Real> = (0..3 * count).map(|i| (i as Real).sin()).collect();
        let bytes = 16 * cholesky.factor_len();
        limit::bench(&mut group, "library", bytes, || {
            cholesky.solve_in_place(&mut columns);
        });
        let b = &scene.start.positions;
        let mut solution = vec![Vec3::zeros(); count];
        limit::bench(&mut group, "panels", bytes, || {
            panels.solve(black_box(b), &mut solution);
        });
    }
}

/// Refactoring against setting up a correction of rank k, and what the correction adds to every solve.
///
/// Factorising reads the matrix and writes the factor twice, as the library has it and as panels; a correction of rank
/// k takes a solve for every three columns, and reads those columns whenever it is applied.
fn changes(criterion: &mut Criterion) {
    for side in [32, 64, 128, 256] {
        let scene = sheet(side);
        let count = scene.start.positions.len();
        let mut cholesky = constant_matrix(&scene).expect("a factor");
        let mut panels = panels_of(&cholesky);
        let (given, factor) = (cholesky.values_mut().len(), cholesky.factor_len());
        let mut group = criterion.benchmark_group(format!("projective change, {side} a side"));
        group.sample_size(10);
        group.throughput(Throughput::Elements(factor as u64));
        limit::bench(&mut group, "factorise", 8 * (given + 2 * factor), || {
            cholesky.factorize().expect("positive definite");
            panels.refill(cholesky.factor());
        });
        let b = &scene.start.positions;
        let mut solution = vec![Vec3::zeros(); count];
        limit::bench(&mut group, "solve", 16 * factor, || {
            panels.solve(black_box(b), &mut solution);
        });
        for rank in [1, 3, 10, 30, 100] {
            let mut low_rank = WoodburyUpdate::default();
            for column in 0..rank {
                low_rank.push([((column * 7919 % count) as u32, 1.0)]);
            }
            let solves = limit::Moved::times(rank.div_ceil(3) as u32, 16 * factor);
            limit::bench(
                &mut group,
                format!("set up a correction/{rank}"),
                solves,
                || low_rank.prepare(count, |b, x| panels.solve(b, x)),
            );
            let columns = (8 * rank + 48) * count;
            limit::bench(
                &mut group,
                format!("correct a solve/{rank}"),
                columns,
                || {
                    low_rank.correct(&mut solution);
                },
            );
        }
    }
}

/// The projections of all springs, and reading and writing the same bytes without them: two positions and two forces
/// (24 B each, the forces read and written) and a spring (24 B).
fn local_step(criterion: &mut Criterion) {
    for side in [128, 256, 512] {
        let scene = sheet(side);
        let (springs, x) = (&scene.model.springs, &scene.start.positions);
        let mut forces = vec![Vec3::zeros(); x.len()];
        let mut group = criterion.benchmark_group(format!("projective local step, {side} a side"));
        let bytes = local_bytes(springs, x);
        group.throughput(Throughput::Bytes(bytes as u64));
        let mut local = LocalStep::new(&scene.model.particles, springs.clone()).expect("springs");
        limit::bench(&mut group, "project springs", bytes as usize, || {
            local.add_gradient(black_box(x), &mut forces)
        });
        group.bench_function("read and write the same bytes", |bencher| {
            bencher.iter(|| move_bytes(black_box(springs), x, &mut forces));
        });
    }
}

/// Iterations of a step.
const ITERATIONS: u32 = 10;

/// One step at a quarter of a second into the fall, with each acceleration. Every iteration reads the factor twice, and
/// what the local step moves.
fn steps(criterion: &mut Criterion) {
    for side in [64, 128] {
        let scene = sheet(side);
        let springs = &scene.model.springs;
        let build = |acceleration| {
            PdSolver::builder(&scene.model.particles)
                .energy(springs.clone())
                .energy(scene.model.hinges.clone())
                .coarse_grid(&scene.start.positions, 12)
                .config(PdConfig {
                    iterations: Some(ITERATIONS),
                    acceleration,
                    ..PdConfig::default()
                })
                .build()
                .expect("a solver")
        };
        let quasi_newton = Acceleration::QuasiNewton { history: 2 };
        let mut solver = build(quasi_newton);
        let mut state = scene.start.clone();
        let input = || StepInput::new(scene.dt).gravity(scene.gravity);
        for _ in 0..15 {
            solver.step(&mut state, input()).expect("a step");
        }
        let factor = constant_matrix(&scene).expect("a factor").factor_len();
        let bytes = 16 * factor + local_bytes(springs, &state.positions);
        let moved = limit::Moved::times(ITERATIONS, bytes);
        let mut group = criterion.benchmark_group(format!("projective step, {side} a side"));
        group.sample_size(10);
        let chebyshev = Acceleration::Chebyshev {
            spectral_radius: Some(0.99),
        };
        for (name, acceleration) in [
            ("plain", Acceleration::None),
            ("chebyshev", chebyshev),
            ("quasi-newton", quasi_newton),
        ] {
            let mut solver = build(acceleration);
            let mut end = state.clone();
            limit::bench(&mut group, name, moved, || {
                end.clone_from(&state);
                solver.step(&mut end, input())
            });
        }
    }
}

fn main() {
    limit::main(&[global_solve, changes, local_step, steps]);
}

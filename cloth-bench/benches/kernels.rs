//! The inner loops, one by one: each line is a kernel on the hanging sheet of 128 × 128 vertices. The throughput
//! that criterion prints is elements, blocks or nonzeros per second, so its inverse is the time of one.

use cloth_bench::scene::{self, Scene};
use cloth_bench::settings::Settings;
use cloth_core::block_matrix::BlockMatrix;
use cloth_core::coloring::Colored;
use cloth_core::element::{Convexity, Element};
use cloth_core::energy::Spring;
use cloth_core::family::Energies;
use cloth_core::linear::{
    BlockCholesky, Budget, Cholesky, LinearMethod, PanelFactor, UpperPattern,
};
use cloth_core::math::{Real, Vec3};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

const SIDE: u32 = 128;

fn sheet(side: u32) -> Scene {
    scene::build("hang", None, &Settings::default().with("n", side)).expect("a scene")
}

/// Reading and writing memory: what every kernel is held against.
fn bandwidth(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bandwidth");
    for (name, count) in [
        ("triad in L2", 12_000),
        ("triad in L3", 400_000),
        ("triad in memory", 8_000_000),
    ] {
        let (b, c) = (vec![1.0; count], vec![2.0; count]);
        let mut a: Vec<Real> = vec![0.0; count];
        group.throughput(Throughput::Bytes(24 * count as u64));
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
                    *a = b + 3.0 * c;
                }
                black_box(&mut a);
            });
        });
    }
}

/// One Gauss–Seidel sweep of distance projections, in vertex order and colour by colour.
fn projections(criterion: &mut Criterion) {
    let scene = sheet(SIDE);
    let springs = &scene.model.springs;
    let count = scene.start.positions.len();
    let project = |spring: &Spring, (): &mut (), x: &mut [Vec3; 2]| {
        let d = x[0] - x[1];
        let length = d.norm();
        let shift = d * (0.5 * (1.0 - spring.rest_length / length));
        x[0] -= shift;
        x[1] += shift;
    };
    let mut group = criterion.benchmark_group("distance projection");
    group.throughput(Throughput::Elements(springs.len() as u64));
    let mut none = vec![(); springs.len()];
    for (name, order) in [
        ("vertex order", Colored::in_input_order(springs, count)),
        ("coloured", Colored::new(springs, count)),
    ] {
        let mut x = scene.start.positions.clone();
        group.bench_function(name, |bencher| {
            bencher.iter(|| order.sweep(&mut none, &mut x, project))
        });
    }
}

/// Energies, gradients and Hessians of springs and hinges.
fn elements(criterion: &mut Criterion) {
    let scene = sheet(SIDE);
    let x = &scene.start.positions;
    let families = [
        (
            "springs",
            Energies::new(x.len()).with(scene.model.springs.clone()),
            scene.model.springs.len(),
        ),
        (
            "hinges",
            Energies::new(x.len()).with(scene.model.hinges.clone()),
            scene.model.hinges.len(),
        ),
    ];
    for (name, energies, count) in families {
        let mut energies = energies.expect("elements of the sheet");
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function("value", |bencher| {
            bencher.iter(|| energies.value(black_box(x)))
        });
        let mut gradient = vec![Vec3::zeros(); x.len()];
        group.bench_function("gradient", |bencher| {
            bencher.iter(|| energies.add_gradient(black_box(x), &mut gradient))
        });
        let mut matrix = BlockMatrix::zeros(energies.bind_pattern());
        group.bench_function("hessian into slots", |bencher| {
            bencher.iter(|| energies.add_hessian(black_box(x), 1.0, Convexity::Clamp, &mut matrix));
        });
    }
}

/// `M/Δt² + H` of a sheet at rest, Δt = 1/60 s.
fn implicit_matrix(scene: &Scene) -> BlockMatrix {
    let mut energies = scene.model.energies().expect("elements of the sheet");
    let mut matrix = BlockMatrix::zeros(energies.bind_pattern());
    energies.add_hessian(&scene.start.positions, 1.0, Convexity::Clamp, &mut matrix);
    matrix.add_diagonal(scene.model.particles.mass().iter().map(|m| m * 3600.0));
    matrix
}

/// The block matrix of a Newton iteration: product, factorisation, solve.
fn newton_matrix(criterion: &mut Criterion) {
    let scene = sheet(SIDE);
    let x = &scene.start.positions;
    let matrix = implicit_matrix(&scene);
    let mut y = vec![Vec3::zeros(); x.len()];
    let mut group = criterion.benchmark_group("block matrix");
    group.throughput(Throughput::Elements(matrix.pattern().block_count() as u64));
    group.bench_function("product", |bencher| {
        bencher.iter(|| matrix.multiply(black_box(x), &mut y))
    });
    let free = vec![true; x.len()];
    let mut cholesky = BlockCholesky::analyze(matrix.pattern(), &free).expect("memory");
    group.sample_size(10);
    group.throughput(Throughput::Elements(cholesky.factor_len() as u64));
    group.bench_function("factorise", |bencher| {
        bencher.iter(|| cholesky.factorize(&matrix))
    });
    group.bench_function("solve", |bencher| {
        bencher.iter(|| cholesky.solve(x, &mut y))
    });
}

/// One iteration of each linear solver, or one factorisation and solve: the same matrix.
fn linear_solvers(criterion: &mut Criterion) {
    for side in [128, 256] {
        let scene = sheet(side);
        let x = &scene.start.positions;
        let matrix = implicit_matrix(&scene);
        let mut y = vec![Vec3::zeros(); x.len()];
        let mut group = criterion.benchmark_group(format!("linear solver, {side} a side"));
        group.sample_size(10);
        group.bench_function("product", |bencher| {
            bencher.iter(|| matrix.multiply(black_box(x), &mut y))
        });
        let budget = Budget {
            tolerance: 0.0,
            max_iterations: ITERATIONS,
        };
        for method in [
            LinearMethod::ConjugateGradients(budget),
            LinearMethod::ChebyshevJacobi(budget),
            LinearMethod::Jacobi(budget),
            LinearMethod::GaussSeidel(budget),
        ] {
            let free = vec![true; x.len()];
            let mut solver = method.build(matrix.pattern(), &free).expect("memory");
            solver.prepare(&matrix).expect("a positive definite matrix");
            let name = format!("{}, {ITERATIONS} iterations", solver.name());
            group.bench_function(name, |bencher| {
                bencher.iter(|| solver.solve(&matrix, black_box(x), &mut y))
            });
        }
    }
}

/// Iterations of an iterative solver in one measurement.
const ITERATIONS: u32 = 10;

/// The V × V matrix of projective dynamics: x, y and z at once, by the library's solve and by panels.
fn global_solve(criterion: &mut Criterion) {
    for side in [64, 128, 256] {
        let scene = sheet(side);
        let count = scene.start.positions.len();
        let mut cholesky = laplacian(&scene);
        cholesky.factorize().expect("a positive definite matrix");
        let mut panels = PanelFactor::new(cholesky.factor());
        let mut group = criterion.benchmark_group(format!("three right-hand sides, {side} a side"));
        group.throughput(Throughput::Elements(cholesky.factor_len() as u64));
        let mut columns: Vec<Real> = (0..3 * count).map(|i| (i as Real).sin()).collect();
        group.bench_function("library", |bencher| {
            bencher.iter(|| cholesky.solve_in_place(&mut columns))
        });
        let b = scene.start.positions;
        let mut solution = vec![Vec3::zeros(); count];
        group.bench_function("panels", |bencher| {
            bencher.iter(|| panels.solve(black_box(&b), &mut solution))
        });
    }
}

/// `M + 20 L` of the springs.
fn laplacian(scene: &Scene) -> Cholesky {
    let count = scene.start.positions.len();
    let mut columns: Vec<Vec<(u32, Real)>> = (0..count as u32).map(|v| vec![(v, 1.0)]).collect();
    for spring in &scene.model.springs {
        let [a, b] = spring.vertices();
        columns[a.max(b) as usize].push((a.min(b), -20.0));
        for end in [a, b] {
            columns[end as usize][0].1 += 20.0;
        }
    }
    let mut pattern = UpperPattern {
        column_offsets: vec![0],
        rows: Vec::new(),
    };
    let mut values = Vec::new();
    for column in &mut columns {
        column.sort_by_key(|entry| entry.0);
        pattern.rows.extend(column.iter().map(|entry| entry.0));
        values.extend(column.iter().map(|entry| entry.1));
        pattern.column_offsets.push(values.len() as u32);
    }
    let mut cholesky = Cholesky::analyze(pattern).expect("memory");
    cholesky.values_mut().copy_from_slice(&values);
    cholesky
}

criterion_group!(
    benches,
    bandwidth,
    projections,
    elements,
    newton_matrix,
    linear_solvers,
    global_solve
);
criterion_main!(benches);

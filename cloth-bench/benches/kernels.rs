//! Linear algebra on the matrices of the hanging sheet, at three sizes: products, factorisations, solves, iterations,
//! eigenvalues.
//!
//! Elements have a bench of their own (`elements`), sweeps (`sweeps`), what projective dynamics does with its factor
//! (`projective`).

use cloth_bench::scene::Scene;
use cloth_core::element::{Convexity, Element};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::linear::{
    BlockCholesky, Cholesky, LinearMethod, Preconditioner, QuasidefiniteLdlt, StoppingCriteria,
    UpperPattern, spectrum,
};
use cloth_pd::PanelFactor;
use cloth_xpbd::direct::Minres;
use criterion::{Criterion, Throughput};
use support::limit;
use support::limit::Moved;
use support::sheet::sheet;

const SIDES: [u32; 3] = [64, 128, 256];

/// `M/Δt² + H` of a sheet at rest, Δt = 1/60 s.
fn implicit_matrix(scene: &Scene) -> BlockMatrix {
    let energies = scene.model.energies().expect("elements of the sheet");
    let mut matrix = energies.hessian(&scene.start.positions, Convexity::Clamp);
    matrix.add_diagonal(scene.model.particles.mass().iter().map(|m| m * 3600.0));
    matrix
}

/// The block matrix of a Newton iteration: product, factorisation, solve. A factorisation has to write the factor, a
/// solve to read it twice.
fn newton_matrix(criterion: &mut Criterion) {
    for side in SIDES {
        let scene = sheet(side);
        let x = &scene.start.positions;
        let matrix = implicit_matrix(&scene);
        let (of_matrix, vector) = (bytes_of(&matrix), size_of_val(&x[..]));
        let mut y = vec![Vec3::zeros(); x.len()];
        let mut group = criterion.benchmark_group(format!("block matrix, {side} a side"));
        group.throughput(Throughput::Elements(matrix.pattern().block_count() as u64));
        limit::bench(&mut group, "product", of_matrix + 2 * vector, || {
            matrix.multiply(x, &mut y);
        });
        let free = vec![true; x.len()];
        let mut cholesky = BlockCholesky::analyze(matrix.pattern(), &free).expect("memory");
        let factor = cholesky.factor_len() * size_of::<Real>();
        group.sample_size(10);
        group.throughput(Throughput::Elements(cholesky.factor_len() as u64));
        limit::bench(&mut group, "factorise", of_matrix + factor, || {
            cholesky.factorize(&matrix)
        });
        limit::bench(&mut group, "solve", 2 * factor + 2 * vector, || {
            cholesky.solve(x, &mut y);
        });
    }
}

/// Bytes of the blocks of a matrix and of their columns.
fn bytes_of(matrix: &BlockMatrix) -> usize {
    size_of_val(matrix.blocks()) + size_of_val(matrix.pattern().columns())
}

/// Ten iterations of each iterative solver on the same matrix. Each iteration has to read the matrix.
fn linear_solvers(criterion: &mut Criterion) {
    for side in SIDES {
        let scene = sheet(side);
        let x = &scene.start.positions;
        let matrix = implicit_matrix(&scene);
        let moved = Moved::times(ITERATIONS, bytes_of(&matrix) + 2 * size_of_val(&x[..]));
        let mut y = vec![Vec3::zeros(); x.len()];
        let mut group = criterion.benchmark_group(format!("linear solver, {side} a side"));
        group.sample_size(10);
        let budget = StoppingCriteria {
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
            let mut solver = method
                .build(matrix.pattern(), &free, Some(&scene.start.positions))
                .expect("memory");
            solver.prepare(&matrix).expect("a positive definite matrix");
            let name = format!("{}, {ITERATIONS} iterations", solver.name());
            limit::bench(&mut group, name, moved, || solver.solve(&matrix, x, &mut y));
        }
    }
}

/// Iterations of an iterative solver in one measurement.
const ITERATIONS: u32 = 10;

/// The outermost eigenvalues by so many steps of conjugate gradients, with and without preconditioner.
fn eigenvalues(criterion: &mut Criterion) {
    const STEPS: u32 = 100;
    for side in SIDES {
        let scene = sheet(side);
        let matrix = implicit_matrix(&scene);
        let free = vec![true; scene.start.positions.len()];
        let vector = size_of_val(&scene.start.positions[..]);
        let moved = Moved::times(STEPS, bytes_of(&matrix) + 2 * vector);
        let mut group = criterion.benchmark_group(format!("spectrum, {side} a side"));
        group.sample_size(10);
        for (name, preconditioner) in [
            ("of the matrix", Preconditioner::Identity),
            ("with block Jacobi", Preconditioner::BlockJacobi),
        ] {
            let name = format!("{name}, {STEPS} steps");
            limit::bench(&mut group, name, moved, || {
                spectrum(&matrix, &free, preconditioner, STEPS)
            });
        }
    }
}

/// The saddle-point matrix `[M/Δt² Jᵀ; J −1/k]` of the springs, of which XPBD's direct solver factorises one an
/// iteration: the signed factorisation, and a solve.
fn saddle_factor(criterion: &mut Criterion) {
    for side in [32, 64, 128] {
        let scene = sheet(side);
        let (pattern, values) = saddle(&scene);
        let positive = 3 * scene.start.positions.len();
        let mut cholesky = QuasidefiniteLdlt::analyze(pattern, positive).expect("memory");
        cholesky.values_mut().copy_from_slice(&values);
        let mut group = criterion.benchmark_group(format!("saddle-point factor, {side} a side"));
        group.sample_size(10);
        group.throughput(Throughput::Elements(cholesky.factor_len() as u64));
        let factor = cholesky.factor_len() * size_of::<Real>();
        let bytes = factor + size_of_val(&values[..]);
        limit::bench(&mut group, "factorise", bytes, || cholesky.factorize());
        cholesky.factorize().expect("a quasi-definite matrix");
        let rows = positive + scene.model.springs.len();
        let mut column: Vec<Real> = (0..rows).map(|i| (i as Real).sin()).collect();
        let bytes = 2 * factor + 2 * size_of_val(&column[..]);
        limit::bench(&mut group, "solve", bytes, || {
            cholesky.solve_in_place(&mut column);
        });
    }
}

/// Columns of the upper half, and its numbers: Δt = 1/60 s.
fn saddle(scene: &Scene) -> (UpperPattern, Vec<Real>) {
    let x = &scene.start.positions;
    let mut pattern = UpperPattern {
        column_offsets: vec![0],
        rows: Vec::new(),
    };
    let mut values = Vec::new();
    let mut close = |column: &mut Vec<(u32, Real)>| {
        column.sort_by_key(|entry| entry.0);
        pattern.rows.extend(column.iter().map(|entry| entry.0));
        values.extend(column.drain(..).map(|entry| entry.1));
        pattern.column_offsets.push(values.len() as u32);
    };
    let mut column = Vec::new();
    for (vertex, mass) in scene.model.particles.mass().iter().enumerate() {
        for axis in 0..3 {
            column.push((3 * vertex as u32 + axis, mass * 3600.0));
            close(&mut column);
        }
    }
    for (number, spring) in scene.model.springs.iter().enumerate() {
        let [a, b] = spring.vertices();
        let along = (x[b as usize] - x[a as usize]).normalize();
        for axis in 0..3 {
            column.push((3 * a + axis, -along[axis as usize]));
            column.push((3 * b + axis, along[axis as usize]));
        }
        column.push(((3 * x.len() + number) as u32, -1.0 / spring.stiffness));
        close(&mut column);
    }
    (pattern, values)
}

/// A V × V matrix of springs, three right-hand sides at once: the factorisation, the library's solve, and that by
/// panels. A solve has to read the factor twice.
fn scalar_factor(criterion: &mut Criterion) {
    for side in SIDES {
        let scene = sheet(side);
        let b = &scene.start.positions;
        let count = b.len();
        let mut cholesky = laplacian(&scene);
        cholesky.factorize().expect("a positive definite matrix");
        let mut panels = PanelFactor::new(cholesky.factor());
        let mut group = criterion.benchmark_group(format!("scalar factor, {side} a side"));
        group.throughput(Throughput::Elements(cholesky.factor_len() as u64));
        let factor = cholesky.factor_len() * size_of::<Real>();
        limit::bench(&mut group, "factorise", factor, || cholesky.factorize());
        let bytes = 2 * factor + 2 * size_of_val(&b[..]);
        let mut columns: Vec<Real> = (0..3 * count).map(|i| (i as Real).sin()).collect();
        limit::bench(&mut group, "solve, library", bytes, || {
            cholesky.solve_in_place(&mut columns);
        });
        let mut solution = vec![Vec3::zeros(); count];
        limit::bench(&mut group, "solve, panels", bytes, || {
            panels.solve(b, &mut solution);
        });
        let mut minres = Minres::new(count);
        let mut y = vec![0.0; count];
        let right: Vec<Real> = b.iter().map(|x| x.x).collect();
        let springs = &scene.model.springs;
        let moved = Moved::times(
            ITERATIONS,
            size_of_val(&springs[..]) + 5 * size_of_val(&y[..]),
        );
        let name = format!("MINRES, {ITERATIONS} iterations");
        limit::bench(&mut group, name, moved, || {
            y.fill(0.0);
            let plain = |p: &[Real], out: &mut [Real]| out.copy_from_slice(p);
            let apply = |p: &[Real], out: &mut [Real]| spring_product(springs, p, out);
            minres.solve(apply, plain, &right, &mut y, 0.0, ITERATIONS)
        });
    }
}

/// `(1 + 20 L) p` without a matrix.
fn spring_product(springs: &[Spring], p: &[Real], out: &mut [Real]) {
    out.copy_from_slice(p);
    for spring in springs {
        let [a, b] = spring.vertices().map(|v| v as usize);
        let pull = 20.0 * (p[a] - p[b]);
        out[a] += pull;
        out[b] -= pull;
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

fn main() {
    limit::main(&[
        newton_matrix,
        linear_solvers,
        eigenvalues,
        scalar_factor,
        saddle_factor,
    ]);
}

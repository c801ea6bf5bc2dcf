//! The linear solvers against closed forms of their convergence, and against dense matrices.

use crate::counting_allocator;
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::element::Convexity;
use cloth_core::energy::Spring;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::block_matrix::{BlockMatrix, PatternBuilder};
use cloth_core::method::family::Energies;
use cloth_core::method::linear::{
    ChebyshevJacobi, ConjugateGradients, GaussSeidel, Jacobi, LinearError, LinearMethod,
    LinearReport, LinearSolver, Preconditioner, StoppingCriteria, spectrum,
};
use cloth_core::step::{BuildError, Outcome};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

const LINKS: usize = 20;
const FREE: [bool; LINKS] = [true; LINKS];

fn exactly(max_iterations: u32) -> StoppingCriteria {
    StoppingCriteria {
        tolerance: 0.0,
        max_iterations,
    }
}

/// `tridiag(−1, 2, −1)` for each axis: `D⁻¹A` has the eigenvalues `1 − cos(jπ/(N + 1))`.
fn chain() -> BlockMatrix {
    let neighbours: Vec<Spring> = (1..LINKS as u32)
        .map(|i| Spring {
            vertices: [i - 1, i],
            rest_length: 1.0,
            stiffness: 1.0,
        })
        .collect();
    let mut pattern = PatternBuilder::new(LINKS);
    pattern.add(&neighbours);
    let mut matrix = BlockMatrix::zeros(pattern.build());
    matrix.blocks_mut().fill(-Mat3::identity());
    matrix.add_diagonal([3.0; LINKS]);
    matrix
}

/// Eigenvector j of the chain (from 1), along some direction, and its eigenvalue.
fn mode(j: usize) -> (Vec<Vec3>, Real) {
    let angle = j as Real * PI / (LINKS + 1) as Real;
    let along = Vec3::new(1.0, -2.0, 0.5);
    let mode = (1..=LINKS).map(|i| along * (angle * i as Real).sin());
    (mode.collect(), 1.0 - angle.cos())
}

/// What is left of an error along `mode` after a solve: `(mode − x)·mode/‖mode‖²`, and how much else there is.
fn remainder(solver: &mut dyn LinearSolver, mode: &[Vec3]) -> (Real, Real) {
    let matrix = chain();
    let (mut b, mut x) = (vec![Vec3::zeros(); LINKS], vec![Vec3::zeros(); LINKS]);
    matrix.multiply(mode, &mut b);
    solver.prepare(&matrix).unwrap();
    solver.solve(&matrix, &b, &mut x).unwrap();
    let dot = |a: &[Vec3], b: &[Vec3]| -> Real { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
    let error: Vec<Vec3> = mode.iter().zip(&x).map(|(m, x)| m - x).collect();
    let share = dot(&error, mode) / dot(mode, mode);
    let rest: Vec<Vec3> = error.iter().zip(mode).map(|(e, m)| e - m * share).collect();
    (share, (dot(&rest, &rest) / dot(mode, mode)).sqrt())
}

#[test]
fn jacobi_shrinks_every_mode_by_one_minus_omega_lambda() {
    for omega in [0.3, 0.9, 1.0] {
        for j in [1, 7, LINKS] {
            for iterations in [1, 2, 25] {
                let budget = exactly(iterations);
                let mut solver = Jacobi::new(&FREE, Some(omega), budget).unwrap();
                let (mode, lambda) = mode(j);
                let (share, rest) = remainder(&mut solver, &mode);
                let expected = (1.0 - omega * lambda).powi(iterations as i32);
                assert!(
                    (share - expected).abs() < 1e-14 && rest < 1e-14,
                    "{omega} {j}"
                );
            }
        }
    }
}

/// `T_k(t)`, also outside of [−1, 1].
fn chebyshev(k: u32, t: Real) -> Real {
    let (mut before, mut now) = (1.0, t);
    for _ in 1..k {
        (before, now) = (now, 2.0 * t * now - before);
    }
    if k == 0 { 1.0 } else { now }
}

#[test]
fn chebyshev_jacobi_multiplies_every_mode_by_its_polynomial() {
    for [a, b] in [[0.01, 1.99], [0.2, 1.5], [1.0, 1.0]] {
        for j in [1, 3, 12, LINKS] {
            for iterations in [1, 2, 3, 17] {
                let budget = exactly(iterations);
                let mut solver = ChebyshevJacobi::new(&FREE, Some([a, b]), budget).unwrap();
                let (mode, lambda) = mode(j);
                let (share, rest) = remainder(&mut solver, &mode);
                // A single point is undamped Jacobi divided by it: (1 − λ/a)^k.
                let expected = if a == b {
                    (1.0 - lambda / a).powi(iterations as i32)
                } else {
                    chebyshev(iterations, (b + a - 2.0 * lambda) / (b - a))
                        / chebyshev(iterations, (b + a) / (b - a))
                };
                let scale = expected.abs().max(1.0);
                assert!((share - expected).abs() < 1e-12 * scale, "{a} {b} {j}");
                assert!(rest < 1e-12 * scale);
            }
        }
    }
}

#[test]
fn gauss_seidel_tends_to_the_square_of_the_jacobi_rate() {
    // Mode j of the sweep is cos^i(jπ/(N+1)) sin(ij π/(N+1)), with eigenvalue cos²(jπ/(N + 1)).
    let angle = PI / (LINKS + 1) as Real;
    let rate = angle.cos().powi(2);
    let mode: Vec<Vec3> = (1..=LINKS)
        .map(|i| Vec3::x() * (angle.cos().powi(i as i32) * (angle * i as Real).sin()))
        .collect();
    for sweeps in [1, 2, 40] {
        let mut solver = GaussSeidel::new(&FREE, exactly(sweeps)).unwrap();
        let (share, rest) = remainder(&mut solver, &mode);
        assert!((share - rate.powi(sweeps as i32)).abs() < 1e-14 && rest < 1e-14);
    }
}

#[test]
fn conjugate_gradients_end_after_as_many_steps_as_there_are_eigenvalues() {
    let matrix = chain();
    // Three modes: three steps.
    let mut b = vec![Vec3::zeros(); LINKS];
    for j in [2, 5, 11] {
        b.iter_mut().zip(mode(j).0).for_each(|(b, m)| *b += m);
    }
    let budget = StoppingCriteria {
        tolerance: 1e-13,
        max_iterations: 100,
    };
    let mut solver = ConjugateGradients::new(&FREE, Preconditioner::BlockJacobi, budget).unwrap();
    solver.prepare(&matrix).unwrap();
    let mut x = vec![Vec3::zeros(); LINKS];
    let report = solver.solve(&matrix, &b, &mut x).unwrap();
    assert_eq!((report.iterations, report.outcome), (3, Outcome::Converged));
}

#[test]
fn conjugate_gradients_are_at_least_as_fast_as_chebyshev() {
    let (_, smallest) = mode(1);
    let (_, largest) = mode(LINKS);
    let root = (largest / smallest as Real).sqrt();
    let matrix = chain();
    let exact: Vec<Vec3> = (0..LINKS).map(noise).collect();
    let mut b = vec![Vec3::zeros(); LINKS];
    matrix.multiply(&exact, &mut b);
    let energy = |x: &[Vec3]| -> Real {
        let error: Vec<Vec3> = exact.iter().zip(x).map(|(e, x)| e - x).collect();
        let mut product = vec![Vec3::zeros(); LINKS];
        matrix.multiply(&error, &mut product);
        error.iter().zip(&product).map(|(a, b)| a.dot(b)).sum()
    };
    let start = energy(&vec![Vec3::zeros(); LINKS]);
    for k in 1..=15 {
        let mut solver =
            ConjugateGradients::new(&FREE, Preconditioner::BlockJacobi, exactly(k)).unwrap();
        solver.prepare(&matrix).unwrap();
        let mut x = vec![Vec3::zeros(); LINKS];
        solver.solve(&matrix, &b, &mut x).unwrap();
        // The bound of Chebyshev's polynomial, without the factor that makes it simple.
        let bound = 1.0 / chebyshev(k, (largest + smallest) / (largest - smallest));
        let simple = 2.0 * ((root - 1.0) / (root + 1.0)).powi(k as i32);
        let measured = (energy(&x) / start).sqrt();
        assert!(
            measured <= bound && bound <= simple,
            "{k}: {measured} {bound}"
        );
    }
}

/// Deterministic numbers in (−1, 1).
fn noise(index: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let t = (3 * index + axis) as Real * 0.754_877_666 + 0.17;
        2.0 * t.fract() - 1.0
    })
}

/// The matrix of an implicit step of a small sheet that is out of shape, and the same as a dense matrix.
fn sheet(convexity: Convexity, inertia: Real) -> (BlockMatrix, DMatrix<Real>, Vec<bool>) {
    let mesh = grid(7, 6, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e3),
        bending_rigidity: 1e-3,
    };
    let model = cloth.on(&mesh).unwrap();
    let count = mesh.positions().len();
    let positions = mesh.positions().iter().enumerate();
    let x: Vec<Vec3> = positions.map(|(i, x)| x + noise(i) * 0.02).collect();
    let energies = Energies::new(count)
        .with(model.springs)
        .and_then(|e| e.with(model.hinges))
        .unwrap();
    let mut matrix = energies.hessian(&x, convexity);
    matrix.add_diagonal(model.particles.mass().iter().map(|m| m * inertia));
    let mut dense = DMatrix::zeros(3 * count, 3 * count);
    let (mut unit, mut column) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
    for i in 0..3 * count {
        unit[i / 3][i % 3] = 1.0;
        matrix.multiply(&unit, &mut column);
        dense.set_column(i, &flat(&column));
        unit[i / 3][i % 3] = 0.0;
    }
    let is_free = (0..count).map(|v| v != 0 && v != 5 && v != count - 1);
    let is_free = is_free.collect();
    (matrix, dense, is_free)
}

fn flat(x: &[Vec3]) -> DVector<Real> {
    DVector::from_iterator(3 * x.len(), x.iter().flat_map(|v| v.iter().copied()))
}

fn free_part(dense: &DMatrix<Real>, is_free: &[bool]) -> (DMatrix<Real>, Vec<usize>) {
    let free: Vec<usize> = (0..dense.nrows()).filter(|i| is_free[i / 3]).collect();
    (dense.select_rows(&free).select_columns(&free), free)
}

fn methods(budget: StoppingCriteria) -> Vec<LinearMethod> {
    vec![
        #[cfg(feature = "cholesky")]
        LinearMethod::Cholesky,
        LinearMethod::Multigrid(budget),
        LinearMethod::ConjugateGradients(budget),
        LinearMethod::ChebyshevJacobi(budget),
        LinearMethod::Jacobi(budget),
        LinearMethod::GaussSeidel(budget),
    ]
}

#[test]
fn every_solver_finds_what_a_dense_one_finds() {
    let (matrix, dense, is_free) = sheet(Convexity::Clamp, 1e4);
    let (reduced, free) = free_part(&dense, &is_free);
    let b: Vec<Vec3> = (0..is_free.len()).map(|i| noise(i + 300)).collect();
    let right = flat(&b).select_rows(&free);
    let expected = reduced.clone().cholesky().unwrap().solve(&right);
    let budget = StoppingCriteria {
        tolerance: 1e-11,
        max_iterations: 20_000,
    };
    let mut iterations = Vec::new();
    for method in methods(budget) {
        let mut solver = method.build(matrix.pattern(), &is_free, None).unwrap();
        solver.prepare(&matrix).unwrap();
        let mut x = vec![Vec3::repeat(1e9); b.len()];
        let report = solver.solve(&matrix, &b, &mut x).unwrap();
        let found = flat(&x).select_rows(&free);
        let name = solver.name();
        assert!(
            (&found - &expected).norm() < 1e-9 * expected.norm(),
            "{name}"
        );
        let residual = (&right - &reduced * found).norm() / right.norm();
        assert!(
            (report.residual - residual).abs() < 1e-13,
            "{name} {residual:e} {report:?}"
        );
        assert_eq!(report.outcome, Outcome::Converged, "{name}");
        for (x, free) in x.iter().zip(&is_free) {
            assert!(*free || *x == Vec3::zeros());
        }
        iterations.push(report.iterations);
    }
    // Cholesky or not, then multigrid, CG, Chebyshev and Jacobi: each slower than the one before.
    assert!(
        iterations
            .windows(2)
            .rev()
            .skip(1)
            .all(|pair| pair[0] < pair[1]),
        "{iterations:?}"
    );
}

#[test]
fn the_spectrum_is_that_of_the_dense_matrix() {
    let (matrix, dense, is_free) = sheet(Convexity::Clamp, 1e3);
    let (reduced, _) = free_part(&dense, &is_free);
    let eigenvalues = reduced.symmetric_eigenvalues();
    let found = spectrum(&matrix, &is_free, Preconditioner::Identity, 1000).unwrap();
    let exact = eigenvalues.max() / eigenvalues.min();
    assert!((found.largest / eigenvalues.max() - 1.0).abs() < 1e-12);
    assert!(
        (found.smallest / eigenvalues.min() - 1.0).abs() < 1e-8,
        "{found:?}"
    );
    assert!((found.condition_number() / exact - 1.0).abs() < 1e-8);
    // With the preconditioner: the eigenvalues of D^(−½) A D^(−½).
    let mut roots = DMatrix::zeros(reduced.nrows(), reduced.nrows());
    for vertex in 0..reduced.nrows() / 3 {
        let block: Mat3 = reduced.fixed_view::<3, 3>(3 * vertex, 3 * vertex).into();
        let eigen = block.symmetric_eigen();
        let root = eigen.eigenvectors
            * Mat3::from_diagonal(&eigen.eigenvalues.map(|e| 1.0 / e.sqrt()))
            * eigen.eigenvectors.transpose();
        roots
            .fixed_view_mut::<3, 3>(3 * vertex, 3 * vertex)
            .copy_from(&root);
    }
    let eigenvalues = (&roots * reduced * &roots).symmetric_eigenvalues();
    let found = spectrum(&matrix, &is_free, Preconditioner::BlockJacobi, 1000).unwrap();
    assert!(
        (found.largest / eigenvalues.max() - 1.0).abs() < 1e-12,
        "{found:?}"
    );
    assert!(
        (found.smallest / eigenvalues.min() - 1.0).abs() < 1e-8,
        "{found:?}"
    );
}

#[test]
fn an_estimate_cut_short_is_a_bound_from_inside() {
    let (matrix, dense, is_free) = sheet(Convexity::Clamp, 1e3);
    let eigenvalues = free_part(&dense, &is_free).0.symmetric_eigenvalues();
    let mut narrower = [0.0, Real::INFINITY];
    for iterations in [1, 2, 5, 10, 20, 40] {
        let found = spectrum(&matrix, &is_free, Preconditioner::Identity, iterations).unwrap();
        assert!(found.largest <= eigenvalues.max() * (1.0 + 1e-12));
        assert!(found.smallest >= eigenvalues.min() * (1.0 - 1e-12));
        assert!(found.largest >= narrower[0] && found.smallest <= narrower[1]);
        narrower = [found.largest, found.smallest];
    }
}

#[test]
fn jacobi_diverges_beyond_its_limit_and_says_so() {
    let (matrix, _, is_free) = sheet(Convexity::Clamp, 1e3);
    let b = vec![Vec3::x(); is_free.len()];
    let largest = spectrum(&matrix, &is_free, Preconditioner::BlockJacobi, 1000)
        .unwrap()
        .largest;
    let solve = |factor: Real| {
        let budget = StoppingCriteria {
            tolerance: 1e-6,
            max_iterations: 100_000,
        };
        let mut solver = Jacobi::new(&is_free, Some(factor * 2.0 / largest), budget).unwrap();
        solver.prepare(&matrix).unwrap();
        solver.solve(&matrix, &b, &mut vec![Vec3::zeros(); b.len()])
    };
    assert!(matches!(
        solve(0.98),
        Ok(LinearReport {
            outcome: Outcome::Converged,
            ..
        })
    ));
    assert!(matches!(solve(1.02), Err(LinearError::Diverged { .. })));
}

#[test]
fn an_indefinite_matrix_is_refused_by_those_that_can_tell() {
    // Diagonal blocks positive definite, the whole not: only a curvature or a pivot shows it.
    let (mut matrix, _, is_free) = sheet(Convexity::Clamp, 1e3);
    for slot in 0..matrix.blocks().len() {
        let diagonal = (0..is_free.len()).any(|row| matrix.pattern().row(row).end - 1 == slot);
        if !diagonal {
            matrix.blocks_mut()[slot] *= 10.0;
        }
    }
    let b: Vec<Vec3> = (0..is_free.len()).map(noise).collect();
    for method in methods(StoppingCriteria {
        tolerance: 1e-8,
        max_iterations: 100_000,
    }) {
        let mut solver = method.build(matrix.pattern(), &is_free, None).unwrap();
        let refused = solver
            .prepare(&matrix)
            .and_then(|()| solver.solve(&matrix, &b, &mut vec![Vec3::zeros(); b.len()]));
        let name = solver.name();
        match refused {
            Err(LinearError::NotPositiveDefinite) => {}
            Err(LinearError::Diverged { .. }) => assert_eq!(name, "gauss-seidel"),
            other => panic!("{name}: {other:?}"),
        }
    }
    // A diagonal block that is not: all of them.
    let last = matrix.blocks().len() - 1;
    let row = is_free.iter().rposition(|free| *free).unwrap();
    let diagonal = matrix.pattern().row(row).end - 1;
    assert!(diagonal < last);
    matrix.blocks_mut()[diagonal] = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, -1.0));
    for method in methods(StoppingCriteria::default()) {
        let mut solver = method.build(matrix.pattern(), &is_free, None).unwrap();
        assert_eq!(
            solver.prepare(&matrix),
            Err(LinearError::NotPositiveDefinite)
        );
    }
}

#[test]
fn nothing_to_solve_for_is_solved() {
    let matrix = chain();
    for method in methods(StoppingCriteria::default()) {
        for free in [true, false] {
            let mut solver = method
                .build(matrix.pattern(), &[free; LINKS], None)
                .unwrap();
            solver.prepare(&matrix).unwrap();
            let b = [if free { Vec3::zeros() } else { Vec3::x() }; LINKS];
            let mut x = [Vec3::x(); LINKS];
            let report = solver.solve(&matrix, &b, &mut x).unwrap();
            assert_eq!((x, report.residual), ([Vec3::zeros(); LINKS], 0.0));
        }
    }
}

#[test]
fn a_spent_budget_is_told() {
    let matrix = chain();
    for method in methods(exactly(2))
        .into_iter()
        .filter(|m| !m.proves_definiteness())
    {
        let mut solver = method.build(matrix.pattern(), &FREE, None).unwrap();
        solver.prepare(&matrix).unwrap();
        let b: Vec<Vec3> = (0..LINKS).map(noise).collect();
        let report = solver
            .solve(&matrix, &b, &mut vec![Vec3::zeros(); LINKS])
            .unwrap();
        assert_eq!(
            (report.outcome, report.iterations),
            (Outcome::BudgetSpent, 2)
        );
        // A mesh this small is one level of multigrid, which single precision solves but for its rounding.
        let least = match method {
            LinearMethod::Multigrid(_) => 1e-16,
            _ => 1e-3,
        };
        assert!(report.residual > least, "{method:?}: {report:?}");
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let refused = |result: Result<(), BuildError>| {
        assert!(
            matches!(result, Err(BuildError::OutOfRange(_))),
            "{result:?}"
        );
    };
    let matrix = chain();
    for tolerance in [-1.0, 1.0, Real::NAN] {
        for method in methods(StoppingCriteria {
            tolerance,
            max_iterations: 5,
        }) {
            if !method.proves_definiteness() {
                refused(method.build(matrix.pattern(), &FREE, None).map(|_| ()));
            }
        }
    }
    refused(GaussSeidel::new(&FREE, exactly(0)).map(|_| ()));
    for omega in [0.0, -1.0, Real::NAN, Real::INFINITY] {
        refused(Jacobi::new(&FREE, Some(omega), exactly(1)).map(|_| ()));
    }
    for interval in [
        [0.0, 1.0],
        [2.0, 1.0],
        [Real::NAN, 1.0],
        [0.5, Real::INFINITY],
    ] {
        refused(ChebyshevJacobi::new(&FREE, Some(interval), exactly(1)).map(|_| ()));
    }
}

#[test]
fn solving_again_does_not_allocate() {
    let (matrix, _, is_free) = sheet(Convexity::Clamp, 1e4);
    let b: Vec<Vec3> = (0..is_free.len()).map(noise).collect();
    for method in methods(StoppingCriteria::default()) {
        let mut solver = method.build(matrix.pattern(), &is_free, None).unwrap();
        let mut x = b.clone();
        let count = counting_allocator::allocations_once_warm(|| {
            solver.prepare(&matrix).unwrap();
            solver.solve(&matrix, &b, &mut x).unwrap();
        });
        assert_eq!(count, 0, "{}", solver.name());
    }
}

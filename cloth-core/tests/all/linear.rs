//! Block matrices and their factorisation against dense ones.

use crate::counting_allocator;
use cloth_core::element::{Convexity, Element};
use cloth_core::energy::{Attachment, CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::{BlockMatrix, PatternBuilder};
use cloth_core::method::family::Energies;
use cloth_core::method::linear::{BlockCholesky, CholeskyError, FillOrdering};
use nalgebra::{DMatrix, DVector};

/// Deterministic numbers in (−1, 1).
fn noise(index: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let t = (3 * index + axis) as Real * 0.754_877_666 + 0.17;
        2.0 * t.fract() - 1.0
    })
}

const COUNT: usize = 14;

/// Springs between vertices whose numbers differ by 1, 3 or 7, in both directions.
fn springs() -> Vec<Spring> {
    let count = COUNT as u32;
    let pairs = [1, 3, 7].map(|d| (0..count - d).map(move |i| [i, i + d]));
    let pairs = pairs.into_iter().flatten();
    pairs
        .map(|[a, b]| Spring {
            vertices: if a % 2 == 0 { [a, b] } else { [b, a] },
            rest_length: 0.4,
            stiffness: 10.0 + Real::from(a),
        })
        .collect()
}

/// The Hessian of the springs at a random shape plus `diagonal`, and the same as a dense matrix.
fn matrices(seed: usize, diagonal: Real, convexity: Convexity) -> (BlockMatrix, DMatrix<Real>) {
    let energies = Energies::new(COUNT).with(springs()).unwrap();
    let x: Vec<Vec3> = (0..COUNT).map(|i| noise(100 * seed + i)).collect();
    let mut sparse = energies.hessian(&x, convexity);
    sparse.add_diagonal(std::iter::repeat_n(diagonal, COUNT));
    let mut dense = DMatrix::identity(3 * COUNT, 3 * COUNT) * diagonal;
    for spring in springs() {
        let [a, b] = spring.vertices().map(|v| v as usize);
        let hessian = cloth_core::element::Energy::hessian(&spring, &[x[a], x[b]], convexity);
        for (i, row) in [a, b].into_iter().enumerate() {
            for (j, column) in [a, b].into_iter().enumerate() {
                let mut block = dense.fixed_view_mut::<3, 3>(3 * row, 3 * column);
                block += hessian[i][j];
            }
        }
    }
    (sparse, dense)
}

fn flat(x: &[Vec3]) -> DVector<Real> {
    DVector::from_iterator(3 * x.len(), x.iter().flat_map(|v| v.iter().copied()))
}

#[test]
fn a_block_matrix_multiplies_like_a_dense_one() {
    let (sparse, dense) = matrices(1, 0.5, Convexity::Exact);
    let x: Vec<Vec3> = (0..COUNT).map(|i| noise(i + 777)).collect();
    let mut y = vec![Vec3::repeat(1e9); COUNT];
    sparse.multiply(&x, &mut y);
    assert!((flat(&y) - &dense * flat(&x)).amax() < 1e-13 * dense.amax());
}

#[test]
fn the_product_without_a_matrix_is_the_same() {
    let (sparse, _) = matrices(2, 0.0, Convexity::Clamp);
    let energies = Energies::new(COUNT).with(springs()).unwrap();
    let x: Vec<Vec3> = (0..COUNT).map(|i| noise(200 + i)).collect();
    let p: Vec<Vec3> = (0..COUNT).map(|i| noise(i + 777)).collect();
    let (mut with, mut without) = (vec![Vec3::zeros(); COUNT], vec![Vec3::zeros(); COUNT]);
    sparse.multiply(&p, &mut with);
    energies.add_hessian_product(&x, &p, Convexity::Clamp, &mut without);
    assert!((flat(&with) - flat(&without)).amax() < 1e-12);
}

#[test]
fn constant_hessians_added_up_once_are_those_of_the_elements() {
    let hinges: Vec<CurvatureHinge> = (0..COUNT as u32 - 3)
        .map(|i| {
            let corners = [0, 97, 194, 291].map(|k| noise(i as usize + k));
            CurvatureHinge::new([i + 3, i, i + 1, i + 2], &corners, 7.0)
        })
        .collect();
    let pins = [2, 5].map(|vertex| Attachment {
        vertex,
        target: Vec3::x(),
        stiffness: 3.0,
    });
    let energies = |count| {
        Energies::new(count)
            .with(hinges.clone())
            .and_then(|e| e.with(pins.to_vec()))
            .unwrap()
    };
    let energy = energies(COUNT);
    let assembly = energy.assembly();
    let mut sparse = BlockMatrix::zeros(assembly.pattern().clone());
    let x: Vec<Vec3> = (0..COUNT).map(|i| noise(40 + i)).collect();
    let p: Vec<Vec3> = (0..COUNT).map(|i| noise(i + 777)).collect();
    energy.add_hessian(&assembly, &x, 0.25, Convexity::Exact, &mut sparse);
    energy.add_hessian(&assembly, &x, 0.75, Convexity::Clamp, &mut sparse);
    let (mut with, mut without) = (vec![Vec3::zeros(); COUNT], vec![Vec3::zeros(); COUNT]);
    sparse.multiply(&p, &mut with);
    energies(COUNT).add_hessian_product(&x, &p, Convexity::Exact, &mut without);
    let scale = flat(&without).amax();
    assert!((flat(&with) - flat(&without)).amax() < 1e-13 * scale);
}

#[test]
#[should_panic(expected = "assembly of another energy")]
fn an_assembly_of_another_energy_is_refused() {
    let pins = vec![Attachment {
        vertex: 0,
        target: Vec3::x(),
        stiffness: 3.0,
    }];
    let assembly = Energies::new(1).with(pins).unwrap().assembly();
    let mut sparse = BlockMatrix::zeros(assembly.pattern().clone());
    let x = [Vec3::zeros()];
    Energies::new(1).add_hessian(&assembly, &x, 1.0, Convexity::Exact, &mut sparse);
}

/// Solves with some vertices prescribed, sparse and dense, and compares.
fn solves_like_dense(cholesky: &mut BlockCholesky, seed: usize, is_free: &[bool]) {
    let (sparse, dense) = matrices(seed, 0.5, Convexity::Clamp);
    cholesky.factorize(&sparse).unwrap();
    let b: Vec<Vec3> = (0..COUNT).map(|i| noise(i + 50 * seed)).collect();
    let mut x = vec![Vec3::repeat(1e9); COUNT];
    cholesky.solve(&b, &mut x);
    let free: Vec<usize> = (0..3 * COUNT).filter(|i| is_free[i / 3]).collect();
    let reduced = dense.select_rows(&free).select_columns(&free);
    let expected = reduced
        .cholesky()
        .unwrap()
        .solve(&flat(&b).select_rows(&free));
    assert!((flat(&x).select_rows(&free) - expected).amax() < 1e-12);
    for (x, free) in x.iter().zip(is_free) {
        assert!(*free || *x == Vec3::zeros());
    }
}

#[test]
fn a_factor_solves_like_a_dense_one_with_and_without_prescribed_vertices() {
    let pins: [&[usize]; 4] = [&[], &[0], &[COUNT - 1], &[2, 3, 9]];
    for pins in pins {
        let is_free: Vec<bool> = (0..COUNT).map(|v| !pins.contains(&v)).collect();
        let (sparse, _) = matrices(0, 1.0, Convexity::Clamp);
        let mut cholesky = BlockCholesky::analyze(sparse.pattern(), &is_free).unwrap();
        // The same analysis serves any numbers.
        for seed in 0..5 {
            solves_like_dense(&mut cholesky, seed, &is_free);
        }
    }
}

#[test]
fn every_order_of_elimination_gives_the_same_solution() {
    let is_free: Vec<bool> = (0..COUNT).map(|v| v != 4).collect();
    let (sparse, _) = matrices(0, 1.0, Convexity::Clamp);
    for ordering in [FillOrdering::MinimumDegree, FillOrdering::NestedDissection] {
        let pattern = sparse.pattern();
        let mut cholesky = BlockCholesky::analyze_with(pattern, &is_free, ordering).unwrap();
        assert_eq!(cholesky.ordering(), ordering);
        solves_like_dense(&mut cholesky, 1, &is_free);
    }
}

#[test]
fn an_indefinite_matrix_is_refused_and_the_next_one_taken() {
    let is_free = [true; COUNT];
    let (indefinite, dense) = matrices(3, -5.0, Convexity::Exact);
    assert!(dense.symmetric_eigenvalues().min() < -1.0);
    let mut cholesky = BlockCholesky::analyze(indefinite.pattern(), &is_free).unwrap();
    let refused = cholesky.factorize(&indefinite);
    assert_eq!(refused, Err(CholeskyError::NotPositiveDefinite));
    solves_like_dense(&mut cholesky, 4, &is_free);
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let (mut matrix, _) = matrices(0, 1.0, Convexity::Clamp);
    let mut cholesky = BlockCholesky::analyze(matrix.pattern(), &[true; COUNT]).unwrap();
    matrix.blocks_mut()[5][(1, 1)] = Real::NAN;
    assert!(cholesky.factorize(&matrix).is_err());
}

#[test]
fn nothing_to_solve_for_is_solved() {
    let pattern = PatternBuilder::new(3).build();
    let mut cholesky = BlockCholesky::analyze(&pattern, &[false; 3]).unwrap();
    cholesky.factorize(&BlockMatrix::zeros(pattern)).unwrap();
    let mut x = [Vec3::x(); 3];
    cholesky.solve(&[Vec3::y(); 3], &mut x);
    assert_eq!(x, [Vec3::zeros(); 3]);
}

#[test]
fn factorising_and_solving_again_does_not_allocate() {
    let (first, _) = matrices(1, 0.5, Convexity::Clamp);
    let (second, _) = matrices(2, 0.5, Convexity::Clamp);
    let mut cholesky = BlockCholesky::analyze(first.pattern(), &[true; COUNT]).unwrap();
    let (b, mut x) = (vec![Vec3::x(); COUNT], vec![Vec3::zeros(); COUNT]);
    let count = counting_allocator::allocations_once_warm(|| {
        for matrix in [&first, &second] {
            cholesky.factorize(matrix).unwrap();
            cholesky.solve(&b, &mut x);
        }
    });
    assert_eq!(count, 0);
}

//! Eigenvalues of a Hessian of four vertices.

use cloth_core::element::Convexity;
use cloth_core::math::{Blocks, Real, Vec3, length_and_direction, make_semidefinite};

/// A symmetric matrix that no translation notices, beside the same by all its twelve eigenvalues.
#[test]
fn eigenvalues_in_nine_combinations_are_those_of_the_four_vertices() {
    let mut root = nalgebra::SMatrix::<Real, 12, 12>::from_fn(|r, c| {
        length_and_direction(Vec3::zeros(), [r as u32, 100 + c as u32])
            .1
            .x
    });
    for axis in 0..3 {
        let mean = (0..4)
            .map(|v| root.row(3 * v + axis) / 4.0)
            .sum::<nalgebra::RowSVector<Real, 12>>();
        for vertex in 0..4 {
            let mut row = root.row_mut(3 * vertex + axis);
            row -= mean;
        }
    }
    let signs = nalgebra::SMatrix::<Real, 12, 12>::from_fn(|r, c| match r == c {
        true => 1.0 - 2.0 * (r % 2) as Real,
        false => 0.0,
    });
    let dense = root * signs * root.transpose();
    let blocks: Blocks<4> = std::array::from_fn(|i| {
        std::array::from_fn(|j| dense.fixed_view::<3, 3>(3 * i, 3 * j).into_owned())
    });
    for convexity in [Convexity::Clamp, Convexity::Abs] {
        let mut eigen = dense.symmetric_eigen();
        eigen
            .eigenvalues
            .apply(|value| *value = convexity.applied_to(*value));
        let expected = eigen.recompose();
        let found = make_semidefinite(&blocks, convexity);
        for (i, row) in found.iter().enumerate() {
            for (j, block) in row.iter().enumerate() {
                let error = block - expected.fixed_view::<3, 3>(3 * i, 3 * j);
                assert!(
                    error.norm() < 1e-13 * expected.norm(),
                    "{convexity:?}: {error}"
                );
            }
        }
    }
}

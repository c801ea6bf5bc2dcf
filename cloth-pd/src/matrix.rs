//! The matrix `A = M/Δt² + Σ w GᵀG` itself: its pattern, its numbers, and what elimination has left of them.

use crate::local::Projections;
use cloth_core::linear::{CholeskyError, FactorView, UpperPattern};
use cloth_core::math::Real;
use sprs::{CsMat, TriMat};

/// A pivot below this part of its diagonal entry has lost all but a few of its digits.
pub(crate) const SMALLEST_PIVOT: Real = 1e-12;

/// The numbers of A for a step of `dt` (s), in the order of its lower half.
pub(crate) fn fill(stiffness: &CsMat<Real>, mass: &[Option<Real>], dt: Real, values: &mut [Real]) {
    let mut values = values.iter_mut();
    for (row, entries) in stiffness.outer_iterator().enumerate() {
        for ((column, &k), value) in entries.iter().zip(&mut values) {
            *value = match (mass[row], mass[column]) {
                (Some(mass), Some(_)) if row == column => k + mass / dt / dt,
                (Some(_), Some(_)) => k,
                _ if row == column => 1.0,
                _ => 0.0,
            };
        }
    }
}

/// The smallest square of a diagonal entry of the factor, relative to the diagonal entry of the matrix that it comes from: what elimination has left of it.
pub(crate) fn smallest_pivot(
    factor: FactorView<'_>,
    stiffness: &CsMat<Real>,
    mass: &[Option<Real>],
    dt: Real,
) -> Real {
    let order = factor.order();
    let row_ends = stiffness.indptr();
    let mut smallest: Real = 1.0;
    for index in 0..factor.supernode_count() {
        let (start, _, block) = factor.supernode(index);
        for column in 0..block.ncols() {
            let row = order[start + column] as usize;
            if let Some(mass) = mass[row] {
                let last = row_ends.outer_inds_sz(row).end - 1;
                let diagonal = stiffness.data()[last] + mass / dt / dt;
                let pivot = block[(column, column)];
                smallest = smallest.min(pivot * pivot / diagonal);
            }
        }
    }
    smallest
}

/// Lower half of `Σ w GᵀG` over all vertices, every diagonal entry present.
pub(crate) fn assemble(vertex_count: usize, families: &[Box<dyn Projections>]) -> CsMat<Real> {
    let mut entries = TriMat::new((vertex_count, vertex_count));
    for row in 0..vertex_count {
        entries.add_triplet(row, row, 0.0);
    }
    for family in families {
        family.add_matrix(&mut |i, j, value| entries.add_triplet(i as usize, j as usize, value));
    }
    entries.to_csr()
}

/// Row i of the lower half, read across, is column i of the upper half, read down.
pub(crate) fn upper_pattern(lower: &CsMat<Real>) -> Result<UpperPattern, CholeskyError> {
    let narrow = |&index: &usize| u32::try_from(index).map_err(|_| CholeskyError::TooLarge);
    let offsets = lower.indptr();
    let offsets = offsets.as_slice().expect("whole").iter().map(narrow);
    Ok(UpperPattern {
        column_offsets: offsets.collect::<Result<_, _>>()?,
        rows: lower
            .indices()
            .iter()
            .map(narrow)
            .collect::<Result<_, _>>()?,
    })
}

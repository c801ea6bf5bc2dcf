//! The matrix `A = M/Δt² + Σ w SᵀS` itself: its pattern, its numbers, and what elimination has left of them.

use crate::local::Projections;
use cloth_core::math::Real;
use cloth_core::method::linear::{CholeskyError, FactorView, UpperPattern};
use sprs::{CsMat, TriMat};

/// A pivot below this fraction of its diagonal entry has lost all but a few of its digits.
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

/// The smallest square of a diagonal entry of the factor, relative to the diagonal entry of the matrix that it comes
/// from: what elimination has left of it.
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

/// Lower half of `Σ w SᵀS` of some families, over all vertices, every diagonal entry present.
pub(crate) fn assemble<'a>(
    vertex_count: usize,
    families: impl Iterator<Item = &'a Box<dyn Projections>>,
) -> CsMat<Real> {
    let mut entries = TriMat::new((vertex_count, vertex_count));
    for row in 0..vertex_count {
        entries.add_triplet(row, row, 0.0);
    }
    for family in families {
        family.add_matrix(&mut |i, j, value| entries.add_triplet(i as usize, j as usize, value));
    }
    entries.to_csr()
}

/// Which families are of constant projection, couple vertices and are, at every vertex, so much less stiff than
/// all others that they hardly count: the bending of thin cloth. A hinge couples four vertices, so the matrix has less
/// than half as many numbers in its factor without them.
pub(crate) fn negligible(vertex_count: usize, families: &[Box<dyn Projections>]) -> Vec<bool> {
    let mut others = vec![0.0; vertex_count];
    for family in families.iter().filter(|family| !family.is_constant()) {
        add_diagonal(family.as_ref(), &mut others);
    }
    let is_negligible = |family: &dyn Projections| {
        let mut own = vec![0.0; vertex_count];
        let couples_vertices = add_diagonal(family, &mut own);
        let is_small = own
            .iter()
            .zip(&others)
            .all(|(own, all)| *own <= NEGLIGIBLE * all);
        family.is_constant() && couples_vertices && is_small
    };
    families
        .iter()
        .map(|family| is_negligible(family.as_ref()))
        .collect()
}

/// Adds the diagonal of `Σ w SᵀS` (N/m) of a family, and returns whether there is anything beside the diagonal.
fn add_diagonal(family: &dyn Projections, diagonal: &mut [Real]) -> bool {
    let mut couples_vertices = false;
    family.add_matrix(&mut |i, j, value| match i == j {
        true => diagonal[i as usize] += value,
        false => couples_vertices = true,
    });
    couples_vertices
}

/// A family is negligible below this fraction of the diagonal entries of the others. Its eigenvalues are then well
/// below theirs: both matrices have their largest for the shortest waves.
const NEGLIGIBLE: Real = 0.02;

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

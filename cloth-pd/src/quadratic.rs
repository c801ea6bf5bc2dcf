//! The elements whose energy is quadratic, as one matrix: bending of a flat sheet, attachments.

use crate::local::Projections;
use cloth_core::math::{Real, Vec3};
use sprs::{CsMatI, TriMatI};

/// `Σ w GᵀG` over the families of constant projection, both halves, over all vertices; prescribed ones move too.
#[derive(Debug)]
pub(crate) struct Quadratic {
    matrix: CsMatI<Real, u32>,
}

impl Quadratic {
    pub(crate) fn of(vertex_count: usize, families: &[Box<dyn Projections>]) -> Self {
        let mut entries = TriMatI::<Real, u32>::new((vertex_count, vertex_count));
        for family in families.iter().filter(|family| family.is_constant()) {
            family.add_matrix(&mut |i, j, value| {
                entries.add_triplet(i as usize, j as usize, value);
                if i != j {
                    entries.add_triplet(j as usize, i as usize, value);
                }
            });
        }
        Self {
            matrix: entries.to_csr(),
        }
    }

    /// Row `vertex` of the product with `x`.
    #[inline]
    pub(crate) fn row_times(&self, vertex: usize, x: &[Vec3]) -> Vec3 {
        let range = self.matrix.indptr().outer_inds_sz(vertex);
        let entries = self.matrix.indices()[range.clone()].iter();
        let mut sum = Vec3::zeros();
        for (&column, value) in entries.zip(&self.matrix.data()[range]) {
            sum += x[column as usize] * *value;
        }
        sum
    }
}

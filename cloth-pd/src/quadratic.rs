//! The elements whose energy is quadratic, as one matrix: bending of a flat sheet, attachments.

use crate::local::Projections;
use cloth_core::math::{Real, Vec3};
use cloth_core::wide::wide;
use sprs::{CsMatI, TriMatI};

/// `Q = Σ w GᵀG` over the families of constant projection, both halves, over all vertices; prescribed ones move too.
#[derive(Debug)]
pub(crate) struct Quadratic {
    matrix: CsMatI<Real, u32>,
    /// A displacement (m) with a fourth number beside x, y and z, so that a row of the product is a sum of whole registers.
    padded: Vec<[Real; 4]>,
    /// `Q q` (N), likewise.
    product: Vec<[Real; 4]>,
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
            padded: vec![[0.0; 4]; vertex_count],
            product: vec![[0.0; 4]; vertex_count],
        }
    }

    /// `Q q` (N) of a displacement q (m), the fourth number 0.
    pub(crate) fn times(&mut self, q: &[Vec3]) -> &[[Real; 4]] {
        if self.matrix.nnz() == 0 {
            return &self.product; // zeros from the beginning
        }
        for (padded, q) in self.padded.iter_mut().zip(q) {
            *padded = [q.x, q.y, q.z, 0.0];
        }
        let (matrix, padded, product) = (&self.matrix, &self.padded[..], &mut self.product[..]);
        let offsets = matrix.indptr();
        let offsets = offsets.raw_storage();
        wide(
            #[inline(always)]
            || {
                for (range, product) in offsets.windows(2).zip(product) {
                    let range = range[0] as usize..range[1] as usize;
                    let entries = matrix.indices()[range.clone()].iter();
                    let mut sum = [0.0; 4];
                    for (&column, &value) in entries.zip(&matrix.data()[range]) {
                        let q = padded[column as usize];
                        for lane in 0..4 {
                            sum[lane] += q[lane] * value;
                        }
                    }
                    *product = sum;
                }
            },
        );
        &self.product
    }
}

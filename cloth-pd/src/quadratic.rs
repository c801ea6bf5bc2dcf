//! The elements whose energy is quadratic, as one matrix: bending of a flat sheet, attachments.
//!
//! A product with a row is two sums side by side. More of them do not make an iteration faster (AMD EPYC, Zen 4, one
//! thread): with two, additions hardly wait for each other.

use crate::local::Projections;
use cloth_core::math::Real;
use sprs::{CsMatI, TriMatI};

/// x, y, z and a fourth number, so that a row of a product is a sum of whole registers.
pub(crate) type Padded = [Real; 4];

/// `Σ w SᵀS` over the families of constant projection, both halves, over all vertices; prescribed ones move too.
#[derive(Debug)]
pub(crate) struct Quadratic {
    /// Row i: `columns[offsets[i]..offsets[i + 1]]`, and its values (N/m) likewise.
    offsets: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<Real>,
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
        let matrix: CsMatI<Real, u32> = entries.to_csr();
        let (offsets, columns, values) = matrix.into_raw_storage();
        Self {
            offsets,
            columns,
            values,
        }
    }

    /// The entries of its lower half: row, column, value (N/m).
    pub(crate) fn lower_half(&self) -> impl Iterator<Item = (usize, usize, Real)> {
        let rows = self.offsets.windows(2).enumerate();
        rows.flat_map(|(row, range)| {
            let range = range[0] as usize..range[1] as usize;
            let entries = self.columns[range.clone()].iter().zip(&self.values[range]);
            let lower = entries.filter(move |entry| *entry.0 as usize <= row);
            lower.map(move |(&column, &value)| (row, column as usize, value))
        })
    }

    /// Whether there is no entry.
    pub(crate) fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// An entry of the product (N) with a displacement q (m).
    #[inline(always)]
    pub(crate) fn times(&self, row: usize, q: &[Padded]) -> Padded {
        let range = self.offsets[row] as usize..self.offsets[row + 1] as usize;
        let (columns, last_column) = self.columns[range.clone()].as_chunks::<2>();
        let (values, last_value) = self.values[range].as_chunks::<2>();
        // Two sums, so that an addition does not wait for the one before.
        let mut sums = [[0.0; 4]; 2];
        for (columns, values) in columns.iter().zip(values) {
            for (sum, (&column, value)) in sums.iter_mut().zip(columns.iter().zip(values)) {
                let q = q[column as usize];
                for lane in 0..4 {
                    sum[lane] += q[lane] * value;
                }
            }
        }
        for (&column, value) in last_column.iter().zip(last_value) {
            let q = q[column as usize];
            for lane in 0..4 {
                sums[1][lane] += q[lane] * value;
            }
        }
        std::array::from_fn(|lane| sums[0][lane] + sums[1][lane])
    }
}

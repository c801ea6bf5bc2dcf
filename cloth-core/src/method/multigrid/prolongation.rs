//! Prolongation and restriction: what a coarse level says about a fine one.

use crate::math::Real;

/// A sparse matrix P with a row of weights (dimensionless) per fine vertex: a fine value is the weighted sum of coarse
/// ones. Rows and columns are both listed, so that P and Pᵀ are applied without scattering.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prolongation {
    rows: Lists,
    columns: Lists,
}

/// Lists of numbered weights, one after another.
#[derive(Clone, Debug, Default, PartialEq)]
struct Lists {
    /// List k is `offsets[k]..offsets[k + 1]`.
    offsets: Vec<u32>,
    entries: Vec<(u32, Real)>,
}

impl Lists {
    #[inline(always)]
    fn of(&self, list: usize) -> &[(u32, Real)] {
        &self.entries[self.offsets[list] as usize..self.offsets[list + 1] as usize]
    }
}

impl Prolongation {
    /// From the coarse vertices and weights of every fine vertex; none for a fine value that is always zero.
    #[must_use]
    pub fn new<'a>(rows: impl IntoIterator<Item = &'a [(u32, Real)]>, coarse_count: usize) -> Self {
        let mut own = Lists {
            offsets: vec![0],
            entries: Vec::new(),
        };
        let mut offsets = vec![0u32; coarse_count + 1];
        for row in rows {
            own.entries.extend_from_slice(row);
            own.offsets.push(own.entries.len() as u32);
            row.iter()
                .for_each(|&(coarse, _)| offsets[coarse as usize + 1] += 1);
        }
        for coarse in 0..coarse_count {
            offsets[coarse + 1] += offsets[coarse];
        }
        let mut next = offsets.clone();
        let mut entries = vec![(0, 0.0); own.entries.len()];
        for (fine, bounds) in (0u32..).zip(own.offsets.windows(2)) {
            for &(coarse, weight) in &own.entries[bounds[0] as usize..bounds[1] as usize] {
                entries[next[coarse as usize] as usize] = (fine, weight);
                next[coarse as usize] += 1;
            }
        }
        Self {
            rows: own,
            columns: Lists { offsets, entries },
        }
    }

    /// Number of fine vertices.
    #[must_use]
    pub fn fine_count(&self) -> usize {
        self.rows.offsets.len() - 1
    }

    /// Number of coarse vertices.
    #[must_use]
    pub fn coarse_count(&self) -> usize {
        self.columns.offsets.len() - 1
    }

    /// Coarse vertices and weights of a fine one: a row of P.
    #[inline(always)]
    #[must_use]
    pub fn of_fine(&self, fine: usize) -> &[(u32, Real)] {
        self.rows.of(fine)
    }

    /// Fine vertices, ascending, and their weights under a coarse one: a row of Pᵀ.
    #[inline(always)]
    #[must_use]
    pub fn of_coarse(&self, coarse: usize) -> &[(u32, Real)] {
        self.columns.of(coarse)
    }
}

//! A symmetric sparse matrix of 3 × 3 blocks, refilled in every iteration through places looked up once.
//!
//! Only the blocks on and below the diagonal are stored: half the memory to fill and to read, and row `i` of the lower half is column `i` of the upper half,
//! which is what the factorisation wants.

use crate::element::Element;
use crate::math::{Mat3, Real, Vec3};
use crate::parallel::prefetch;
use std::sync::Arc;

/// Collects which blocks of the lower half are not zero.
#[derive(Clone, Debug)]
pub struct PatternBuilder {
    vertex_count: usize,
    /// `row << 32 | column` with `row ≥ column`.
    entries: Vec<u64>,
}

impl PatternBuilder {
    /// A pattern of `vertex_count` block rows; the diagonal is always in it.
    #[must_use]
    pub fn new(vertex_count: usize) -> Self {
        let entries = (0..vertex_count as u64).map(|v| v << 32 | v).collect();
        Self {
            vertex_count,
            entries,
        }
    }

    /// Adds all pairs of vertices of each element.
    pub fn add<const N: usize, E: Element<N>>(&mut self, elements: &[E]) {
        for element in elements {
            let vertices = element.vertices();
            for i in 1..N {
                for j in 0..i {
                    let (row, column) = lower(vertices[i], vertices[j]);
                    self.entries.push(u64::from(row) << 32 | u64::from(column));
                }
            }
        }
    }

    /// Sorts, removes duplicates, and fixes the pattern.
    ///
    /// # Panics
    /// If an element named a vertex that is not smaller than the vertex count.
    #[must_use]
    pub fn build(mut self) -> Arc<BlockPattern> {
        self.entries.sort_unstable();
        self.entries.dedup();
        let mut row_offsets = vec![0u32; self.vertex_count + 1];
        for &entry in &self.entries {
            row_offsets[(entry >> 32) as usize + 1] += 1;
        }
        for row in 0..self.vertex_count {
            row_offsets[row + 1] += row_offsets[row];
        }
        let columns = self.entries.iter().map(|&entry| entry as u32).collect();
        Arc::new(BlockPattern {
            row_offsets,
            columns,
        })
    }
}

#[inline]
fn lower(a: u32, b: u32) -> (u32, u32) {
    if a >= b { (a, b) } else { (b, a) }
}

/// Which blocks are stored: compressed rows of the lower half, columns ascending, so that the diagonal is the last block of each row.
#[derive(Debug, PartialEq, Eq)]
pub struct BlockPattern {
    row_offsets: Vec<u32>,
    columns: Vec<u32>,
}

impl BlockPattern {
    /// Number of block rows V.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.row_offsets.len() - 1
    }

    /// Number of stored blocks, diagonal included.
    #[must_use]
    pub fn block_count(&self) -> usize {
        self.columns.len()
    }

    /// Where the blocks of a row are stored.
    #[inline]
    #[must_use]
    pub fn row(&self, row: usize) -> std::ops::Range<usize> {
        self.row_offsets[row] as usize..self.row_offsets[row + 1] as usize
    }

    /// Column of each stored block.
    #[inline]
    #[must_use]
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// Place of the block of two vertices, whichever of them is the row.
    #[must_use]
    pub fn slot(&self, a: u32, b: u32) -> Option<u32> {
        let (row, column) = lower(a, b);
        let range = self.row(row as usize);
        let at = self.columns[range.clone()].binary_search(&column).ok()?;
        Some((range.start + at) as u32)
    }
}

/// How many blocks before its use a product asks for a block: 2 kB.
const AHEAD: usize = 28;

/// The numbers on a [`BlockPattern`], for instance a Hessian (N/m).
#[derive(Clone, Debug)]
pub struct BlockMatrix {
    pattern: Arc<BlockPattern>,
    blocks: Vec<Mat3>,
}

impl BlockMatrix {
    /// The zero matrix on a pattern.
    #[must_use]
    pub fn zeros(pattern: Arc<BlockPattern>) -> Self {
        let blocks = vec![Mat3::zeros(); pattern.block_count()];
        Self { pattern, blocks }
    }

    /// The pattern.
    #[must_use]
    pub fn pattern(&self) -> &BlockPattern {
        &self.pattern
    }

    /// The stored blocks, in the order of the pattern.
    #[must_use]
    pub fn blocks(&self) -> &[Mat3] {
        &self.blocks
    }

    /// The stored blocks, to be filled.
    pub fn blocks_mut(&mut self) -> &mut [Mat3] {
        &mut self.blocks
    }

    /// Sets every block to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(Mat3::zeros());
    }

    /// Adds `diagonal[i]` times the identity to each diagonal block.
    ///
    /// # Panics
    /// If there are fewer diagonal values than rows.
    pub fn add_diagonal(&mut self, diagonal: impl IntoIterator<Item = Real>) {
        let mut values = diagonal.into_iter();
        for row in 0..self.pattern.row_count() {
            let last = self.pattern.row(row).end - 1;
            let value = values.next().expect("one diagonal value per row");
            for axis in 0..3 {
                self.blocks[last][(axis, axis)] += value;
            }
        }
    }

    /// `y = A x`.
    ///
    /// # Panics
    /// If `x` or `y` does not have one entry per row.
    pub fn multiply(&self, x: &[Vec3], y: &mut [Vec3]) {
        let rows = self.pattern.row_count();
        assert_eq!(x.len(), rows, "length of x");
        assert_eq!(y.len(), rows, "length of y");
        y.fill(Vec3::zeros());
        for row in 0..rows {
            let range = self.pattern.row(row);
            let diagonal = range.end - 1;
            let mut sum = self.blocks[diagonal] * x[row];
            for slot in range.start..diagonal {
                prefetch(&self.blocks, slot + AHEAD);
                let column = self.pattern.columns[slot] as usize;
                let block = &self.blocks[slot];
                sum += block * x[column];
                y[column] += block.tr_mul(&x[row]);
            }
            y[row] += sum;
        }
    }
}

//! A symmetric sparse matrix of 3 × 3 blocks, refilled in every iteration through places looked up once.
//!
//! Only the blocks on and below the diagonal are stored: half the memory to fill and to read, and row `i` of the lower
//! half is column `i` of the upper half, which is what the factorisation wants.

use crate::element::Element;
use crate::math::{Mat3, Real, Vec3};
use crate::method::chunked::CHUNK;
use crate::method::parallel::{join, prefetch, wide};
use std::ops::Range;
use std::sync::Arc;

/// Collects which blocks of the lower half are not zero.
#[derive(Clone, Debug)]
pub struct PatternBuilder {
    vertex_count: usize,
    /// `row << 32 | column` with `row ≥ column`.
    entries: Vec<u64>,
    /// How many they were when they were last sorted.
    sorted: usize,
}

impl PatternBuilder {
    /// A pattern of `vertex_count` block rows; the diagonal is always in it.
    #[must_use]
    pub fn new(vertex_count: usize) -> Self {
        let entries = (0..vertex_count as u64).map(|v| v << 32 | v).collect();
        Self {
            vertex_count,
            entries,
            sorted: 0,
        }
    }

    /// Adds all pairs of vertices of each element.
    pub fn add<const N: usize, E: Element<N>>(&mut self, elements: &[E]) {
        for element in elements {
            self.add_pairs(&element.vertices(), |_| true);
        }
    }

    /// Adds the pairs of these vertices that `keep` names.
    pub fn add_pairs(&mut self, vertices: &[u32], keep: impl Fn([u32; 2]) -> bool) {
        for (i, &a) in vertices.iter().enumerate() {
            for &b in vertices[..i].iter().filter(|&&b| keep([a, b])) {
                let (row, column) = lower(a, b);
                self.entries.push(u64::from(row) << 32 | u64::from(column));
            }
        }
        // Elements share their pairs; without this the list is many times as long as the pattern.
        if self.entries.len() > 2 * self.sorted.max(1 << 16) {
            self.sort();
        }
    }

    fn sort(&mut self) {
        self.entries.sort_unstable();
        self.entries.dedup();
        self.sorted = self.entries.len();
    }

    /// Sorts, removes duplicates, and fixes the pattern.
    ///
    /// # Panics
    /// If an element named a vertex that is not smaller than the vertex count.
    #[must_use]
    pub fn build(mut self) -> Arc<BlockPattern> {
        self.sort();
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

/// Which blocks are stored: compressed rows of the lower half, columns ascending, so that the diagonal is the last
/// block of each row.
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
    pub fn row(&self, row: usize) -> Range<usize> {
        self.row_offsets[row] as usize..self.row_offsets[row + 1] as usize
    }

    /// The row of the block at a place.
    #[must_use]
    pub fn row_of(&self, slot: usize) -> usize {
        self.row_offsets
            .partition_point(|&offset| offset as usize <= slot)
            - 1
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

fn for_each_chunk(
    pattern: &BlockPattern,
    rows: Range<usize>,
    blocks: &mut [Mat3],
    work: &(impl Fn(&BlockPattern, usize, &mut [Mat3]) + Sync),
) {
    let first = pattern.row_offsets[rows.start] as usize;
    if rows.len() <= CHUNK {
        return wide(
            #[inline(always)]
            || work(pattern, first, blocks),
        );
    }
    let middle = rows.start + (rows.len() / 2).next_multiple_of(CHUNK);
    let (a, b) = blocks.split_at_mut(pattern.row_offsets[middle] as usize - first);
    join(
        rows.len(),
        || for_each_chunk(pattern, rows.start..middle, a, work),
        || for_each_chunk(pattern, middle..rows.end, b, work),
    );
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

    /// The pattern, to be shared.
    #[must_use]
    pub fn shared_pattern(&self) -> &Arc<BlockPattern> {
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

    /// Makes the matrix `scale · diagonal[i]` times the identity in each diagonal block, and zero elsewhere.
    ///
    /// # Panics
    /// If there is not one diagonal value per row.
    pub fn set_diagonal(&mut self, diagonal: &[Real], scale: Real) {
        assert_eq!(
            diagonal.len(),
            self.pattern.row_count(),
            "one diagonal value per row"
        );
        self.for_each_chunk(
            #[inline(always)]
            |pattern, first, blocks| {
                blocks.fill(Mat3::zeros());
                for row in pattern.row_of(first).. {
                    let last = pattern
                        .row_offsets
                        .get(row + 1)
                        .map(|end| *end as usize - 1 - first);
                    let Some(block) = last.and_then(|last| blocks.get_mut(last)) else {
                        break;
                    };
                    *block = Mat3::from_diagonal_element(diagonal[row] * scale);
                }
            },
        );
    }

    /// Sets every block to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(Mat3::zeros());
    }

    /// Hands the blocks to `work` by chunks of [`CHUNK`] rows, with the pattern and the place of the first block; on
    /// several threads where that pays, with the same bits on any number of them.
    pub fn for_each_chunk(&mut self, work: impl Fn(&BlockPattern, usize, &mut [Mat3]) + Sync) {
        let rows = 0..self.pattern.row_count();
        for_each_chunk(&self.pattern, rows, &mut self.blocks, &work);
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

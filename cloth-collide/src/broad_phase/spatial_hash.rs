//! Overlapping boxes from a hash table of cells.

use super::BroadPhase;
use super::cells::{Cell, Entry, Grid};
use super::order::BucketSorter;
use crate::bounds::Bounds;

/// Uniform cells, about as large as a typical box, kept in a table by a hash of their place (Teschner et al. 2003).
/// Cells with the same hash share a slot of it. Unlike in the paper, each entry also stores its cell, so that boxes of
/// two cells in one slot are told apart. Filled anew each time, by counting, in linear time.
///
/// Limits: the cells have one size. Boxes in more than 64 cells are compared with all others; many boxes much smaller
/// than the median crowd in one cell. Slow then, not wrong.
#[derive(Debug, Default)]
pub struct SpatialHash {
    /// Sorts entries into the slots of the table, whose number is a power of two.
    sorter: BucketSorter<Entry>,
    grid: Grid,
}

/// All three numbers of a cell in one.
fn packed(cell: Cell) -> u64 {
    let [x, y, z] = cell.map(u64::from);
    x | y << 21 | z << 42
}

/// The slot of a cell, in a table of 2^`bits` slots: the upper bits of a multiplicative hash.
fn slot(key: u64, bits: u32) -> u64 {
    key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> (64 - bits)
}

impl BroadPhase for SpatialHash {
    fn overlapping(&mut self, boxes: &[Bounds], out: &mut Vec<[u32; 2]>) {
        // A box of typical size is in one to eight cells.
        let bits = (4 * boxes.len().max(1)).next_power_of_two().ilog2();
        let sorter = &mut self.sorter;
        let sort = |entries: &mut Vec<Entry>| {
            sorter.sort(entries, 1 << bits, |entry| slot(entry.0, bits) as usize);
            std::mem::swap(entries, &mut sorter.sorted);
        };
        self.grid
            .overlapping(boxes, out, packed, sort, |key| slot(key, bits));
    }
}

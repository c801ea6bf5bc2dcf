//! Overlapping boxes from a hash table of cells.

use super::BroadPhase;
use super::cells::{Cell, Cells, Entry, add_large, add_pairs};
use crate::bounds::Bounds;
use cloth_core::math::Real;

/// Uniform cells, about as large as a typical box, kept in a table by a hash of their place (Teschner et al. 2003,
/// without their collisions: an entry remembers its cell). Filled anew each time, by counting, in linear time.
///
/// Limits: the cells have one size. Boxes in more than 64 cells are compared with all others; many boxes much smaller
/// than the median crowd in one cell. Slow then, not wrong.
#[derive(Debug, Default)]
pub struct SpatialHash {
    /// Where the entries of each slot of the table begin, and where the last ones end; the number of slots is a power
    /// of two.
    starts: Vec<u32>,
    entries: Vec<Entry>,
    large: Vec<u32>,
    scratch: Vec<Real>,
}

impl SpatialHash {
    /// No table yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}

/// All three numbers of a cell in one.
fn packed(cell: Cell) -> u64 {
    let [x, y, z] = cell.map(u64::from);
    x | y << 21 | z << 42
}

/// The slot of a cell, in a table of 2^`bits` slots: the upper bits of a multiplicative hash.
fn slot(key: u64, bits: u32) -> usize {
    (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> (64 - bits)) as usize
}

impl BroadPhase for SpatialHash {
    fn overlapping(&mut self, boxes: &[Bounds], out: &mut Vec<[u32; 2]>) {
        out.clear();
        self.large.clear();
        if boxes.is_empty() {
            return;
        }
        let cells = Cells::fitted(boxes, &mut self.scratch);
        // A box of typical size is in one to eight cells.
        let bits = (4 * boxes.len()).next_power_of_two().ilog2();
        self.starts.clear();
        self.starts.resize((1 << bits) + 1, 0);
        for (number, bounds) in (0..).zip(boxes) {
            let counted = cells.visit(bounds, |cell| {
                self.starts[slot(packed(cell), bits)] += 1;
            });
            if !counted {
                self.large.push(number);
            }
        }
        for i in 1..self.starts.len() {
            self.starts[i] += self.starts[i - 1];
        }
        // Each number is now where its slot ends. Filled from there backwards, it is where the slot begins.
        let count = self.starts[1 << bits] as usize;
        self.entries.clear();
        self.entries.resize(count, (0, 0));
        for (number, bounds) in (0..).zip(boxes) {
            cells.visit(bounds, |cell| {
                let key = packed(cell);
                let place = &mut self.starts[slot(key, bits)];
                *place -= 1;
                self.entries[*place as usize] = (key, number);
            });
        }
        for range in self.starts.windows(2) {
            let entries = &self.entries[range[0] as usize..range[1] as usize];
            add_pairs(entries, &cells, packed, boxes, out);
        }
        add_large(&self.large, boxes, out);
    }
}

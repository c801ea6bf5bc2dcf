//! Overlapping boxes from cells in the order of a space-filling curve.

use super::BroadPhase;
use super::cells::{Cell, Cells, Entry, add_large, add_pairs};
use crate::bounds::Bounds;
use cloth_core::math::Real;

/// Uniform cells like those of [`super::SpatialHash`], but sorted by their Morton number, in which the bits of the
/// three numbers of a cell take turns. What is in one cell stands together, what is near mostly also; nothing is looked
/// up. Sorted anew each time.
///
/// Limits: as there.
#[derive(Debug, Default)]
pub struct MortonGrid {
    entries: Vec<Entry>,
    large: Vec<u32>,
    scratch: Vec<Real>,
}

impl MortonGrid {
    /// No cells yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}

/// The lower 21 bits with two zeros after each.
fn spread(x: u32) -> u64 {
    let x = u64::from(x);
    let x = (x | x << 32) & 0x001F_0000_0000_FFFF;
    let x = (x | x << 16) & 0x001F_0000_FF00_00FF;
    let x = (x | x << 8) & 0x100F_00F0_0F00_F00F;
    let x = (x | x << 4) & 0x10C3_0C30_C30C_30C3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

fn morton([x, y, z]: Cell) -> u64 {
    spread(x) | spread(y) << 1 | spread(z) << 2
}

impl BroadPhase for MortonGrid {
    fn overlapping(&mut self, boxes: &[Bounds], out: &mut Vec<[u32; 2]>) {
        out.clear();
        self.entries.clear();
        self.large.clear();
        if boxes.is_empty() {
            return;
        }
        let cells = Cells::fitted(boxes, &mut self.scratch);
        for (number, bounds) in (0..).zip(boxes) {
            if !cells.visit(bounds, |cell| self.entries.push((morton(cell), number))) {
                self.large.push(number);
            }
        }
        self.entries.sort_unstable();
        for same in self.entries.chunk_by(|a, b| a.0 == b.0) {
            add_pairs(same, &cells, morton, boxes, out);
        }
        add_large(&self.large, boxes, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_take_turns() {
        for cell in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [5, 3, 6], [0x1F_FFFF; 3]] {
            let bit = |k: usize, i: u32| u64::from(cell[k] >> i & 1) << (3 * i + k as u32);
            let expected = (0..21).flat_map(|i| (0..3).map(move |k| (k, i)));
            assert_eq!(morton(cell), expected.map(|(k, i)| bit(k, i)).sum::<u64>());
        }
    }
}

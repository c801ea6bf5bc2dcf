//! Overlapping boxes from cells in the order of a space-filling curve.

use super::BroadPhase;
use super::cells::{Cell, Grid};
use crate::bounds::Bounds;

/// Uniform cells like those of [`super::SpatialHash`], but sorted by their Morton number, in which the bits of the
/// three numbers of a cell take turns. What is in one cell stands together, what is near mostly also; nothing is looked
/// up. Sorted anew each time.
///
/// Limits: as there.
#[derive(Debug, Default)]
pub struct MortonGrid(Grid);

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
        let sort = |entries: &mut Vec<_>| entries.sort_unstable();
        self.0.overlapping(boxes, out, morton, sort, |key| key);
    }
}

#[cfg(test)]
#[path = "../../tests/unit/broad_phase_morton_grid.rs"]
mod tests;

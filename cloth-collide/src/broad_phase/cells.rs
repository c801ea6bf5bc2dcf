//! Cubic cells of space, for the two broad phases that sort boxes into them.

use crate::bounds::Bounds;
use cloth_core::math::{Real, Vec3};

/// Cells along each axis: three numbers of 21 bits fit a key of 64.
const CELLS: Real = 2_097_152.0;

/// A box in more cells than this is compared with all boxes instead.
const MOST_CELLS: u64 = 64;

/// Where a cell is: its number along each axis.
pub(super) type Cell = [u32; 3];

/// A regular grid of cubic cells, fitted to some boxes.
///
/// The first and the last cell along each axis reach to infinity, so there is a cell everywhere. All that correctness
/// asks for is that the number of the cell does not fall along an axis: then boxes that overlap have a cell in common.
/// It holds in floating point, because differences and products are rounded monotonically.
#[derive(Clone, Copy, Debug)]
struct Cells {
    origin: Vec3,
    /// Cells per m.
    density: Real,
}

impl Cells {
    /// Cells half as large again as the median box. `scratch` is overwritten.
    fn fitted(boxes: &[Bounds], scratch: &mut Vec<Real>) -> Self {
        let whole = boxes
            .iter()
            .skip(1)
            .fold(boxes[0], |whole, b| whole.joined(b));
        let extent = (whole.upper - whole.lower).amax();
        let size = |b: &Bounds| (b.upper - b.lower).amax();
        // A median, because one huge box would otherwise put all others into one cell.
        let sizes = boxes.iter().map(size).filter(|&s| s > 0.0);
        let side = median(sizes, scratch).map_or(extent / 1024.0, |size| 1.5 * size);
        let density = 1.0 / side;
        if !density.is_finite() {
            return Self {
                origin: whole.lower,
                density: 0.0,
            };
        }
        let mut origin = whole.lower;
        if extent * density >= CELLS {
            // Not all fits between the first and the last cell. Most does around the median.
            for axis in 0..3 {
                let centres = boxes
                    .iter()
                    .map(|b| 0.5 * b.lower[axis] + 0.5 * b.upper[axis]);
                let middle = median(centres, scratch).unwrap_or(0.0);
                origin[axis] = middle - 0.5 * CELLS * side;
            }
        }
        Self { origin, density }
    }

    /// The cell of a point (m).
    fn cell(&self, point: &Vec3) -> Cell {
        let place = (point - self.origin) * self.density;
        // NaN, from an overflow times zero, becomes 0.
        [place.x, place.y, place.z].map(|x| x.clamp(0.0, CELLS - 1.0) as u32)
    }

    /// Hands `visit` all cells that a box reaches into, and returns whether it did: not if they are too many.
    fn visit(&self, bounds: &Bounds, mut visit: impl FnMut(Cell)) -> bool {
        let (first, last) = (self.cell(&bounds.lower), self.cell(&bounds.upper));
        let count = |k: usize| u64::from(last[k] - first[k]) + 1;
        // 2²¹ cells along each of three axes: no overflow.
        if count(0) * count(1) * count(2) > MOST_CELLS {
            return false;
        }
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    visit([x, y, z]);
                }
            }
        }
        true
    }

    /// The first of the cells that two overlapping boxes have in common: a pair that is met in several cells counts
    /// there.
    fn first_common(&self, a: &Bounds, b: &Bounds) -> Cell {
        self.cell(&a.lower.sup(&b.lower))
    }
}

/// The median, the upper one of an even number.
fn median(values: impl Iterator<Item = Real>, scratch: &mut Vec<Real>) -> Option<Real> {
    scratch.clear();
    scratch.extend(values);
    let middle = scratch.len() / 2;
    (!scratch.is_empty()).then(|| *scratch.select_nth_unstable_by(middle, Real::total_cmp).1)
}

/// A key of a cell, and a box that reaches into it.
pub(super) type Entry = (u64, u32);

/// Boxes sorted into cells.
#[derive(Debug, Default)]
pub(super) struct Grid {
    entries: Vec<Entry>,
    /// Boxes in too many cells, in rising order.
    large: Vec<u32>,
    scratch: Vec<Real>,
}

impl Grid {
    /// Replaces `out` by the pairs of overlapping boxes. `key` names a cell; `group` brings together entries of one
    /// bucket, which `bucket` tells from a key: all those of one cell, and perhaps of others.
    pub(super) fn overlapping(
        &mut self,
        boxes: &[Bounds],
        out: &mut Vec<[u32; 2]>,
        key: impl Fn(Cell) -> u64,
        group: impl FnOnce(&mut Vec<Entry>),
        bucket: impl Fn(u64) -> u64,
    ) {
        out.clear();
        self.entries.clear();
        self.large.clear();
        if boxes.is_empty() {
            return;
        }
        let cells = Cells::fitted(boxes, &mut self.scratch);
        for (number, bounds) in (0..).zip(boxes) {
            if !cells.visit(bounds, |cell| self.entries.push((key(cell), number))) {
                self.large.push(number);
            }
        }
        group(&mut self.entries);
        for same in self.entries.chunk_by(|a, b| bucket(a.0) == bucket(b.0)) {
            for (i, &(here, a)) in same.iter().enumerate() {
                let first = &boxes[a as usize];
                for &(there, b) in &same[i + 1..] {
                    let second = &boxes[b as usize];
                    let overlap = here == there && first.overlaps(second);
                    if overlap && key(cells.first_common(first, second)) == here {
                        out.push([a.min(b), a.max(b)]);
                    }
                }
            }
        }
        for &a in &self.large {
            for (b, bounds) in (0..).zip(boxes) {
                // Of two large boxes, the first one reports the pair.
                let reported = b <= a && self.large.binary_search(&b).is_ok();
                if boxes[a as usize].overlaps(bounds) && !reported {
                    out.push([a.min(b), a.max(b)]);
                }
            }
        }
    }
}

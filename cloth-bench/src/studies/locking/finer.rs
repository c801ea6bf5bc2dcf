//! The same shape on a mesh twice as fine: where a drape on a finer mesh begins.
//!
//! A drape has many shapes to end in, and two meshes that both begin flat end in two of them, which compares luck.
//! Begun where the coarser mesh came to rest, the finer one shows what the finer mesh alone changes.

use super::sheet::square;
use crate::studies::prelude::*;

/// The points (m) of a square grid of twice as many cells on the surface of one of `cells` cells a side whose points
/// are at `coarse` (m). Both alternate their diagonals, so every triangle of the finer one is a quarter of one of the
/// coarser, or lies within half of it: the surface is the same, and nothing crosses that did not before.
pub fn refined(coarse: &[Vec3], cells: usize) -> Result<Vec<Vec3>, BenchError> {
    let fine = square("alternating", 2 * cells)?;
    let row = cells + 1;
    let at = |i: usize, j: usize| coarse[j * row + i];
    let place = |p: &Vec3| {
        let cell = |t: Real| {
            let t = t * cells as Real;
            let first = (t as usize).min(cells - 1);
            (first, t - first as Real)
        };
        let ((i, s), (j, t)) = (cell(p.x), cell(p.y));
        let [a, b, d, e] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        match ((i + j) % 2 == 0, s >= t, s + t <= 1.0) {
            (true, true, _) => a + (b - a) * s + (d - b) * t,
            (true, false, _) => a + (e - a) * t + (d - e) * s,
            (false, _, true) => a + (b - a) * s + (e - a) * t,
            (false, _, false) => d + (e - d) * (1.0 - s) + (b - d) * (1.0 - t),
        }
    };
    Ok(fine.positions().iter().map(place).collect())
}

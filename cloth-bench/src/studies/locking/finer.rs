//! The same shape on a mesh twice as fine: where a drape on a finer mesh begins.
//!
//! A drape has many shapes to end in, and two meshes that both begin flat end in two of them, which compares luck.
//! Begun where the coarser mesh came to rest, the finer one shows what the finer mesh alone changes.

use super::sheet::square;
use crate::studies::prelude::*;

/// The points (m) of a square grid of twice as many cells on the surface of one of `cells` cells a side whose points
/// are at `coarse` (m): bilinear in each cell, whatever its diagonal.
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
        let along = |j: usize| at(i, j) + (at(i + 1, j) - at(i, j)) * s;
        along(j) + (along(j + 1) - along(j)) * t
    };
    Ok(fine.positions().iter().map(place).collect())
}

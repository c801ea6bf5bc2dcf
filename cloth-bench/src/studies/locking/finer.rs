//! The same shape on a mesh twice as fine: where a drape on a finer mesh begins.
//!
//! A drape has many shapes to end in, and two meshes that both begin flat end in two of them, which compares luck.
//! Begun where the coarser mesh came to rest, the finer one shows what the finer mesh alone changes.

use super::sheet::square;
use crate::studies::prelude::*;

/// The points (m) of a square grid of twice as many cells on the surface of one of `cells` cells a side whose points
/// are at `coarse` (m): bilinear in each cell, whatever its diagonal.
pub(super) fn refined(coarse: &[Vec3], cells: usize) -> Result<Vec<Vec3>, BenchError> {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Bilinear functions of the place at rest are kept, and every second point is a point of the coarse grid.
    #[test]
    fn a_finer_grid_lies_on_the_coarser_one() {
        let cells = 6;
        let coarse = square("alternating", cells).unwrap();
        let fine = square("alternating", 2 * cells).unwrap();
        let bilinear =
            |p: &Vec3| Vec3::new(p.x + 0.2 * p.y, p.y - 0.3 * p.x * p.y, p.x * p.y + 0.1);
        let placed: Vec<Vec3> = coarse.positions().iter().map(bilinear).collect();
        let found = refined(&placed, cells).unwrap();
        assert_eq!(found.len(), fine.vertex_count());
        for (x, p) in found.iter().zip(fine.positions()) {
            assert!((x - bilinear(p)).norm() < 1e-15);
        }
        let bent = |p: &Vec3| p + Vec3::z() * (5.0 * p.x - 3.0 * p.y * p.y).sin();
        let placed: Vec<Vec3> = coarse.positions().iter().map(bent).collect();
        let found = refined(&placed, cells).unwrap();
        for (p, x) in coarse.positions().iter().zip(&placed) {
            let same = fine.positions().iter().position(|q| (q - p).norm() < 1e-12);
            assert!((found[same.unwrap()] - x).norm() < 1e-14);
        }
    }
}

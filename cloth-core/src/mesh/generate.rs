//! Meshes made by rule: sheets, tubes, closed surfaces.
//!
//! Every generator returns the same bits for the same arguments on the same machine; those that
//! call sine and cosine may differ in the last bit on a machine with another mathematics library.
//! Flat sheets lie in the x–y plane at z = 0 with their normals along +z; closed surfaces and
//! tubes have their normals outward.
//!
//! | surface | function | V | F | χ |
//! |---|---|---|---|---|
//! | sheet, c × r vertices | [`grid`], [`equilateral`] | c r | 2 (c−1)(r−1) | 1 |
//! | the same, crossed | [`grid`] | c r + (c−1)(r−1) | 4 (c−1)(r−1) | 1 |
//! | irregular sheet | [`irregular`] | n² | 2 (n−1)² | 1 |
//! | disk of n rings | [`disk`] | 1 + 3n(n+1) | 6n² | 1 |
//! | open tube, n around, m cells along | [`tube`] | n (m+1) | 2 n m | 0 |
//! | torus, n × m | [`torus`] | n m | 2 n m | 0 |
//! | sphere of frequency n | [`sphere`] | 10n² + 2 | 20n² | 2 |
//! | box | [`cuboid`] | 8 | 12 | 2 |
//! | Möbius band, n around, m cells across | [`moebius`] | n (m+1) | 2 n m | 0 |
//!
//! Solids, of tetrahedra: [`block`] with 5 c₁c₂c₃ of them, and [`ball`] of n shells with 20n³.
//!
//! [`without_triangles`] cuts holes, [`join`] puts several meshes into one.

mod cuboid;
mod irregular;
mod pieces;
mod round;
mod solid;

pub use cuboid::cuboid;
pub use irregular::irregular;
pub use pieces::{join, without_triangles};
pub use round::{disk, moebius, sphere, torus, tube};
pub use solid::{ball, block};

use super::{MeshError, TriMesh};
use crate::error::{positive, within};
use crate::math::{Real, Vec3};

/// How the rectangular cells of [`grid`] are cut into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonals {
    /// All diagonals run from the lower left to the upper right. The sheet is then stiffer along
    /// one diagonal than along the other.
    OneWay,
    /// Neighbouring cells have mirrored diagonals (union jack): vertices with four and with eight
    /// neighbours take turns.
    Alternating,
    /// Both diagonals, meeting in an additional vertex in the middle of the cell; four triangles
    /// per cell.
    Crossed,
}

/// Flat sheet of `columns` × `rows` vertices, `width` × `height` (m), with a corner at the origin.
///
/// Vertex `row * columns + column` lies at x = width · column/(columns − 1),
/// y = height · row/(rows − 1). The middle vertices of [`Diagonals::Crossed`] follow after all
/// of these, cell by cell in the same order.
///
/// # Errors
/// [`MeshError::OutOfRange`] for fewer than 2 columns or rows, for a width or height that
/// is not positive and finite, or for more vertices than fit.
pub fn grid(
    columns: usize,
    rows: usize,
    width: Real,
    height: Real,
    diagonals: Diagonals,
) -> Result<TriMesh, MeshError> {
    at_least("columns", columns, 2, "at least 2")?;
    at_least("rows", rows, 2, "at least 2")?;
    positive("width", width)?;
    positive("height", height)?;
    room_for(2.0 * columns as Real * rows as Real)?;
    let (cells_x, cells_y) = (columns - 1, rows - 1);
    // Counted in half cells, so that grid points and cell centres share one formula.
    let point = |x2: usize, y2: usize| {
        Vec3::new(
            width * x2 as Real / (2 * cells_x) as Real,
            height * y2 as Real / (2 * cells_y) as Real,
            0.0,
        )
    };
    let cells = || (0..cells_y).flat_map(|r| (0..cells_x).map(move |c| (c, r)));
    let grid_points = (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r)));
    let mut positions: Vec<Vec3> = grid_points.map(|(c, r)| point(2 * c, 2 * r)).collect();
    let mut triangles = Vec::with_capacity(4 * cells_x * cells_y);
    for (c, r) in cells() {
        let a = (r * columns + c) as u32;
        let [b, d, e] = [a + 1, a + 1 + columns as u32, a + columns as u32];
        match diagonals {
            Diagonals::OneWay => triangles.extend(rising([a, b, d, e])),
            Diagonals::Alternating if (c + r) % 2 == 0 => triangles.extend(rising([a, b, d, e])),
            Diagonals::Alternating => triangles.extend([[a, b, e], [b, d, e]]),
            Diagonals::Crossed => {
                let m = positions.len() as u32;
                positions.push(point(2 * c + 1, 2 * r + 1));
                triangles.extend([[a, b, m], [b, d, m], [d, e, m], [e, a, m]]);
            }
        }
    }
    TriMesh::new(positions, triangles)
}

/// Flat sheet of equilateral triangles with sides of length `edge` (m), `columns` × `rows`
/// vertices.
///
/// Rows run along x, (√3/2) `edge` apart; every second one is moved by `edge`/2, so the left and
/// the right boundary go zigzag. Inner vertices have six neighbours in directions 60° apart, which makes
/// springs on the edges isotropic to first order.
///
/// # Errors
/// [`MeshError::OutOfRange`] for fewer than 2 columns or rows, for an edge length that is
/// not positive and finite, or for more vertices than fit.
pub fn equilateral(columns: usize, rows: usize, edge: Real) -> Result<TriMesh, MeshError> {
    at_least("columns", columns, 2, "at least 2")?;
    at_least("rows", rows, 2, "at least 2")?;
    positive("edge", edge)?;
    room_for(columns as Real * rows as Real)?;
    let grid_points = (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r)));
    let positions = grid_points.map(|(c, r)| {
        let shift = if r % 2 == 1 { 0.5 } else { 0.0 };
        let height = r as Real * 0.75_f64.sqrt();
        edge * Vec3::new(c as Real + shift, height, 0.0)
    });
    let mut triangles = Vec::with_capacity(2 * (columns - 1) * (rows - 1));
    for r in 0..rows - 1 {
        for c in 0..columns - 1 {
            let a = (r * columns + c) as u32;
            let [b, d, e] = [a + 1, a + 1 + columns as u32, a + columns as u32];
            // The upper row is moved to the right of an even row and to the left of an odd one,
            // and the short diagonal changes with it.
            if r % 2 == 0 {
                triangles.extend([[a, b, e], [b, d, e]]);
            } else {
                triangles.extend(rising([a, b, d, e]));
            }
        }
    }
    TriMesh::new(positions.collect(), triangles)
}

/// Cuts a cell, given counter-clockwise from its lower left corner, along the rising diagonal.
fn rising([a, b, d, e]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, d], [a, d, e]]
}

/// Most vertices a generator makes (3 GiB of positions): a slip of the pen should be an error and
/// not exhaust the memory.
const MOST_VERTICES: Real = 134_217_728.0;

fn room_for(vertices: Real) -> Result<(), MeshError> {
    let is_right = vertices <= MOST_VERTICES;
    within(
        is_right,
        "the number of vertices",
        vertices,
        "at most 134217728",
    )?;
    Ok(())
}

fn at_least(
    name: &'static str,
    count: usize,
    least: usize,
    range: &'static str,
) -> Result<(), MeshError> {
    within(count >= least, name, count as Real, range)?;
    Ok(())
}

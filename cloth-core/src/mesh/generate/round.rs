//! Surfaces with a circle in them: disk, tube, torus, sphere, Möbius band.

use super::{at_least, positive, rising, room_for};
use crate::error::within;
use crate::math::{Real, Vec3};
use crate::mesh::{MeshError, TriMesh};
use crate::topology::{EdgeTable, triangle_edges};
use std::f64::consts::TAU;

/// Point on the unit circle after `part` of `whole` equal steps.
fn on_circle(part: usize, whole: usize) -> Vec3 {
    let angle = TAU * part as Real / whole as Real;
    Vec3::new(angle.cos(), angle.sin(), 0.0)
}

/// Flat disk of the given radius (m) around the origin, built of `rings` rings.
///
/// Ring k carries 6k vertices on the circle of radius k/`rings`, so triangles are near
/// equilateral everywhere and none is thin at the centre. Vertex 0 is the centre; rings follow
/// from inside to outside. The boundary is a regular polygon with n = 6 `rings` corners, and the
/// area is that of the polygon, ½ n `radius`² sin(2π/n).
///
/// # Errors
/// [`MeshError::OutOfRange`] for no rings, for a radius that is not positive and finite,
/// or for more vertices than fit.
pub fn disk(rings: usize, radius: Real) -> Result<TriMesh, MeshError> {
    at_least("rings", rings, 1, "at least 1")?;
    positive("radius", radius)?;
    room_for(3.0 * (rings as Real + 1.0) * (rings as Real + 1.0))?;
    let mut positions = vec![Vec3::zeros()];
    for ring in 1..=rings {
        let r = radius * ring as Real / rings as Real;
        positions.extend((0..6 * ring).map(|j| on_circle(j, 6 * ring) * r));
    }
    // Vertex `j` of a ring, which closes on itself.
    let vertex = |ring: usize, j: usize| match ring {
        0 => 0,
        _ => (1 + 3 * ring * (ring - 1) + j % (6 * ring)) as u32,
    };
    let mut triangles = Vec::with_capacity(6 * rings * rings);
    for ring in 1..=rings {
        for sector in 0..6 {
            let outer = |j| vertex(ring, sector * ring + j);
            let inner = |j| vertex(ring - 1, sector * (ring - 1) + j);
            triangles.extend((0..ring).map(|j| [outer(j), outer(j + 1), inner(j)]));
            triangles.extend((1..ring).map(|j| [inner(j - 1), outer(j), inner(j)]));
        }
    }
    TriMesh::new(positions, triangles)
}

/// Open cylinder around the z axis from z = 0 to `length` (m), of the given `radius` (m), with
/// `around` vertices around and `cells_along` rows of cells along it.
///
/// Vertex `ring * around + i`; all diagonals turn the same way.
///
/// # Errors
/// [`MeshError::OutOfRange`] for fewer than 3 vertices around or 1 cell along, for a
/// radius or length that is not positive and finite, or for more vertices than fit.
pub fn tube(
    around: usize,
    cells_along: usize,
    radius: Real,
    length: Real,
) -> Result<TriMesh, MeshError> {
    at_least("around", around, 3, "at least 3")?;
    at_least("cells_along", cells_along, 1, "at least 1")?;
    positive("radius", radius)?;
    positive("length", length)?;
    room_for(around as Real * (cells_along as Real + 1.0))?;
    let mut positions = Vec::with_capacity(around * (cells_along + 1));
    for ring in 0..=cells_along {
        let up = Vec3::z() * (length * ring as Real / cells_along as Real);
        positions.extend((0..around).map(|i| on_circle(i, around) * radius + up));
    }
    let vertex = |i: usize, ring: usize| (ring * around + i % around) as u32;
    TriMesh::new(positions, cells(around, cells_along, vertex))
}

/// Torus around the z axis: `around` vertices along the circle of radius `major` (m), `across`
/// vertices around each circle of radius `minor` (m).
///
/// Vertex `j * around + i`, `i` along the large circle; vertex 0 is the outermost point on the
/// x axis.
///
/// # Errors
/// [`MeshError::OutOfRange`] for fewer than 3 vertices either way, for radii that are not
/// positive and finite, for `minor` not below `major`, or for more vertices than fit.
pub fn torus(around: usize, across: usize, major: Real, minor: Real) -> Result<TriMesh, MeshError> {
    at_least("around", around, 3, "at least 3")?;
    at_least("across", across, 3, "at least 3")?;
    positive("major", major)?;
    positive("minor", minor)?;
    within(minor < major, "minor", minor, "below the major radius")?;
    room_for(around as Real * across as Real)?;
    let mut positions = Vec::with_capacity(around * across);
    for j in 0..across {
        let small = on_circle(j, across) * minor;
        let ring = (0..around).map(|i| on_circle(i, around) * (major + small.x));
        positions.extend(ring.map(|p| p + Vec3::z() * small.y));
    }
    let vertex = |i: usize, j: usize| (j % across * around + i % around) as u32;
    TriMesh::new(positions, cells(around, across, vertex))
}

/// Möbius band: a strip of the given `width` (m) whose middle runs along the circle of `radius`
/// (m) in the x–y plane and which makes half a turn on the way; `around` vertices around,
/// `cells_across` cells across.
///
/// It has one boundary loop and no consistent winding: the `cells_across` edges of the seam at
/// the positive x axis are [opposed](crate::topology::inconsistently_oriented_edges).
///
/// # Errors
/// [`MeshError::OutOfRange`] for fewer than 3 vertices around or 1 cell across, for a
/// radius or width that is not positive and finite, for a width not below 2 `radius` (the band
/// would pass through its own axis), or for more vertices than fit.
pub fn moebius(
    around: usize,
    cells_across: usize,
    radius: Real,
    width: Real,
) -> Result<TriMesh, MeshError> {
    at_least("around", around, 3, "at least 3")?;
    at_least("cells_across", cells_across, 1, "at least 1")?;
    positive("radius", radius)?;
    positive("width", width)?;
    within(
        width < 2.0 * radius,
        "width",
        width,
        "below twice the radius",
    )?;
    room_for(around as Real * (cells_across as Real + 1.0))?;
    let mut positions = Vec::with_capacity(around * (cells_across + 1));
    for j in 0..=cells_across {
        let offset = width * (j as Real / cells_across as Real - 0.5);
        positions.extend((0..around).map(|i| {
            // The strip turns at half the speed at which it goes around.
            let half = on_circle(i, 2 * around);
            on_circle(i, around) * (radius + offset * half.x) + Vec3::z() * (offset * half.y)
        }));
    }
    let vertex = |i: usize, j: usize| {
        let row = if i < around { j } else { cells_across - j };
        (row * around + i % around) as u32
    };
    TriMesh::new(positions, cells(around, cells_across, vertex))
}

/// Sphere of the given radius (m) around the origin: every face of an icosahedron divided into
/// `n`² triangles and projected.
///
/// All vertices have six neighbours but the twelve of the icosahedron, which have five. The
/// first twelve vertices are those; then come the inner points of its 30 edges, then of its 20
/// faces. The longest edge tends to about 1.5 times the shortest as `n` grows.
///
/// # Errors
/// [`MeshError::OutOfRange`] for `n` = 0, for a radius that is not positive and finite, or
/// for more vertices than fit.
pub fn sphere(n: usize, radius: Real) -> Result<TriMesh, MeshError> {
    at_least("n", n, 1, "at least 1")?;
    positive("radius", radius)?;
    room_for(10.0 * n as Real * n as Real + 2.0)?;
    let solid = icosahedron()?;
    let edges = EdgeTable::build(&solid)?;
    let of_face = triangle_edges(&solid, &edges);
    let project = |p: Vec3| p.normalize() * radius;

    let corners = solid.positions();
    let mut positions: Vec<Vec3> = corners.iter().map(|&p| project(p)).collect();
    for &[a, b] in edges.ends() {
        let [a, b] = [corners[a as usize], corners[b as usize]];
        positions.extend((1..n).map(|k| project(a * (n - k) as Real + b * k as Real)));
    }
    let mut triangles = Vec::with_capacity(20 * n * n);
    for (&face, &sides) in solid.triangles().iter().zip(&of_face) {
        let first_inner = positions.len();
        let [a, b, c] = crate::math::gather(corners, face);
        for j in 1..n {
            for i in 1..n - j {
                let weights = [(n - i - j) as Real, i as Real, j as Real];
                positions.push(project(a * weights[0] + b * weights[1] + c * weights[2]));
            }
        }
        // Point `k` steps along side `side`, which the edge table may number from the other end.
        let along = |side: usize, k: usize| {
            let edge = sides[side] as usize;
            let forward = edges.ends()[edge][0] == face[side];
            let k = if forward { k } else { n - k };
            (12 + edge * (n - 1) + k - 1) as u32
        };
        // Point with weights (n − i − j, i, j) on the three corners.
        let vertex = |i: usize, j: usize| match (i, j, n - i - j) {
            (0, 0, _) => face[0],
            (_, 0, 0) => face[1],
            (0, _, 0) => face[2],
            (i, 0, _) => along(0, i),
            (_, j, 0) => along(1, j),
            (0, j, _) => along(2, n - j),
            // Before row j lie rows of n − 2, n − 3, … points.
            (i, j, _) => (first_inner + (j - 1) * (n - 1) - j * (j - 1) / 2 + i - 1) as u32,
        };
        for j in 0..n {
            for i in 0..n - j {
                triangles.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < n {
                    let upper = [vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
                    triangles.push(upper);
                }
            }
        }
    }
    TriMesh::new(positions, triangles)
}

/// Twelve vertices in three golden rectangles, twenty triangles wound outward.
pub(super) fn icosahedron() -> Result<TriMesh, MeshError> {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut positions = Vec::with_capacity(12);
    for [s, t] in [[-1.0, g], [1.0, g], [-1.0, -g], [1.0, -g]] {
        positions.push(Vec3::new(s, t, 0.0));
    }
    for [s, t] in [[-1.0, g], [1.0, g], [-1.0, -g], [1.0, -g]] {
        positions.push(Vec3::new(0.0, s, t));
    }
    for [s, t] in [[-1.0, g], [1.0, g], [-1.0, -g], [1.0, -g]] {
        positions.push(Vec3::new(t, 0.0, s));
    }
    // Golden rectangles fix the neighbours: all pairs at distance 2. Listing the twenty triples
    // by that rule is shorter than a table, and cannot contain a slip.
    let near = |a: usize, b: usize| (positions[a] - positions[b]).norm_squared() < 5.0;
    let mut triangles = Vec::with_capacity(20);
    for a in 0..12 {
        for b in (a + 1..12).filter(|&b| near(a, b)) {
            for c in (b + 1..12).filter(|&c| near(a, c) && near(b, c)) {
                let volume = positions[a].dot(&positions[b].cross(&positions[c]));
                let [b, c] = if volume > 0.0 { [b, c] } else { [c, b] };
                triangles.push([a, b, c].map(|v| v as u32));
            }
        }
    }
    TriMesh::new(positions, triangles)
}

/// Two triangles for each of `columns` × `rows` cells, where `vertex(i, j)` may be asked for
/// i = `columns` and j = `rows` too.
fn cells(columns: usize, rows: usize, vertex: impl Fn(usize, usize) -> u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(2 * columns * rows);
    for j in 0..rows {
        for i in 0..columns {
            let lower = [vertex(i, j), vertex(i + 1, j)];
            let upper = [vertex(i + 1, j + 1), vertex(i, j + 1)];
            triangles.extend(rising([lower[0], lower[1], upper[0], upper[1]]));
        }
    }
    triangles
}

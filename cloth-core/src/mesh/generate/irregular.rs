//! An irregular sheet: a mesh without directions, for studies of mesh dependence.

use super::{Diagonals, at_least, grid, positive, room_for};
use crate::math::{Real, Vec3};
use crate::mesh::{MeshError, TriMesh};
use crate::random::SplitMix64;
use crate::topology::{EdgeTable, HingeTable};

/// Rounds of moving vertices and restoring the Delaunay property. After eight, little is left of
/// the two directions of the grid: the mean of cos 4φ over the edges falls from 0.22 after one
/// round to about 0.05 (60 × 60, of which 0.02 are the boundary).
const ROUNDS: usize = 8;

/// Largest displacement per round and axis, as a fraction of the spacing.
const JITTER: Real = 0.24;

/// No triangle may be pushed below this shape quality (1 is equilateral, 0 has no area). It
/// keeps angles above about 16° in a sheet of square cells, and still lets most moves pass.
const LEAST_QUALITY: Real = 0.5;

/// Flat irregular sheet of n × n vertices, `width` × `height` (m), with a corner at the origin:
/// the Delaunay triangulation of randomly displaced points.
///
/// The boundary is the rectangle itself, with n vertices on each side. Vertices keep the numbers
/// of the grid they started from, row by row. The same `seed` gives the same bits.
///
/// Method: start from a regular grid; displace every inner vertex at random (boundary vertices
/// along their side) unless a triangle would become too thin; flip edges until every one has the
/// Delaunay property (C. L. Lawson, *Software for C¹ surface interpolation*, 1977,
/// doi:10.1016/B978-0-12-587260-7.50011-X); repeat. Of all triangulations of its points the
/// result has the largest smallest angle.
///
/// # Errors
/// [`MeshError::OutOfRange`] for `n` < 2, for a width or height that is not positive and
/// finite, or for more vertices than fit. [`MeshError::ZeroArea`] if width and height differ by
/// many orders of magnitude.
pub fn irregular(n: usize, width: Real, height: Real, seed: u64) -> Result<TriMesh, MeshError> {
    at_least("n", n, 2, "at least 2")?;
    positive("width", width)?;
    positive("height", height)?;
    room_for(n as Real * n as Real)?;
    let sheet = grid(n, n, width, height, Diagonals::Alternating)?;
    let mut positions = sheet.positions().to_vec();
    let mut triangles = sheet.triangles().to_vec();
    let mut random = SplitMix64::new(seed);
    let spacing = [width, height].map(|side| side / (n - 1) as Real);
    for _ in 0..ROUNDS {
        displace(&mut positions, &triangles, n, spacing, &mut random);
        triangles = make_delaunay(&positions, triangles)?;
    }
    TriMesh::new(positions, triangles)
}

/// Moves one vertex after the other, where the triangles around it allow.
fn displace(
    positions: &mut [Vec3],
    triangles: &[[u32; 3]],
    n: usize,
    spacing: [Real; 2],
    random: &mut SplitMix64,
) {
    let around = Incidence::new(positions.len(), triangles);
    for vertex in 0..positions.len() {
        let inside = |k: usize| k > 0 && k < n - 1;
        let mut d = Vec3::zeros();
        // Drawn for every vertex, so that the sequence does not depend on what was refused.
        let draw = [random.symmetric(), random.symmetric()];
        // On the boundary a vertex slides along its side; a corner stays.
        if inside(vertex % n) {
            d.x = JITTER * spacing[0] * draw[0];
        }
        if inside(vertex / n) {
            d.y = JITTER * spacing[1] * draw[1];
        }
        let worst = |positions: &[Vec3]| {
            let shapes = around.of(vertex).iter();
            shapes.fold(1.0_f64, |worst, &t| {
                worst.min(quality(positions, triangles[t as usize]))
            })
        };
        let before = positions[vertex];
        let quality_before = worst(positions);
        positions[vertex] += d;
        // On a stretched sheet all triangles are thin from the start; then they may at least not
        // get thinner.
        if worst(positions) < LEAST_QUALITY.min(quality_before) {
            positions[vertex] = before;
        }
    }
}

/// Twice the area (m²) of a triangle in the plane, negative if it is wound clockwise.
fn signed(a: Vec3, b: Vec3, c: Vec3) -> Real {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// 4√3 · area / Σ length², at most 1; negative for a triangle turned over.
fn quality(positions: &[Vec3], triangle: [u32; 3]) -> Real {
    let [a, b, c] = crate::math::gather(positions, triangle);
    let squares = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    2.0 * 3.0_f64.sqrt() * signed(a, b, c) / squares
}

/// Flips edges until none violates the Delaunay property.
///
/// The tables are built anew in every pass, in which no triangle takes part in two flips. That
/// costs a few passes more than a queue of edges and needs no neighbour bookkeeping.
fn make_delaunay(positions: &[Vec3], triangles: Vec<[u32; 3]>) -> Result<Vec<[u32; 3]>, MeshError> {
    let mut mesh = TriMesh::new(positions.to_vec(), triangles)?;
    loop {
        let edges = EdgeTable::build(&mesh)?;
        let hinges = HingeTable::build(&mesh, &edges);
        let mut triangles = mesh.triangles().to_vec();
        let mut touched = vec![false; triangles.len()];
        let mut flips = 0;
        let inner = edges
            .sides()
            .iter()
            .filter(|s| s[1] != crate::topology::NONE);
        for (&hinge, sides) in hinges.hinges().iter().zip(inner) {
            let [first, second] = sides.map(|t| t as usize);
            if touched[first] || touched[second] || !should_flip(positions, hinge) {
                continue;
            }
            let [a, b, left, right] = hinge;
            triangles[first] = [left, right, b];
            triangles[second] = [right, left, a];
            touched[first] = true;
            touched[second] = true;
            flips += 1;
        }
        if flips == 0 {
            return Ok(triangles);
        }
        mesh = TriMesh::new(positions.to_vec(), triangles)?;
    }
}

/// Whether the two angles opposite to the edge add up to more than π.
///
/// α + β > π exactly if sin(α + β) < 0. The small margin keeps four points on one circle, where rounding
/// decides the sign, from being flipped for ever.
fn should_flip(positions: &[Vec3], hinge: [u32; 4]) -> bool {
    let [a, b, left, right] = crate::math::gather(positions, hinge);
    // Sine and cosine of the angle at `tip`, both times the product of its two sides.
    let angle =
        |tip: Vec3, from: Vec3, to: Vec3| (signed(tip, from, to), (from - tip).dot(&(to - tip)));
    let (sin_left, cos_left) = angle(left, a, b);
    let (sin_right, cos_right) = angle(right, b, a);
    let lengths = (a - left).norm() * (b - left).norm() * (a - right).norm() * (b - right).norm();
    sin_left * cos_right + cos_left * sin_right < -1e-10 * lengths
}

/// The triangles around each vertex.
struct Incidence {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Incidence {
    fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0_u32; vertex_count + 1];
        for &vertex in triangles.as_flattened() {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut list = vec![0; 3 * triangles.len()];
        for (triangle, corners) in triangles.iter().enumerate() {
            for &vertex in corners {
                list[next[vertex as usize] as usize] = triangle as u32;
                next[vertex as usize] += 1;
            }
        }
        Self {
            starts,
            triangles: list,
        }
    }

    fn of(&self, vertex: usize) -> &[u32] {
        &self.triangles[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

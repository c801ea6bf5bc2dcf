//! Solids made of tetrahedra.

use super::round::icosahedron;
use super::{at_least, room_for};
use crate::error::positive;
use crate::math::{Real, Vec3, gather};
use crate::mesh::{MeshError, TetMesh};
use std::collections::BTreeMap;

/// A box with a corner at the origin, of `cells` cubes or cuboids along the axes, `size` (m) long in all; five
/// tetrahedra each, one in the middle, in two mirrored ways that take turns.
///
/// Vertex `(z * (cells[1] + 1) + y) * (cells[0] + 1) + x`.
///
/// # Errors
/// [`MeshError::OutOfRange`] for no cell along an axis, for a size that is not positive and finite, or for more
/// vertices than fit.
pub fn block(cells: [usize; 3], size: Vec3) -> Result<TetMesh, MeshError> {
    for axis in 0..3 {
        at_least("cells", cells[axis], 1, "at least 1")?;
        positive("size", size[axis])?;
    }
    room_for(cells.iter().map(|&n| n as Real + 1.0).product())?;
    let [nx, ny, nz] = cells;
    let part = |k: usize, axis: usize| size[axis] * k as Real / cells[axis] as Real;
    let mut positions = Vec::with_capacity((nx + 1) * (ny + 1) * (nz + 1));
    for z in 0..=nz {
        for y in 0..=ny {
            positions.extend((0..=nx).map(|x| Vec3::new(part(x, 0), part(y, 1), part(z, 2))));
        }
    }
    let mut tetrahedra = Vec::with_capacity(5 * nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                // Bit k of a corner says on which side along axis k it is; in every second cell, the cell mirrored.
                let mirror = (x + y + z) % 2;
                let corner = |bits: usize| {
                    let bits = bits ^ mirror;
                    let [x, y, z] = [x + (bits & 1), y + (bits >> 1 & 1), z + (bits >> 2)];
                    ((z * (ny + 1) + y) * (nx + 1) + x) as u32
                };
                let five = [
                    [0, 3, 5, 6],
                    [1, 0, 3, 5],
                    [2, 0, 3, 6],
                    [4, 0, 5, 6],
                    [7, 3, 5, 6],
                ];
                tetrahedra.extend(five.map(|corners| corners.map(corner)));
            }
        }
    }
    TetMesh::new(positions, tetrahedra)
}

/// A ball of the given radius (m) around the origin, of `n` shells: the tetrahedra between its middle and the faces of
/// an icosahedron, each divided into n³, and the shells projected. On the outermost one it is a
/// [`sphere`](super::sphere) of frequency n.
///
/// # Errors
/// [`MeshError::OutOfRange`] for `n` = 0, for a radius that is not positive and finite, or for more vertices than fit.
pub fn ball(n: usize, radius: Real) -> Result<TetMesh, MeshError> {
    at_least("n", n, 1, "at least 1")?;
    positive("radius", radius)?;
    room_for((10.0 / 3.0) * (n as Real + 1.0).powi(3))?;
    let solid = icosahedron()?;
    let mut positions = Vec::new();
    // A vertex by its shell and its weights on the corners of the icosahedron, which neighbours know alike.
    let mut numbers: BTreeMap<Vec<(u32, usize)>, u32> = BTreeMap::new();
    let mut tetrahedra = Vec::with_capacity(20 * n * n * n);
    for &face in solid.triangles() {
        let corners = gather(solid.positions(), face);
        // The lattice of the simplex n ≥ a ≥ b ≥ c ≥ 0, in the shell a; the middle is at a = 0.
        let mut vertex = |[a, b, c]: [usize; 3]| {
            let weights = [a - b, b - c, c];
            let mut key: Vec<(u32, usize)> = face.into_iter().zip(weights).collect();
            key.retain(|(_, weight)| *weight > 0);
            key.sort_unstable();
            *numbers.entry(key).or_insert_with(|| {
                let direction: Vec3 = (0..3).map(|k| corners[k] * weights[k] as Real).sum();
                let shell = radius * a as Real / n as Real;
                positions.push(direction.try_normalize(0.0).unwrap_or_default() * shell);
                positions.len() as u32 - 1
            })
        };
        // Kuhn's six paths along the edges of each cube of the lattice, where they are in the simplex.
        for cube in (0..n * n * n).map(|k| [k / (n * n), k / n % n, k % n]) {
            for path in [
                [0, 1, 2],
                [0, 2, 1],
                [1, 0, 2],
                [1, 2, 0],
                [2, 0, 1],
                [2, 1, 0],
            ] {
                let mut places = [cube; 4];
                for (step, axis) in path.into_iter().enumerate() {
                    places[step + 1..]
                        .iter_mut()
                        .for_each(|place| place[axis] += 1);
                }
                if places.iter().all(|[a, b, c]| a >= b && b >= c) {
                    tetrahedra.push(places.map(&mut vertex));
                }
            }
        }
    }
    TetMesh::new(positions, tetrahedra)
}

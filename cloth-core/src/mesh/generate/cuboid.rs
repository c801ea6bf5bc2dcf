//! Boxes.

use crate::error::positive;
use crate::math::{Real, Vec3};
use crate::mesh::{MeshError, TriMesh};

/// Surface of a box around the origin with these half extents (m) along the axes, twelve triangles. The bits 0, 1 and 2
/// of a vertex's number say on which side of x, y and z it is.
///
/// # Errors
/// [`MeshError::OutOfRange`] for a half extent that is not positive and finite.
pub fn cuboid(half: [Real; 3]) -> Result<TriMesh, MeshError> {
    for extent in half {
        positive("half extent", extent)?;
    }
    let corner = |number: u32| {
        let side = |axis: usize| {
            if number >> axis & 1 == 1 {
                half[axis]
            } else {
                -half[axis]
            }
        };
        Vec3::new(side(0), side(1), side(2))
    };
    let faces: [[u32; 4]; 6] = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let triangles = faces.into_iter().flat_map(halves).collect();
    TriMesh::new((0..8).map(corner).collect(), triangles)
}

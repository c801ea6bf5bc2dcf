//! The rest shape of a solid: tetrahedra, and the surface around them.

use super::{MeshError, TriMesh, check, duplicate, used};
use crate::math::{Real, Vec3, gather};
use crate::topology::EdgeTable;

/// Rest shape of a solid: positions (m), tetrahedra, and the triangles around them.
///
/// The mesh of the surface has all vertices, those inside in no triangle: what takes part in contact and in pictures is
/// the surface, while masses, elements and states have one entry for each vertex of both.
#[derive(Clone, Debug, PartialEq)]
pub struct TetMesh {
    surface: TriMesh,
    tetrahedra: Vec<[u32; 4]>,
}

/// The faces of a tetrahedron with a positive volume, counter-clockwise from outside.
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

/// Volumes below this part of the third power of the longest edge are zero to rounding.
const ZERO_VOLUME: Real = 1e-12;

impl TetMesh {
    /// Checks the buffers and keeps them; tetrahedra with a negative volume get two corners exchanged.
    ///
    /// # Errors
    /// The first [`MeshError`] met: a position that is not finite, a tetrahedron that names a vertex that does not
    /// exist or one twice, has no volume to rounding, has the vertices of another one, or is the third at one of its
    /// faces; a vertex that is in none; a surface that meets itself along an edge; no tetrahedron at all.
    pub fn new(positions: Vec<Vec3>, mut tetrahedra: Vec<[u32; 4]>) -> Result<Self, MeshError> {
        let is_finite = crate::math::is_finite;
        if let Some(vertex) = positions.iter().position(|x| !is_finite(x)) {
            return Err(MeshError::NonFinitePosition { vertex });
        }
        for (tetrahedron, corners) in tetrahedra.iter_mut().enumerate() {
            let bad = |reason| MeshError::BadTetrahedron {
                tetrahedron,
                corners: *corners,
                reason,
            };
            if corners.iter().any(|&v| v as usize >= positions.len()) {
                return Err(bad("names a vertex that does not exist"));
            }
            if (1..4).any(|k| corners[..k].contains(&corners[k])) {
                return Err(bad("names a vertex twice"));
            }
            let [a, b, c, d] = gather(&positions, *corners);
            let edges = [b - a, c - a, d - a, c - b, d - c, b - d];
            let longest = edges.iter().map(Vec3::norm).fold(0.0, Real::max);
            let volume = edges[0].dot(&edges[1].cross(&edges[2])) / 6.0;
            let size = volume.abs();
            // Written so that a volume or a length that is infinite is an error too.
            if !(size > ZERO_VOLUME * longest.powi(3) && size.is_finite()) {
                return Err(bad("has no volume"));
            }
            if volume < 0.0 {
                corners.swap(2, 3);
            }
        }
        if let Some([_, tetrahedron]) = duplicate(&tetrahedra) {
            return Err(MeshError::BadTetrahedron {
                tetrahedron,
                corners: tetrahedra[tetrahedron],
                reason: "has the vertices of another one",
            });
        }
        let triangles = surface(&tetrahedra)?;
        check(&positions, &triangles)?;
        if let Some(vertex) = used(&tetrahedra, positions.len()).iter().position(|u| !u) {
            return Err(MeshError::UnreferencedVertex { vertex });
        }
        let surface = TriMesh::unchecked(positions, triangles);
        EdgeTable::build(&surface)?;
        Ok(Self {
            surface,
            tetrahedra,
        })
    }

    /// Its surface, with all vertices.
    #[must_use]
    pub fn surface(&self) -> &TriMesh {
        &self.surface
    }

    /// Vertex numbers of each tetrahedron, of a positive volume.
    #[must_use]
    pub fn tetrahedra(&self) -> &[[u32; 4]] {
        &self.tetrahedra
    }

    /// Both.
    #[must_use]
    pub fn into_parts(self) -> (TriMesh, Vec<[u32; 4]>) {
        (self.surface, self.tetrahedra)
    }
}

/// The faces that one tetrahedron alone has, in the order of the tetrahedra.
fn surface(tetrahedra: &[[u32; 4]]) -> Result<Vec<[u32; 3]>, MeshError> {
    let faces = |corners: &[u32; 4]| FACES.map(|face| face.map(|k| corners[k]));
    let mut keyed: Vec<([u32; 3], usize)> = Vec::with_capacity(4 * tetrahedra.len());
    for (tetrahedron, corners) in tetrahedra.iter().enumerate() {
        for mut key in faces(corners) {
            key.sort_unstable();
            keyed.push((key, tetrahedron));
        }
    }
    keyed.sort_unstable();
    let shared = keyed.chunk_by(|a, b| a.0 == b.0);
    if let Some(many) = shared.clone().find(|same| same.len() > 2) {
        let tetrahedron = many[2].1;
        return Err(MeshError::BadTetrahedron {
            tetrahedron,
            corners: tetrahedra[tetrahedron],
            reason: "is the third at one of its faces",
        });
    }
    let single: Vec<[u32; 3]> = shared
        .filter(|same| same.len() == 1)
        .map(|s| s[0].0)
        .collect();
    let all = tetrahedra.iter().flat_map(faces);
    let outer = all.filter(|face| {
        let mut key = *face;
        key.sort_unstable();
        single.binary_search(&key).is_ok()
    });
    Ok(outer.collect())
}

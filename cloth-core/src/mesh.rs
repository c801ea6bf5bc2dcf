//! The rest shape of a cloth: rest positions and triangles, checked once, where it is made.
//!
//! # Polygons
//! A face of more than three corners in a file becomes a fan of triangles around its first corner where this sees all
//! of it, as in a convex polygon. Any other is cut by ears: two successive edges with no other corner in the triangle
//! that they span, the least pointed first. A polygon that crosses itself is refused.

use crate::error::OutOfRange;
use crate::math::{Real, Vec3};
use std::fmt;

mod file_error;
pub mod generate;
pub mod gmsh;
pub mod io;
mod normals;
pub mod obj;
pub mod ply;
mod polygon;
mod tet_mesh;

pub use normals::vertex_normals;
pub use tet_mesh::TetMesh;

/// Rest shape of the cloth: `V` rest positions (m) and `F` triangles, counter-clockwise seen from
/// the front.
///
/// A `TriMesh` that exists has passed the checks of [`TriMesh::new`], so no later code repeats them. Only in that of a
/// [`TetMesh`], which is the surface of a solid, and where triangles are torn out, are vertices that are in no
/// triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct TriMesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// Checks the buffers and keeps them.
    ///
    /// # Errors
    /// The first [`MeshError`] met: an empty mesh, a position that is not finite, an index out of range, a
    /// triangle that names a vertex twice or whose area is zero to rounding, two triangles
    /// on the same three vertices, or a vertex that no triangle uses.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check(&positions, &triangles)?;
        match used(&triangles, positions.len()).iter().position(|u| !u) {
            Some(vertex) => Err(MeshError::UnreferencedVertex { vertex }),
            None => Ok(Self::unchecked(positions, triangles)),
        }
    }

    /// What is known to be right.
    pub(crate) fn unchecked(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self {
            positions,
            triangles,
        }
    }

    /// All vertices with other triangles, so that vertices may be in none: what is left where some are torn out, or one
    /// piece.
    ///
    /// # Errors
    /// Those of [`TriMesh::new`] but for vertices in no triangle.
    pub fn with_triangles(&self, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check(&self.positions, &triangles)?;
        Ok(self.part(triangles))
    }

    /// The same with triangles that are known to be right: some of its own.
    pub(crate) fn part(&self, triangles: Vec<[u32; 3]>) -> Self {
        Self::unchecked(self.positions.clone(), triangles)
    }

    /// The same triangles with other positions at rest (m).
    ///
    /// # Errors
    /// [`MeshError`] for a position that is not finite, or a triangle without an area.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub fn moved(&self, positions: Vec<Vec3>) -> Result<Self, MeshError> {
        assert_eq!(positions.len(), self.positions.len(), "one per vertex");
        check(&positions, &self.triangles)?;
        Ok(Self::unchecked(positions, self.triangles.clone()))
    }

    /// Rest positions (m), one per vertex.
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Vertex numbers of each triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Number of vertices V.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of triangles F.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Rest area of each triangle (m²).
    pub fn areas(&self) -> impl Iterator<Item = Real> + '_ {
        self.triangles
            .iter()
            .map(|&t| triangle_area(&self.positions, t))
    }

    /// Rest area of the whole mesh (m²).
    #[must_use]
    pub fn area(&self) -> Real {
        self.areas().sum()
    }
}

/// Area (m²) of a triangle of `positions` (m).
pub(crate) fn triangle_area(positions: &[Vec3], triangle: [u32; 3]) -> Real {
    let [a, b, c] = crate::math::gather(positions, triangle);
    0.5 * (b - a).cross(&(c - a)).norm()
}

/// Areas below this fraction of the squared longest edge are zero to rounding.
const ZERO_AREA: Real = 1e-12;

fn check(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    if let Some(vertex) = positions.iter().position(|p| !crate::math::is_finite(p)) {
        return Err(MeshError::NonFinitePosition { vertex });
    }
    for (triangle, &corners) in triangles.iter().enumerate() {
        let missing = |&&vertex: &&u32| vertex as usize >= positions.len();
        if let Some(&vertex) = corners.iter().find(missing) {
            return Err(MeshError::IndexOutOfRange {
                triangle,
                vertex,
                vertex_count: positions.len(),
            });
        }
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            return Err(MeshError::RepeatedVertex { triangle, corners });
        }
        let [pa, pb, pc] = crate::math::gather(positions, corners);
        let longest = (pb - pa)
            .norm_squared()
            .max((pc - pb).norm_squared())
            .max((pa - pc).norm_squared());
        let area = triangle_area(positions, corners);
        // Written so that a comparison with NaN, or with an infinite length, is an error too.
        if !(area > ZERO_AREA * longest && area.is_finite()) {
            return Err(MeshError::ZeroArea { triangle, area });
        }
    }
    if let Some([first, second]) = duplicate(triangles) {
        return Err(MeshError::DuplicateTriangle { first, second });
    }
    Ok(())
}

/// Of so many vertices, which ones are in an element.
fn used<const N: usize>(elements: &[[u32; N]], vertex_count: usize) -> Vec<bool> {
    let mut used = vec![false; vertex_count];
    for &vertex in elements.as_flattened() {
        used[vertex as usize] = true;
    }
    used
}

/// The first pair of elements on the same vertices, whatever their winding.
fn duplicate<const N: usize>(elements: &[[u32; N]]) -> Option<[usize; 2]> {
    let mut keyed: Vec<([u32; N], usize)> = elements
        .iter()
        .enumerate()
        .map(|(index, &corners)| {
            let mut key = corners;
            key.sort_unstable();
            (key, index)
        })
        .collect();
    keyed.sort_unstable();
    keyed
        .windows(2)
        .filter(|pair| pair[0].0 == pair[1].0)
        .map(|pair| [pair[0].1, pair[1].1])
        .min_by_key(|pair| pair[1])
}

/// Why triangles and positions do not make a usable mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// There is no triangle.
    Empty,
    /// A coordinate is NaN or infinite.
    NonFinitePosition {
        /// The vertex.
        vertex: usize,
    },
    /// A triangle names a vertex that does not exist.
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// A triangle names a vertex twice.
    RepeatedVertex {
        /// The triangle.
        triangle: usize,
        /// Its three vertices.
        corners: [u32; 3],
    },
    /// A triangle has no area at rest, to rounding.
    ZeroArea {
        /// The triangle.
        triangle: usize,
        /// Its area (m²).
        area: Real,
    },
    /// Two triangles have the same three vertices.
    DuplicateTriangle {
        /// The earlier triangle.
        first: usize,
        /// The later one.
        second: usize,
    },
    /// A tetrahedron cannot be one of a solid.
    BadTetrahedron {
        /// The tetrahedron.
        tetrahedron: usize,
        /// Its four vertices.
        corners: [u32; 4],
        /// What is wrong with it.
        reason: &'static str,
    },
    /// No triangle or tetrahedron uses a vertex, so it would have no mass.
    UnreferencedVertex {
        /// The vertex.
        vertex: usize,
    },
    /// More than two triangles meet at an edge.
    NonManifoldEdge {
        /// The two vertices of the edge.
        ends: [u32; 2],
        /// The first three of the triangles that meet there.
        triangles: [usize; 3],
    },
    /// Edges are numbered with 32 bits, which is enough for this many triangles only.
    TooManyTriangles {
        /// How many there are.
        count: usize,
        /// The most there may be.
        limit: usize,
    },
    /// A generator was asked for a mesh that does not exist.
    OutOfRange(OutOfRange),
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "the mesh has no triangles"),
            Self::NonFinitePosition { vertex } => {
                write!(
                    f,
                    "vertex {vertex} has a coordinate that is not a finite number"
                )
            }
            Self::IndexOutOfRange {
                triangle,
                vertex,
                vertex_count,
            } => write!(
                f,
                "triangle {triangle} names vertex {vertex}, but there are only {vertex_count} vertices"
            ),
            Self::RepeatedVertex { triangle, corners } => {
                write!(f, "triangle {triangle} names a vertex twice: {corners:?}")
            }
            Self::BadTetrahedron {
                tetrahedron,
                corners,
                reason,
            } => write!(
                f,
                "tetrahedron {tetrahedron} with the vertices {corners:?} {reason}"
            ),
            Self::ZeroArea { triangle, area } => {
                write!(
                    f,
                    "triangle {triangle} is degenerate: its area is {area:e} m²"
                )
            }
            Self::DuplicateTriangle { first, second } => {
                write!(
                    f,
                    "triangles {first} and {second} have the same three vertices"
                )
            }
            Self::UnreferencedVertex { vertex } => {
                write!(f, "vertex {vertex} belongs to no triangle")
            }
            Self::NonManifoldEdge { ends, triangles } => write!(
                f,
                "the edge between vertices {} and {} is not manifold: triangles {}, {} and {} meet there",
                ends[0], ends[1], triangles[0], triangles[1], triangles[2]
            ),
            Self::TooManyTriangles { count, limit } => {
                write!(
                    f,
                    "the mesh has {count} triangles, but {limit} is the most that can be numbered"
                )
            }
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MeshError {}

impl From<OutOfRange> for MeshError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

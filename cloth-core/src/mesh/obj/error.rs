//! What can be wrong with an OBJ file.

use super::MeshError;
use crate::math::Real;
use std::fmt;

/// What is wrong with an OBJ file. Vertices are counted from 1 here, as in the file.
#[derive(Debug)]
#[non_exhaustive]
pub enum ObjProblem {
    /// There is no face.
    Empty,
    /// A line begins with something that is no keyword.
    NotAStatement(String),
    /// A vertex has fewer than three coordinates.
    TooFewCoordinates {
        /// How many it has.
        found: usize,
    },
    /// A coordinate is not a number.
    NotANumber(String),
    /// A corner of a face is none of `v`, `v/vt`, `v//vn`, `v/vt/vn` with whole numbers other
    /// than 0.
    NotAnIndex(String),
    /// A face names a vertex that does not exist.
    NoSuchVertex {
        /// The number in the file, negative if counted backwards.
        index: i64,
        /// How many vertices there are; so far, if the number is negative or beyond 32 bits.
        vertex_count: usize,
    },
    /// A face names a vertex twice.
    RepeatedVertex,
    /// A face, or a triangle of a polygon, has no area to rounding.
    ZeroArea {
        /// Its area (m²).
        area: Real,
    },
    /// A face has the same three vertices as an earlier one.
    DuplicateFace {
        /// The line of the earlier one.
        first_line: usize,
    },
    /// No face uses a vertex, so it would have no mass.
    UnreferencedVertex,
    /// A face is the third one at an edge.
    NonManifoldEdge {
        /// The two vertices of the edge.
        ends: [usize; 2],
        /// The lines of two faces that meet there already.
        first_lines: [usize; 2],
    },
    /// Any other reason why the mesh was refused.
    Mesh(MeshError),
}

impl fmt::Display for ObjProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "there are no faces, so there is no cloth"),
            Self::NotAStatement(word) => write!(f, "{word:?} is not a keyword of OBJ"),
            Self::TooFewCoordinates { found } => {
                write!(f, "a vertex needs three coordinates, this one has {found}")
            }
            Self::NotANumber(word) => write!(f, "{word:?} is not a number"),
            Self::NotAnIndex(word) => write!(
                f,
                "{word:?} is not a corner of a face, which reads v, v/vt, v//vn or v/vt/vn"
            ),
            Self::NoSuchVertex {
                index,
                vertex_count,
            } if *index < 0 => write!(
                f,
                "the face names vertex {index}, counted backwards, but there are only {vertex_count} vertices so far"
            ),
            Self::NoSuchVertex {
                index,
                vertex_count,
            } => write!(
                f,
                "the face names vertex {index}, but there are only {vertex_count} vertices, counted from 1"
            ),
            Self::RepeatedVertex => write!(f, "the face names a vertex twice"),
            Self::ZeroArea { area } => {
                write!(
                    f,
                    "the face is degenerate: the area of a triangle is {area:e} m²"
                )
            }
            Self::DuplicateFace { first_line } => {
                write!(
                    f,
                    "the face has the same three vertices as that of line {first_line}: remove one of the two"
                )
            }
            Self::UnreferencedVertex => write!(
                f,
                "the vertex belongs to no face: remove it, since nothing would hold it"
            ),
            Self::NonManifoldEdge { ends, first_lines } => write!(
                f,
                "the edge between vertices {} and {}, counted from 1, belongs to the faces of lines {} and {} already: \
                 of the sheets that meet in it, give all but two vertices of their own there",
                ends[0], ends[1], first_lines[0], first_lines[1]
            ),
            Self::Mesh(error) => error.fmt(f),
        }
    }
}

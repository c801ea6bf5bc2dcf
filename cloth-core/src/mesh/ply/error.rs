//! What can be wrong with a PLY file.

use super::{MeshError, Place};
use std::fmt;

/// What is wrong with a PLY file. Vertices and faces are counted from 0 here, as in the file.
#[derive(Debug)]
#[non_exhaustive]
pub enum PlyProblem {
    /// The first line is not `ply`.
    NotPly,
    /// The header ends before `end_header`.
    NoEndOfHeader,
    /// A line of the header says something else than it may.
    Header {
        /// What the line says.
        found: String,
        /// What it may say.
        expected: &'static str,
    },
    /// The header describes nothing of that kind.
    Missing {
        /// What is missing.
        what: &'static str,
    },
    /// The header describes something twice.
    Twice {
        /// What it describes twice.
        what: String,
    },
    /// The file ends before everything that the header announces.
    Truncated {
        /// The element that is not complete.
        element: String,
        /// Its number, counted from 0.
        index: u64,
        /// How many the header announces.
        count: u64,
    },
    /// There is more in the file than the header announces.
    TooLong,
    /// A line of the body has too few or too many values.
    WrongLength {
        /// The element, such as `vertex`.
        element: String,
        /// How many values the header announces for it.
        expected: usize,
        /// How many it has.
        found: usize,
    },
    /// A value in the text is not of the type that the header announces.
    NotANumber {
        /// The value.
        found: String,
        /// The type.
        expected: &'static str,
    },
    /// A face names a vertex that does not exist.
    NoSuchVertex {
        /// The number in the file.
        index: i64,
        /// How many vertices there are.
        vertex_count: u64,
    },
    /// A face has the same three vertices as an earlier one.
    DuplicateFace {
        /// The face.
        face: usize,
        /// The earlier one, and its place.
        first: (usize, Place),
    },
    /// A face is the third one at an edge.
    NonManifoldEdge {
        /// The face.
        face: usize,
        /// The two vertices of the edge.
        ends: [u32; 2],
        /// Two faces that meet there already, and their places.
        first: [(usize, Place); 2],
    },
    /// What the file describes is no usable mesh for another reason.
    Mesh {
        /// The face of the file, if it is about one. Triangles in the error are counted after
        /// polygons have been cut.
        face: Option<usize>,
        /// Why.
        error: MeshError,
    },
}

impl fmt::Display for PlyProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPly => write!(
                f,
                "the first line of a PLY file is \"ply\", this one is not"
            ),
            Self::NoEndOfHeader => write!(f, "the header ends without a line \"end_header\""),
            Self::Header { found, expected } => {
                write!(f, "expected {expected}, but the line says {found:?}")
            }
            Self::Missing { what } => write!(f, "the header describes no {what}"),
            Self::Twice { what } => write!(f, "the header describes {what} twice"),
            Self::Truncated {
                element,
                index,
                count,
            } => write!(
                f,
                "the file ends within {element} {index}, but the header announces {count} of them"
            ),
            Self::TooLong => write!(f, "there is more in the file than the header announces"),
            Self::WrongLength {
                element,
                expected,
                found,
            } => write!(
                f,
                "expected {expected} values for this {element}, but the line has {found}"
            ),
            Self::NotANumber { found, expected } => {
                write!(f, "expected {expected}, but found {found:?}")
            }
            Self::NoSuchVertex {
                index,
                vertex_count,
            } => write!(
                f,
                "the face names vertex {index}, but there are only {vertex_count} vertices, counted from 0"
            ),
            Self::DuplicateFace {
                face,
                first: (first, place),
            } => write!(
                f,
                "face {face} has the same three vertices as face {first} ({place}): remove one of the two"
            ),
            Self::NonManifoldEdge {
                face,
                ends: [a, b],
                first: [(first, at_first), (second, at_second)],
            } => write!(
                f,
                "the edge between vertices {a} and {b} of face {face} belongs to faces {first} ({at_first}) and {second} \
                 ({at_second}) already: of the sheets that meet in it, give all but two vertices of their own there"
            ),
            Self::Mesh {
                face: Some(face),
                error,
            } => write!(f, "face {face}: {error}"),
            Self::Mesh { face: None, error } => error.fmt(f),
        }
    }
}

//! What can be wrong with a PLY file, and where.

use super::MeshError;
use std::path::{Path, PathBuf};
use std::{fmt, io};

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Of the header, or of a body written as text: the line, counted from 1.
    Line(usize),
    /// Of a binary body: the byte, counted from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why a PLY file was refused: the place and the problem.
#[derive(Debug)]
pub struct PlyError {
    path: Option<PathBuf>,
    place: Option<Place>,
    problem: PlyProblem,
}

impl PlyError {
    pub(super) fn new(place: Option<Place>, problem: PlyProblem) -> Self {
        Self {
            path: None,
            place,
            problem,
        }
    }

    pub(super) fn in_file(self, path: &Path) -> Self {
        Self {
            path: Some(path.to_owned()),
            ..self
        }
    }

    /// The file, unless the bytes came from elsewhere.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Where the problem is, if it has a place.
    #[must_use]
    pub fn place(&self) -> Option<Place> {
        self.place
    }

    /// What is wrong.
    #[must_use]
    pub fn problem(&self) -> &PlyProblem {
        &self.problem
    }
}

/// What is wrong with a PLY file. Vertices and faces are counted from 0 here, as in the file.
#[derive(Debug)]
#[non_exhaustive]
pub enum PlyProblem {
    /// The file cannot be read.
    Unreadable(io::Error),
    /// The file cannot be written.
    Unwritable(io::Error),
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
    /// A coordinate is NaN or infinite.
    NotFinite,
    /// A face has fewer than three corners.
    TooFewCorners {
        /// How many it has.
        found: usize,
    },
    /// A face names a vertex that does not exist.
    NoSuchVertex {
        /// The number in the file.
        index: i64,
        /// How many vertices there are.
        vertex_count: u64,
    },
    /// What the file describes is no usable mesh.
    Mesh {
        /// The face of the file, if it is about one. Triangles in the error are counted after
        /// polygons have been cut.
        face: Option<usize>,
        /// Why.
        error: MeshError,
    },
}

impl fmt::Display for PlyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(path) = &self.path {
            write!(f, "{}: ", path.display())?;
        }
        if let Some(place) = self.place {
            write!(f, "{place}: ")?;
        }
        self.problem.fmt(f)
    }
}

impl fmt::Display for PlyProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => write!(f, "the file cannot be read: {error}"),
            Self::Unwritable(error) => write!(f, "the file cannot be written: {error}"),
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
            Self::NotFinite => write!(f, "a coordinate is not a finite number"),
            Self::TooFewCorners { found } => write!(
                f,
                "a face needs at least three corners, this one has {found}"
            ),
            Self::NoSuchVertex {
                index,
                vertex_count,
            } => write!(
                f,
                "the face names vertex {index}, but there are only {vertex_count} vertices, counted from 0"
            ),
            Self::Mesh {
                face: Some(face),
                error,
            } => write!(f, "face {face}: {error}"),
            Self::Mesh { face: None, error } => error.fmt(f),
        }
    }
}

impl std::error::Error for PlyError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.problem {
            PlyProblem::Unreadable(error) | PlyProblem::Unwritable(error) => Some(error),
            PlyProblem::Mesh { error, .. } => Some(error),
            _ => None,
        }
    }
}

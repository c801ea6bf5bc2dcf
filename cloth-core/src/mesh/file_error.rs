//! What can be wrong with a file of a mesh, and where.

use super::gmsh::GmshProblem;
use super::obj::ObjProblem;
use super::ply::PlyProblem;
use std::path::{Path, PathBuf};
use std::{fmt, io};

/// What `parse` makes of the bytes of a file; its errors name the file.
pub(super) fn read<T>(
    path: &Path,
    parse: impl FnOnce(&[u8]) -> Result<T, MeshFileError>,
) -> Result<T, MeshFileError> {
    let parsed = match std::fs::read(path) {
        Ok(bytes) => parse(&bytes),
        Err(error) => Err(MeshFileError::new(None, MeshFileProblem::Unreadable(error))),
    };
    parsed.map_err(|error| error.in_file(path))
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Of a text: the line, counted from 1. For a statement that runs over several lines it is the first of them.
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

/// Why a mesh was not read or written: the file, the place in it, and the problem.
#[derive(Debug)]
pub struct MeshFileError {
    path: Option<PathBuf>,
    place: Option<Place>,
    problem: MeshFileProblem,
}

impl MeshFileError {
    pub(super) fn new(place: Option<Place>, problem: impl Into<MeshFileProblem>) -> Self {
        Self {
            path: None,
            place,
            problem: problem.into(),
        }
    }

    pub(super) fn in_file(self, path: &Path) -> Self {
        Self {
            path: Some(path.to_owned()),
            ..self
        }
    }

    /// The file, unless what was read came from elsewhere.
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
    pub fn problem(&self) -> &MeshFileProblem {
        &self.problem
    }
}

/// What is wrong with a file, whatever its format, or in the terms of its format.
#[derive(Debug)]
#[non_exhaustive]
pub enum MeshFileProblem {
    /// The file cannot be read.
    Unreadable(io::Error),
    /// The file cannot be written.
    Unwritable(io::Error),
    /// A coordinate is NaN, infinite or too large.
    NotFinite,
    /// A face has fewer than three corners.
    TooFewCorners {
        /// How many it has.
        found: usize,
    },
    /// A face of more than three corners crosses itself, and cannot be cut into triangles.
    CrossingPolygon,
    /// Anything else about an OBJ file.
    Obj(ObjProblem),
    /// Anything else about a PLY file.
    Ply(PlyProblem),
    /// Anything else about a file of Gmsh.
    Gmsh(GmshProblem),
}

impl From<GmshProblem> for MeshFileProblem {
    fn from(problem: GmshProblem) -> Self {
        Self::Gmsh(problem)
    }
}

impl From<ObjProblem> for MeshFileProblem {
    fn from(problem: ObjProblem) -> Self {
        Self::Obj(problem)
    }
}

impl From<PlyProblem> for MeshFileProblem {
    fn from(problem: PlyProblem) -> Self {
        Self::Ply(problem)
    }
}

impl fmt::Display for MeshFileError {
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

impl fmt::Display for MeshFileProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => write!(f, "the file cannot be read: {error}"),
            Self::Unwritable(error) => write!(f, "the file cannot be written: {error}"),
            Self::CrossingPolygon => {
                write!(
                    f,
                    "the face crosses itself, or lies on a line: triangles are needed in its place"
                )
            }
            Self::NotFinite => write!(f, "a coordinate is not a finite number"),
            Self::TooFewCorners { found } => {
                write!(
                    f,
                    "a face needs at least three corners, this one has {found}"
                )
            }
            Self::Obj(problem) => problem.fmt(f),
            Self::Ply(problem) => problem.fmt(f),
            Self::Gmsh(problem) => problem.fmt(f),
        }
    }
}

impl std::error::Error for MeshFileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.problem {
            MeshFileProblem::Unreadable(error) | MeshFileProblem::Unwritable(error) => Some(error),
            MeshFileProblem::Obj(ObjProblem::Mesh(error))
            | MeshFileProblem::Gmsh(GmshProblem::Mesh(error))
            | MeshFileProblem::Ply(PlyProblem::Mesh { error, .. }) => Some(error),
            _ => None,
        }
    }
}

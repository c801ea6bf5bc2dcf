//! Reading a mesh file of any kind that is known here.

use super::TriMesh;
use super::obj::{self, ObjError};
use super::ply::{self, PlyError};
use std::fmt;
use std::path::Path;

/// Reads a mesh (positions in m) from a file: PLY if its name ends in `.ply`, in any case, otherwise [OBJ](obj).
///
/// # Errors
/// [`MeshFileError`] with the path, and with the place if the file can be read and is wrong.
pub fn read(path: &Path) -> Result<TriMesh, MeshFileError> {
    let is_ply = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("ply"));
    if is_ply {
        ply::read(path).map_err(MeshFileError::Ply)
    } else {
        obj::read(path).map_err(MeshFileError::Obj)
    }
}

/// Why a mesh file was refused.
#[derive(Debug)]
#[non_exhaustive]
pub enum MeshFileError {
    /// It was read as OBJ.
    Obj(ObjError),
    /// It was read as PLY.
    Ply(PlyError),
}

impl fmt::Display for MeshFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Obj(error) => error.fmt(f),
            Self::Ply(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MeshFileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Obj(error) => error.source(),
            Self::Ply(error) => error.source(),
        }
    }
}

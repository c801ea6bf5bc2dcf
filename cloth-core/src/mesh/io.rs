//! Reading a mesh file of any kind that is known here.

pub use super::file_error::{MeshFileError, MeshFileProblem, Place};

use super::TriMesh;
use super::{obj, ply};
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
        ply::read(path)
    } else {
        obj::read(path)
    }
}

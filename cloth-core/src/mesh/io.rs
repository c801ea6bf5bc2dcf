//! Reading a mesh file of any kind that is known here.

pub use super::file_error::{MeshFileError, MeshFileProblem, Place};

use super::TriMesh;
use super::{obj, ply};
use crate::math::Vec3;
use std::path::Path;

/// Reads a mesh (positions in m) from a file: PLY if its name ends in `.ply`, in any case, otherwise [OBJ](obj).
///
/// # Errors
/// [`MeshFileError`] with the path, and with the place if the file can be read and is wrong.
pub fn read(path: &Path) -> Result<TriMesh, MeshFileError> {
    match is_ply(path) {
        true => ply::read(path),
        false => obj::read(path),
    }
}

/// Reads the vertices (m) of such a file alone, whatever mesh its faces make: a state of a mesh that is known already.
///
/// # Errors
/// As [`read`], but for what is wrong with a mesh.
pub fn read_vertices(path: &Path) -> Result<Vec<Vec3>, MeshFileError> {
    match is_ply(path) {
        true => ply::read_vertices(path),
        false => obj::read_vertices(path),
    }
}

fn is_ply(path: &Path) -> bool {
    let extension = path.extension();
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case("ply"))
}

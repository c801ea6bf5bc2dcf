//! `[[mesh]]`: the pieces of the cloth, each in its place.

use super::document::Section;
use super::keys::{FILE, GENERATOR, ROTATE, SCALE, TRANSLATE};
use crate::error::BenchError;
use crate::mesh_spec;
use cloth_core::math::Vec3;
use cloth_core::mesh::{TriMesh, generate, io};
use nalgebra::Rotation3;
use std::path::Path;

/// All pieces as one mesh, the number of vertices of each, and whether any of them came from a file.
pub(super) fn joined(
    sections: &[Section<'_>],
    folder: &Path,
) -> Result<(TriMesh, Vec<usize>, bool), BenchError> {
    let mut pieces = Vec::new();
    let mut from_file = false;
    for section in sections {
        from_file |= section.value(&FILE).is_some();
        pieces.push(piece(section, folder)?);
    }
    let counts = pieces.iter().map(TriMesh::vertex_count).collect();
    match (pieces.pop(), pieces.is_empty()) {
        (Some(only), true) => Ok((only, counts, from_file)),
        (last, _) => {
            pieces.extend(last);
            let joined = generate::join(&pieces).map_err(BenchError::usage)?;
            Ok((joined, counts, from_file))
        }
    }
}

/// The file or the generated mesh of a table, with its scale.
pub(super) fn scaled(section: &Section<'_>, folder: &Path) -> Result<TriMesh, BenchError> {
    let mesh = match (section.text(&FILE)?, section.text(&GENERATOR)?) {
        (Some(file), None) => {
            io::read(&folder.join(file)).map_err(|error| section.refuse(&FILE, error))?
        }
        (None, Some(spec)) if mesh_spec::is_file(spec) => {
            let message = format!("`{spec}` is no generator; a file goes under the key `file`");
            return Err(section.refuse(&GENERATOR, message));
        }
        (None, Some(spec)) => {
            mesh_spec::load(spec).map_err(|error| section.refuse(&GENERATOR, error))?
        }
        (None, None) => return Err(section.refuse_table("needs a file or a generator")),
        (Some(_), Some(_)) => {
            return Err(section.refuse(&GENERATOR, "a file is given too: give one of them"));
        }
    };
    // What is not given changes no bit.
    let Some(factors) = section.factors(&SCALE)? else {
        return Ok(mesh);
    };
    let scaled = mesh.positions().iter().map(|x| x.component_mul(&factors));
    let scaled = TriMesh::new(scaled.collect(), mesh.triangles().to_vec());
    scaled.map_err(|error| section.refuse_table(error))
}

fn piece(section: &Section<'_>, folder: &Path) -> Result<TriMesh, BenchError> {
    let mesh = scaled(section, folder)?;
    let mut positions = mesh.positions().to_vec();
    if let Some(rotation) = section.vector(&ROTATE)? {
        let rotation = Rotation3::new(rotation);
        positions.iter_mut().for_each(|x| *x = rotation * *x);
    }
    if let Some(shift) = section.vector(&TRANSLATE)? {
        positions.iter_mut().for_each(|x: &mut Vec3| *x += shift);
    }
    TriMesh::new(positions, mesh.triangles().to_vec()).map_err(|error| section.refuse_table(error))
}

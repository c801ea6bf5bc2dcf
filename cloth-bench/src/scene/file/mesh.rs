//! `[[mesh]]`: the pieces of the cloth, each in its place.

use super::document::Section;
use super::keys::{Piece, Source};
use crate::error::BenchError;
use crate::mesh_spec;
use crate::scene::loose::coincident;
use crate::settings::Factors;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::{MeshError, TriMesh, generate, io};
use cloth_core::topology::EdgeTable;
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
        from_file |= section.read::<Source>()?.file.is_some();
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
    let own = section.read::<Source>()?;
    let mesh = match (own.file.as_deref(), own.generator.as_deref()) {
        (Some(file), None) => {
            io::read(&folder.join(file)).map_err(|error| own.file.refuse(error))?
        }
        (None, Some(spec)) if mesh_spec::is_file(spec) => {
            let message = format!("`{spec}` is no generator; a file goes under the key `file`");
            return Err(own.generator.refuse(message));
        }
        (None, Some(spec)) => mesh_spec::load(spec).map_err(|error| own.generator.refuse(error))?,
        (None, None) => return Err(section.refuse_table("needs a file or a generator")),
        (Some(_), Some(_)) => {
            return Err(own
                .generator
                .refuse("a file is given too: give one of them"));
        }
    };
    // What is not given changes no bit.
    let Some(Factors(factors)) = *own.scale else {
        return Ok(mesh);
    };
    let scaled = mesh.positions().iter().map(|x| x.component_mul(&factors));
    let scaled = TriMesh::new(scaled.collect(), mesh.triangles().to_vec());
    scaled.map_err(|error| section.refuse_table(error))
}

/// The mesh in which vertices no farther than `distance` (m) from each other are one.
fn welded(mesh: &TriMesh, distance: Real) -> Result<TriMesh, MeshError> {
    let mut sets = coincident(mesh.positions(), distance);
    let mut positions = Vec::new();
    let mut number: Vec<u32> = Vec::with_capacity(mesh.vertex_count());
    for (v, x) in (0..).zip(mesh.positions()) {
        // The root of a set is its lowest number, which has its place already.
        let root = sets.root(v);
        if root == v {
            number.push(positions.len() as u32);
            positions.push(*x);
        } else {
            number.push(number[root as usize]);
        }
    }
    let triangles = mesh.triangles().iter();
    let triangles = triangles.map(|corners| corners.map(|v| number[v as usize]));
    let welded = TriMesh::new(positions, triangles.collect())?;
    EdgeTable::build(&welded).map(|_| welded)
}

fn piece(section: &Section<'_>, folder: &Path) -> Result<TriMesh, BenchError> {
    let mesh = scaled(section, folder)?;
    let own = section.read::<Piece>()?;
    let mesh = match *own.weld {
        Some(distance) => welded(&mesh, distance).map_err(|error| own.weld.refuse(error))?,
        None => mesh,
    };
    let mut positions = mesh.positions().to_vec();
    if let Some(rotation) = *own.rotate {
        let rotation = Rotation3::new(rotation);
        positions.iter_mut().for_each(|x| *x = rotation * *x);
    }
    if let Some(shift) = *own.translate {
        positions.iter_mut().for_each(|x: &mut Vec3| *x += shift);
    }
    TriMesh::new(positions, mesh.triangles().to_vec()).map_err(|error| section.refuse_table(error))
}

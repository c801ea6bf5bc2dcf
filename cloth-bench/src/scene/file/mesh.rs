//! `[[mesh]]`: the pieces of the cloth and its solids, each in its place.

use super::document::Section;
use super::keys::{Piece, SolidTable, Source};
use crate::error::BenchError;
use crate::mesh_spec;
use crate::scene::loose::coincident;
use crate::settings::Factors;
use cloth_core::cloth::{Solid, SolidPiece};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::{MeshError, TetMesh, TriMesh, generate, gmsh, io};
use cloth_core::topology::EdgeTable;
use nalgebra::Rotation3;
use std::path::Path;

/// All pieces as one mesh.
pub(super) struct Joined {
    pub(super) mesh: TriMesh,
    /// The number of vertices of each piece.
    pub(super) counts: Vec<usize>,
    /// Of each piece, what is inside, if it is a solid.
    pub(super) solids: Vec<Option<SolidPiece>>,
    /// Whether any of them came from a file.
    pub(super) from_file: bool,
}

/// The pieces of these tables, and what each of them says of its solid.
pub(super) fn joined(
    sections: &[Section<'_>],
    solids: &[Option<Section<'_>>],
    folder: &Path,
) -> Result<Joined, BenchError> {
    let (mut pieces, mut inside, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    let mut from_file = false;
    for (section, solid) in sections.iter().zip(solids) {
        from_file |= section.read::<Source>()?.file.is_some();
        let (mesh, mut tetrahedra) = piece(section, solid.is_some(), folder)?;
        let first: usize = counts.iter().sum();
        for corner in tetrahedra.as_flattened_mut() {
            *corner += first as u32;
        }
        counts.push(mesh.vertex_count());
        pieces.push(mesh);
        let material = solid.as_ref().map(material).transpose()?;
        inside.push(material.map(|solid| SolidPiece { solid, tetrahedra }));
    }
    let mesh = match pieces.pop() {
        Some(only) if pieces.is_empty() => only,
        last => {
            pieces.extend(last);
            generate::join(&pieces).map_err(BenchError::usage)?
        }
    };
    Ok(Joined {
        mesh,
        counts,
        solids: inside,
        from_file,
    })
}

fn material(section: &Section<'_>) -> Result<Solid, BenchError> {
    let own = section.read::<SolidTable>()?;
    Ok(Solid {
        density: *own.density,
        modulus: *own.modulus,
        poisson_ratio: *own.poisson,
    })
}

/// The file or the generated mesh of a table, with its scale.
pub(super) fn scaled(section: &Section<'_>, folder: &Path) -> Result<TriMesh, BenchError> {
    source(section, false, folder).map(|(mesh, _)| mesh)
}

/// The same, with the tetrahedra of a solid.
fn source(
    section: &Section<'_>,
    is_solid: bool,
    folder: &Path,
) -> Result<(TriMesh, Vec<[u32; 4]>), BenchError> {
    let own = section.read::<Source>()?;
    let needs = if is_solid {
        "a solid is made of tetrahedra: block:NxMxK, ball:N or a file of Gmsh, .msh"
    } else {
        "tetrahedra are for a [[mesh]] with [mesh.solid] below it"
    };
    let (mesh, tetrahedra) = match (own.file.as_deref(), own.generator.as_deref()) {
        (Some(file), None) => {
            let path = folder.join(file);
            if path.extension().is_some_and(|kind| kind == "msh") != is_solid {
                return Err(own.file.refuse(needs));
            }
            let read = match is_solid {
                true => gmsh::read(&path).map(TetMesh::into_parts),
                false => io::read(&path).map(|mesh| (mesh, Vec::new())),
            };
            read.map_err(|error| own.file.refuse(error))?
        }
        (None, Some(spec)) if mesh_spec::is_file(spec) => {
            let message = format!("`{spec}` is no generator; a file goes under the key `file`");
            return Err(own.generator.refuse(message));
        }
        (None, Some(spec)) => {
            if mesh_spec::is_solid(spec) != is_solid {
                return Err(own.generator.refuse(needs));
            }
            let made = match is_solid {
                true => mesh_spec::solid(spec).map(TetMesh::into_parts),
                false => mesh_spec::load(spec).map(|mesh| (mesh, Vec::new())),
            };
            made.map_err(|error| own.generator.refuse(error))?
        }
        (None, None) => return Err(section.refuse_table("needs a file or a generator")),
        (Some(_), Some(_)) => {
            return Err(own
                .generator
                .refuse("a file is given too: give one of them"));
        }
    };
    // What is not given changes no bit.
    let Some(Factors(factors)) = *own.scale else {
        return Ok((mesh, tetrahedra));
    };
    let scaled = mesh.positions().iter().map(|x| x.component_mul(&factors));
    let scaled = mesh.moved(scaled.collect());
    let scaled = scaled.map_err(|error| section.refuse_table(error))?;
    Ok((scaled, tetrahedra))
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

fn piece(
    section: &Section<'_>,
    is_solid: bool,
    folder: &Path,
) -> Result<(TriMesh, Vec<[u32; 4]>), BenchError> {
    let (mesh, tetrahedra) = source(section, is_solid, folder)?;
    let own = section.read::<Piece>()?;
    if is_solid {
        own.weld.refuse_given("for a solid")?;
        own.pressure.refuse_given("for a solid")?;
        own.bulk_modulus.refuse_given("for a solid")?;
    }
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
    let mesh = mesh.moved(positions);
    let mesh = mesh.map_err(|error| section.refuse_table(error))?;
    Ok((mesh, tetrahedra))
}

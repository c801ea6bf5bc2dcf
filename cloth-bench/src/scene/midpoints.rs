//! A sheet whose degrees of freedom are the middles of its edges: the remedy against locking that is no matter of
//! springs.

use super::cloth::{self, COMPRESSION, EDGES, FINE_SHARE, LEVEL, SLACK};
use super::{BENDING, BENDING_STIFFNESS, RIGIDITY, SHEAR};
use crate::error::BenchError;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::cloth::ClothModel;
use cloth_core::mesh::TriMesh;
use cloth_core::topology::EdgeTable;

pub(super) const POINTS: Parameter = parameter(
    "points",
    "vertices",
    "what moves: vertices, or midpoints of the edges (nonconforming elements; no contact; pictures and exports show the small triangles between them)",
);

/// What is made of springs on edges, or of other hinges.
const WITHOUT_MEANING: [&Parameter; 8] = [
    &SHEAR,
    &COMPRESSION,
    &SLACK,
    &EDGES,
    &LEVEL,
    &FINE_SHARE,
    &BENDING,
    &BENDING_STIFFNESS,
];

/// Whether the middles of edges move instead of vertices.
pub(super) fn are_asked_for(settings: &Settings) -> Result<bool, BenchError> {
    settings.choice(&POINTS, &[("vertices", false), ("midpoints", true)])
}

/// Cuts the cloth that settings describe to the midpoints of a mesh. A vertex that is held holds the middles of all its
/// edges. Returns the small triangles between midpoints, and the cloth on them.
pub(super) fn cut(
    settings: &Settings,
    mesh: &TriMesh,
    held: &[usize],
) -> Result<(TriMesh, ClothModel), BenchError> {
    for parameter in WITHOUT_MEANING {
        if settings.get(parameter.name).is_some() {
            return Err(BenchError::Usage(format!(
                "{} has no meaning with points=midpoints: small triangles of springs or of a continuum, and their own hinges, are all there is",
                parameter.name
            )));
        }
    }
    let described = cloth::described(settings, &RIGIDITY)?;
    let carrier = cloth::membrane_carrier(settings)?;
    let cut = described
        .on_midpoints(carrier, mesh)
        .map_err(BenchError::usage)?;
    let mut model = cut.model;
    let edges = EdgeTable::build(mesh).map_err(BenchError::usage)?;
    for (middle, ends) in edges.ends().iter().enumerate() {
        if ends.iter().any(|&vertex| held.contains(&(vertex as usize))) {
            model
                .particles
                .prescribe(middle)
                .map_err(BenchError::usage)?;
        }
    }
    Ok((cut.midpoints.mesh().clone(), model))
}

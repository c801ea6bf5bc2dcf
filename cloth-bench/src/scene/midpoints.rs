//! A sheet whose degrees of freedom are the middles of its edges: the remedy against locking that is no matter of
//! springs.

use super::cloth::{self, EdgeSprings, Material};
use crate::error::BenchError;
use crate::settings::{Settings, Table};
use cloth_core::cloth::ClothModel;
use cloth_core::mesh::TriMesh;
use cloth_core::topology::EdgeTable;

crate::settings! {
    /// Of `hang`.
    pub(super) struct Midpoints {
        points: Points = "vertices",
            "what moves: vertices, or midpoints of the edges (nonconforming elements; no contact; pictures and exports \
             show the small triangles between them)";
    }
}

crate::choices! {
    /// What moves.
    #[derive(PartialEq)]
    pub(super) enum Points { Vertices = "vertices", Midpoints = "midpoints" }
}

/// Cuts the cloth that settings describe to the midpoints of a mesh. A vertex that is held holds the middles of all its
/// edges. Returns the small triangles between midpoints, and the cloth on them.
pub(super) fn cut(
    settings: &Settings,
    mesh: &TriMesh,
    held: &[usize],
) -> Result<(TriMesh, ClothModel), BenchError> {
    let (own, springs) = (Material::read(settings)?, EdgeSprings::read(settings)?);
    // What is made of springs on edges, or of other hinges.
    let others = [
        own.shear.bare(),
        springs.compression.bare(),
        springs.slack.bare(),
        springs.edges.bare(),
        springs.level.bare(),
        springs.fine_fraction.bare(),
        own.bending.bare(),
        own.bending_stiffness.bare(),
    ];
    for other in others {
        other.refuse_given(
            "with points=midpoints: small triangles of springs or of a continuum, and their own hinges, are all there is",
        )?;
    }
    let described = cloth::described(settings)?;
    let elements = cloth::membrane_elements(&own)?;
    let cut = described
        .on_midpoints(elements, mesh)
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

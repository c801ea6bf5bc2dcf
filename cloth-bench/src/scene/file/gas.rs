//! What is inside closed pieces: `pressure` and `bulk_modulus` of a `[[mesh]]`.

use super::document::Section;
use super::keys::Piece;
use crate::error::BenchError;
use cloth_core::enclosure::{ClosedVolume, Pressure};
use cloth_core::mesh::TriMesh;
use cloth_core::method::ordering::Order;

/// What is inside of one piece.
pub(super) struct Inside {
    /// The triangles of the piece, by their numbers.
    triangles: Vec<usize>,
    content: Content,
}

enum Content {
    Gas(Pressure),
    Volume(ClosedVolume),
}

/// Gases of constant pressure, and sealed volumes.
type Contents = (Vec<Pressure>, Vec<ClosedVolume>);

/// What the tables of the pieces, of so many vertices each, ask for.
pub(super) fn inside(
    sections: &[Section<'_>],
    counts: &[usize],
    mesh: &TriMesh,
    order: Option<&Order>,
) -> Result<Vec<Inside>, BenchError> {
    let mut all = Vec::new();
    let mut first = 0;
    for (section, count) in sections.iter().zip(counts) {
        let own = first..first + count;
        first = own.end;
        let is_own = |corners: &[u32; 3]| {
            let old = order.map_or(corners[0], |order| order.old_of_new()[corners[0] as usize]);
            own.contains(&(old as usize))
        };
        let numbered = mesh.triangles().iter().enumerate();
        let triangles = numbered.filter(|(_, corners)| is_own(corners));
        let triangles: Vec<usize> = triangles.map(|(number, _)| number).collect();
        let piece = section.read::<Piece>()?;
        let own = triangles.iter().copied();
        let content = if let Some(modulus) = *piece.bulk_modulus {
            let volume = ClosedVolume::inside(modulus, mesh, own);
            let volume = volume.map_err(|error| piece.bulk_modulus.refuse(error))?;
            let volume = volume.pressure(piece.pressure.unwrap_or(0.0));
            Content::Volume(volume.map_err(|error| piece.pressure.refuse(error))?)
        } else if let Some(pressure) = *piece.pressure {
            let gas = Pressure::inside(pressure, mesh, own);
            Content::Gas(gas.map_err(|error| piece.pressure.refuse(error))?)
        } else {
            continue;
        };
        all.push(Inside { triangles, content });
    }
    Ok(all)
}

/// What is still inside where these triangles are left: nothing in a piece that has a hole.
pub(super) fn left(all: &[Inside], is_left: &[bool]) -> Contents {
    let (mut gases, mut volumes) = (Vec::new(), Vec::new());
    let whole = |inside: &&Inside| inside.triangles.iter().all(|&t| is_left[t]);
    for Inside { content, .. } in all.iter().filter(whole) {
        match content {
            Content::Gas(gas) => gases.push(gas.clone()),
            Content::Volume(volume) => volumes.push(volume.clone()),
        }
    }
    (gases, volumes)
}

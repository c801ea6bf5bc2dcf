//! What is inside closed pieces: `pressure` and `bulk_modulus` of a `[[mesh]]`.

use super::document::Section;
use super::keys::Piece;
use crate::error::BenchError;
use cloth_core::enclosure::{ClosedVolume, Pressure};
use cloth_core::mesh::TriMesh;
use cloth_core::method::ordering::Order;

/// The gases of constant pressure and the sealed volumes that the tables of the pieces, of so many vertices each, ask
/// for.
pub(super) fn inside(
    sections: &[Section<'_>],
    counts: &[usize],
    mesh: &TriMesh,
    order: Option<&Order>,
) -> Result<(Vec<Pressure>, Vec<ClosedVolume>), BenchError> {
    let (mut gases, mut volumes) = (Vec::new(), Vec::new());
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
        let triangles = triangles.map(|(number, _)| number);
        let piece = section.read::<Piece>()?;
        if let Some(modulus) = *piece.bulk_modulus {
            let volume = ClosedVolume::inside(modulus, mesh, triangles);
            let volume = volume.map_err(|error| piece.bulk_modulus.refuse(error))?;
            let volume = volume.pressure(piece.pressure.unwrap_or(0.0));
            volumes.push(volume.map_err(|error| piece.pressure.refuse(error))?);
        } else if let Some(pressure) = *piece.pressure {
            let gas = Pressure::inside(pressure, mesh, triangles);
            gases.push(gas.map_err(|error| piece.pressure.refuse(error))?);
        }
    }
    Ok((gases, volumes))
}

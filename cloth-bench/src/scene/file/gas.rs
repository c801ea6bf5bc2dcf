//! Gas inside closed pieces: `pressure` of a `[[mesh]]`.

use super::document::Section;
use super::keys::PRESSURE;
use crate::error::BenchError;
use cloth_core::mesh::TriMesh;
use cloth_core::method::ordering::Order;
use cloth_core::pressure::Pressure;

/// What the tables of the pieces, of so many vertices each, say of their insides.
pub(super) fn inside(
    sections: &[Section<'_>],
    counts: &[usize],
    mesh: &TriMesh,
    order: Option<&Order>,
) -> Result<Vec<Pressure>, BenchError> {
    let mut gases = Vec::new();
    let mut first = 0;
    for (section, count) in sections.iter().zip(counts) {
        let own = first..first + count;
        first = own.end;
        let Some(pressure) = section.number(&PRESSURE)? else {
            continue;
        };
        let is_own = |corners: &[u32; 3]| {
            let old = order.map_or(corners[0], |order| order.old_of_new()[corners[0] as usize]);
            own.contains(&(old as usize))
        };
        let numbered = mesh.triangles().iter().enumerate();
        let triangles = numbered.filter(|(_, corners)| is_own(corners));
        let gas = Pressure::inside(pressure, mesh, triangles.map(|(number, _)| number));
        gases.push(gas.map_err(|error| section.refuse(&PRESSURE, error))?);
    }
    Ok(gases)
}

//! `[[mass]]`: masses on chosen vertices, beside that of the cloth.

use super::document::Section;
use super::keys::Mass;
use crate::error::BenchError;
use cloth_core::math::Real;
use cloth_core::particles::Particles;

/// Adds the mass (kg) of a table to these vertices, and gives it.
pub(super) fn add(
    section: &Section<'_>,
    vertices: &[usize],
    particles: &mut Particles,
) -> Result<Real, BenchError> {
    let own = section.read::<Mass>()?;
    let mass = own
        .mass
        .ok_or_else(|| section.refuse_table("needs a mass"))?;
    let part = mass / vertices.len() as Real;
    for &vertex in vertices {
        let whole = particles.mass()[vertex] + part;
        let added = particles.set_mass(vertex, whole);
        added.map_err(|error| own.mass.refuse(error))?;
    }
    Ok(mass)
}

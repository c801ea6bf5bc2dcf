//! `[start]`: how the cloth differs from rest when the run begins.

use super::document::Section;
use super::keys::Start;
use crate::error::BenchError;
use crate::scene::Scene;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::{TriMesh, io};
use cloth_core::method::ordering::Order;
use std::f64::consts::TAU;
use std::path::Path;

/// Where the vertices of `mesh` are (m): at rest, or where a file has them, in the caller's order.
pub(super) fn positions(
    section: &Section<'_>,
    folder: &Path,
    mesh: &TriMesh,
    order: Option<&Order>,
) -> Result<Vec<Vec3>, BenchError> {
    let own = section.read::<Start>()?;
    let Some(file) = own.positions.as_deref() else {
        return Ok(mesh.positions().to_vec());
    };
    let given =
        io::read_vertices(&folder.join(file)).map_err(|error| own.positions.refuse(error))?;
    let (found, wanted) = (given.len(), mesh.vertex_count());
    if found != wanted {
        let message = format!("{file} has {found} vertices, but the meshes have {wanted}");
        return Err(own.positions.refuse(message));
    }
    Ok(order.map_or_else(|| given.clone(), |order| order.apply(&given)))
}

pub(super) fn apply(section: &Section<'_>, scene: &mut Scene) -> Result<(), BenchError> {
    let own = section.read::<Start>()?;
    if let Some(velocity) = *own.velocity {
        let inverse_mass = scene.model.particles.inverse_mass();
        for (v, w) in scene.start.velocities.iter_mut().zip(inverse_mass) {
            if *w > 0.0 {
                *v = velocity;
            }
        }
    }
    match (*own.wave, *own.wave_number) {
        (None, None) => {}
        (Some(wave), Some(number)) => {
            let number = number * TAU;
            for x in &mut scene.start.positions {
                *x += wave * number.dot(x).sin();
            }
            scene.hints.extend(stretched(scene)?);
        }
        _ => return Err(section.refuse_table("wave and wave_number go together")),
    }
    Ok(())
}

/// Of a wave that stretches the cloth: it gives that back as motion.
fn stretched(scene: &Scene) -> Result<Option<String>, BenchError> {
    /// A strain from which on the energy is more than that of most folds.
    const MUCH: Real = 0.01;
    let gauges = scene.gauges()?;
    let strain = |spring: &Spring| {
        let [a, b] = gather(&scene.start.positions, spring.vertices);
        (a - b).norm() / spring.rest_length - 1.0
    };
    let gauges = gauges.iter().filter(|spring| spring.rest_length > 0.0);
    let most = gauges.map(strain).fold(0.0, Real::max);
    let energy = scene.elastic().map_err(BenchError::failed)?;
    let energy = energy.value(&scene.start.positions);
    Ok((most > MUCH).then(|| {
        format!(
            "the wave of the start stretches edges by up to {:.1} %: the cloth begins with {energy:.3e} J, which it gives \
             back as motion; a lower or longer wave does not",
            100.0 * most
        )
    }))
}

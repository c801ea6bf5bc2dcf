//! `[air]`: what brakes the cloth, and the wind.

use super::document::Section;
use super::keys::AirTable;
use crate::error::BenchError;
use crate::scene::cloth::Material;
use crate::settings::{Settings, Table};
use cloth_core::air::{Air, AirConfig};
use cloth_core::mesh::TriMesh;

/// The air that a table describes around the cloth `mesh`, if there is a table.
pub(super) fn around(
    section: &Section<'_>,
    cloth: &Settings,
    mesh: &TriMesh,
) -> Result<Option<Air>, BenchError> {
    if !section.is_given() {
        return Ok(None);
    }
    let (own, usual) = (section.read::<AirTable>()?, AirConfig::default());
    let config = AirConfig {
        density: own.density.unwrap_or(usual.density),
        drag: own.drag.unwrap_or(usual.drag),
        lift: own.lift.unwrap_or(usual.lift),
        wind: own.wind.unwrap_or(usual.wind),
    };
    let air = Air::new(config, *Material::read(cloth)?.density, mesh).map_err(|error| {
        let (density, drag) = (own.density.bare(), own.drag.bare());
        let keys = [density, drag, own.lift.bare(), own.wind.bare()];
        match keys.iter().find(|key| error.name.contains(key.name())) {
            Some(key) => key.refuse(error),
            None => section.refuse_table(error),
        }
    })?;
    Ok(Some(air))
}

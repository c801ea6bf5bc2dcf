//! `[air]`: what brakes the cloth, and the wind.

use super::document::Section;
use super::keys::{AIR_DENSITY, DRAG, LIFT, WIND};
use crate::error::BenchError;
use crate::scene::DENSITY;
use crate::settings::Settings;
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
    let usual = AirConfig::default();
    let config = AirConfig {
        density: section.number(&AIR_DENSITY)?.unwrap_or(usual.density),
        drag: section.number(&DRAG)?.unwrap_or(usual.drag),
        lift: section.number(&LIFT)?.unwrap_or(usual.lift),
        wind: section.vector(&WIND)?.unwrap_or(usual.wind),
    };
    let air = Air::new(config, cloth.number(&DENSITY)?, mesh).map_err(|error| {
        let keys = [&AIR_DENSITY, &DRAG, &LIFT, &WIND];
        match keys.iter().find(|key| error.name.starts_with(key.name)) {
            Some(key) => section.refuse(key, error),
            None => section.refuse_table(error),
        }
    })?;
    Ok(Some(air))
}

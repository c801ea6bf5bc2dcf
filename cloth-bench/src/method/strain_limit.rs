//! Strain limiting after the step: a setting of every method.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::step::Stepper;
use cloth_pbd::{StrainLimiter, StretchRange, WithStrainLimit};

const STRAIN_LIMIT: Parameter = parameter(
    "strain_limit",
    "none",
    "strain beyond which no spring is stretched after a step (strain limiting), or none",
);
const STRAIN_LIMIT_PASSES: Parameter = parameter(
    "strain_limit_passes",
    "100",
    "most passes of strain limiting per step",
);

/// Of all methods.
pub(super) const STRAIN_LIMITING: &[Parameter] = &[STRAIN_LIMIT, STRAIN_LIMIT_PASSES];

/// The solver, with strain limiting if the settings ask for it.
pub(super) fn limited(
    solver: Box<dyn Stepper>,
    scene: &Scene,
    settings: &Settings,
) -> Result<Box<dyn Stepper>, BenchError> {
    if settings.text(&STRAIN_LIMIT) == "none" {
        settings.refuse_without(&STRAIN_LIMIT_PASSES, "strain_limit")?;
        return Ok(solver);
    }
    let range = StretchRange::stretch(settings.number(&STRAIN_LIMIT)?);
    // Triangles, and springs that are slack in a range, are limited along the edges.
    let limiter = StrainLimiter::builder(&scene.model.particles)
        .springs(&scene.gauges()?, range)
        .max_passes(settings.count(&STRAIN_LIMIT_PASSES, 1)?)
        .build()
        .map_err(BenchError::usage)?;
    Ok(Box::new(WithStrainLimit::new(solver, limiter)))
}

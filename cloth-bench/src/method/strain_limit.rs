//! Strain limiting after the step: a setting of every method.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::energy::{ArapTriangle, AreaTriangle};
use cloth_core::step::Stepper;
use cloth_pbd::{StrainLimiter, StretchRange, WithStrainLimit};

const STRAIN_LIMIT: Parameter = parameter(
    "strain_limit",
    "none",
    "strain beyond which nothing is stretched after a step (strain limiting), or none",
);
const STRAIN_LIMIT_OF: Parameter = parameter(
    "strain_limit_of",
    "edges",
    "what is limited: edges, triangles (principal stretches, so in all directions alike) or areas (of triangles)",
);
const STRAIN_LIMIT_PASSES: Parameter = parameter(
    "strain_limit_passes",
    "100",
    "most passes of strain limiting per step",
);

/// What is kept from being stretched.
#[derive(Clone, Copy, PartialEq)]
enum Limited {
    Edges,
    Triangles,
    Areas,
}

/// Of all methods.
pub(super) const STRAIN_LIMITING: &[Parameter] =
    &[STRAIN_LIMIT, STRAIN_LIMIT_OF, STRAIN_LIMIT_PASSES];

/// The solver, with strain limiting if the settings ask for it.
pub(super) fn limited(
    solver: Box<dyn Stepper>,
    scene: &Scene,
    settings: &Settings,
) -> Result<Box<dyn Stepper>, BenchError> {
    if settings.text(&STRAIN_LIMIT) == "none" {
        settings.refuse_without(&STRAIN_LIMIT_OF, "strain_limit")?;
        settings.refuse_without(&STRAIN_LIMIT_PASSES, "strain_limit")?;
        return Ok(solver);
    }
    let range = StretchRange::stretch(settings.number(&STRAIN_LIMIT)?);
    let builder = StrainLimiter::builder(&scene.model.particles);
    let limited = settings.choice(
        &STRAIN_LIMIT_OF,
        &[
            ("edges", Limited::Edges),
            ("triangles", Limited::Triangles),
            ("areas", Limited::Areas),
        ],
    )?;
    let mesh = || {
        scene.mesh.as_ref().ok_or_else(|| {
            BenchError::usage("strain_limit_of: a scene without triangles has edges only")
        })
    };
    let builder = match limited {
        // Of every kind of cloth, springs with slack and triangles included.
        Limited::Edges => builder.springs(&scene.gauges()?, range),
        // The limiter knows no modulus.
        Limited::Triangles => builder.stretches(&ArapTriangle::on(mesh()?, 1.0), range),
        Limited::Areas => builder.areas(&AreaTriangle::on(mesh()?, 1.0), range),
    };
    let limiter = builder
        .max_passes(settings.count(&STRAIN_LIMIT_PASSES, 1)?)
        .build()
        .map_err(BenchError::usage)?;
    Ok(Box::new(WithStrainLimit::new(solver, limiter)))
}

//! Strain limiting after the step: a setting of every method.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Range::*, Settings, Table};
use cloth_core::energy::{ArapTriangle, AreaTriangle};
use cloth_core::math::Real;
use cloth_core::step::Stepper;
use cloth_pbd::{StrainLimiter, StretchRange, WithStrainLimit};

crate::settings! {
    /// Of all methods.
    pub(super) struct StrainLimit {
        strain_limit: Option<Real> = "none" in AtLeast(0.0),
            "strain beyond which nothing is stretched after a step (strain limiting), or none";
        strain_limit_of: Limited = "edges",
            "what is limited: edges, triangles (principal stretches, so in all directions alike) or areas (of \
             triangles)";
        strain_limit_passes: u32 = 100 in AtLeast(1.0), "most passes of strain limiting per step";
    }
}

crate::choices! {
    /// What is kept from being stretched.
    pub(super) enum Limited { Edges = "edges", Triangles = "triangles", Areas = "areas" }
}

/// The solver, with strain limiting if the settings ask for it.
pub(super) fn limited(
    solver: Box<dyn Stepper>,
    scene: &Scene,
    settings: &Settings,
) -> Result<Box<dyn Stepper>, BenchError> {
    let own = StrainLimit::read(settings)?;
    let Some(strain) = *own.strain_limit else {
        own.strain_limit_of.refuse_without("strain_limit")?;
        own.strain_limit_passes.refuse_without("strain_limit")?;
        return Ok(solver);
    };
    let range = StretchRange::stretch(strain);
    let builder = StrainLimiter::builder(&scene.model.particles);
    let mesh = || {
        scene.mesh.as_ref().ok_or_else(|| {
            BenchError::usage("strain_limit_of: a scene without triangles has edges only")
        })
    };
    let builder = match *own.strain_limit_of {
        // Of every kind of cloth, springs with slack and triangles included.
        Limited::Edges => builder.springs(&scene.gauges()?, range),
        // The limiter knows no modulus.
        Limited::Triangles => builder.stretches(&ArapTriangle::on(mesh()?, 1.0), range),
        Limited::Areas => builder.areas(&AreaTriangle::on(mesh()?, 1.0), range),
    };
    let limiter = builder
        .max_passes(*own.strain_limit_passes)
        .build()
        .map_err(BenchError::usage)?;
    Ok(Box::new(WithStrainLimit::new(solver, limiter)))
}

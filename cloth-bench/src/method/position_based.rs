//! What can be set for sweeps, coarse levels and strain limiting.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_pbd::{Hierarchy, HierarchyConfig, StrainLimiter, StretchRange};

pub(super) const RELAXATION: Parameter = parameter(
    "relaxation",
    "1",
    "part of its correction that a constraint makes in a visit, above 0 and below 2",
);
pub(super) const CHEBYSHEV: Parameter = parameter(
    "chebyshev",
    "none",
    "extrapolation of the sweeps: none, auto (spectral radius estimated), or the spectral radius",
);
pub(super) const CHEBYSHEV_DELAY: Parameter = parameter(
    "chebyshev_delay",
    "4",
    "plain sweeps of a substep before the extrapolation",
);
pub(super) const HIERARCHY: Parameter = parameter(
    "hierarchy",
    "none",
    "correction by coarse levels: none, once a substep, or the number of sweeps from one to the next",
);
pub(super) const STRAIN_LIMIT: Parameter = parameter(
    "strain_limit",
    "none",
    "strain beyond which no spring is stretched after a step (strain limiting), or none",
);
pub(super) const STRAIN_LIMIT_PASSES: Parameter = parameter(
    "strain_limit_passes",
    "100",
    "most passes of strain limiting per step",
);
pub(super) const SWEEP: Parameter = parameter(
    "sweep",
    "colored",
    "how a sweep goes: colored, sequential, jacobi (with averaging) or plain-jacobi",
);

const SWEEPS: [(&str, Sweep); 4] = [
    ("colored", Sweep::Colored),
    ("sequential", Sweep::Sequential),
    ("jacobi", Sweep::Jacobi),
    ("plain-jacobi", Sweep::PlainJacobi),
];

pub(super) fn sweep(settings: &Settings) -> Result<Sweep, BenchError> {
    settings.choice(&SWEEP, &SWEEPS)
}

pub(super) fn hierarchy(
    scene: &Scene,
    settings: &Settings,
) -> Result<Option<Hierarchy>, BenchError> {
    let every = match settings.text(&HIERARCHY) {
        "none" => return Ok(None),
        "once" => None,
        _ => Some(settings.count(&HIERARCHY, 1)?),
    };
    let Some(mesh) = &scene.mesh else {
        return Err(BenchError::Usage(format!(
            "scene `{}` has no triangles to make coarse levels of",
            scene.name
        )));
    };
    let config = HierarchyConfig {
        every,
        ..HierarchyConfig::default()
    };
    Hierarchy::build(mesh, &scene.model.particles, config)
        .map(Some)
        .map_err(BenchError::usage)
}

pub(super) fn acceleration(settings: &Settings) -> Result<Acceleration, BenchError> {
    let radius = match settings.text(&CHEBYSHEV) {
        "none" => None,
        "auto" => Some(Radius::Estimated),
        _ => Some(Radius::Given(settings.number(&CHEBYSHEV)?)),
    };
    let delay = settings.count(&CHEBYSHEV_DELAY, 1)?;
    Ok(Acceleration {
        relaxation: settings.number(&RELAXATION)?,
        chebyshev: radius.map(|radius| Chebyshev { radius, delay }),
    })
}

pub(super) fn strain_limiter(
    scene: &Scene,
    settings: &Settings,
) -> Result<Option<StrainLimiter>, BenchError> {
    if settings.text(&STRAIN_LIMIT) == "none" {
        return Ok(None);
    }
    let range = StretchRange::stretch(settings.number(&STRAIN_LIMIT)?);
    StrainLimiter::builder(&scene.model.particles)
        .springs(&scene.model.springs, range)
        .max_passes(settings.count(&STRAIN_LIMIT_PASSES, 1)?)
        .build()
        .map(Some)
        .map_err(BenchError::usage)
}

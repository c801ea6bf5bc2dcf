//! Settings of XPBD solved as one system.

use super::position_based::{self, AUTO, XPBD_DAMPING, XPBD_SUBSTEPS};
use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::math::Real;
use cloth_xpbd::direct::{DirectConfig, System};

const DIRECT_ITERATIONS: Parameter = parameter("iterations", "20", "most iterations per step");
const DIRECT_SUBSTEPS: Parameter = parameter(
    "substeps",
    AUTO,
    "parts of a step, with contact at the end of each: a number, or auto: 1 where nothing can be touched, otherwise what auto is to xpbd",
);
const DIRECT_TOLERANCE: Parameter = parameter(
    "tolerance",
    "1e-6",
    "largest motion of the last iteration, as a part of the size of the cloth",
);
const DIRECT_SYSTEM: Parameter = parameter(
    "system",
    "saddle",
    "linear system and solver: saddle (primal–dual, L D Lᵀ), saddle-minres, schur (dual, Cholesky) or schur-cg",
);
const DIRECT_MODE: Parameter = parameter(
    "mode",
    "converged",
    "converged, stable (one solve a step with geometric stiffness) or plain (one solve without)",
);

/// Of the direct solver.
pub(super) const DIRECT: &[Parameter] = &[
    DIRECT_ITERATIONS,
    DIRECT_SUBSTEPS,
    DIRECT_TOLERANCE,
    DIRECT_SYSTEM,
    DIRECT_MODE,
    XPBD_DAMPING,
];

/// The number of substeps on a scene, for a step of `dt` (s).
pub(super) fn substeps(scene: &Scene, settings: &Settings, dt: Real) -> Result<u32, BenchError> {
    if settings.text(&DIRECT_SUBSTEPS) != AUTO {
        return settings.count(&DIRECT_SUBSTEPS, 1);
    }
    if !scene.can_touch() {
        return Ok(1);
    }
    let as_swept = Settings::default().with(XPBD_SUBSTEPS.name, AUTO);
    position_based::xpbd_substeps(scene, &as_swept, dt)
}

pub(super) fn direct(settings: &Settings) -> Result<DirectConfig, BenchError> {
    let systems = [
        ("saddle", System::SaddleLdlt),
        ("saddle-minres", System::SaddleMinres),
        ("schur", System::SchurCholesky),
        ("schur-cg", System::SchurConjugateGradients),
    ];
    let one_solve = DirectConfig::linearized();
    let plain = DirectConfig {
        geometric_stiffness: false,
        ..one_solve
    };
    let converged = DirectConfig {
        max_iterations: settings.count(&DIRECT_ITERATIONS, 1)?,
        tolerance: settings.number(&DIRECT_TOLERANCE)?,
        ..DirectConfig::default()
    };
    let modes = [
        ("converged", converged),
        ("stable", one_solve),
        ("plain", plain),
    ];
    let mode = settings.choice(&DIRECT_MODE, &modes)?;
    if mode != converged {
        for parameter in [&DIRECT_ITERATIONS, &DIRECT_TOLERANCE] {
            settings.refuse_without(parameter, "mode=converged")?;
        }
    }
    Ok(DirectConfig {
        substeps: settings.count(&DIRECT_SUBSTEPS, 1)?,
        system: settings.choice(&DIRECT_SYSTEM, &systems)?,
        damping: settings.number(&XPBD_DAMPING)?,
        ..mode
    })
}

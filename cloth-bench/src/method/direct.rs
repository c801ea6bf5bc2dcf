//! Settings of XPBD solved as one system.

use super::position_based::XPBD_DAMPING;
use crate::error::BenchError;
use crate::settings::{Parameter, Settings, parameter};
use cloth_xpbd::direct::{DirectConfig, System};

const DIRECT_ITERATIONS: Parameter = parameter("iterations", "20", "most iterations per step");
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
    DIRECT_TOLERANCE,
    DIRECT_SYSTEM,
    DIRECT_MODE,
    XPBD_DAMPING,
];

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
        system: settings.choice(&DIRECT_SYSTEM, &systems)?,
        damping: settings.number(&XPBD_DAMPING)?,
        ..mode
    })
}

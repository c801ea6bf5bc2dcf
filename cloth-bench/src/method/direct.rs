//! Settings of XPBD solved as one system.

use super::position_based::{self, ConstraintDamping};
use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Auto, Choice, Or, Parameter, Range::*, Settings, Table};
use cloth_core::math::Real;
use cloth_xpbd::direct::{DirectConfig, System};

crate::settings! {
    /// Of the direct solver.
    pub(super) struct Direct {
        iterations: u32 = 20 in AtLeast(1.0), "most iterations per step";
        substeps: Or<Auto, u32> = "auto" in AtLeast(1.0),
            "parts of a step, with contact at the end of each: a number, or auto: 1 where nothing can be touched, \
             otherwise what auto is to xpbd";
        tolerance: Real = 1e-6, "largest motion of the last iteration, as a part of the size of the cloth";
        system: System = "saddle",
            "linear system and solver: saddle (primal–dual, L D Lᵀ), saddle-minres, schur (dual, Cholesky) or schur-cg";
        mode: Mode = "converged",
            "converged, stable (one solve a step with geometric stiffness) or plain (one solve without)";
    }
}

/// Of the direct solver.
pub(super) const DIRECT: &[&[Parameter]] = &[Direct::PARAMETERS, ConstraintDamping::PARAMETERS];

crate::choices! {
    /// What a step solves.
    pub(super) enum Mode { Converged = "converged", Stable = "stable", Plain = "plain" }
}

impl Choice for System {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("saddle", Self::SaddleLdlt),
        ("saddle-minres", Self::SaddleMinres),
        ("schur", Self::SchurCholesky),
        ("schur-cg", Self::SchurConjugateGradients),
    ];
}

/// The number of substeps on a scene, for a step of `dt` (s).
pub(super) fn substeps(scene: &Scene, settings: &Settings, dt: Real) -> Result<u32, BenchError> {
    match *Direct::read(settings)?.substeps {
        Or::Value(count) => Ok(count),
        Or::Word(Auto::Auto) if !scene.can_touch() => Ok(1),
        Or::Word(Auto::Auto) => {
            let as_swept = Settings::of("substeps=auto");
            position_based::xpbd_substeps(scene, &as_swept, dt)
        }
    }
}

pub(super) fn direct(settings: &Settings, substeps: u32) -> Result<DirectConfig, BenchError> {
    let own = Direct::read(settings)?;
    let one_solve = DirectConfig::linearized();
    let mode = match *own.mode {
        Mode::Converged => DirectConfig {
            max_iterations: *own.iterations,
            tolerance: *own.tolerance,
            ..DirectConfig::default()
        },
        Mode::Stable => one_solve,
        Mode::Plain => DirectConfig {
            geometric_stiffness: false,
            ..one_solve
        },
    };
    if !matches!(*own.mode, Mode::Converged) {
        own.iterations.refuse_without("mode=converged")?;
        own.tolerance.refuse_without("mode=converged")?;
    }
    Ok(DirectConfig {
        substeps,
        system: *own.system,
        damping: *ConstraintDamping::read(settings)?.damping,
        ..mode
    })
}

//! Settings of projective dynamics.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::math::Real;
use cloth_pd::{Acceleration, PdConfig, Start};

pub(super) const PD_COARSE: Parameter = parameter(
    "coarse",
    "12",
    "cells a side of the coarse grid under quasi-newton; 0: none",
);
const PD_ITERATIONS: Parameter = parameter(
    "iterations",
    "auto",
    "local–global iterations per step, at most; auto: 10, or 60 where contact acts after the step",
);
/// After an impact that the method has not felt, a few iterations are not enough: they leave strains that the next impacts feed on.
const TOUCHING: (u32, Real) = (60, 1e-2);
const PD_CONTACT_ITERATIONS: Parameter = parameter(
    "contact_iterations",
    "30",
    "the same for a step in which contact pushes and the method feels it, if that is more",
);
const PD_TOLERANCE: Parameter = parameter(
    "tolerance",
    "auto",
    "relative gradient norm at which a step is done, or none; auto: none, or 1e-2 where contact acts after the step",
);
const PD_START: Parameter = parameter(
    "start",
    "inertial",
    "first guess: previous, inertial or predicted",
);
const PD_ACCELERATION: Parameter = parameter(
    "acceleration",
    "quasi-newton",
    "none, chebyshev or quasi-newton",
);
const PD_HISTORY: Parameter = parameter("history", "2", "pairs that quasi-newton remembers");
const PD_RADIUS: Parameter = parameter(
    "spectral_radius",
    "auto",
    "of the plain iteration, for chebyshev; auto: estimated in every step",
);

/// Of projective dynamics.
pub(super) const PD: &[Parameter] = &[
    PD_ITERATIONS,
    PD_CONTACT_ITERATIONS,
    PD_TOLERANCE,
    PD_START,
    PD_ACCELERATION,
    PD_HISTORY,
    PD_COARSE,
    PD_RADIUS,
];

/// Of a solver for `scene`.
pub(super) fn projective(settings: &Settings, scene: &Scene) -> Result<PdConfig, BenchError> {
    let kind = settings.choice(
        &PD_ACCELERATION,
        &[("none", 0), ("chebyshev", 1), ("quasi-newton", 2)],
    )?;
    if kind != 1 {
        settings.refuse_without(&PD_RADIUS, "acceleration=chebyshev")?;
    }
    if kind != 2 {
        for parameter in [&PD_HISTORY, &PD_COARSE] {
            settings.refuse_without(parameter, "acceleration=quasi-newton")?;
        }
    }
    let touching = scene.touches() && !scene.has_potential();
    let acceleration = match kind {
        0 => Acceleration::None,
        1 => Acceleration::Chebyshev {
            spectral_radius: match settings.text(&PD_RADIUS) {
                "auto" => None,
                _ => Some(settings.number(&PD_RADIUS)?),
            },
        },
        _ => Acceleration::QuasiNewton {
            history: settings.count(&PD_HISTORY, 0)?,
        },
    };
    Ok(PdConfig {
        iterations: match settings.text(&PD_ITERATIONS) {
            "auto" if touching => TOUCHING.0,
            "auto" => PdConfig::default().iterations,
            _ => settings.count(&PD_ITERATIONS, 1)?,
        },
        contact_iterations: settings.count(&PD_CONTACT_ITERATIONS, 1)?,
        tolerance: match settings.text(&PD_TOLERANCE) {
            "auto" if touching => Some(TOUCHING.1),
            "auto" | "none" => None,
            _ => Some(settings.number(&PD_TOLERANCE)?),
        },
        start: settings.choice(
            &PD_START,
            &[
                ("previous", Start::Previous),
                ("inertial", Start::Inertial),
                ("predicted", Start::Predicted),
            ],
        )?,
        acceleration,
    })
}

//! Settings of projective dynamics.

use crate::error::BenchError;
use crate::settings::{Parameter, Settings, parameter};
use cloth_pd::{Acceleration, PdConfig, StartGuess};

pub(super) const PD_COARSE: Parameter = parameter(
    "coarse",
    "12",
    "cells a side of the coarse grid under quasi-newton; 0: none",
);
const PD_ITERATIONS: Parameter = parameter(
    "iterations",
    "10",
    "local–global iterations per step, at most",
);
const PD_CONTACT_ITERATIONS: Parameter = parameter(
    "contact_iterations",
    "30",
    "the same for a step in which contact pushes, if that is more",
);
const PD_TOLERANCE: Parameter = parameter(
    "tolerance",
    "none",
    "relative gradient norm at which a step is done, or none",
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

/// Of a solver.
pub(super) fn projective(settings: &Settings) -> Result<PdConfig, BenchError> {
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
        iterations: settings.count(&PD_ITERATIONS, 1)?,
        contact_iterations: settings.count(&PD_CONTACT_ITERATIONS, 1)?,
        tolerance: match settings.text(&PD_TOLERANCE) {
            "none" => None,
            _ => Some(settings.number(&PD_TOLERANCE)?),
        },
        start: settings.choice(
            &PD_START,
            &[
                ("previous", StartGuess::Previous),
                ("inertial", StartGuess::Inertial),
                ("predicted", StartGuess::Predicted),
            ],
        )?,
        acceleration,
    })
}

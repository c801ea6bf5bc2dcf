//! Settings of projective dynamics.

use crate::error::BenchError;
use crate::settings::{Auto, Choice, Or, Range::*};
use cloth_core::math::Real;
use cloth_pd::{Acceleration, PdConfig, StartGuess};

crate::settings! {
    /// Of projective dynamics.
    pub(super) struct Pd {
        iterations: Or<Auto, u32> = "auto" in AtLeast(1.0), "local–global iterations per step; auto: as many as velocity_tolerance takes, from 10";
        most_iterations: u32 = 300 in AtLeast(1.0), "most iterations per step, with iterations=auto";
        velocity_tolerance: Real = 0.1 in AtLeast(0.0), "decrement at which a step is done, over the change of velocity, with iterations=auto";
        tolerance: Option<Real> = "none", "relative gradient norm at which a step is done, or none";
        start: StartGuess = "extrapolated", "first guess: previous, inertial, extrapolated or predicted";
        acceleration: Accelerated = "quasi-newton", "none, chebyshev or quasi-newton";
        history: u32 = 2, "pairs that quasi-newton remembers";
        coarse: u32 = 12, "cells a side of the coarse grid under quasi-newton; 0: none";
        spectral_radius: Or<Auto, Real> = "auto",
            "of the plain iteration, for chebyshev; auto: estimated in every step";
    }
}

crate::choices! {
    /// What makes the iteration faster.
    #[derive(PartialEq)]
    pub(super) enum Accelerated {
        None = "none",
        Chebyshev = "chebyshev",
        QuasiNewton = "quasi-newton",
    }
}

impl Choice for StartGuess {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("previous", Self::Previous),
        ("inertial", Self::Inertial),
        ("extrapolated", Self::Extrapolated),
        ("predicted", Self::Predicted),
    ];
}

/// Of a solver.
pub(super) fn projective(own: &Pd) -> Result<PdConfig, BenchError> {
    if *own.acceleration != Accelerated::Chebyshev {
        own.spectral_radius
            .refuse_without("acceleration=chebyshev")?;
    }
    if *own.acceleration != Accelerated::QuasiNewton {
        own.history.refuse_without("acceleration=quasi-newton")?;
        own.coarse.refuse_without("acceleration=quasi-newton")?;
    }
    if own.tolerance.is_some() {
        own.velocity_tolerance.refuse_without("tolerance=none")?;
    }
    let iterations = match *own.iterations {
        Or::Word(Auto::Auto) => None,
        Or::Value(iterations) => {
            own.most_iterations.refuse_without("iterations=auto")?;
            own.velocity_tolerance.refuse_without("iterations=auto")?;
            Some(iterations)
        }
    };
    Ok(PdConfig {
        iterations,
        most_iterations: *own.most_iterations,
        velocity_tolerance: *own.velocity_tolerance,
        tolerance: *own.tolerance,
        start: *own.start,
        acceleration: match *own.acceleration {
            Accelerated::None => Acceleration::None,
            Accelerated::Chebyshev => Acceleration::Chebyshev {
                spectral_radius: match *own.spectral_radius {
                    Or::Word(Auto::Auto) => None,
                    Or::Value(radius) => Some(radius),
                },
            },
            Accelerated::QuasiNewton => Acceleration::QuasiNewton {
                history: *own.history,
            },
        },
    })
}

//! Settings of the mass-spring integrators.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::element::Convexity;
use cloth_core::method::linear::{LinearMethod, StoppingCriteria};
use cloth_massspring::{Damping, HessianPolicy, ImplicitConfig, Solve, StartGuess};

pub(super) const EXPLICIT_SUBSTEPS: Parameter = parameter(
    "substeps",
    "auto",
    "parts of a step; auto: as many as half the stable step of the start asks for",
);
const MAX_ITERATIONS: Parameter = parameter("iterations", "4000", "most iterations per step");
const TOLERANCE: Parameter = parameter(
    "tolerance",
    "1e-3",
    "error of the velocity change at which a step is done, relative to it (estimated by the Newton decrement)",
);
const START: Parameter = parameter(
    "start",
    "extrapolated",
    "first guess: previous, inertial, extrapolated or predicted",
);
const AIR_DRAG: Parameter = parameter("air_drag", "0", "drag per mass α (1/s): a force −α m v");
const STIFFNESS_DAMPING: Parameter = parameter(
    "stiffness_damping",
    "0",
    "stiffness-proportional damping β (s): a force −β K v",
);
const LINEAR: Parameter = parameter(
    "linear",
    "multigrid",
    "multigrid: nothing is factorised, a step that iterates is a quasi-Newton method around it; newton-multigrid: \
     Newton's method with the clamped Hessian and conjugate gradients around multigrid; cholesky, \
     conjugate-gradients, chebyshev-jacobi, jacobi, gauss-seidel: Newton's method with that linear solver",
);
/// The linear solver of Newton's method around multigrid: `multigrid` alone is another method there.
const NEWTON_MULTIGRID: &str = "newton-multigrid";
const LINEAR_ONCE: Parameter = parameter(
    "linear",
    "multigrid",
    "linear solver: multigrid (preconditioned conjugate gradients), cholesky, conjugate-gradients, chebyshev-jacobi, \
     jacobi or gauss-seidel",
);
const LINEAR_TOLERANCE: Parameter = parameter(
    "linear_tolerance",
    "1e-3",
    "relative residual at which an iterative linear solver is done",
);
const LINEAR_TOLERANCE_ONCE: Parameter = parameter(
    "linear_tolerance",
    "1e-8",
    "relative residual at which an iterative linear solver is done",
);
const LINEAR_ITERATIONS: Parameter = parameter(
    "linear_iterations",
    "1000",
    "most iterations of an iterative linear solver",
);

/// Of the explicit integrators.
pub(super) const EXPLICIT: &[Parameter] = &[EXPLICIT_SUBSTEPS, AIR_DRAG, STIFFNESS_DAMPING];

/// Of those that iterate with Newton's method.
pub(super) const NEWTON: &[Parameter] = &[
    MAX_ITERATIONS,
    TOLERANCE,
    LINEAR,
    LINEAR_TOLERANCE,
    LINEAR_ITERATIONS,
    START,
    AIR_DRAG,
    STIFFNESS_DAMPING,
];

/// Of the linearised step.
pub(super) const LINEARIZED: &[Parameter] = &[
    LINEAR_ONCE,
    LINEAR_TOLERANCE_ONCE,
    LINEAR_ITERATIONS,
    AIR_DRAG,
    STIFFNESS_DAMPING,
];

/// Settings of the methods that iterate with Newton's method.
pub(super) fn newton(scene: &Scene, settings: &Settings) -> Result<ImplicitConfig, BenchError> {
    let linear_name = settings.text(&LINEAR);
    if linear_name != "multigrid" && (scene.can_touch() || !scene.volumes.is_empty()) {
        return Err(BenchError::Usage(format!(
            "linear={linear_name}: Newton's linear systems have no place for contact and bulk_modulus; linear=multigrid has"
        )));
    }
    let (solve, linear) = if linear_name == "multigrid" {
        refuse_budget(settings)?;
        (Solve::QuasiNewton, LinearMethod::Cholesky)
    } else {
        (
            Solve::Newton,
            linear(settings, &LINEAR, &LINEAR_TOLERANCE, NEWTON_MULTIGRID)?,
        )
    };
    // With the exact Hessian first, steps of few conjugate gradients can fail.
    let hessian = match linear_name {
        NEWTON_MULTIGRID => HessianPolicy::Always(Convexity::Clamp),
        _ => HessianPolicy::default(),
    };
    Ok(ImplicitConfig {
        solve,
        hessian,
        max_iterations: settings.count(&MAX_ITERATIONS, 1)?,
        tolerance: settings.number(&TOLERANCE)?,
        linear,
        start: settings.choice(
            &START,
            &[
                ("previous", StartGuess::Previous),
                ("inertial", StartGuess::Inertial),
                ("extrapolated", StartGuess::Extrapolated),
                ("predicted", StartGuess::Predicted),
            ],
        )?,
        damping: damping(settings)?,
        ..Default::default()
    })
}

pub(super) fn linearized(settings: &Settings) -> Result<ImplicitConfig, BenchError> {
    Ok(ImplicitConfig {
        linear: linear(settings, &LINEAR_ONCE, &LINEAR_TOLERANCE_ONCE, "multigrid")?,
        damping: damping(settings)?,
        ..ImplicitConfig::linearized()
    })
}

/// Refuses what only an iterative linear solver has.
fn refuse_budget(settings: &Settings) -> Result<(), BenchError> {
    for parameter in [&LINEAR_TOLERANCE, &LINEAR_ITERATIONS] {
        settings.refuse_without(parameter, "an iterative linear solver")?;
    }
    Ok(())
}

/// `multigrid`: what conjugate gradients around multigrid are called there.
fn linear(
    settings: &Settings,
    parameter: &Parameter,
    tolerance: &Parameter,
    multigrid: &'static str,
) -> Result<LinearMethod, BenchError> {
    if settings.text(parameter) == "cholesky" {
        refuse_budget(settings)?;
    }
    let budget = StoppingCriteria {
        tolerance: settings.number(tolerance)?,
        max_iterations: settings.count(&LINEAR_ITERATIONS, 1)?,
    };
    settings.choice(
        parameter,
        &[
            (multigrid, LinearMethod::Multigrid(budget)),
            ("cholesky", LinearMethod::Cholesky),
            (
                "conjugate-gradients",
                LinearMethod::ConjugateGradients(budget),
            ),
            ("chebyshev-jacobi", LinearMethod::ChebyshevJacobi(budget)),
            ("jacobi", LinearMethod::Jacobi(budget)),
            ("gauss-seidel", LinearMethod::GaussSeidel(budget)),
        ],
    )
}

pub(super) fn damping(settings: &Settings) -> Result<Damping, BenchError> {
    Ok(Damping {
        air_drag: settings.number(&AIR_DRAG)?,
        stiffness: settings.number(&STIFFNESS_DAMPING)?,
    })
}

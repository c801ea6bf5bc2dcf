//! Settings of the mass-spring integrators.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Auto, Choice, Or, Parameter, Range::*, Settings, Table};
use cloth_core::element::Convexity;
use cloth_core::math::Real;
use cloth_core::method::linear::{LinearMethod, StoppingCriteria};
use cloth_massspring::{Damping, HessianPolicy, ImplicitConfig, Solve, StartGuess};

/// A residual below this, relative to what it began with, is not resolved in double precision: the directions of
/// conjugate gradients vanish, and the matrix would be told for singular.
const ROUNDING: Real = 1e-16;

crate::settings! {
    /// Of the explicit integrators.
    pub(super) struct Explicit {
        substeps: Or<Auto, u32> = "auto" in AtLeast(1.0),
            "parts of a step; auto: as many as half the stable step of the start asks for";
    }
    /// Of those that iterate with Newton's method.
    pub(super) struct Newton {
        iterations: u32 = 4000 in AtLeast(1.0), "most iterations per step";
        tolerance: Real = 1e-3,
            "error of the velocity change at which a step is done, relative to it (estimated by the Newton decrement)";
        linear: Or<NewtonMultigrid, LinearSolver> = "multigrid",
            "multigrid: nothing is factorised, a step that iterates is a quasi-Newton method around it; \
             newton-multigrid: Newton's method with the clamped Hessian and conjugate gradients around multigrid; \
             cholesky, conjugate-gradients, chebyshev-jacobi, jacobi, gauss-seidel: Newton's method with that linear \
             solver";
        start: StartGuess = "extrapolated", "first guess: previous, inertial, extrapolated or predicted";
    }
    /// Of the linearised step.
    pub(super) struct Linearized {
        linear: LinearSolver = "multigrid",
            "linear solver: multigrid (preconditioned conjugate gradients), cholesky, conjugate-gradients, \
             chebyshev-jacobi, jacobi or gauss-seidel";
    }
    /// Of linear solvers that iterate.
    pub(super) struct Iterative {
        linear_tolerance: Real = 1e-3 in Between(ROUNDING, 1.0),
            "relative residual at which an iterative linear solver is done";
        linear_iterations: u32 = 1000 in AtLeast(1.0), "most iterations of an iterative linear solver";
    }
    /// Of all of them.
    pub(super) struct Damped {
        air_drag: Real = 0 "1/s", "drag per mass α: a force −α m v";
        stiffness_damping: Real = 0 "s", "stiffness-proportional damping β: a force −β K v";
    }
}

/// Of the explicit integrators, of those that iterate, and of the linearised step.
pub(super) const EXPLICIT: &[&[Parameter]] = &[Explicit::PARAMETERS, Damped::PARAMETERS];
pub(super) const NEWTON: &[&[Parameter]] = &[
    Newton::PARAMETERS,
    Iterative::PARAMETERS,
    Damped::PARAMETERS,
];
pub(super) const LINEARIZED: &[&[Parameter]] = &[
    Linearized::PARAMETERS,
    Iterative::PARAMETERS,
    Damped::PARAMETERS,
];

crate::choices! {
    /// Linear solvers by name.
    #[derive(PartialEq)]
    pub(super) enum LinearSolver {
        Multigrid = "multigrid",
        Cholesky = "cholesky",
        ConjugateGradients = "conjugate-gradients",
        ChebyshevJacobi = "chebyshev-jacobi",
        Jacobi = "jacobi",
        GaussSeidel = "gauss-seidel",
    }
    /// The linear solver of Newton's method around multigrid: `multigrid` alone is another method there.
    #[derive(PartialEq)]
    pub(super) enum NewtonMultigrid { Multigrid = "newton-multigrid" }
}

impl Choice for StartGuess {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("previous", Self::Previous),
        ("inertial", Self::Inertial),
        ("extrapolated", Self::Extrapolated),
        ("predicted", Self::Predicted),
    ];
}

/// Settings of the methods that iterate with Newton's method.
pub(super) fn newton(scene: &Scene, settings: &Settings) -> Result<ImplicitConfig, BenchError> {
    let own = Newton::read(settings)?;
    let is_quasi_newton = *own.linear == Or::Value(LinearSolver::Multigrid);
    if !is_quasi_newton && (scene.can_touch() || !scene.volumes.is_empty()) {
        return Err(own.linear.refuse(format!(
            "linear={}: Newton's linear systems have no place for contact and bulk_modulus; linear=multigrid has",
            settings.get(own.linear.name()).unwrap_or_default()
        )));
    }
    // With the exact Hessian first, steps of few conjugate gradients can fail.
    let (solver, hessian) = match *own.linear {
        Or::Word(_) => (
            LinearSolver::Multigrid,
            HessianPolicy::Always(Convexity::Clamp),
        ),
        Or::Value(solver) => (solver, HessianPolicy::default()),
    };
    let (solve, linear) = if is_quasi_newton {
        refuse_budget(&Iterative::read(settings)?)?;
        (Solve::QuasiNewton, LinearMethod::Cholesky)
    } else {
        (Solve::Newton, linear(solver, settings)?)
    };
    Ok(ImplicitConfig {
        solve,
        hessian,
        max_iterations: *own.iterations,
        tolerance: *own.tolerance,
        linear,
        start: *own.start,
        damping: damping(settings)?,
        ..Default::default()
    })
}

pub(super) fn linearized(settings: &Settings) -> Result<ImplicitConfig, BenchError> {
    Ok(ImplicitConfig {
        linear: linear(*Linearized::read(settings)?.linear, settings)?,
        damping: damping(settings)?,
        ..ImplicitConfig::linearized()
    })
}

/// Refuses what only an iterative linear solver has.
fn refuse_budget(budget: &Iterative) -> Result<(), BenchError> {
    let what = "an iterative linear solver";
    budget.linear_tolerance.refuse_without(what)?;
    budget.linear_iterations.refuse_without(what)
}

fn linear(solver: LinearSolver, settings: &Settings) -> Result<LinearMethod, BenchError> {
    let own = Iterative::read(settings)?;
    let budget = StoppingCriteria {
        tolerance: *own.linear_tolerance,
        max_iterations: *own.linear_iterations,
    };
    Ok(match solver {
        LinearSolver::Multigrid => LinearMethod::Multigrid(budget),
        LinearSolver::Cholesky => {
            refuse_budget(&own)?;
            LinearMethod::Cholesky
        }
        LinearSolver::ConjugateGradients => LinearMethod::ConjugateGradients(budget),
        LinearSolver::ChebyshevJacobi => LinearMethod::ChebyshevJacobi(budget),
        LinearSolver::Jacobi => LinearMethod::Jacobi(budget),
        LinearSolver::GaussSeidel => LinearMethod::GaussSeidel(budget),
    })
}

pub(super) fn damping(settings: &Settings) -> Result<Damping, BenchError> {
    let damped = Damped::read(settings)?;
    Ok(Damping {
        air_drag: *damped.air_drag,
        stiffness: *damped.stiffness_damping,
    })
}

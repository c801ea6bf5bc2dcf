//! Newton's method: the loop.
//!
//! 1. Done if `‖∇G‖ ≤ tolerance · ‖M(x − x̂)/s²‖` in the norm of M⁻¹, or if `‖∇G‖` is within rounding. Where
//!    [`Accept::Minimum`] finds a saddle, it is left along a direction of negative curvature in place of 3.
//! 2. The matrix A, factorised with as much of the exact Hessian as leaves it positive definite (`system`).
//! 3. `p = −A⁻¹∇G`. An iterative solver that meets negative curvature goes back to 2, with less of the exact Hessian.
//! 4. `x ← x + t p`, with t = 1 or the first shorter one that the line search accepts (`line_search`). If it accepts
//!    none, that is the end where the gradient is at most 100 times the rounding error or the decrement of 5 is small
//!    enough. Else the indefinite part is dropped as a whole, and 1 to 4 are repeated; if it was dropped already, the
//!    step ends with [`StepError::LineSearchStalled`].
//! 5. Done if the Newton decrement `√(−∇G·p)` before this step was at most `tolerance · ‖x − x̂‖_M/s` (a minimum that
//!    is asked for is checked by 1). The step has been taken: where convergence is quadratic, x is better than that.
//!
//! After `max_iterations` the point so far is the result, with `Outcome::BudgetSpent`.

use super::line_search;
use super::minimizer::{Minimizer, ROUNDING_FACTOR, Task};
use super::system::NewtonSystem;
use crate::config::Accept;
use cloth_core::math::Real;
use cloth_core::method::vectors::dot;
use cloth_core::step::{Observer, Outcome, StepError, StepReport};

/// Newton's method to the tolerance, from the evaluated current point of `points`.
pub(super) fn iterate(
    points: &mut Minimizer,
    task: &Task<'_>,
    mut observer: Option<&mut dyn Observer>,
    report: &mut StepReport,
) -> Result<(), StepError> {
    with_system(points, |points, system| {
        let stage = &task.stage;
        // Not known before a matrix has been assembled.
        let mut rounding = 0.0;
        loop {
            let norm = points.gradient_norm(task)?;
            report.residual = Some(points.residual(norm, rounding));
            let small = norm <= points.small_enough(task, rounding);
            if small && is_accepted(points, system, task, report) {
                return Ok(());
            }
            if report.iterations >= task.config.max_iterations {
                report.outcome = Outcome::BudgetSpent;
                return Ok(());
            }
            system.assemble(stage, &points.current.positions);
            rounding = stage.rounding(system.matrix(), &points.current.positions);
            report.residual = Some(points.residual(norm, rounding));
            if !small && norm <= rounding && is_accepted(points, system, task, report) {
                return Ok(());
            }
            report.iterations += 1;
            factorize(points, system, task, report)?;
            let (moved, decrement) = if norm <= points.small_enough(task, rounding) {
                (leave_saddle(points, system, task), Real::INFINITY)
            } else {
                descend(points, system, task, report)?
            };
            let is_close = decrement <= points.close_enough(task, task.config.tolerance);
            if is_close {
                report.residual = Some(points.relative(task, decrement));
            }
            if !moved {
                if norm <= ROUNDING_FACTOR * rounding || is_close {
                    return Ok(());
                }
                if system.clamp_fully() {
                    continue;
                }
                return Err(StepError::LineSearchStalled {
                    iteration: report.iterations,
                    residual: points.residual(norm, rounding),
                    step: task.step,
                });
            }
            std::mem::swap(&mut points.current, &mut points.next);
            if let Some(observer) = observer.as_deref_mut() {
                observer.iteration(report.iterations, &points.current.positions);
            }
            if is_close && task.config.accept == Accept::Stationary {
                return Ok(());
            }
        }
    })
}

/// One full Newton step and nothing else. From where the cloth was, prescribed vertices are there too: that they move
/// is a part of the step, `H Δx` in the gradient, so that a cloth that moves along with them is not strained.
pub(super) fn solve_once(
    points: &mut Minimizer,
    task: &Task<'_>,
    report: &mut StepReport,
) -> Result<(), StepError> {
    with_system(points, |points, system| {
        let stage = &task.stage;
        report.iterations = 1;
        let are_back = points.put_pins_back(task);
        stage.gradient_into(&points.current.positions, &mut points.current.gradient);
        points.current.value = 0.0;
        points.gradient_norm(task)?;
        system.restore_momentum(stage, &mut points.current);
        system.assemble(stage, &points.current.positions);
        factorize(points, system, task, report)?;
        if are_back {
            points.add_pull_of_pins(system.matrix());
        }
        solve(points, system, task, report)?;
        for (x, p) in points.current.positions.iter_mut().zip(&points.direction) {
            *x += p;
        }
        if are_back {
            points.put_pins_on();
        }
        // What an iterative solver left of it.
        system.restore_momentum(stage, &mut points.current);
        Ok(())
    })
}

/// Makes the matrix of the current point.
pub(super) fn prepare(
    points: &Minimizer,
    system: &mut NewtonSystem,
    task: &Task<'_>,
    report: &mut StepReport,
) -> Result<(), StepError> {
    system.reset();
    system.assemble(&task.stage, &points.current.positions);
    factorize(points, system, task, report)
}

/// Lends the system out of the minimizer, which has one.
fn with_system(
    points: &mut Minimizer,
    work: impl FnOnce(&mut Minimizer, &mut NewtonSystem) -> Result<(), StepError>,
) -> Result<(), StepError> {
    let mut system = points.newton.take().expect("built before it is used");
    system.reset();
    let result = work(points, &mut system);
    points.newton = Some(system);
    result
}

fn factorize(
    points: &Minimizer,
    system: &mut NewtonSystem,
    task: &Task<'_>,
    report: &mut StepReport,
) -> Result<(), StepError> {
    match system.factorize(&task.stage, &points.current.positions) {
        Ok(attempts) => {
            report.factorizations += attempts;
            Ok(())
        }
        Err(_) => Err(StepError::NotPositiveDefinite {
            iteration: report.iterations,
            step: task.step,
        }),
    }
}

/// The Newton direction. An iterative solver may find the matrix indefinite only here.
fn solve(
    points: &mut Minimizer,
    system: &mut NewtonSystem,
    task: &Task<'_>,
    report: &mut StepReport,
) -> Result<(), StepError> {
    let indefinite = |report: &StepReport| StepError::NotPositiveDefinite {
        iteration: report.iterations,
        step: task.step,
    };
    loop {
        report.linear_solves += 1;
        let (gradient, x) = (&points.current.gradient, &points.current.positions);
        if let Ok(done) = system.solve(gradient, &mut points.direction) {
            report.linear_iterations += done.iterations;
            return Ok(());
        }
        let attempts = system.reduce_blend(&task.stage, x);
        report.factorizations += attempts.map_err(|_| indefinite(report))?;
    }
}

/// One Newton step into `next`. Returns whether it leads down, and the Newton decrement (√J) before it.
fn descend(
    points: &mut Minimizer,
    system: &mut NewtonSystem,
    task: &Task<'_>,
    report: &mut StepReport,
) -> Result<(bool, Real), StepError> {
    solve(points, system, task, report)?;
    let (from, to) = (&points.current, &mut points.next);
    let slope = dot(&from.gradient, &points.direction);
    let found = line_search::search(&task.stage, from, &points.direction, slope, 1.0, to);
    report.backtracks += found.backtracks;
    Ok((found.accepted, (-slope).max(0.0).sqrt()))
}

/// Whether a point where the gradient is small is good enough to stop.
fn is_accepted(
    points: &Minimizer,
    system: &mut NewtonSystem,
    task: &Task<'_>,
    report: &mut StepReport,
) -> bool {
    // If the last factor was exact, the Newton step that led here was from the valley of a minimum.
    if task.config.accept == Accept::Stationary || system.is_exact() {
        return true;
    }
    report.factorizations += 1;
    system.factorize_exact(&task.stage, &points.current.positions)
}

/// Goes down from a saddle point, into `next`, where the gradient vanishes. Returns whether there is a way down.
fn leave_saddle(points: &mut Minimizer, system: &mut NewtonSystem, task: &Task<'_>) -> bool {
    let (x, product) = (&points.current.positions, &mut points.next.gradient);
    let direction = &mut points.direction;
    let found: Option<Real> = system.negative_curvature(&task.stage, x, direction, product);
    found.is_some_and(|curvature| {
        let (from, to) = (&points.current, &mut points.next);
        line_search::leave_saddle(&task.stage, from, direction, curvature, to)
    })
}

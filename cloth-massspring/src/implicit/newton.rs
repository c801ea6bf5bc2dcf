//! Newton's method, S1 (11)–(15): the loop.

use super::line_search::{self, Point};
use super::stage::Stage;
use super::system::NewtonSystem;
use crate::config::{Accept, ImplicitConfig, Solve};
use cloth_core::math::{Real, Vec3};
use cloth_core::step::{Observer, Outcome, StepError, StepReport};

/// Where no lower point is found, the gradient counts as lost in rounding up to this multiple of the estimate of
/// [`NewtonSystem::rounding`]; above, it is an error.
const STALL: Real = 100.0;

/// Newton's method with everything it needs between two calls.
#[derive(Debug)]
pub(super) struct Newton {
    system: NewtonSystem,
    direction: Vec<Vec3>,
    pub(super) current: Point,
    next: Point,
    /// Norm of the gradient at the prediction (N/√kg).
    reference: Real,
}

/// What stays the same during one minimisation.
#[derive(Debug)]
pub(super) struct Task<'a> {
    pub(super) stage: Stage<'a>,
    pub(super) config: &'a ImplicitConfig,
    /// The step, counted from 1.
    pub(super) step: u64,
}

impl Newton {
    pub(super) fn new(system: NewtonSystem, vertex_count: usize) -> Self {
        Self {
            system,
            direction: vec![Vec3::zeros(); vertex_count],
            current: Point::new(vertex_count),
            next: Point::new(vertex_count),
            reference: 0.0,
        }
    }

    /// Minimises the function of a stage, starting at `self.current.positions` and ending there; or takes one step of it only.
    pub(super) fn minimize(
        &mut self,
        task: &Task<'_>,
        observer: Option<&mut dyn Observer>,
    ) -> Result<StepReport, StepError> {
        self.system.reset();
        match task.config.solve {
            Solve::Newton => self.iterate(task, observer),
            Solve::Linearized => self.solve_once(task, observer),
        }
    }

    /// One full Newton step and nothing else.
    fn solve_once(
        &mut self,
        task: &Task<'_>,
        observer: Option<&mut dyn Observer>,
    ) -> Result<StepReport, StepError> {
        let mut report = StepReport::new(Outcome::Converged, 1);
        let stage = &task.stage;
        stage.gradient_into(&self.current.positions, &mut self.current.gradient);
        self.current.value = 0.0;
        self.gradient_norm(task)?;
        self.system.assemble(stage, &self.current.positions);
        self.factorize(task, &mut report)?;
        self.solve(task, &mut report)?;
        for (x, p) in self.current.positions.iter_mut().zip(&self.direction) {
            *x += p;
        }
        if let Some(observer) = observer {
            observer.iteration(1, &self.current.positions);
        }
        Ok(report)
    }

    /// Newton's method to the tolerance.
    fn iterate(
        &mut self,
        task: &Task<'_>,
        mut observer: Option<&mut dyn Observer>,
    ) -> Result<StepReport, StepError> {
        let stage = &task.stage;
        let mut report = StepReport::new(Outcome::Converged, 0);
        // Not known before a matrix has been assembled.
        let mut rounding = 0.0;
        // The place of the gradient is free until the iteration starts.
        stage.gradient_into(stage.potential.predicted, &mut self.current.gradient);
        self.reference = stage.gradient_norm(&self.current.gradient);
        self.current.evaluate(stage);
        loop {
            let norm = self.gradient_norm(task)?;
            report.residual = Some(self.residual(norm, rounding));
            let small = norm <= self.small_enough(task, rounding);
            if small && self.is_accepted(task, &mut report) {
                return Ok(report);
            }
            if report.iterations == task.config.max_iterations {
                report.outcome = Outcome::BudgetSpent;
                return Ok(report);
            }
            self.system.assemble(stage, &self.current.positions);
            rounding = self.system.rounding(stage, &self.current.positions);
            report.residual = Some(self.residual(norm, rounding));
            if !small && norm <= rounding && self.is_accepted(task, &mut report) {
                return Ok(report);
            }
            report.iterations += 1;
            self.factorize(task, &mut report)?;
            let moved = if norm <= self.small_enough(task, rounding) {
                self.leave_saddle(task)
            } else {
                self.descend(task, &mut report)?
            };
            if !moved {
                if norm <= STALL * rounding {
                    return Ok(report);
                }
                if self.system.fall_back() {
                    continue;
                }
                return Err(StepError::LineSearchStalled {
                    iteration: report.iterations,
                    residual: self.residual(norm, rounding),
                    step: task.step,
                });
            }
            std::mem::swap(&mut self.current, &mut self.next);
            if let Some(observer) = observer.as_deref_mut() {
                observer.iteration(report.iterations, &self.current.positions);
            }
        }
    }

    fn gradient_norm(&self, task: &Task<'_>) -> Result<Real, StepError> {
        let norm = task.stage.gradient_norm(&self.current.gradient);
        if norm.is_finite() && self.current.value.is_finite() {
            return Ok(norm);
        }
        let bad = |v| !cloth_core::math::is_finite(v);
        let vertex = self.current.gradient.iter().position(bad).unwrap_or(0);
        Err(StepError::NonFinite {
            vertex,
            step: task.step,
        })
    }

    fn factorize(&mut self, task: &Task<'_>, report: &mut StepReport) -> Result<(), StepError> {
        let x = &self.current.positions;
        match self.system.factorize(&task.stage, x) {
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
    fn solve(&mut self, task: &Task<'_>, report: &mut StepReport) -> Result<(), StepError> {
        let indefinite = |report: &StepReport| StepError::NotPositiveDefinite {
            iteration: report.iterations,
            step: task.step,
        };
        loop {
            report.linear_solves += 1;
            let (gradient, x) = (&self.current.gradient, &self.current.positions);
            if let Ok(done) = self.system.solve(gradient, &mut self.direction) {
                report.linear_iterations += done.iterations;
                return Ok(());
            }
            let attempts = self.system.retreat(&task.stage, x);
            report.factorizations += attempts.map_err(|_| indefinite(report))?;
        }
    }

    /// One Newton step, S1 (14), into `next`. Returns whether it leads down.
    fn descend(&mut self, task: &Task<'_>, report: &mut StepReport) -> Result<bool, StepError> {
        self.solve(task, report)?;
        let found =
            line_search::search(&task.stage, &self.current, &self.direction, &mut self.next);
        report.backtracks += found.backtracks;
        Ok(found.accepted)
    }

    /// Whether a point where the gradient is small is good enough to stop.
    fn is_accepted(&mut self, task: &Task<'_>, report: &mut StepReport) -> bool {
        // If the last factor was exact, the Newton step that led here was from the valley of a minimum.
        if task.config.accept == Accept::Stationary || self.system.is_exact() {
            return true;
        }
        report.factorizations += 1;
        self.system
            .factorize_exact(&task.stage, &self.current.positions)
    }

    /// Goes down from a saddle point, into `next`, where a gradient shows no way. Returns whether there is one.
    fn leave_saddle(&mut self, task: &Task<'_>) -> bool {
        let (x, product) = (&self.current.positions, &mut self.next.gradient);
        let direction = &mut self.direction;
        match self
            .system
            .negative_curvature(&task.stage, x, direction, product)
        {
            Some(curvature) => line_search::leave_saddle(
                &task.stage,
                &self.current,
                direction,
                curvature,
                &mut self.next,
            ),
            None => false,
        }
    }

    /// Gradient norm (N/√kg) at which the iteration ends.
    fn small_enough(&self, task: &Task<'_>, rounding: Real) -> Real {
        (task.config.tolerance * self.reference).max(rounding)
    }

    /// Gradient norm relative to that at the prediction. In free fall the latter is zero and only rounding is left to compare with.
    fn residual(&self, norm: Real, rounding: Real) -> Real {
        if norm > 0.0 {
            norm / self.reference.max(rounding)
        } else {
            0.0
        }
    }
}

//! Newton's method, S1 (11)–(15): the loop.

use super::line_search::{self, Point};
use super::system::NewtonSystem;
use crate::config::{Accept, ImplicitConfig};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::IncrementalPotential;
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
}

/// What stays the same during one minimisation.
#[derive(Debug)]
pub(super) struct Task<'a> {
    pub(super) potential: IncrementalPotential<'a>,
    pub(super) config: &'a ImplicitConfig,
    /// `‖∇G(x̃)‖` (N/√kg).
    pub(super) reference: Real,
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
        }
    }

    /// Minimises `G`, starting at `self.current.positions` and ending there.
    pub(super) fn minimize(
        &mut self,
        task: &Task<'_>,
        mut observer: Option<&mut dyn Observer>,
    ) -> Result<StepReport, StepError> {
        let potential = &task.potential;
        let mut report = StepReport::new(Outcome::Converged, 0);
        // Not known before a matrix has been assembled.
        let mut rounding = 0.0;
        self.system.reset();
        self.current.evaluate(potential);
        loop {
            let norm = self.gradient_norm(task)?;
            report.residual = Some(task.residual(norm, rounding));
            let small = norm <= task.small_enough(rounding);
            if small && self.is_accepted(task, &mut report) {
                return Ok(report);
            }
            if report.iterations == task.config.max_iterations {
                report.outcome = Outcome::BudgetSpent;
                return Ok(report);
            }
            self.system.assemble(potential, &self.current.positions);
            rounding = self.system.rounding(potential, &self.current.positions);
            report.residual = Some(task.residual(norm, rounding));
            if !small && norm <= rounding && self.is_accepted(task, &mut report) {
                return Ok(report);
            }
            report.iterations += 1;
            self.factorize(task, &mut report)?;
            let moved = if norm <= task.small_enough(rounding) {
                self.leave_saddle(task)
            } else {
                self.descend(task, &mut report)
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
                    residual: task.residual(norm, rounding),
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
        let norm = task.potential.gradient_norm(&self.current.gradient);
        if norm.is_finite() && self.current.value.is_finite() {
            return Ok(norm);
        }
        let bad = |v: &Vec3| !v.iter().all(|c| c.is_finite());
        let vertex = self.current.gradient.iter().position(bad).unwrap_or(0);
        Err(StepError::NonFinite {
            vertex,
            step: task.step,
        })
    }

    fn factorize(&mut self, task: &Task<'_>, report: &mut StepReport) -> Result<(), StepError> {
        let x = &self.current.positions;
        match self.system.factorize(&task.potential, x) {
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

    /// One Newton step, S1 (14), into `next`. Returns whether it leads down.
    fn descend(&mut self, task: &Task<'_>, report: &mut StepReport) -> bool {
        self.system
            .solve(&self.current.gradient, &mut self.direction);
        report.linear_solves += 1;
        let found = line_search::search(
            &task.potential,
            &self.current,
            &self.direction,
            &mut self.next,
        );
        report.backtracks += found.backtracks;
        found.accepted
    }

    /// Whether a point where the gradient is small is good enough to stop.
    fn is_accepted(&mut self, task: &Task<'_>, report: &mut StepReport) -> bool {
        // If the last factor was exact, the Newton step that led here was from the valley of a minimum.
        if task.config.accept == Accept::Stationary || self.system.is_exact() {
            return true;
        }
        report.factorizations += 1;
        self.system
            .factorize_exact(&task.potential, &self.current.positions)
    }

    /// Goes down from a saddle point, into `next`, where a gradient shows no way. Returns whether there is one.
    fn leave_saddle(&mut self, task: &Task<'_>) -> bool {
        let (x, product) = (&self.current.positions, &mut self.next.gradient);
        let direction = &mut self.direction;
        match self
            .system
            .negative_curvature(&task.potential, x, direction, product)
        {
            Some(curvature) => line_search::leave_saddle(
                &task.potential,
                &self.current,
                direction,
                curvature,
                &mut self.next,
            ),
            None => false,
        }
    }
}

impl Task<'_> {
    /// Gradient norm (N/√kg) at which the iteration ends.
    fn small_enough(&self, rounding: Real) -> Real {
        (self.config.tolerance * self.reference).max(rounding)
    }

    /// Gradient norm relative to that at x̃. In free fall the latter is zero and only rounding is left to compare with.
    fn residual(&self, norm: Real, rounding: Real) -> Real {
        if norm > 0.0 {
            norm / self.reference.max(rounding)
        } else {
            0.0
        }
    }
}

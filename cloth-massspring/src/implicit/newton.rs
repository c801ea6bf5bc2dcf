//! Newton's method, S1 (11)–(15).

use super::line_search::{self, Point};
use crate::config::{HessianPolicy, ImplicitConfig};
use cloth_core::block_matrix::BlockMatrix;
use cloth_core::element::Convexity;
use cloth_core::linear::BlockCholesky;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::IncrementalPotential;
use cloth_core::step::{Observer, Outcome, StepError, StepReport};

/// A gradient that a line search cannot lower any more counts as lost in rounding up to this multiple of the
/// estimate [`Newton::rounding`]; above, the stall is an error.
const STALL: Real = 1e3;

/// Newton's method with everything it needs between two calls.
#[derive(Debug)]
pub(super) struct Newton {
    matrix: BlockMatrix,
    cholesky: BlockCholesky,
    direction: Vec<Vec3>,
    pub(super) current: Point,
    next: Point,
    /// Gradient norm (N/√kg) that rounding of the positions makes, where the matrix was last assembled.
    rounding: Real,
}

/// What stays the same during one minimisation.
pub(super) struct Task<'a> {
    pub(super) potential: IncrementalPotential<'a>,
    pub(super) config: &'a ImplicitConfig,
    /// `‖∇G(x̃)‖` (N/√kg).
    pub(super) reference: Real,
    /// The step, counted from 1.
    pub(super) step: u64,
}

impl Newton {
    pub(super) fn new(matrix: BlockMatrix, cholesky: BlockCholesky) -> Self {
        let vertex_count = matrix.pattern().row_count();
        Self {
            matrix,
            cholesky,
            direction: vec![Vec3::zeros(); vertex_count],
            current: Point::new(vertex_count),
            next: Point::new(vertex_count),
            rounding: 0.0,
        }
    }

    /// Minimises `G`, starting at `self.current.positions` and ending there.
    pub(super) fn minimize(
        &mut self,
        task: &Task<'_>,
        mut observer: Option<&mut dyn Observer>,
    ) -> Result<StepReport, StepError> {
        let mut report = StepReport::new(Outcome::Converged, 0);
        self.rounding = 0.0;
        self.current.evaluate(&task.potential);
        loop {
            let norm = task.potential.gradient_norm(&self.current.gradient);
            if !(norm.is_finite() && self.current.value.is_finite()) {
                return Err(self.non_finite(task.step));
            }
            let relative = |rounding: Real| match norm / task.reference.max(rounding) {
                ratio if norm > 0.0 => ratio,
                _ => 0.0,
            };
            report.residual = Some(relative(self.rounding));
            if norm <= (task.config.tolerance * task.reference).max(self.rounding) {
                return Ok(report);
            }
            if report.iterations == task.config.max_iterations {
                report.outcome = Outcome::BudgetSpent;
                return Ok(report);
            }
            report.iterations += 1;
            let mut exact = task.config.hessian == HessianPolicy::ExactFirst;
            self.assemble(task, if exact { Convexity::Exact } else { fixed(task) });
            self.rounding = self.estimate_rounding(task);
            if norm <= self.rounding {
                report.iterations -= 1;
                report.residual = Some(relative(self.rounding));
                return Ok(report);
            }
            report.factorizations += 1;
            let mut factored = self.cholesky.factorize(&self.matrix).is_ok();
            if !factored && exact {
                exact = false;
                self.assemble(task, Convexity::Clamp);
                report.factorizations += 1;
                factored = self.cholesky.factorize(&self.matrix).is_ok();
            }
            let _ = exact;
            if !factored {
                return Err(StepError::NotPositiveDefinite {
                    iteration: report.iterations,
                    step: task.step,
                });
            }
            self.cholesky
                .solve(&self.current.gradient, &mut self.direction);
            self.direction.iter_mut().for_each(|p| *p = -*p);
            report.linear_solves += 1;
            let found = line_search::search(
                &task.potential,
                &self.current,
                &self.direction,
                &mut self.next,
            );
            report.backtracks += found.backtracks;
            if std::env::var("NEWTON").is_ok() {
                eprintln!(
                    "  it {} exact {exact} backtracks {} norm {:.3e} rel {:.3e} floor {:.3e} value {:.6e}",
                    report.iterations,
                    found.backtracks,
                    norm,
                    norm / task.reference,
                    self.rounding,
                    self.current.value
                );
            }
            if !found.accepted {
                if norm <= STALL * self.rounding {
                    return Ok(report);
                }
                return Err(StepError::LineSearchStalled {
                    iteration: report.iterations,
                    residual: relative(self.rounding),
                    step: task.step,
                });
            }
            std::mem::swap(&mut self.current, &mut self.next);
            if let Some(observer) = observer.as_deref_mut() {
                observer.iteration(report.iterations, &self.current.positions);
            }
        }
    }

    /// `M/Δt² + H`, the matrix of S1 (15).
    fn assemble(&mut self, task: &Task<'_>, convexity: Convexity) {
        let potential = &task.potential;
        self.matrix.clear();
        let scale = 1.0 / (potential.dt * potential.dt);
        let inertia = potential.particles.mass().iter().map(|m| m * scale);
        self.matrix.add_diagonal(inertia);
        potential
            .energies
            .add_hessian(&self.current.positions, 1.0, convexity, &mut self.matrix);
    }

    /// Norm (N/√kg) of the gradient that the rounding of the positions alone can make: half a unit in the last place
    /// of the largest coordinate, times the diagonal of the matrix.
    fn estimate_rounding(&self, task: &Task<'_>) -> Real {
        let pattern = self.matrix.pattern();
        let mut sum = 0.0;
        let mut largest: Real = 0.0;
        for (vertex, w) in task.potential.particles.inverse_mass().iter().enumerate() {
            let diagonal = &self.matrix.blocks()[pattern.row(vertex).end - 1];
            sum += w * diagonal.norm_squared();
            largest = largest.max(self.current.positions[vertex].amax());
        }
        Real::EPSILON * largest * sum.sqrt()
    }

    fn non_finite(&self, step: u64) -> StepError {
        let bad = |v: &Vec3| !v.iter().all(|c| c.is_finite());
        let vertex = self.current.gradient.iter().position(bad).unwrap_or(0);
        StepError::NonFinite { vertex, step }
    }
}

fn fixed(task: &Task<'_>) -> Convexity {
    match task.config.hessian {
        HessianPolicy::ExactFirst => Convexity::Exact,
        HessianPolicy::Always(convexity) => convexity,
    }
}

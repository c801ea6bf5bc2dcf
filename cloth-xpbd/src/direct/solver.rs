//! The solver: iterations of the linear system, substeps around them.

use super::builder::DirectBuilder;
use super::config::{DirectConfig, DirectStart};
use super::contact;
use super::kkt::{Kkt, KktVector};
use super::linear::Solver;
use super::merit::Merit;
use super::readout::Residuals;
use super::rows::{RowFamily, Rows};
use crate::update::XpbdUpdate;
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::measure::predict;
use cloth_core::method::linear::CholeskyError;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};

/// The step of XPBD as one system; see the [module documentation](super).
#[derive(Debug)]
pub struct DirectXpbd {
    pub(super) particles: Particles,
    /// Masses (kg), 0 for prescribed vertices.
    pub(super) mass: Vec<Real>,
    pub(super) config: DirectConfig,
    pub(super) families: Vec<Box<dyn RowFamily>>,
    /// As last evaluated. With damping, `value` is less by what a damped row keeps of C⁰.
    pub(super) rows: Rows,
    pub(super) kkt: Kkt,
    pub(super) solver: Solver,
    pub(super) merit: Merit,
    /// `β/(h + β) C⁰` of each row (unit of C), subtracted from its value: damping.
    pub(super) start_value: Vec<Real>,
    /// λ of each row (kg m² per unit of C).
    pub(super) multipliers: Vec<Real>,
    pub(super) trial_multipliers: Vec<Real>,
    /// α̃ of each row; infinite where no multiplier could change it.
    pub(super) scaled_compliance: Vec<Real>,
    pub(super) right: KktVector,
    pub(super) change: KktVector,
    pub(super) correction: KktVector,
    /// x̃, x, Δx, and a place to try (m), one per vertex.
    pub(super) predicted: Vec<Vec3>,
    pub(super) positions: Vec<Vec3>,
    pub(super) direction: Vec<Vec3>,
    pub(super) trial: Vec<Vec3>,
    /// Where the substep begins.
    pub(super) current: State,
    /// With the size of the last step, if it succeeded.
    pub(super) last: Option<XpbdUpdate>,
    pub(super) residuals: Residuals,
}

impl Stepper for DirectXpbd {
    fn name(&self) -> &'static str {
        "xpbd-direct"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.particles.len())?;
        let asks_pin_forces = input.begin_pin_forces(self.particles.len());
        let written = self.substeps(state, &mut input);
        if written.is_err() {
            // A failed step must not warm-start the next one.
            self.last = None;
            self.multipliers.fill(0.0);
        }
        Ok(StepReport {
            tells_pin_forces: asks_pin_forces,
            ..written?
        })
    }
}

impl DirectXpbd {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without constraints.
    #[must_use]
    pub fn builder(particles: &Particles) -> DirectBuilder {
        DirectBuilder::new(particles)
    }

    /// The settings.
    #[must_use]
    pub fn config(&self) -> &DirectConfig {
        &self.config
    }

    /// The whole step; `state` is written when all of it is taken.
    fn substeps(
        &mut self,
        state: &mut State,
        input: &mut StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        let (dt, step) = (input.dt, state.steps + 1);
        if let Some(air) = &mut input.air {
            air.restart();
        }
        contact::begin_step(input, self.particles.inverse_mass(), state)?;
        let mut current = std::mem::take(&mut self.current);
        current.positions.copy_from_slice(&state.positions);
        current.velocities.copy_from_slice(&state.velocities);
        current.steps = state.steps;
        let mut sum = StepReport {
            pin_work: Some(0.0),
            ..StepReport::new(Outcome::Converged, 0)
        };
        input.dt = dt / Real::from(self.config.substeps);
        let taken = (1..=self.config.substeps).try_for_each(|substep| {
            current.time = state.time + Real::from(substep - 1) * input.dt;
            self.substep(&mut current, input, &mut sum)
        });
        input.dt = dt;
        let ended = taken.map(|()| {
            if let Some(contacts) = input.contact_constraints() {
                contacts.end_step(&current.positions);
            }
            state.positions.copy_from_slice(&current.positions);
            state.velocities.copy_from_slice(&current.velocities);
            state.time += dt;
            state.steps = step;
            sum
        });
        self.current = current;
        ended
    }

    /// One substep: the system, then the drag of the air and contact, then the velocities.
    fn substep(
        &mut self,
        current: &mut State,
        input: &mut StepInput<'_>,
        sum: &mut StepReport,
    ) -> Result<(), StepError> {
        let w = self.particles.inverse_mass();
        if let Some(air) = &mut input.air {
            air.linearize(&current.positions, &current.velocities);
            air.begin_projection(w, input.dt);
        }
        let report = self.iterate(current, input, sum.iterations)?;
        let work = sum.pin_work.unwrap_or(0.0) + self.pin_work(current, input);
        let converged = sum.outcome == Outcome::Converged;
        *sum = StepReport {
            outcome: if converged {
                report.outcome
            } else {
                sum.outcome
            },
            iterations: sum.iterations + report.iterations,
            factorizations: sum.factorizations + report.factorizations,
            linear_solves: sum.linear_solves + report.linear_solves,
            linear_iterations: sum.linear_iterations + report.linear_iterations,
            backtracks: sum.backtracks + report.backtracks,
            pin_work: Some(work),
            ..report
        };
        let w = self.particles.inverse_mass();
        if let Some(air) = &mut input.air {
            air.project(&mut self.positions);
        }
        contact::project(input, w, current, &mut self.positions)?;
        // v ← v + h a + (x − x̃)/h
        for (v, velocity) in current.velocities.iter_mut().enumerate() {
            let a = input.external_acceleration(v, w[v]);
            let change = (self.positions[v] - self.predicted[v]) / input.dt;
            *velocity = *velocity + a * input.dt + change;
        }
        if let Some(air) = &mut input.air {
            air.end(&self.positions, &current.velocities, w);
        }
        if let Some(contacts) = input.contact_constraints() {
            contacts.change_velocities(&mut current.velocities);
        }
        current.positions.copy_from_slice(&self.positions);
        Ok(())
    }

    /// Solves one substep; `before` iterations were made in the substeps before it.
    fn iterate(
        &mut self,
        state: &State,
        input: &mut StepInput<'_>,
        before: u32,
    ) -> Result<StepReport, StepError> {
        let step = state.steps + 1;
        let update = XpbdUpdate::new(input.dt, self.config.damping);
        let unknown =
            self.config.warm_start && self.config.geometric_stiffness && self.last.is_none();
        self.begin(state, input, update);
        // A row whose stiffness is NaN would be left out.
        if let Some(row) = self.rows.stiffness.iter().position(|k| k.is_nan()) {
            let vertex = self.rows.vertices[self.rows.entries(row).start] as usize;
            return Err(StepError::NonFinite { vertex, step });
        }
        let size = extent(&state.positions);
        let mut report = StepReport::new(Outcome::BudgetSpent, 0);
        for iteration in 1..=self.config.max_iterations {
            report.iterations = iteration;
            self.assemble(update);
            if iteration == 1 && unknown {
                self.initial_multipliers()
                    .map_err(|_| StepError::NotPositiveDefinite { iteration, step })?;
                self.assemble(update);
            }
            self.solver
                .prepare(&self.kkt)
                .map_err(|_| StepError::NotPositiveDefinite { iteration, step })?;
            if self.solver.solve(&self.kkt, &self.right, &mut self.change) {
                self.remove_undetermined();
            }
            let scaled = self.change.x.iter().zip(&self.kkt.vertex_scale);
            for (direction, (x, scale)) in self.direction.iter_mut().zip(scaled) {
                *direction = x * *scale;
            }
            if let Some(vertex) = self.direction.iter().position(|d| !is_finite(d)) {
                return Err(StepError::NonFinite { vertex, step });
            }
            let moved = self.direction.iter().map(Vec3::amax).fold(0.0, Real::max);
            // Where nothing moves any more, two values of the merit differ by rounding only.
            let done = moved <= self.config.tolerance * size;
            if done || !self.config.line_search {
                self.try_length(1.0);
                self.accept();
            } else {
                self.line_search(size, &mut report)
                    .ok_or(StepError::LineSearchStalled {
                        iteration,
                        residual: moved / size,
                        step,
                    })?;
            }
            if let Some(observer) = &mut input.observer {
                observer.iteration(before + iteration, &self.positions);
            }
            if done && !self.activate() {
                report.outcome = Outcome::Converged;
                break;
            }
        }
        // The velocity is a quotient of positions, and may overflow where they do not.
        let velocity = |v: usize| (self.positions[v] - self.predicted[v]) / input.dt;
        if let Some(vertex) = (0..self.positions.len())
            .find(|&v| !is_finite(&self.positions[v]) || !is_finite(&velocity(v)))
        {
            return Err(StepError::NonFinite { vertex, step });
        }
        self.finish(update, &mut report);
        Ok(report)
    }

    /// x̃, where to start, and λ to start from.
    fn begin(&mut self, state: &State, input: &StepInput<'_>, update: XpbdUpdate) {
        predict(&self.particles, state, input, &mut self.predicted);
        self.start_value.fill(0.0);
        if self.config.damping > 0.0 {
            self.families
                .iter_mut()
                .for_each(|f| f.set_time(state.time));
            self.evaluate_at(&state.positions);
            for (row, start) in self.start_value.iter_mut().enumerate() {
                let update = update.for_row(self.rows.is_limit[row]);
                *start = update.damped_fraction(self.rows.stiffness[row]) * self.rows.value[row];
            }
        }
        let end = state.time + input.dt;
        self.families.iter_mut().for_each(|f| f.set_time(end));
        for (v, x) in self.positions.iter_mut().enumerate() {
            let free = !self.particles.is_prescribed(v);
            *x = match self.config.start {
                DirectStart::Previous if free => state.positions[v],
                _ => self.predicted[v],
            };
        }
        let ratio = match self.last {
            Some(last) if self.config.warm_start => update.substep() / last.substep(),
            _ => 0.0,
        };
        self.multipliers
            .iter_mut()
            .for_each(|l| *l *= ratio * ratio);
        self.merit.reset();
        self.solver.factorizations = 0;
        self.solver.solves = 0;
        self.solver.iterations = 0;
        self.trial.copy_from_slice(&self.positions);
        self.evaluate_trial();
    }

    /// C, J and k at `x`.
    fn evaluate_at(&mut self, x: &[Vec3]) {
        let mut first = 0;
        for family in &self.families {
            family.evaluate(x, first, &mut self.rows);
            first += family.row_count();
        }
        for (value, start) in self.rows.value.iter_mut().zip(&self.start_value) {
            *value -= start;
        }
        self.rows.violation.copy_from_slice(&self.rows.value);
    }

    /// Decides which rows with a dead zone act at the present positions and multipliers. Gives whether one let go.
    fn activate(&mut self) -> bool {
        let (mut first, mut released) = (0, false);
        for family in &self.families {
            let count = family.row_count();
            released |= family.activate(
                &self.positions,
                &self.kkt.vertex_scale,
                &mut self.multipliers[first..first + count],
                first,
                &mut self.rows,
            );
            first += count;
        }
        released
    }

    pub(super) fn evaluate_trial(&mut self) {
        let trial = std::mem::take(&mut self.trial);
        self.evaluate_at(&trial);
        self.trial = trial;
    }

    /// The matrix and the right-hand side at the present positions and multipliers.
    fn assemble(&mut self, update: XpbdUpdate) {
        self.activate();
        self.set_rows(update);
        let families: &[_] = if self.config.geometric_stiffness {
            &self.families
        } else {
            &[]
        };
        let diagonal_only = self.config.system.is_dual();
        self.kkt
            .set_hessian(families, &self.positions, &self.multipliers, diagonal_only);
        self.set_right();
    }

    fn set_rows(&mut self, update: XpbdUpdate) {
        self.kkt.set_rows(&self.rows, update);
        for row in 0..self.rows.len() {
            self.scaled_compliance[row] = if self.kkt.row_scale[row] > 0.0 {
                self.rows.scaled_compliance(row, update)
            } else {
                Real::INFINITY
            };
        }
    }

    /// Minus the two equations, scaled.
    fn set_right(&mut self) {
        for (v, right) in self.right.x.iter_mut().enumerate() {
            let pull = self.predicted[v] - self.positions[v];
            *right = pull * (self.mass[v] * self.kkt.vertex_scale[v]);
        }
        for row in 0..self.rows.len() {
            let scale = self.kkt.row_scale[row];
            self.change.l[row] = if scale > 0.0 {
                self.multipliers[row] / scale
            } else {
                0.0
            };
        }
        self.kkt.add_forces(&self.change.l, 1.0, &mut self.right.x);
        for row in 0..self.rows.len() {
            let compliant = self.kkt.normalized_compliance[row] * self.change.l[row];
            self.right.l[row] = -(self.kkt.row_scale[row] * self.rows.value[row] + compliant);
        }
    }

    /// The multipliers of one solve without geometric stiffness, positions unmoved: the warm start of a first step.
    fn initial_multipliers(&mut self) -> Result<(), CholeskyError> {
        self.solver.prepare(&self.kkt)?;
        if self.solver.solve(&self.kkt, &self.right, &mut self.change) {
            self.remove_undetermined();
        }
        for row in 0..self.rows.len() {
            self.multipliers[row] += self.kkt.row_scale[row] * self.change.l[row];
        }
        Ok(())
    }

    /// Removes from the new multipliers their part in the null space of dependent rows, which contradictory
    /// rows have made large. It moves nothing, but the geometric stiffness would see it.
    fn remove_undetermined(&mut self) {
        for _ in 0..2 {
            for row in 0..self.rows.len() {
                let scale = self.kkt.row_scale[row];
                self.right.l[row] = self.change.l[row];
                if scale > 0.0 {
                    self.right.l[row] += self.multipliers[row] / scale;
                }
            }
            self.solver
                .undetermined(&self.kkt, &self.right.l, &mut self.correction);
            for (change, undetermined) in self.change.l.iter_mut().zip(&self.correction.l) {
                *change -= undetermined;
            }
        }
    }

    /// What is left of the equations, and the counts.
    fn finish(&mut self, update: XpbdUpdate, report: &mut StepReport) {
        self.last = Some(update);
        self.activate();
        self.set_rows(update);
        for row in 0..self.rows.len() {
            // A spring between two prescribed vertices is not in the system, but has a force.
            if self.kkt.row_scale[row] == 0.0 {
                let force = -self.rows.value[row] / self.rows.scaled_compliance(row, update);
                self.multipliers[row] = if force.is_finite() { force } else { 0.0 };
            }
        }
        self.set_right();
        let rows = self.right.l.iter().zip(&self.kkt.row_scale);
        let left = rows.filter(|(_, scale)| **scale > 0.0);
        let h = update.substep();
        self.residuals = Residuals {
            compliance: left.map(|(l, scale)| l.abs() / scale).fold(0.0, Real::max),
            momentum: self
                .right
                .x
                .iter()
                .map(Vec3::norm_squared)
                .sum::<Real>()
                .sqrt()
                / (h * h),
        };
        report.factorizations = self.solver.factorizations;
        report.linear_solves = self.solver.solves;
        report.linear_iterations = self.solver.iterations;
        report.residual = Some(self.residuals.compliance);
    }

    /// Work (J) of the prescribed vertices in the substep from `state`: each moved by h v against the force `Jᵀλ/h²` on
    /// it, which is added to those that `input` asks for, as its share of the whole step.
    fn pin_work(&self, state: &State, input: &mut StepInput<'_>) -> Real {
        let Some(update) = self.last else {
            return 0.0;
        };
        let mut work = 0.0;
        let share = 1.0 / Real::from(self.config.substeps);
        for (row, &multiplier) in self.multipliers.iter().enumerate() {
            for e in self.rows.entries(row) {
                let vertex = self.rows.vertices[e] as usize;
                if self.particles.is_prescribed(vertex) {
                    let velocity = &state.velocities[vertex];
                    let gradient = &self.rows.gradient[e];
                    work -= gradient.dot(velocity) * update.impulse(multiplier);
                    input.add_pin_force(vertex, gradient * (update.force(multiplier) * share));
                }
            }
        }
        work
    }
}

/// Largest side of the box around the positions (m); 1 if they are one point.
fn extent(positions: &[Vec3]) -> Real {
    let low = positions.iter().copied().reduce(|a, b| a.inf(&b));
    let high = positions.iter().copied().reduce(|a, b| a.sup(&b));
    match (low, high) {
        (Some(low), Some(high)) if high != low => (high - low).amax(),
        _ => 1.0,
    }
}

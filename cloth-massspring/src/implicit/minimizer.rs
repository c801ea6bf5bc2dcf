//! The minimisation of one stage: which method begins, when it is done, and which takes over.

mod clear_path;
mod extrapolation;
mod linearized_step;
mod second_order;

use super::line_search::{self, Point};
use super::linearized::Linearized;
use super::newton;
use super::progress::Progress;
use super::quasi_newton::QuasiNewton;
use super::stage::Stage;
use super::system::NewtonSystem;
use crate::config::{Accept, ImplicitConfig, Solve};
use cloth_core::contact::{ContactError, ContactPotential, ContactStep, FadingTruncation};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockPattern;
use cloth_core::method::family::Energies;
use cloth_core::method::in_contact::{HALVED_BELOW, VERTEX_BY_VERTEX_BELOW};
use cloth_core::method::trust::TrustRadius;
use cloth_core::method::vectors::dot;
use cloth_core::particles::Particles;
use cloth_core::step::{BuildError, Observer, Outcome, StepError, StepReport};
use std::sync::Arc;

/// Where no lower point is found, the gradient counts as lost in rounding up to this multiple of the estimate of
/// [`Stage::rounding`]; above, it is an error.
pub(super) const ROUNDING_FACTOR: Real = 100.0;
/// With a gradient that small, a step length below this counts as no step.
pub(super) const NEGLIGIBLE_STEP: Real = 1e-3;
/// Relative gradient norm below which Newton's method finishes, where a tolerance asks for less: it converges
/// quadratically there, down to rounding, the quasi-Newton method linearly.
const NEWTON_HANDOVER: Real = 1e-5;
/// Factor on the tolerance where something touches: friction holds what lies near its limit, and what it does not hold
/// is a small fraction of all forces. With all of the tolerance a handkerchief that should slide off a corner stays
/// there.
const CONTACT_TOLERANCE_FACTOR: Real = 0.3;
/// The same as NEWTON_HANDOVER as a multiple of the estimate of rounding: one Newton step from there ends well below
/// it.
const NEWTON_HANDOVER_ROUNDING: Real = 1e4;
/// Where much energy is released after the start, as from cloth crushed to a point, the decrement is compared with at
/// least this fraction of the velocity that the energy would make.
const MIN_RELEASED_SPEED: Real = 1e-3;

/// Factor on the trust radius after a step to its end that has not been shortened.
const RADIUS_GROWTH: Real = 4.0;

/// The iterates, and what the methods keep between two calls.
#[derive(Debug)]
pub(super) struct Minimizer {
    pub(super) current: Point,
    pub(super) next: Point,
    /// Beyond the next; with contact only.
    farther: Option<Point>,
    pub(super) direction: Vec<Vec3>,
    /// Norm of the forces that the current point asks for (N/√kg), as the potential's `inertial_norm` says: what the
    /// gradient is compared with.
    forces: Real,
    /// `G` (J) where the iteration has started.
    first: Real,
    quasi_newton: Option<QuasiNewton>,
    /// Made when it is first needed.
    pub(super) newton: Option<NewtonSystem>,
    /// Where the cloth is linearised, and scratch for a displacement from there (m); with contact only.
    linearized: Option<(Point, Vec<Vec3>)>,
    /// Where prescribed vertices end (m), while they are put back; empty before.
    pin_ends: Vec<Vec3>,
    /// Where each vertex is followed as far as it can go alone: the fractions (dimensionless), and the displacements
    /// (m).
    fractions: Vec<Real>,
    shortened: Vec<Vec3>,
    truncation: FadingTruncation,
    /// Which vertices elements couple; made in the first step with contact.
    neighbours: Option<Arc<BlockPattern>>,
    is_free: Vec<bool>,
}

/// What stays the same during one minimisation.
#[derive(Debug)]
pub(super) struct Task<'a> {
    pub(super) stage: Stage<'a>,
    pub(super) config: &'a ImplicitConfig,
    /// Positions (m) before the step.
    pub(super) before: &'a [Vec3],
    /// The step, counted from 1.
    pub(super) step: u64,
}

impl Task<'_> {
    /// What contact has refused ends the step.
    fn refused(&self, reason: ContactError) -> StepError {
        let step = self.step;
        StepError::Contact { reason, step }
    }
}

/// How the quasi-Newton iteration ended.
enum End {
    Done(Outcome),
    /// It does not get further.
    Stuck,
}

impl End {
    /// Where no other method takes over.
    fn outcome(self) -> Outcome {
        match self {
            Self::Done(outcome) => outcome,
            Self::Stuck => Outcome::BudgetSpent,
        }
    }
}

impl Minimizer {
    pub(super) fn new(
        particles: &Particles,
        energies: &Energies,
        config: &ImplicitConfig,
    ) -> Result<Self, BuildError> {
        let count = particles.len();
        let is_free: Vec<bool> = (0..count).map(|v| !particles.is_prescribed(v)).collect();
        let begins_with_newton = config.solve != Solve::QuasiNewton;
        Ok(Self {
            current: Point::new(count),
            next: Point::new(count),
            farther: None,
            direction: vec![Vec3::zeros(); count],
            forces: 0.0,
            first: 0.0,
            quasi_newton: (!begins_with_newton)
                .then(|| QuasiNewton::new(energies, is_free.clone())),
            newton: begins_with_newton
                .then(|| {
                    NewtonSystem::build(energies, &is_free, particles.rest_positions(), config)
                })
                .transpose()?,
            linearized: None,
            pin_ends: Vec::new(),
            fractions: Vec::new(),
            shortened: Vec::new(),
            truncation: FadingTruncation::default(),
            neighbours: None,
            is_free,
        })
    }

    /// Begins contact, and truncates the displacement to the current positions (m) where it is not free of crossings,
    /// so that what is stopped hardly strains what flies on.
    pub(super) fn begin_contact(
        &mut self,
        step: &ContactStep<'_>,
        energies: &Energies,
        contact: &mut dyn ContactPotential,
    ) -> Result<(), ContactError> {
        let (start, feasible) = (&mut self.current.positions, &mut self.next.positions);
        let pattern = self
            .neighbours
            .get_or_insert_with(|| Arc::clone(energies.lumped_assembly().pattern()));
        let columns = |v: usize| {
            let slots = pattern.row(v);
            pattern.columns()[slots].iter().map(|&u| u as usize)
        };
        self.truncation
            .begin(contact, step, feasible, start, columns)
    }

    /// Minimises the function of a stage, starting at `self.current.positions` and ending there; or takes one Newton
    /// step only. Contact is felt by the quasi-Newton method alone.
    pub(super) fn minimize(
        &mut self,
        task: &Task<'_>,
        mut observer: Option<&mut dyn Observer>,
        mut contact: Contact<'_>,
    ) -> Result<StepReport, StepError> {
        let mut report = StepReport::new(Outcome::Converged, 0);
        let is_alone = contact.is_none();
        if task.config.solve == Solve::Linearized {
            if !self.solve_apart(task, &mut observer, &mut contact, &mut report)? {
                self.minimize_linearized(task, &mut observer, &mut contact, &mut report)?;
            }
            return Ok(report);
        }
        let stage = &task.stage;
        if self.quasi_newton.is_some() {
            match self.descend(task, &mut contact, &mut observer, &mut report)? {
                end if !is_alone => {
                    report.outcome = end.outcome();
                    return Ok(report);
                }
                End::Done(Outcome::Converged)
                    if task.config.accept == Accept::Minimum
                        || task.config.tolerance < NEWTON_HANDOVER => {}
                End::Done(outcome) => {
                    report.outcome = outcome;
                    return Ok(report);
                }
                End::Stuck => report.newton_fallbacks += 1,
            }
        } else {
            self.current.evaluate(stage);
            self.first = self.current.value;
        }
        if self.newton.is_none() {
            let energies = stage.potential.energies;
            let rest = stage.potential.particles.rest_positions();
            match NewtonSystem::build(energies, &self.is_free, rest, task.config) {
                Ok(system) => self.newton = Some(system),
                Err(_) => {
                    // The factor does not fit into the memory.
                    report.outcome = Outcome::BudgetSpent;
                    return Ok(report);
                }
            }
        }
        match newton::iterate(self, task, observer, &mut report) {
            Ok(()) => Ok(report),
            // An iterative linear solver may lose a nearly singular matrix to rounding; the point so far is a step all
            // the same.
            Err(StepError::NotPositiveDefinite { .. })
                if report.newton_fallbacks > 0 && !task.config.linear.proves_definiteness() =>
            {
                report.outcome = Outcome::BudgetSpent;
                Ok(report)
            }
            Err(error) => Err(error),
        }
    }

    /// Shows an observer where an iteration has come to.
    fn notify(&self, observer: &mut Option<&mut dyn Observer>, iteration: u32) {
        if let Some(observer) = observer.as_deref_mut() {
            observer.iteration(iteration, &self.current.positions);
        }
    }

    /// The quasi-Newton method from the current positions on: evaluates them, iterates, and restores linear momentum.
    fn descend(
        &mut self,
        task: &Task<'_>,
        contact: &mut Contact<'_>,
        observer: &mut Option<&mut dyn Observer>,
        report: &mut StepReport,
    ) -> Result<End, StepError> {
        let mut method = self.quasi_newton.take().expect("there is one");
        let stage = &task.stage;
        // What touches something does not go where its momentum alone would take it.
        if contact.is_none() {
            method.restore_momentum(stage, &mut self.current);
        }
        self.current.evaluate(&with(task, contact));
        self.first = self.current.value;
        let end = self
            .fall_together(&mut method, task, contact)
            .and_then(|()| self.iterate(&mut method, task, contact, observer, report));
        let shifted = self.shift_together(&mut method, task, contact);
        if contact.is_none() {
            // The value stays that before the shift: see there by how much it is then too high.
            method.restore_momentum(stage, &mut self.current);
        }
        self.quasi_newton = Some(method);
        if shifted? {
            std::mem::swap(&mut self.current, &mut self.next);
        }
        end
    }

    /// The quasi-Newton iteration to the tolerance, as the [crate page](crate#the-minimisation) lists it. In contact:
    /// - The longest step is what lies within the trust radius, a bound on the displacement of any vertex, and of that
    ///   the fraction free of crossings (CCD). Where the line search has shortened a step the radius becomes twice the
    ///   displacement that was left, and four times as large after a full step to its end.
    /// - A direction of which less than a tenth is free gets a second-order correction (`second_order`).
    /// - A full step with half of its slope left goes on along its direction (`extrapolation`).
    /// - Once five steps have been cut below a quarter of their directions, directions are to a tenth of the residual
    ///   (conjugate gradients, the Hessian recomputed): what one cycle leaves would run into the next contact.
    fn iterate(
        &mut self,
        method: &mut QuasiNewton,
        task: &Task<'_>,
        contact: &mut Contact<'_>,
        observer: &mut Option<&mut dyn Observer>,
        report: &mut StepReport,
    ) -> Result<End, StepError> {
        method.begin();
        // Not known before a matrix has been assembled.
        let mut rounding = 0.0;
        let mut progress = Progress::new();
        let mut radius = TrustRadius::new(Real::INFINITY, RADIUS_GROWTH);
        loop {
            let norm = self.gradient_norm(task)?;
            report.residual = Some(self.residual(norm, rounding));
            let is_finishing = task.config.tolerance < NEWTON_HANDOVER && contact.is_none();
            let (tolerance, least) = if is_finishing {
                (NEWTON_HANDOVER, NEWTON_HANDOVER_ROUNDING * rounding)
            } else if contact.is_some() && method.has_active_contacts() {
                (CONTACT_TOLERANCE_FACTOR * task.config.tolerance, rounding)
            } else {
                (task.config.tolerance, rounding)
            };
            let dt = task.stage.potential.dt;
            let point = (&task.stage, &self.current);
            // What touches each other moves together.
            let touches = contact.is_some() && method.has_active_contacts();
            if norm <= (tolerance * self.forces).max(least)
                && (touches || method.piecewise.is_balanced(point, tolerance, least * dt))
            {
                return Ok(End::Done(Outcome::Converged));
            }
            if report.iterations == task.config.max_iterations {
                return Ok(End::Done(Outcome::BudgetSpent));
            }
            let is_start = report.iterations == 0;
            let before = if is_start {
                task.before
            } else {
                &self.next.positions[..]
            };
            let stage = with(task, contact);
            if method.refresh(&stage, &self.current, before, is_start) {
                report.factorizations += 1;
                rounding = stage.rounding(method.matrix(), &self.current.positions);
                report.residual = Some(self.residual(norm, rounding));
                if norm <= rounding {
                    return Ok(End::Done(Outcome::Converged));
                }
            }
            report.iterations += 1;
            report.linear_solves += 1;
            let (g, direction) = (&self.current.gradient, &mut self.direction);
            let (slope, left, solves) = method.direction(g, direction);
            report.linear_iterations += solves;
            if let Some(source) = contact.as_deref_mut().filter(|_| method.is_fresh()) {
                source.update_multipliers(&self.current.positions, direction);
            }
            // A pair that is nearly closed has most of the gradient, and a solve to a tenth may leave all other forces.
            let decrement = (left - slope).max(0.0).sqrt();
            if slope >= 0.0 || slope.is_nan() {
                // Uphill: the pairs, or a matrix that rounding has made indefinite, mislead.
                if method.restart() {
                    self.next.positions.copy_from_slice(&self.current.positions);
                    continue;
                }
                return Ok(match norm <= ROUNDING_FACTOR * rounding {
                    true => End::Done(Outcome::Converged),
                    false => End::Stuck,
                });
            }
            let enough = self.close_enough(task, tolerance);
            report.residual = Some(self.relative(task, decrement));
            let point = (&task.stage, &self.current);
            let (direction, least) = (
                &self.direction,
                (least * dt).max(tolerance * self.released()),
            );
            if decrement <= enough
                && (touches || method.piecewise.is_near(point, direction, tolerance, least))
            {
                return Ok(End::Done(Outcome::Converged));
            }
            if contact.is_none() && progress.is_too_slow(report.iterations, decrement, enough) {
                return Ok(End::Stuck);
            }
            let (value, number) = (self.current.value, report.iterations);
            if contact.is_some() && progress.is_stalled(number, value, decrement) {
                return Ok(End::Stuck);
            }
            let trusted = contact.is_some().then(|| radius.trust(&self.direction));
            let fraction = trusted.map_or(1.0, |trusted| trusted.fraction);
            let mut most = self.longest_step(task, contact, fraction)?;
            let mut is_corrected = false;
            if most < HALVED_BELOW * fraction
                && let Some(farther) = self.correct(method, task, contact, fraction, most)?
            {
                (most, is_corrected) = (farther, true);
            }
            if contact.is_some()
                && most < VERTEX_BY_VERTEX_BELOW * fraction
                && self.search_vertex_by_vertex(task, contact, fraction, report)?
            {
                method.drop_pairs();
                std::mem::swap(&mut self.current, &mut self.next);
                continue;
            }
            let most = if most < HALVED_BELOW * fraction {
                0.5 * most
            } else {
                most
            };
            let stage = with(task, contact);
            let (from, to) = (&self.current, &mut self.next);
            let found = line_search::search(&stage, from, &self.direction, slope, most, to);
            report.backtracks += found.backtracks;
            if let Some(trusted) = trusted {
                method.record_shortening(found.length);
                // What contact has truncated says nothing about the radius.
                if found.backtracks > 0 {
                    radius.shorten(found.length * trusted.longest);
                } else if trusted.fraction < 1.0 && found.length == trusted.fraction {
                    radius.grow();
                }
            }
            if !found.accepted {
                if norm <= ROUNDING_FACTOR * rounding {
                    return Ok(End::Done(Outcome::Converged));
                }
                if method.restart() {
                    self.next.positions.copy_from_slice(&self.current.positions);
                    continue;
                }
                return Ok(End::Stuck);
            }
            if found.length < NEGLIGIBLE_STEP && norm <= ROUNDING_FACTOR * rounding {
                return Ok(End::Done(Outcome::Converged));
            }
            // What is linearised has the curvature that the matrix says.
            let is_whole =
                found.length == 1.0 && !is_corrected && task.config.solve != Solve::Linearized;
            let length = match is_whole {
                true => self.extrapolate(task, contact, slope)?,
                false => found.length,
            };
            let (from, to) = (&self.current.gradient, &self.next.gradient);
            if !is_corrected {
                method.accumulate(length, &self.direction, from, to);
            }
            std::mem::swap(&mut self.current, &mut self.next);
            self.notify(observer, report.iterations);
        }
    }

    /// Shifts cloth that nothing holds to where gravity takes it, if nothing is in between and `G` falls: cloth that
    /// falls without touching anything is then solved.
    fn fall_together(
        &mut self,
        method: &mut QuasiNewton,
        task: &Task<'_>,
        contact: &mut Contact<'_>,
    ) -> Result<(), StepError> {
        if self.shift_together(method, task, contact)? {
            self.next.evaluate(&with(task, contact));
            if self.next.value < self.current.value {
                std::mem::swap(&mut self.current, &mut self.next);
            }
        }
        Ok(())
    }

    /// Puts the next point where the momentum of cloth that touches nothing but itself is that of the step. Returns
    /// whether there is such a place, and nothing in between.
    fn shift_together(
        &mut self,
        method: &mut QuasiNewton,
        task: &Task<'_>,
        contact: &mut Contact<'_>,
    ) -> Result<bool, StepError> {
        let Some(source) = contact else {
            return Ok(false);
        };
        let (from, to) = (&self.current, &mut self.next);
        to.positions.copy_from_slice(&from.positions);
        to.gradient.copy_from_slice(&from.gradient);
        to.value = from.value;
        if !method.restore_momentum_together(&task.stage, &**source, to) {
            return Ok(false);
        }
        let path = [&self.current.positions[..], &self.next.positions];
        clear_path::is_clear(task, &mut **source, path, &mut self.shortened)
    }

    /// The fraction of the direction, `most` of it at most, that is free of crossings.
    fn longest_step(
        &mut self,
        task: &Task<'_>,
        contact: &mut Contact<'_>,
        most: Real,
    ) -> Result<Real, StepError> {
        let Some(contact) = contact else {
            return Ok(most);
        };
        self.follow(most);
        let (from, to) = (&self.current.positions, &self.next.positions);
        let limited = contact.limit(from, to);
        let safe = limited.map_err(|reason| task.refused(reason))?;
        Ok(most * safe)
    }

    /// Puts the next positions at `fraction` of the direction.
    fn follow(&mut self, fraction: Real) {
        line_search::place(&self.current, &self.direction, fraction, &mut self.next);
    }

    /// Follows `fraction` of the direction with every vertex as far as it alone can go, and evaluates what that comes
    /// to: one bound for all would let one pair that is nearly closed hold the whole cloth. Returns whether that is
    /// lower.
    ///
    /// Nothing crosses by it. A pair is safe if it keeps a fifth of its distance, or of h if that is less, on its
    /// straight paths. `limit_each` truncates all vertices of one that is not at the fraction up to which it is, and
    /// tests the pairs around it again on what is left. After 20 such rounds all vertices are truncated to what the
    /// worst pair allows, and near pairs are detected again. The line search takes one factor for all of these paths:
    /// the beginning of a safe path is safe.
    fn search_vertex_by_vertex(
        &mut self,
        task: &Task<'_>,
        contact: &mut Contact<'_>,
        fraction: Real,
        report: &mut StepReport,
    ) -> Result<bool, StepError> {
        let Some(source) = contact.as_deref_mut() else {
            return Ok(false);
        };
        self.follow(fraction);
        let (from, to) = (&self.current.positions, &mut self.next.positions);
        self.fractions.resize(from.len(), 1.0);
        source
            .limit_each(from, to, &mut self.fractions)
            .map_err(|reason| task.refused(reason))?;
        let mut shortened = std::mem::take(&mut self.shortened);
        shortened.clear();
        let displacements = to.iter().zip(from).map(|(to, x)| to - x);
        shortened.extend(displacements);
        let slope = dot(&self.current.gradient, &shortened);
        let mut is_lower = false;
        if slope < 0.0 {
            let stage = with(task, contact);
            let (from, to) = (&self.current, &mut self.next);
            let found = line_search::search(&stage, from, &shortened, slope, 1.0, to);
            report.backtracks += found.backtracks;
            is_lower = found.accepted;
        }
        self.shortened = shortened;
        Ok(is_lower)
    }

    /// Norm (N/√kg) of the gradient of the current point, which is finite; and records what to compare it with.
    pub(super) fn gradient_norm(&mut self, task: &Task<'_>) -> Result<Real, StepError> {
        let norm = task.stage.gradient_norm(&self.current.gradient);
        self.forces = task.stage.potential.inertial_norm(&self.current.positions);
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

    /// Gradient norm (N/√kg) at which the iteration ends.
    pub(super) fn small_enough(&self, task: &Task<'_>, rounding: Real) -> Real {
        (task.config.tolerance * self.forces).max(rounding)
    }

    /// The change of velocity that the forces make, `‖x − x̂‖_M/s` (√J), times the tolerance: Newton decrement at which
    /// the iteration ends.
    pub(super) fn close_enough(&self, task: &Task<'_>, tolerance: Real) -> Real {
        let change = self.forces * task.stage.potential.dt;
        tolerance * change.max(self.released())
    }

    /// The least change of velocity (√J) to compare with after much energy was released.
    fn released(&self) -> Real {
        let given_off = 2.0 * (self.first - self.current.value).max(0.0);
        MIN_RELEASED_SPEED * given_off.sqrt()
    }

    /// A Newton decrement (√J) relative to the change of velocity that the forces make.
    pub(super) fn relative(&self, task: &Task<'_>, decrement: Real) -> Real {
        decrement / self.close_enough(task, 1.0).max(Real::MIN_POSITIVE)
    }

    /// Gradient norm relative to that of the forces. In free fall these are zero and only rounding is left to compare
    /// with.
    pub(super) fn residual(&self, norm: Real, rounding: Real) -> Real {
        if norm > 0.0 {
            norm / self.forces.max(rounding)
        } else {
            0.0
        }
    }
}

/// What the cloth touches, if it can touch anything.
pub(super) type Contact<'a> = Option<&'a mut dyn ContactPotential>;

/// The function of a stage with contact as it is now.
fn with<'a>(task: &Task<'a>, contact: &'a Contact<'_>) -> Stage<'a> {
    Stage {
        contact: contact
            .as_deref()
            .map(|contact| contact as &dyn ContactPotential),
        ..task.stage
    }
}

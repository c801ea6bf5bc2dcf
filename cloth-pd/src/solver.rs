//! The solver: one step, from the prediction to the new velocities.

mod builder;
mod end;
mod start;

pub use builder::PdBuilder;

use crate::chebyshev::Chebyshev;
use crate::coarse::CoarseGrid;
use crate::components::FreeComponents;
use crate::config::PdConfig;
use crate::contact::Contact;
use crate::global::GlobalSystem;
use crate::objective::{Objective, Point};
use crate::quasi_newton::{QuasiNewton, ROUNDING};
use cloth_core::contact::{ContactError, FadingTruncation};
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};
use end::{PieceNorms, Relapses};
use start::Before;

/// Projective dynamics; see the [crate documentation](crate).
///
/// # A step of the default
/// Quasi-Newton with two pairs from `x[0] + Δt v[0]`, where nothing touches (`contact.rs` has the order in contact):
/// 1. Factorise A if Δt is new; where pins, attachments or elements have changed, correct the factor or factorise.
/// 2. Predict x̃. Start at `x = x[0] + Δt v[0]`, prescribed vertices at their ends, components that nothing holds where
///    their momentum takes them.
/// 3. With a coarse grid: H at x, `PᵀHP` and the levels of its cycle V.
/// 4. The local step: p of every element, with it `G` and g = ∇G at x. In free fall (no force but gravity and load) the
///    step is done.
/// 5. Direction d = −B g: the two loops of L-BFGS over the last two pairs (step 7), and between them the global step
///    `A⁻¹ r`, plus `P V Pᵀ r` with a coarse grid.
/// 6. Line search: x ← x + t d, t = 1 or the first shorter one of at most twelve at which `G` has fallen enough
///    (Armijo). Each trial is a local step; that of the accepted one serves the next iteration. If d ascends, or none
///    will do, the pairs are cleared, and d = −A⁻¹ g.
/// 7. Keep the pair s = Δx, y = Δg if s·y > 0.
/// 8. Go on at 5, ten iterations at least (twenty where pins move), until the Newton decrement and the fall of `G` are
///    small enough ([`PdConfig::velocity_tolerance`]: `Converged`), at most 300 (`BudgetSpent`).
/// 9. If x is above `G(x[0])`: once more from 3, with x = `x[0]`.
/// 10. `x[1] = x`, `v[1] = (x − x[0])/Δt`.
///
/// # Report
/// A step reports as factorisations those of the constant matrix: 1 in the first step (0 where all vertices are
/// prescribed), for another Δt, and where so many pins or elements have changed that a correction is dearer; else 0.
/// Its residual is `‖∇G(x)‖/max(‖∇G(x̃)‖, ‖∇C(x)‖)`, with a tolerance only; C is the potential of contact.
#[derive(Debug)]
pub struct PdSolver {
    pub(crate) objective: Objective,
    pub(crate) global: GlobalSystem,
    coarse: Option<CoarseGrid>,
    /// Rest positions (m) and cells of the coarse grid.
    lattice: Option<(Vec<Vec3>, u32)>,
    method: Method,
    /// The bounded method that replaces plain and Chebyshev iterations in steps with contact; made at the first.
    contact_method: Option<Box<QuasiNewton>>,
    free_components: FreeComponents,
    /// Whether pins or elements were changed since the last step, and whether attachments were.
    pub(crate) is_stale: bool,
    pub(crate) are_attachments_stale: bool,
    config: PdConfig,
    /// The iterate.
    pub(crate) point: Point,
    /// `x[0]`, for where the iteration ends above it.
    pub(crate) fallback: Point,
    /// With contact: positions (m) free of intersections, and the truncation of the displacement from there.
    feasible: Vec<Vec3>,
    truncation: FadingTruncation,
    /// `v[1]` (m/s).
    velocities: Vec<Vec3>,
    before: Before,
    norms: PieceNorms,
}

/// The acceleration and its memory.
#[derive(Debug)]
enum Method {
    Plain { increment: Vec<Vec3> },
    Chebyshev(Box<Chebyshev>),
    QuasiNewton(Box<QuasiNewton>),
}

/// Iterations over which the fall of `G` is measured.
const DECREASE_WINDOW: usize = 5;
/// Least number of iterations in a step that goes on until it is near enough, and the number in one that does not know.
const MIN_ITERATIONS: u32 = 10;
/// Least number where pins, bodies or forces drive the cloth and nothing touches: the force that holds a ball at rest
/// in a net is then right to 0.1 %, with ten to 0.8 %.
const MIN_ITERATIONS_DRIVEN: u32 = 20;
/// Least number in a step with contact where directions are those of the constant matrix.
const MIN_ITERATIONS_IN_CONTACT: u32 = 30;
/// Factor on the tolerance with active contacts: with all of it cloth that lands on a ball loses three quarters of the
/// kinetic energy that it should keep, with this hardly any.
const CONTACT_TOLERANCE_FACTOR: Real = 0.3;
/// In the first directions of Newton's method, fewer than this many, a step ends only at this fraction of the
/// tolerance: where they converge fast, a few more cost little. The tolerance is relative to all forces, among them
/// those that friction or a body balances, beside which what slides is small.
const EARLY_NEWTON_ITERATIONS: u32 = 16;
const EARLY_TOLERANCE_FACTOR: Real = 0.1;
/// Factor on the tolerance without active contacts. With all of it the light, stiff sheet of the [limits](crate#limits)
/// falls 0.6 to 1 times as far as it should, with this 0.9 to 1.1 times.
const NO_CONTACT_TOLERANCE_FACTOR: Real = 0.5;
/// Factor on the tolerance where pins move: strain that a step leaves where a pin has pulled adds up over the steps.
/// With all of it a towel whose ends are turned takes 13 times the work that it should, with this about twice.
const MOVING_PIN_TOLERANCE_FACTOR: Real = 0.3;

impl Stepper for PdSolver {
    fn name(&self) -> &'static str {
        "pd"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.point.positions.len())?;
        let step = state.steps + 1;
        let coarse_builds = self.refresh();
        let prepared = self.global.prepare(input.dt);
        let factorizations =
            prepared.map_err(|_| StepError::NotPositiveDefinite { iteration: 1, step })?;
        let is_air_implicit = self.takes_air_implicitly(&input);
        if let Some(air) = input.air.as_mut().filter(|_| is_air_implicit) {
            air.linearize(&state.positions, &state.velocities);
        }
        self.objective.begin(state, &input, is_air_implicit)?; // x̃
        let mut report = StepReport {
            factorizations,
            coarse_builds,
            ..StepReport::new(Outcome::Converged, 0)
        };
        let reference = self.reference();
        let mut source = input.contacts.take();
        let is_in_contact = source.is_some();
        self.start(state, is_in_contact);
        let mut contact = source.as_mut().map(|source| source.potential());
        let solved = self.solve(state, reference, &mut report, &mut input, &mut contact);
        solved.map_err(|reason| StepError::Contact { reason, step })?;
        report.tells_pin_forces = input.begin_pin_forces(self.point.positions.len());
        report.pin_work = self.pin_work(&contact, &mut input);
        self.find_velocities(state, input.dt)?;
        if let Some(air) = input.air.as_mut().filter(|_| is_air_implicit) {
            let w = self.objective.particles.inverse_mass();
            air.end(&self.point.positions, &self.velocities, w);
        }
        if let Some(contact) = contact {
            contact.end(&self.point.positions, &mut self.velocities);
        }
        self.remember(state, input.dt, is_in_contact);
        state.positions.copy_from_slice(&self.point.positions);
        state.velocities.copy_from_slice(&self.velocities);
        state.time += input.dt;
        state.steps = step;
        Ok(report)
    }

    fn set_prescribed(&mut self, vertices: &[usize], are_prescribed: bool) -> bool {
        for &vertex in vertices {
            let changed = match are_prescribed {
                true => self.prescribe(vertex),
                false => self.release(vertex),
            };
            assert!(changed.is_ok(), "there is no vertex {vertex}");
        }
        true
    }

    fn remove_elements(&mut self, gone: &[[usize; 2]]) -> bool {
        for &[family, element] in gone {
            let removed = self.remove(family, element);
            assert!(removed.is_ok(), "no element {element} in family {family}");
        }
        true
    }
}

impl PdSolver {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without elements.
    #[must_use]
    pub fn builder(particles: &Particles) -> PdBuilder {
        PdBuilder::new(particles)
    }

    /// The settings that it was built with.
    #[must_use]
    pub fn config(&self) -> &PdConfig {
        &self.config
    }

    /// Whether the drag of the air is part of the minimisation: only where a line search stands in for the constant
    /// matrix, which knows nothing of it.
    fn takes_air_implicitly(&self, input: &StepInput<'_>) -> bool {
        input.air.is_some()
            && (input.contacts.is_some() || matches!(self.method, Method::QuasiNewton(_)))
    }

    /// Updates what depends on pins, elements and attachments changed since the last step. Returns how many coarse
    /// grids were built for that: one if a pin or an element changed, since P has no rows for prescribed vertices.
    fn refresh(&mut self) -> u32 {
        let are_attachments_stale = std::mem::take(&mut self.are_attachments_stale);
        let is_stale = std::mem::take(&mut self.is_stale);
        let objective = &mut self.objective;
        if is_stale {
            objective.refresh();
            if let Method::QuasiNewton(method) = &mut self.method {
                method.forget_hessian();
            }
        }
        if are_attachments_stale || is_stale {
            self.free_components = objective.free_components(self.global.stiffness());
            objective.pieces = self.free_components.pieces().clone();
            if let Method::QuasiNewton(method) = &mut self.method {
                method.set_pieces(&objective.pieces);
            }
        }
        if !is_stale {
            if let (true, Some(coarse)) = (are_attachments_stale, &mut self.coarse) {
                coarse.set_free_components(&self.free_components);
            }
            return 0;
        }
        let Some((rest, cells)) = &self.lattice else {
            return 0;
        };
        self.coarse = Some(CoarseGrid::new(
            rest,
            *cells,
            &objective.particles,
            &self.global,
            &self.free_components,
            &objective.families,
        ));
        1
    }

    /// `‖∇G(x̃)‖` (N/√kg) without the drag of the air, with a tolerance only.
    fn reference(&mut self) -> Real {
        if self.config.tolerance.is_none() || self.global.is_empty() {
            return 0.0;
        }
        let q = &mut self.point.displacement;
        q.copy_from_slice(&self.objective.inertial);
        let drag = std::mem::take(&mut self.objective.drag);
        self.objective.evaluate(&mut self.point, &None);
        self.objective.drag = drag;
        self.objective.norm(&self.point.gradient)
    }

    /// Minimises, from where it was said to start.
    fn solve(
        &mut self,
        state: &State,
        reference: Real,
        report: &mut StepReport,
        input: &mut StepInput<'_>,
        contact: &mut Contact<'_>,
    ) -> Result<(), ContactError> {
        if contact.is_none() || matches!(self.method, Method::QuasiNewton(_)) {
            return self.minimize(state, reference, report, input, contact);
        }
        // Unbounded displacements pass through obstacles: plain iterations with a bound, and no extrapolation.
        report.chebyshev_fallbacks += u32::from(matches!(self.method, Method::Chebyshev(_)));
        let new = || Box::new(QuasiNewton::new(0, &self.objective.pieces));
        let bounded = Method::QuasiNewton(self.contact_method.take().unwrap_or_else(new));
        let unbounded = std::mem::replace(&mut self.method, bounded);
        let result = self.minimize(state, reference, report, input, contact);
        if let Method::QuasiNewton(bounded) = std::mem::replace(&mut self.method, unbounded) {
            self.contact_method = Some(bounded);
        }
        result
    }

    /// The same by the method as it is now.
    fn minimize(
        &mut self,
        state: &State,
        reference: Real,
        report: &mut StepReport,
        input: &mut StepInput<'_>,
        contact: &mut Contact<'_>,
    ) -> Result<(), ContactError> {
        if let Some(contact) = contact {
            self.begin_contact(state, input.dt, &mut **contact)?;
        }
        report.outcome = self.iterate(reference, report, input, contact)?;
        if self.fall_back_if_higher(state, contact)? {
            report.outcome = self.iterate(reference, report, input, contact)?;
        }
        self.restore_momentum(contact)
    }

    /// Restores the momentum of free components that touch nothing but each other, which inertia gives; truncation
    /// vertex by vertex does not keep it.
    fn restore_momentum(&mut self, contact: &mut Contact<'_>) -> Result<(), ContactError> {
        let Method::QuasiNewton(method) = &mut self.method else {
            return Ok(());
        };
        let components = &mut self.free_components;
        if contact.is_none() || components.is_empty() {
            components.find_supported(&[]);
            return Ok(());
        }
        self.objective.write_positions(&mut self.point);
        method.linearize_contacts(&self.objective, &self.point, contact);
        let rows = method
            .contact_system()
            .map_or(&[][..], |system| &system.rows);
        components.find_supported(rows);
        let q = &mut self.point.displacement;
        let Some(contact) = contact else {
            return Ok(());
        };
        if !components.find_shifts(self.objective.momentum(), rows, q) {
            return Ok(());
        }
        self.feasible.copy_from_slice(&self.point.positions);
        components.add_found(1.0, &mut self.feasible);
        let fraction = contact.limit(&self.point.positions, &self.feasible)?;
        components.add_found(fraction, q);
        self.point.is_evaluated = false;
        Ok(())
    }

    /// Iterates from the point to the end, with a memory that begins anew.
    fn iterate(
        &mut self,
        reference: Real,
        report: &mut StepReport,
        input: &mut StepInput<'_>,
        contact: &mut Contact<'_>,
    ) -> Result<Outcome, ContactError> {
        if self.global.is_empty() {
            return Ok(Outcome::Converged);
        }
        match &mut self.method {
            Method::Plain { .. } => {}
            Method::Chebyshev(method) => method.begin(),
            Method::QuasiNewton(method) => {
                let inertial = contact.is_some().then_some(&self.objective.inertial[..]);
                let before_newton = match self.config.iterations {
                    Some(_) => u32::MAX,
                    None => self.config.most_iterations / 2,
                };
                method.begin(inertial, before_newton);
            }
        }
        if let Some(coarse) = &mut self.coarse {
            self.objective.write_positions(&mut self.point);
            let (families, attachments) = (&self.objective.families, &self.objective.attachments);
            coarse.prepare(families, attachments, &self.point.positions, input.dt);
        }
        let is_coarse_ready = self.coarse.as_ref().is_some_and(CoarseGrid::is_ready);
        report.coarse_fallbacks += u32::from(self.lattice.is_some() && !is_coarse_ready);
        let is_driven = matches!(self.method, Method::QuasiNewton(_))
            && (self.objective.is_driven()
                || contact
                    .as_ref()
                    .is_some_and(|c| c.has_free_bodies() || input.load.is_some()));
        let first = report.iterations;
        let has_no_fixed_count = self.config.iterations.is_none();
        let has_convergence_test =
            self.config.tolerance.is_some() || matches!(self.method, Method::QuasiNewton(_));
        let most = match self.config.iterations {
            Some(iterations) => iterations,
            None if has_convergence_test => self.config.most_iterations,
            None => MIN_ITERATIONS,
        };
        let last = first + most;
        // The last values of `G` (J).
        let mut values = [Real::INFINITY; DECREASE_WINDOW];
        let mut relapses = Relapses::default();
        self.norms.forget();
        loop {
            let is_last = report.iterations == last;
            // A number of iterations is all that may have been asked for.
            let checks_convergence =
                self.config.tolerance.is_some() || (has_no_fixed_count && has_convergence_test);
            report.unfinished = u32::from(is_last && checks_convergence);
            if is_last && self.config.tolerance.is_none() {
                return Ok(Outcome::BudgetSpent);
            }
            if !self.point.is_evaluated {
                self.objective.evaluate(&mut self.point, contact); // the local step
            }
            let is_in_free_fall =
                has_no_fixed_count && report.iterations == first && self.is_in_free_fall();
            if is_in_free_fall
                || self.is_converged(reference, report, contact)
                || self.is_balanced()
            {
                report.unfinished = 0;
                return Ok(Outcome::Converged);
            }
            if is_last {
                return Ok(Outcome::BudgetSpent);
            }
            let is_stuck = self.advance(report, contact)?; // the global step
            self.norms.forget();
            report.iterations += 1;
            if is_stuck {
                return Ok(Outcome::BudgetSpent);
            }
            let oldest = &mut values[report.iterations as usize % DECREASE_WINDOW];
            let decrease = std::mem::replace(oldest, self.point.value) - self.point.value;
            if has_no_fixed_count && self.config.tolerance.is_none() {
                let (least, fraction) = match (is_driven, self.has_contact()) {
                    (true, true) => (MIN_ITERATIONS_IN_CONTACT, MOVING_PIN_TOLERANCE_FACTOR),
                    (true, false) => (MIN_ITERATIONS_DRIVEN, MOVING_PIN_TOLERANCE_FACTOR),
                    (false, true) => (MIN_ITERATIONS_IN_CONTACT, CONTACT_TOLERANCE_FACTOR),
                    (false, false) => (MIN_ITERATIONS, NO_CONTACT_TOLERANCE_FACTOR),
                };
                let is_early = report.iterations - first < EARLY_NEWTON_ITERATIONS;
                let (least, fraction) = match (self.is_by_hessian(), is_early) {
                    (true, true) => (0, fraction * EARLY_TOLERANCE_FACTOR),
                    (true, false) => (0, fraction),
                    (false, _) => (least, fraction),
                };
                let is_enough = report.iterations >= first + least;
                let errors = self.velocity_errors(fraction, decrease, is_enough);
                let is_met = relapses.accepts(errors);
                if is_met && is_enough && (!self.is_by_hessian() || self.is_near_balance()) {
                    return Ok(Outcome::Converged);
                }
            }
            if let Some(observer) = &mut input.observer {
                if !self.point.is_evaluated {
                    self.objective.write_positions(&mut self.point);
                }
                observer.iteration(report.iterations, &self.point.positions);
            }
        }
    }

    /// Goes back to `x[0]`, with free components where their momentum takes them, if `G` is higher at the point, where
    /// the quasi-Newton method has gone where the motion leads, than there. Returns whether it did.
    ///
    /// `G(x[1]) ≤ G(x[0])` bounds the potential energy that a step can make. Every iteration lowers `G`, so a start at
    /// `x[0]` has that; one that goes on with the velocity can end above it, where the cloth is so tangled that the
    /// iterations do not get far, and a tangle fed in every step never rests.
    ///
    /// *A test that saves an evaluation.* Values of `G` leave out a constant of the step ([`Objective`]), such that
    /// inertia and the energy of the families of constant projection are 0 at `x[0]`. All other energies are never
    /// negative, so the value at `x[0]` is at least 0. An end with a value of at most 0 is therefore not above `x[0]`,
    /// and is kept at once; any other is compared with the fallback.
    ///
    /// The fallback is not quite `x[0]` in three cases. There its value may be below 0, and an end of at most 0 that is
    /// kept may be above it:
    /// - A free component without contact has moved as its momentum takes it, its mean (by mass) by ū. That changes no
    ///   elasticity and lowers the value by `m ‖ū‖²/(2Δt²)`, m its mass. `G(x[1]) ≤ G(x[0])` still holds.
    /// - A pin moves: the families of constant projection may store less at the fallback than at `x[0]`. The end that
    ///   is kept is above the fallback by no more than what they store at `x[0]`.
    /// - Contact has led free vertices around a body that moves: the fallback has inertia too.
    fn fall_back_if_higher(
        &mut self,
        state: &State,
        contact: &mut Contact<'_>,
    ) -> Result<bool, ContactError> {
        let is_watched = matches!(self.method, Method::QuasiNewton(_))
            && self.config.start.goes_on()
            && self.point.is_evaluated;
        if !is_watched || self.point.value <= 0.0 {
            return Ok(false);
        }
        let (particles, inertial) = (&self.objective.particles, &self.objective.inertial);
        let q = &mut self.fallback.displacement;
        for (vertex, q) in q.iter_mut().enumerate() {
            *q = if particles.is_prescribed(vertex) {
                inertial[vertex]
            } else if contact.is_some() {
                self.feasible[vertex] - state.positions[vertex]
            } else {
                Vec3::zeros()
            };
        }
        if let Some(contact) = contact {
            // A motion of no length: it sets the candidates for the evaluation there.
            contact.limit(&self.feasible, &self.feasible)?;
        } else {
            self.free_components.align(self.objective.momentum(), q);
        }
        self.objective.evaluate(&mut self.fallback, contact);
        let excess = self.point.value - self.fallback.value;
        let is_higher = excess.is_nan() || excess > ROUNDING * self.fallback.size;
        if is_higher {
            std::mem::swap(&mut self.point, &mut self.fallback);
        } else if let Some(contact) = contact {
            // The candidates for where the step ends again, whose forces bodies get.
            contact.limit(&self.point.positions, &self.point.positions)?;
        }
        Ok(is_higher)
    }

    /// One iteration. Returns whether it found no lower point.
    fn advance(
        &mut self,
        report: &mut StepReport,
        contact: &mut Contact<'_>,
    ) -> Result<bool, ContactError> {
        let (objective, global, point) = (&mut self.objective, &mut self.global, &mut self.point);
        report.linear_solves += 1;
        match &mut self.method {
            Method::Plain { increment } => {
                global.solve(&point.gradient, increment);
                for (q, d) in point.displacement.iter_mut().zip(increment) {
                    *q -= *d;
                }
                point.is_evaluated = false;
            }
            Method::Chebyshev(method) => {
                report.backtracks += u32::from(method.advance(objective, global, point));
            }
            Method::QuasiNewton(method) => {
                let coarse = self.coarse.as_mut();
                let done = method.advance(objective, global, coarse, point, contact)?;
                report.backtracks += done.backtracks;
                report.linear_solves += done.solves - 1;
                report.linear_iterations += done.linear_iterations;
                return Ok(done.is_stuck);
            }
        }
        Ok(false)
    }

    /// `x[1] = x`, `v[1] = (x − x[0])/Δt`.
    fn find_velocities(&mut self, state: &State, dt: Real) -> Result<(), StepError> {
        let step = state.steps + 1;
        self.objective.write_positions(&mut self.point);
        let particles = &self.objective.particles;
        for (vertex, v) in self.velocities.iter_mut().enumerate() {
            *v = if particles.is_prescribed(vertex) {
                state.velocities[vertex]
            } else {
                self.point.displacement[vertex] / dt
            };
            if !is_finite(&self.point.positions[vertex]) || !is_finite(v) {
                return Err(StepError::NonFinite { vertex, step });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_core::cloth::{Cloth, Membrane};
    use cloth_core::mesh::generate::{Diagonals, grid};

    #[test]
    fn a_coarse_grid_that_is_made_anew_or_missing_is_reported() {
        let mesh = grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let cloth = Cloth {
            areal_density: 0.2,
            membrane: Membrane::SpringStiffness(1e3),
            bending_rigidity: 1e-5,
        };
        let mut model = cloth.on(&mesh).unwrap();
        model.particles.prescribe(72).unwrap();
        let mut solver = PdSolver::builder(&model.particles)
            .energy(model.springs)
            .coarse_grid(mesh.positions(), 4)
            .config(PdConfig {
                // So few that a change of the factor costs less than a factorisation.
                iterations: Some(10),
                ..PdConfig::default()
            })
            .build()
            .unwrap();
        let mut state = State::at_rest(mesh.positions().to_vec());
        let mut step = |solver: &mut PdSolver| {
            // A vertex that is grabbed here stays where it is.
            state.velocities[80] = Vec3::zeros();
            let input = StepInput::new(0.01).gravity(Vec3::z() * -9.81);
            let report = solver.step(&mut state, input).unwrap();
            (
                report.factorizations,
                report.coarse_builds,
                report.coarse_fallbacks,
            )
        };
        assert_eq!(step(&mut solver), (1, 0, 0));
        solver.prescribe(80).unwrap();
        assert_eq!(step(&mut solver), (0, 1, 0));
        // As after a grid that could not be made.
        solver.coarse = None;
        assert_eq!(step(&mut solver), (0, 0, 1));
        // The next change tries again.
        solver.release(80).unwrap();
        assert_eq!(step(&mut solver), (0, 1, 0));
    }
}

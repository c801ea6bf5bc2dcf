//! Implicit integrators as minimisations of an incremental potential.
//!
//! The forces are taken where they are not known yet. Implicit Euler, implicit midpoint and BDF2 all do it
//! by one *stage*: from a base `x_b`, `v_b` over a time `τ`,
//!
//! ```text
//! v = v_b + τ (M⁻¹ f(x) + g − α v)
//! x = x_b + τ v
//! ```
//!
//! | integrator | base | τ | after the stage |
//! |---|---|---|---|
//! | implicit Euler | `x[0]`, `v[0]` | Δt | that is the end |
//! | implicit midpoint | `x[0]`, `v[0]` | Δt/2 | as far again: `x[1] = 2x − x[0]`, `v[1] = 2v − v[0]` |
//! | BDF2 | `(4x[0] − x[−1])/3`, `(4v[0] − v[−1])/3` | 2Δt/3 | that is the end |
//!
//! Without the velocity, a stage says that `x` is a stationary point of `‖x − x̂‖²_M/(2s²) + E(x)` with
//! `s² = τ²/(1 + ατ)` and `x̂ = x_b + τ v_b/(1 + ατ) + s² g`: the drag α only changes two numbers. The modules below:
//! the function in `stage`, `damper` and `air_drag`, the loops in `minimizer` (default) and `newton`, the matrix in
//! `system`, the step length in `line_search` and, where there is contact, the core's
//! [`TrustRadius`](cloth_core::method::trust::TrustRadius).
//!
//! **Existence and uniqueness.** E is at least 0 (for elements that are sums of squares), so G grows like `‖x‖²` and
//! has a minimum, and the iterates of a descent stay in a bounded set. A convex set on which the Hessian of G is
//! positive definite holds one stationary point at most: for springs, as `‖p₀ − p₁‖² ≤ 2 ‖p₀‖² + 2 ‖p₁‖²`, a set where
//! `m/s² > 2 Σ k max(0, L/l − 1)` at every vertex, with the sum over its springs. No s ensures that everywhere, since
//! L/l has no bound. At `l = 0` a spring with L > 0 has no gradient: its energy falls by kL per length in every
//! direction, so no local minimum of G has such a spring with a free end.
//!
//! One step is `Implicit::advance`: it sets x_b, x̂ and the start of the iteration (`predict`), minimises
//! (`Minimizer`), checks that the result is finite, and only then writes the state. So another integrator of one stage
//! is a row of the table: a `Stepper` that calls `advance` with its τ and a closure for x_b and v_b
//! ([`ImplicitMidpoint`] in ten lines; [`Bdf2`] with what it keeps of earlier steps). Its tests: the amplitude and
//! angle of one oscillation (`tests/chapter/second_order.rs`, `damping.rs`), and a line in `all`
//! (`tests/chapter/main.rs`) and in `solvers` (`order.rs`), which take it through momenta, free fall, pins, refusals
//! and the order of accuracy.

mod air_drag;
mod at_end;
mod bdf2;
mod builder;
mod damper;
mod drift;
mod energy_guard;
mod line_search;
mod linearized;
mod minimizer;
mod newton;
mod piecewise;
mod progress;
mod quasi_newton;
mod stage;
mod system;
mod work;

pub use bdf2::Bdf2;
pub use builder::ImplicitBuilder;

use crate::config::{ImplicitConfig, Solve, StartGuess};
use air_drag::AirDrag;
use at_end::{AtEnd, EndContactMemory};
use cloth_core::contact::{ContactPotential, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::IncrementalPotential;
use cloth_core::method::family::Energies;
use cloth_core::method::in_contact::EXPECTED_CHANGE;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};
use damper::Damper;
use energy_guard::{Ended, EnergyGuard};
use minimizer::{Minimizer, Task};
use stage::Stage;

/// Implicit Euler: every step is a minimum of `G`, found by a quasi-Newton method around multigrid
/// ([`Solve::QuasiNewton`]) or by Newton's method, with a line search.
///
/// Of first order, and heavily damped: an oscillation ω shrinks by `1/√(1 + (Δt ω)²)` a step, where Δt ω is small by
/// `1 − ½ (Δt ω)²`: as much as by a stiffness damping of β = Δt ([`Damping`](crate::Damping)). Stable for any step:
/// with W the sum of the elastic energy E and that of gravity and load, `½ ‖v[1]‖²_M + W(x[1])` is never above
/// `½ ‖v[0]‖²_M + W(x[0])` where E is convex: `W(x[0]) − W(x[1]) ≥ ∇W(x[1])·(x[0] − x[1])`, the right side is
/// `v[1]·M(v[1] − v[0])` by `∇W(x[1]) = −M(v[1] − v[0])/Δt` and `x[0] − x[1] = −Δt v[1]`, and that is
/// `½ ‖v[1]‖²_M − ½ ‖v[0]‖²_M + ½ ‖v[1] − v[0]‖²_M`, whose last term is lost besides. Springs are not convex where they
/// are compressed. There a descent from `x[0]` ([`StartGuess::Previous`]) guarantees `G(x[1]) ≤ G(x[0])`, that is
/// `½ ‖v[1] − v[0]‖²_M + W(x[1]) ≤ ½ ‖v[0]‖²_M + W(x[0])`, and no more.
///
/// Linear momentum of cloth that nothing holds or touches is kept to rounding, whatever the tolerance, by
/// [`Solve::QuasiNewton`] and [`Solve::Linearized`]: the iteration ends with a shift to where the momentum takes the
/// cloth; with contacts in the input only if nothing is held, and for all components together. In Newton's method it is
/// kept as exactly as the linear systems are solved. Angular momentum is not: with `x[0] = x[1] − Δt v[1]` and
/// `m v[0] = m v[1] − Δt f` for the elastic forces f at `x[1]`, which have no moment about any point, it changes by
/// `−Δt² Σ v[1] × f` in a step.
///
/// With [`Solve::Linearized`] its name is `linear-implicit`, and from the start `x[0]`, as by
/// [`ImplicitConfig::linearized`], it is the step of Baraff and Witkin. With contact, what touches nothing takes the
/// same step. Elsewhere:
/// - The cloth is linearised and contact is not: at the start of the step it does not touch yet what it meets in the
///   step, so a linearised contact would miss that.
/// - The quadratic function of the cloth and the contact potential are minimised together, to the tolerance.
/// - A sheet that is stopped buckles, which the quadratic function does not contain. If `G` has decreased by less than
///   three quarters of what the quadratic function has, the cloth is linearised again at the minimum, up to eight times
///   in all.
///
/// Damping: drag acts with the velocity at the end of the step. Stiffness damping acts with that velocity too, and with
/// the stiffness at `x[0] + Δt v[0]`. With `2γ = α + β ω²` as at [`Damping`](crate::Damping) and z = Δt ω, the step of
/// an oscillation has the inverse of a matrix with the eigenvalues `1 + Δt γ ± √((Δt γ)² − z²)`. Where Δt γ < z they
/// are complex, and the amplitude is multiplied by `1/√(1 + 2 Δt γ + z²)`; an overdamped motion has two real factors.
///
/// The residual in the report is what [`ImplicitConfig::tolerance`] bounds: the Newton decrement relative to the change
/// of velocity that all forces but gravity and load have made. A step may end earlier by its upper bound
/// `‖∇G(x)‖/‖M (x − x̃)/Δt²‖` in the norm of M⁻¹. A step has converged when it is below the tolerance, or when the
/// gradient is as small as rounding lets it be: positions are stored to half a unit in the last place of their
/// coordinates, `½ ε |x|`, and a spring answers that with a force of `½ ε |x| k`. For a sheet of 1 m with springs of
/// 10⁴ N/m and Δt = 1/60 s this floor lies between 10⁻⁸ and 10⁻¹⁰ of the forces. In free fall there are no forces, and
/// the floor decides alone.
///
/// Prescribed vertices are those of the particles the solver was built for. They end at `x[0] + Δt v[0]`, and their
/// rows and columns leave the system: gradient and inverse mass are zero there. The levels of multigrid are laid out in
/// the first step, by the rest positions of the particles if these are known
/// ([`Particles::rest_positions`](cloth_core::particles::Particles::rest_positions)), else by the positions it starts
/// from; the memory that Newton's method needs is taken when it is first called.
///
/// # Force at a pin
/// The elastic force with which the cloth pulls at a pin is `−∂E/∂x` at the end of the step. A mass on a spring, at
/// rest after one very long step, pulls with its weight:
///
/// ```
/// use cloth_massspring::cloth_core::method::family::Energies;
/// use cloth_massspring::{ImplicitConfig, ImplicitEuler, Particles, Spring, State, StepInput, Stepper, Vec3};
///
/// let spring = Spring { vertices: [0, 1], rest_length: 1.0, stiffness: 500.0 };
/// let mut particles = Particles::new(vec![1.0, 2.0])?;             // kg
/// particles.prescribe(0)?;
/// let config = ImplicitConfig { tolerance: 0.0, ..ImplicitConfig::default() };
/// let mut solver = ImplicitEuler::builder(&particles).energy(vec![spring]).config(config).build()?;
/// let mut state = State::at_rest(vec![Vec3::zeros(), -Vec3::z()]);
/// solver.step(&mut state, StepInput::new(1e6).gravity(Vec3::new(0.0, 0.0, -9.81)))?;
/// let mut gradient = vec![Vec3::zeros(); 2];
/// Energies::new(2).with(vec![spring])?.add_gradient(&state.positions, &mut gradient);
/// assert!((-gradient[0].z / (-2.0 * 9.81) - 1.0).abs() < 1e-6);    // N
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Whatever holds the pin bears its mass besides. The equation of the pin, which is not solved, is
/// `m a = m g − ∂E/∂x + F`, with a its prescribed acceleration and F the force of the holder (without air, load and
/// contact at the pin). So `F = ∂E/∂x + m (a − g)`. At rest the reported forces of all pins add up to the weight of the
/// free vertices, and the F to minus the weight of all. (1 kg of the example above is in F only.)
///
/// # Errors of a step
/// [`StepError::LineSearchStalled`] where no lower point is found though the gradient is more than a hundred times what
/// rounding explains; [`StepError::NotPositiveDefinite`] under [`HessianPolicy::Always`](crate::HessianPolicy::Always)
/// of a Hessian that may be indefinite, with an energy of the caller's whose clamped Hessian is, or where an iterative
/// solver loses a nearly singular matrix to rounding, unless Newton's method has taken over where the quasi-Newton
/// method was stuck; [`StepError::NonFinite`] where numbers overflow.
#[derive(Debug)]
pub struct ImplicitEuler(Implicit);

/// The implicit midpoint rule: the forces in the middle of the step, at `(x[0] + x[1])/2`.
///
/// Second order, time-reversible and symplectic. An oscillation ω keeps its amplitude whatever the step, and turns by
/// `2 atan(Δt ω/2)`: a quadratic energy is kept to rounding, linear momentum as in [`ImplicitEuler`], angular momentum
/// to the tolerance. Without damping, gravity and contact `x[1] − x[0] = Δt v̄` and `M(v[1] − v[0]) = Δt f(x̄)`, with
/// the means `x̄` and `v̄` of both ends:
/// - The kinetic energy changes by `v̄·M(v[1] − v[0]) = f(x̄)·(x[1] − x[0])`, and `½ xᵀKx` by the negative of that.
/// - Angular momentum changes by `Σ m (x̄ × (v[1] − v[0]) + (x[1] − x[0]) × v̄) = Δt Σ x̄ × f(x̄)`, as `v̄ × v̄ = 0`.
///   Elastic forces have no moment.
/// - Any other E changes by `∇E(x̄)·Δx` and a remainder, which is what the total energy gains: a 24th of the third
///   derivative along `Δx`, and more of fifth order. With l and n of the middle, and e the change of `x₀ − x₁` in the
///   step, it is `k L (n·e) ‖e − (n·e) n‖²/(8 l²)` for a spring: 0 for L = 0, and else of the sign of n·e.
///
/// The price: nothing dies out, and that holds for modes that the step does not resolve, too. With `Δt ω ≫ 2` they turn
/// by almost half a circle a step and appear as a vertex-to-vertex ringing that goes on for ever. Nor is the energy of
/// springs of length L > 0 kept, which is not quadratic: where they are stiff and the step is long, it grows without
/// bound, though every stage has its minimum. A sheet of 8 × 8 vertices on springs of 10⁴ N/m gains more than 10³ J
/// within 300 steps of 1/60 s (a test says so). Use it where the step resolves the fastest oscillation, `Δt ω < 2` or
/// so; for cloth at large steps take [`Bdf2`].
///
/// It is half a step of implicit Euler, whose change of x and v is then added once more. Damping: drag and stiffness
/// act with the velocity in the middle, both with second order. An oscillation with `2γ = α + β ω²` is multiplied by
/// `(2 − μ)/μ`, with the eigenvalues `μ = 1 + ½ Δt γ ± ½ √((Δt γ)² − z²)` of half a step of implicit Euler. For γ < ω
/// the modulus is `√((1 − Δt γ + z²/4)/(1 + Δt γ + z²/4))`, the less the larger γ; for γ > ω the larger μ grows with γ,
/// and where z > 2 its factor nears −1. So, whatever α and β, one of the two factors of a mode with z > 2 is at least
/// `(z − 2)/(z + 2)` in size, that of γ = ω: damping does not stop the ringing of stiff modes.
///
/// Prescribed vertices pass the middle at `x[0] + ½ Δt v[0]`.
///
/// Contact acts at the end of the step, and takes up motion as in implicit Euler: what it stops does not bounce. But
/// the ringing grows faster in it. Where the cloth in contact moves with more than a hundred times the energy that it
/// had and was given, the step is refused, [`StepError::EnergyGrowth`]; in air it is not looked at. Contacts have
/// ended that step: to take it again by another method, take it back there too (`PotentialContacts::take_back`).
///
/// Other errors, and the residual, are those of [`ImplicitEuler`], for the stage in the middle. An observer is shown
/// positions in the middle too.
///
/// E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical Integration*, 2006, II.1.1,
/// <https://doi.org/10.1007/3-540-30666-8>.
#[derive(Debug)]
pub struct ImplicitMidpoint(Implicit);

impl ImplicitEuler {
    /// Starts the description of a solver for these particles.
    #[must_use]
    pub fn builder(particles: &Particles) -> ImplicitBuilder<Self> {
        ImplicitBuilder::new(particles, Self)
    }

    /// The settings.
    #[must_use]
    pub fn config(&self) -> &ImplicitConfig {
        &self.0.config
    }
}

impl ImplicitMidpoint {
    /// Starts the description of a solver for these particles.
    #[must_use]
    pub fn builder(particles: &Particles) -> ImplicitBuilder<Self> {
        ImplicitBuilder::new(particles, Self)
    }
}

impl Stepper for ImplicitEuler {
    fn name(&self) -> &'static str {
        match self.0.config.solve {
            Solve::QuasiNewton | Solve::Newton => "implicit-euler",
            Solve::Linearized => "linear-implicit",
        }
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.0.particles.len())?;
        self.0.advance_euler(state, &mut input)
    }
}

impl Stepper for ImplicitMidpoint {
    fn name(&self) -> &'static str {
        "implicit-midpoint"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.0.particles.len())?;
        let interval = Interval {
            tau: 0.5 * input.dt,
            at: TimePoint::Middle,
        };
        self.0
            .advance(state, &mut input, interval, |_, x, v| [x, v])
    }
}

/// The time interval of a stage.
#[derive(Clone, Copy, Debug)]
struct Interval {
    /// τ (s).
    tau: Real,
    at: TimePoint,
}

impl Interval {
    /// That of implicit Euler.
    fn euler(dt: Real) -> Self {
        Self {
            tau: dt,
            at: TimePoint::End,
        }
    }
}

/// Which point in time a stage solves for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TimePoint {
    /// The end of the step.
    End,
    /// Its middle; the end is as far again.
    Middle,
}

/// What is said where Newton's method meets contact.
const NOT_NEWTON: &str = "Newton's linear systems have no place for contact, the quasi-Newton method has (`Solve::QuasiNewton`)";

/// What all implicit integrators are made of.
#[derive(Debug)]
struct Implicit {
    particles: Particles,
    energies: Energies,
    config: ImplicitConfig,
    /// `x_b` (m).
    base: Vec<Vec3>,
    /// `x̂` (m).
    predicted: Vec<Vec3>,
    /// `v_b` (m/s) and τ (s) of the last stage.
    before: (Vec<Vec3>, Real),
    damper: Option<Damper>,
    /// Where the stage would end with the velocities before it (m); empty without air.
    constant_velocity_positions: Vec<Vec3>,
    minimizer: Minimizer,
    /// For contact at the end of a step that is solved for its middle.
    end_contact: EndContactMemory,
    guard: EnergyGuard,
}

impl Implicit {
    /// A step of implicit Euler.
    fn advance_euler(
        &mut self,
        state: &mut State,
        input: &mut StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        self.advance(state, input, Interval::euler(input.dt), |_, x, v| [x, v])
    }

    /// A step by one stage. `base` gives `x_b` and `v_b` of a vertex from its number, position and velocity.
    fn advance(
        &mut self,
        state: &mut State,
        input: &mut StepInput<'_>,
        interval: Interval,
        base: impl Fn(usize, Vec3, Vec3) -> [Vec3; 2],
    ) -> Result<StepReport, StepError> {
        let report = self.solve(state, input, interval, base)?;
        self.finish(state, input, interval, report)
    }

    /// Solves a stage; nothing is final before [`finish`](Self::finish).
    fn solve(
        &mut self,
        state: &State,
        input: &mut StepInput<'_>,
        interval: Interval,
        base: impl Fn(usize, Vec3, Vec3) -> [Vec3; 2],
    ) -> Result<StepReport, StepError> {
        if self.config.solve == Solve::Newton && input.contacts.is_some() {
            return Err(StepError::ContactNotFelt { remedy: NOT_NEWTON });
        }
        let step = state.steps + 1;
        let until_then = match interval.at {
            TimePoint::End => input.dt,
            TimePoint::Middle => 0.5 * input.dt,
        };
        let is_middle = interval.at == TimePoint::Middle;
        let is_guarded = is_middle && input.contacts.is_some() && input.air.is_none();
        match is_guarded {
            true => (self.guard).begin(&self.particles, state, &self.predicted),
            false => self.guard.forget(),
        }
        let of_time = self.energies.timed_value(&state.positions);
        self.energies.set_time(state.time + until_then);
        self.guard
            .add(self.energies.timed_value(&state.positions) - of_time);
        // 1/(1 + ατ). (The drag of `input.air` is another one, D.)
        let slowing = 1.0 / (1.0 + self.config.damping.air_drag * interval.tau);
        let from_elsewhere = is_middle && !self.continues(state);
        self.predict(state, input, interval, slowing, base);
        let mut report = StepReport::new(Outcome::Converged, 0);
        let source = input.contacts.as_deref_mut();
        let contact = source.map(|source| source.potential());
        if is_middle && contact.is_some() {
            let (w, s) = (self.particles.inverse_mass(), interval.tau * slowing.sqrt());
            let predicted = &mut self.predicted;
            self.end_contact
                .apply_lasting_force(from_elsewhere, w, s, predicted);
        }
        let mut at_end;
        let mut contact = match (contact, interval.at) {
            (Some(contact), TimePoint::Middle) => {
                at_end = AtEnd {
                    contact,
                    start: &state.positions,
                    memory: &mut self.end_contact,
                };
                Some(&mut at_end as &mut dyn ContactPotential)
            }
            (contact, _) => contact,
        };
        let task = Task {
            stage: Stage {
                potential: IncrementalPotential {
                    particles: &self.particles,
                    energies: &self.energies,
                    predicted: &self.predicted,
                    dt: interval.tau * slowing.sqrt(),
                },
                damper: self.damper.as_ref(),
                air: input.air.as_deref().map(|air| AirDrag {
                    drag: air.drag(),
                    constant_velocity_positions: &self.constant_velocity_positions,
                    tau: interval.tau,
                }),
                linearized: None,
                contact: None,
            },
            config: &self.config,
            before: &state.positions,
            step,
        };
        if let Some(contact) = &mut contact {
            let taken = ContactStep {
                from: &state.positions,
                inverse_mass: self.particles.inverse_mass(),
                dt: input.dt,
            };
            let begun = self
                .minimizer
                .begin_contact(&taken, &self.energies, *contact);
            begun.map_err(|reason| StepError::Contact { reason, step })?;
        }
        if self.particles.free_count() > 0 {
            let observer = input.observer.take();
            report = self.minimizer.minimize(&task, observer, contact)?;
            report.unfinished = u32::from(report.outcome == Outcome::BudgetSpent);
        }
        Ok(report)
    }

    /// Takes the solution of a stage for the step.
    fn finish(
        &mut self,
        state: &mut State,
        input: &mut StepInput<'_>,
        interval: Interval,
        mut report: StepReport,
    ) -> Result<StepReport, StepError> {
        let step = state.steps + 1;
        let is_middle = interval.at == TimePoint::Middle;
        let asks = input.begin_pin_forces(self.particles.len());
        // A linearised step has moved the cloth by other forces than those where it ends.
        report.tells_pin_forces = asks && self.config.solve != Solve::Linearized;
        report.pin_work = self.pin_work(state, input, report.tells_pin_forces);
        let overflow = |vertex: &usize| {
            let [x, v] = self.end(*vertex, state, input.dt, interval);
            !x.iter().chain(&v).all(|c| c.is_finite())
        };
        if let Some(vertex) = (0..self.particles.len()).find(overflow) {
            return Err(StepError::NonFinite { vertex, step });
        }
        for vertex in 0..self.particles.len() {
            let [x, v] = self.end(vertex, state, input.dt, interval);
            // The stage is done with, and its buffers are free for the end.
            (self.predicted[vertex], self.base[vertex]) = (x, v);
        }
        if let Some(air) = &mut input.air {
            // With the velocity of the stage, which is not yet that of the end in the middle of the step.
            let starts = (&mut self.constant_velocity_positions, &state.velocities);
            for (vertex, (speed, before)) in starts.0.iter_mut().zip(starts.1).enumerate() {
                *speed = match interval.at {
                    TimePoint::End => self.base[vertex],
                    TimePoint::Middle => (self.base[vertex] + before) * 0.5,
                };
            }
            let w = self.particles.inverse_mass();
            air.end(&self.predicted, &self.constant_velocity_positions, w);
        }
        if let Some(source) = input.contacts.take() {
            let (x, v) = (&mut self.predicted, &mut self.base);
            let contact = source.potential();
            if is_middle {
                let w = self.particles.inverse_mass();
                self.end_contact
                    .correct_velocities(contact, x, w, input.dt, v);
            }
            contact.end(x, v);
            let (of_contact, stored) = (source.work(), source.potential_energy());
            if is_middle && input.air.is_none() {
                let work = of_contact + report.pin_work.unwrap_or(0.0);
                let ended = self.guard.end(&Ended {
                    particles: &self.particles,
                    energies: &self.energies,
                    positions: &self.predicted,
                    velocities: &self.base,
                    dt: input.dt,
                    work: work + self.steady_work(state, input),
                    stored,
                    step,
                });
                if let Err(gain) = ended {
                    source.take_back();
                    return Err(gain);
                }
            }
        }
        state.positions.copy_from_slice(&self.predicted);
        state.velocities.copy_from_slice(&self.base);
        state.time += input.dt;
        state.steps = step;
        Ok(report)
    }

    /// Whether contact pushes where the stage was solved.
    fn is_touching(&mut self, input: &mut StepInput<'_>) -> bool {
        let contact = input.contacts.as_deref_mut();
        let (x, scratch) = (
            &self.minimizer.current.positions,
            &mut self.minimizer.next.gradient,
        );
        contact.is_some_and(|source| source.potential().add_gradient(x, scratch) > 0.0)
    }

    /// Fills in the base, the prediction, the damper and the start of the minimisation.
    fn predict(
        &mut self,
        state: &State,
        input: &mut StepInput<'_>,
        interval: Interval,
        slowing: Real,
        base: impl Fn(usize, Vec3, Vec3) -> [Vec3; 2],
    ) {
        let tau = interval.tau;
        // The base of a step of BDF2 goes on with the change already. In contact what slides is the nearer to where it
        // will be.
        let is_bdf2_alone = tau < input.dt && input.contacts.is_none();
        let follows = interval.at == TimePoint::End
            && !is_bdf2_alone
            && self.before.1 == tau
            && self.continues(state);
        self.before.1 = tau;
        if let Some(air) = &mut input.air {
            air.linearize(&state.positions, &state.velocities);
        }
        let start = &mut self.minimizer.current.positions;
        for (vertex, &w) in self.particles.inverse_mass().iter().enumerate() {
            let (x, v) = (state.positions[vertex], state.velocities[vertex]);
            if w == 0.0 {
                let there = x + v * match interval.at {
                    TimePoint::End => input.dt,
                    TimePoint::Middle => 0.5 * input.dt,
                };
                self.base[vertex] = there - v * tau;
                self.predicted[vertex] = there;
                start[vertex] = there;
            } else {
                let [from, speed] = base(vertex, x, v);
                let pull = input.external_acceleration(vertex, w) * tau;
                self.base[vertex] = from;
                self.predicted[vertex] = from + (speed + pull) * (tau * slowing);
                start[vertex] = from + speed * tau;
            }
        }
        if input.air.is_some() {
            let starts = self.base.iter().zip(&state.velocities);
            self.constant_velocity_positions.clear();
            self.constant_velocity_positions
                .extend(starts.map(|(x, v)| x + v * tau));
        }
        if let Some(damper) = &mut self.damper {
            let path = [&self.base[..], &start[..]];
            let is_second_order = interval.at == TimePoint::Middle || tau < input.dt;
            damper.set(&self.energies, path, tau, is_second_order);
        }
        for (vertex, start) in start.iter_mut().enumerate() {
            let speed = (*start - self.base[vertex]) / tau;
            let change = speed - std::mem::replace(&mut self.before.0[vertex], speed);
            match self.config.start {
                _ if self.particles.is_prescribed(vertex) => {}
                StartGuess::Extrapolated if follows => *start += change * (EXPECTED_CHANGE * tau),
                StartGuess::Inertial | StartGuess::Extrapolated => {}
                StartGuess::Previous => *start = state.positions[vertex],
                StartGuess::Predicted => *start = self.predicted[vertex],
            }
        }
    }

    /// Whether the state is the one that the last step left.
    fn continues(&self, state: &State) -> bool {
        let is_kept = |vertex| {
            state.positions[vertex] == self.predicted[vertex]
                && (self.particles.is_prescribed(vertex)
                    || state.velocities[vertex] == self.base[vertex])
        };
        (0..self.particles.len()).all(is_kept)
    }

    /// Position (m) and velocity (m/s) of a vertex at the end of the step, from the stage.
    fn end(&self, vertex: usize, state: &State, dt: Real, interval: Interval) -> [Vec3; 2] {
        let (x, v) = (state.positions[vertex], state.velocities[vertex]);
        if self.particles.is_prescribed(vertex) {
            return [x + v * dt, v];
        }
        let there = self.minimizer.current.positions[vertex];
        let speed = (there - self.base[vertex]) / interval.tau;
        match interval.at {
            TimePoint::End => [there, speed],
            TimePoint::Middle => [there * 2.0 - x, speed * 2.0 - v],
        }
    }
}

//! Forward Euler and symplectic Euler.
//!
//! Forces at the start of the step; then:
//!
//! ```text
//! v[1] = v[0] + Δt (M⁻¹ f(x[0]) + g)
//! x[1] = x[0] + Δt v[1]          symplectic (semi-implicit) Euler
//! x[1] = x[0] + Δt v[0]          forward (explicit) Euler
//! ```
//!
//! Only the index of one velocity differs. The drag α and the stiffness damping β of [`Damping`](crate::Damping) are
//! taken with `v[0]`. The resistance of the air, [`StepInput::air`], alone is taken with `v[1]`, which costs a block of
//! 3 × 3 a vertex ([`cloth_core::air`]). Forward Euler lets every oscillation grow by `√(1 + z²)` a step (`z = Δt ω`),
//! symplectic Euler keeps it bounded for ever as long as `z < 2`.

mod builder;
mod monitor;

pub use builder::ExplicitBuilder;

use crate::config::{ExplicitConfig, StabilityCheck};
use cloth_core::air::implicit;
use cloth_core::contact::{ContactError, ContactStep, Projection};
use cloth_core::element::Convexity;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::family::Energies;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};
use monitor::StabilityMonitor;

/// Which velocity moves the positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scheme {
    /// The old one, `v[0]`.
    Forward,
    /// The new one, `v[1]`.
    Symplectic,
}

/// Forward Euler, `x[1] = x[0] + Δt v[0]`: for comparison, not for use.
///
/// No step is small enough for it: a mode of frequency ω grows by `√(1 + (Δt ω)²)` a step, about `½ Δt ω²` per
/// second. Steps beyond the limit of [`SymplecticEuler`] are refused, below it the run goes on until it
/// has gained energy from nowhere; both end with [`StepError::Unstable`], whose `stable_dt` is 0 because no step is
/// stable.
///
/// Damping acts as it does in [`SymplecticEuler`]. A damped oscillation is stable for `Δt ω² < α + β ω²` and
/// `2 Δt (α + β ω²) < 4 + (Δt ω)²`, the second for what is overdamped; that limit is not computed, and `stable_dt`
/// stays 0.
#[derive(Debug)]
pub struct ExplicitEuler(Explicit);

/// Symplectic (semi-implicit) Euler, `v[1] = v[0] + Δt (M⁻¹ f(x[0]) + g)`, `x[1] = x[0] + Δt v[1]`.
///
/// First order, stable for `Δt ω < 2` in every oscillation ω of the cloth. The energy stays within a band around its
/// true value, wide where `Δt ω` is near 2; linear and angular momentum are kept to rounding: as `x[1]` differs from
/// `x[0]` by a multiple of `v[1]`, `Σ m x[1] × v[1] = Σ m x[0] × v[1] = Σ m x[0] × v[0] + Δt Σ x[0] × f(x[0])`, and
/// elastic forces have no moment. (With `v[0]` in its place, forward Euler gains `Δt² Σ v[0] × f(x[0])` a step.)
///
/// Damping acts with the velocities (and the stiffness) at the start of the step, of first order like the rest. It
/// shortens the stable step to that with `(Δt ω)² + 2 Δt (α + β ω²) = 4`: stiffness damping in an explicit step costs
/// more than it saves.
///
/// With [`StabilityCheck::Watch`] a step (or substep) beyond [`crate::stable_time_step`] (shortened by damping) is
/// refused with [`StepError::Unstable`]. The estimate is made before the first step and repeated every 256 substeps or
/// whenever the kinetic energy has grown fourfold, because springs that are stretched are stiffer across their axis;
/// with contacts in the input it is repeated in every step, as contact may have stretched them. A run whose kinetic
/// energy is a hundred times what it started with and was given since (by gravity, load, pins, moving bodies and
/// elements whose energy fell below 0) ends with the same error, or with [`StepError::EnergyGain`] where the step is
/// not too large: contact has then stretched the cloth.
///
/// Stiff cloth needs tens to hundreds of substeps in a step of the size of a frame: a step of Δt needs Δt over
/// [`crate::stable_time_step`], rounded up, as [`ExplicitConfig::substeps`], and some more where springs are stretched
/// in the motion. The message of the error says by how many times they are too few.
///
/// Contact acts at the end of every substep and lets nothing through: the straight paths of all vertices from the start
/// of the substep are tested. Pairs that would come too near or cross are projected again; what is not free even then
/// is cut back, moved as one rigid body or, last, left where it was. Where no free path is left the step is refused,
/// [`StepError::Contact`]. A test is `sheet_falls_on_a_ball` in `cloth-bench/tests/contract/rows.rs`. A vertex whose
/// displacement is truncated loses momentum, and nothing brings contact into balance with the springs as a minimum
/// does: the constraints take one sweep a substep, and more only where a path is not free.
#[derive(Debug)]
pub struct SymplecticEuler(Explicit);

impl ExplicitEuler {
    /// Starts the description of a solver for these particles.
    #[must_use]
    pub fn builder(particles: &Particles) -> ExplicitBuilder<Self> {
        ExplicitBuilder::new(particles, |model| {
            Self(Explicit::new(Scheme::Forward, model))
        })
    }
}

impl SymplecticEuler {
    /// Starts the description of a solver for these particles.
    #[must_use]
    pub fn builder(particles: &Particles) -> ExplicitBuilder<Self> {
        ExplicitBuilder::new(particles, |model| {
            Self(Explicit::new(Scheme::Symplectic, model))
        })
    }
}

impl Stepper for ExplicitEuler {
    fn name(&self) -> &'static str {
        "explicit-euler"
    }

    fn step(&mut self, state: &mut State, input: StepInput<'_>) -> Result<StepReport, StepError> {
        self.0.step(state, input)
    }
}

impl Stepper for SymplecticEuler {
    fn name(&self) -> &'static str {
        "symplectic-euler"
    }

    fn step(&mut self, state: &mut State, input: StepInput<'_>) -> Result<StepReport, StepError> {
        self.0.step(state, input)
    }
}

/// Particles, energies and settings of an explicit solver.
#[derive(Debug)]
struct Model {
    particles: Particles,
    energies: Energies,
    config: ExplicitConfig,
}

/// An explicit solver of either scheme.
#[derive(Debug)]
struct Explicit {
    scheme: Scheme,
    model: Model,
    /// Positions (m) and velocities (m/s) during the step; the caller's change when it has succeeded.
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
    /// `∂E/∂x` (N).
    gradient: Vec<Vec3>,
    /// `β v` (m); empty without stiffness-proportional damping.
    rate: Vec<Vec3>,
    /// Positions (m) before a substep; empty while no contact is felt.
    start: Vec<Vec3>,
    projection: Projection,
    monitor: Option<StabilityMonitor>,
}

impl Explicit {
    fn new(scheme: Scheme, model: Model) -> Self {
        let zeros = vec![Vec3::zeros(); model.particles.len()];
        let monitor = match model.config.stability {
            StabilityCheck::Watch => Some(StabilityMonitor::new(&model.particles)),
            StabilityCheck::Off => None,
        };
        let damped = model.config.damping.stiffness > 0.0;
        Self {
            scheme,
            rate: if damped { zeros.clone() } else { Vec::new() },
            model,
            positions: zeros.clone(),
            velocities: zeros.clone(),
            gradient: zeros,
            start: Vec::new(),
            projection: Projection::default(),
            monitor,
        }
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.model.particles.len())?;
        let tells_pin_forces = input.begin_pin_forces(self.model.particles.len());
        self.positions.copy_from_slice(&state.positions);
        self.velocities.copy_from_slice(&state.velocities);
        self.model.energies.set_time(state.time);
        let (step, dt) = (state.steps + 1, input.dt);
        if let Some(contacts) = input.contact_constraints() {
            let taken = ContactStep {
                from: &state.positions,
                inverse_mass: self.model.particles.inverse_mass(),
                dt,
            };
            let begun = contacts.begin_step(&taken);
            begun.map_err(|reason| StepError::Contact { reason, step })?;
        }
        let mut is_anew = false;
        if let Some(monitor) = &mut self.monitor {
            let contacts = input.contacts.as_ref();
            let stored = contacts.map_or(0.0, |contacts| contacts.potential_energy());
            is_anew = monitor.begin(&self.model, &self.positions, &self.velocities, stored);
        }
        let substeps = self.model.config.substeps;
        let mut pin_work = 0.0;
        for substep in 1..=substeps {
            let part = |number: u32| dt * Real::from(number) / Real::from(substeps);
            let times = [substep - 1, substep].map(|number| state.time + part(number));
            let work = self.set_time(times);
            match self.substep(&mut input, work) {
                Ok(balance) => pin_work += balance.pin_work,
                Err(failure) => return Err(self.report(failure, &input, step)),
            }
            if let (true, Some(monitor)) = (is_anew && substep == 1, &mut self.monitor)
                && let Some(contacts) = input.contact_constraints()
            {
                // Constraints that have pushed know what they hold where the cloth was.
                monitor.add_stored(-contacts.given(&state.positions));
            }
            if let Some(observer) = input.observer.as_deref_mut() {
                observer.iteration(substep, &self.positions);
            }
        }
        if let Some(contacts) = input.contact_constraints() {
            contacts.end_step(&self.positions);
        }
        let closing = self.set_time([state.time + dt; 2]);
        if let Some(monitor) = &mut self.monitor {
            monitor.add_work(closing);
            let touched = input.contacts.as_deref();
            let ended = monitor.end(&self.model, &self.positions, &self.velocities, touched);
            if let Err(failure) = ended {
                if let Some(contacts) = &mut input.contacts {
                    contacts.take_back();
                }
                return Err(self.report(failure, &input, step));
            }
        }
        std::mem::swap(&mut state.positions, &mut self.positions);
        std::mem::swap(&mut state.velocities, &mut self.velocities);
        state.time += input.dt;
        state.steps += 1;
        Ok(StepReport {
            pin_work: Some(pin_work),
            tells_pin_forces,
            ..StepReport::new(Outcome::Converged, substeps)
        })
    }

    /// Sets the elements to the start of a substep, where its forces are taken. Returns the work (J) on the cloth of
    /// rest data that change with time: `½ (E(x, end of this substep) − E(x, start of the one before))`, at the
    /// positions x between the two. A substep so counts half of its change at the positions of its start and half at
    /// those of its end (the trapezoidal rule). Counted at one end only, the work would have the same error, with the
    /// same sign, in every substep. In the first substep of a step there is none before, and half of its own change is
    /// counted; the other half of the last one is what a call with the end of the step gives.
    fn set_time(&mut self, [start, end]: [Real; 2]) -> Real {
        let (energies, x) = (&mut self.model.energies, &self.positions);
        let before = energies.timed_value(x);
        energies.set_time(end);
        let after = energies.timed_value(x);
        energies.set_time(start);
        0.5 * (after - before)
    }

    /// One substep, checked by the monitor; elements that change with time have done `work` (J) before it.
    fn substep(&mut self, input: &mut StepInput<'_>, work: Real) -> Result<EnergyBalance, Failure> {
        let feels_contact = input.contact_constraints().is_some();
        if feels_contact {
            self.start.clone_from(&self.positions);
        }
        let dt = input.dt / Real::from(self.model.config.substeps);
        if let Some(monitor) = &mut self.monitor {
            monitor.admit(&self.model, &self.positions, dt)?;
        }
        if let Some(air) = &mut input.air {
            air.linearize(&self.positions, &self.velocities);
        }
        self.gradient.fill(Vec3::zeros());
        let energies = &self.model.energies;
        energies.add_gradient(&self.positions, &mut self.gradient);
        let damping = self.model.config.damping;
        if damping.stiffness > 0.0 {
            for (rate, v) in self.rate.iter_mut().zip(&self.velocities) {
                *rate = v * damping.stiffness;
            }
            let (x, rate) = (&self.positions, &self.rate);
            energies.add_hessian_product(x, rate, Convexity::GaussNewton, &mut self.gradient);
        }
        let mut balance = EnergyBalance {
            work,
            ..EnergyBalance::default()
        };
        let share = 1.0 / Real::from(self.model.config.substeps);
        let particles = &self.model.particles;
        let masses = particles.mass().iter().zip(particles.inverse_mass());
        for (vertex, (&mass, &w)) in masses.enumerate() {
            let gradient = self.gradient[vertex];
            let mut external = input.external_acceleration(vertex, w);
            let before = self.velocities[vertex];
            let mut change = (external - gradient * w) * dt;
            if damping.air_drag > 0.0 && w != 0.0 {
                change -= before * (damping.air_drag * dt);
            }
            if let Some(air) = &input.air {
                let drag = &air.drag()[vertex];
                change = implicit(drag, w * dt) * change;
                external -= drag * change * w;
            }
            let after = before + change;
            self.velocities[vertex] = after;
            self.positions[vertex] += dt
                * match self.scheme {
                    Scheme::Forward => before,
                    Scheme::Symplectic => after,
                };
            if w == 0.0 {
                // The pin moves against the elastic force.
                balance.pin_work += gradient.dot(&after) * dt;
                input.add_pin_force(vertex, -gradient * share);
            } else {
                // Forward Euler moves by it in the next substep, but has its kinetic energy in this one.
                balance.work += mass * external.dot(&after) * dt;
                balance.kinetic += 0.5 * mass * after.norm_squared();
            }
        }
        if let Some(vertex) = self.first_non_finite() {
            return Err(Failure::NonFinite { vertex });
        }
        if let Some(air) = &mut input.air {
            let w = self.model.particles.inverse_mass();
            air.end_explicit(dt, &self.velocities, w);
        }
        if feels_contact {
            self.resolve_contact(input, dt)?;
        }
        if let Some(monitor) = &mut self.monitor {
            // Before the end of the step nobody knows what moving bodies have done.
            monitor.account(&self.model, &self.positions, &balance, !feels_contact)?;
        }
        Ok(balance)
    }

    /// Contact in a substep of `dt` (s), whose free end has been found: as constraints on the positions, and what they
    /// change as velocity.
    fn resolve_contact(&mut self, input: &mut StepInput<'_>, dt: Real) -> Result<(), Failure> {
        let Some(contacts) = input.contact_constraints() else {
            return Ok(());
        };
        let step = ContactStep {
            from: &self.start,
            inverse_mass: self.model.particles.inverse_mass(),
            dt,
        };
        let (x, v) = (&mut self.positions, &mut self.velocities);
        self.projection.substep(contacts, &step, 1, x, v)?;
        Ok(())
    }

    fn first_non_finite(&self) -> Option<usize> {
        let bad = |v: &Vec3| !cloth_core::math::is_finite(v);
        let both = self.positions.iter().zip(&self.velocities);
        both.enumerate()
            .find_map(|(vertex, (x, v))| (bad(x) || bad(v)).then_some(vertex))
    }

    /// Names the failure in terms of the whole step.
    fn report(&mut self, failure: Failure, input: &StepInput<'_>, step: u64) -> StepError {
        if let Some(monitor) = &mut self.monitor {
            monitor.reset();
        }
        let limit = self.monitor.as_ref().and_then(StabilityMonitor::limit);
        let limit = limit.map(|dt| dt * Real::from(self.model.config.substeps));
        let unstable = |stable_dt| StepError::Unstable {
            dt: input.dt,
            stable_dt: match self.scheme {
                Scheme::Forward => 0.0,
                Scheme::Symplectic => stable_dt,
            },
            step,
        };
        match (failure, limit) {
            (Failure::Contact { reason }, _) => StepError::Contact { reason, step },
            (Failure::NonFinite { .. }, Some(limit)) if input.dt > limit => unstable(limit),
            (Failure::NonFinite { vertex }, _) => StepError::NonFinite { vertex, step },
            (Failure::TooLarge, limit) => unstable(limit.unwrap_or(Real::INFINITY)),
            (Failure::Gain { .. }, _) if self.scheme == Scheme::Forward => unstable(0.0),
            (Failure::Gain { .. }, Some(limit)) if input.dt > limit => unstable(limit),
            (Failure::Gain { kinetic, given }, _) => StepError::EnergyGain {
                kinetic,
                given,
                step,
            },
        }
    }
}

/// Sums over the free vertices of one substep.
#[derive(Clone, Copy, Debug, Default)]
struct EnergyBalance {
    /// Kinetic energy (J) at its end.
    kinetic: Real,
    /// Work (J) done on the cloth by gravity, load and elements that change with time.
    work: Real,
    /// Work (J) done on it by pins.
    pin_work: Real,
}

impl From<ContactError> for Failure {
    fn from(reason: ContactError) -> Self {
        match reason {
            ContactError::NonFinite { vertex } => Self::NonFinite { vertex },
            reason => Self::Contact { reason },
        }
    }
}

/// Why a substep cannot be taken.
#[derive(Clone, Debug)]
enum Failure {
    /// It is beyond the stable one.
    TooLarge,
    /// The cloth has gained energy from nowhere.
    Gain {
        /// Kinetic energy (J).
        kinetic: Real,
        /// The most that it was given (J).
        given: Real,
    },
    /// Contact cannot be resolved.
    Contact {
        /// Why.
        reason: ContactError,
    },
    /// The result is not finite.
    NonFinite {
        /// The first vertex where.
        vertex: usize,
    },
}

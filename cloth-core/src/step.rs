//! The contract between a method and those who run it: one step, what goes in, what comes out.

mod build_error;

pub use build_error::BuildError;

use crate::air::Air;
use crate::contact::{ContactConstraints, ContactError, ContactPotential, ContactSource};
use crate::math::{Real, Vec3};
use crate::particles::State;
use std::fmt;

/// A method: advances a state by one step, in place, without allocating once warm.
///
/// It sets its elements to the time at which it takes their forces, mostly the end of the step
/// ([`Energies::set_time`](crate::method::family::Energies::set_time)): some have rest data that change with time.
pub trait Stepper: Send + Sync {
    /// Name of the method, as `cloth-bench list` shows it.
    fn name(&self) -> &'static str;

    /// Advances `state` by `input.dt`.
    ///
    /// Explicit methods take no step beyond their stable one ([`StepError::Unstable`]) and do not cut it by themselves:
    /// the number of their substeps is a setting of theirs.
    ///
    /// Contacts and air of the input go on with the state, and have one of their own: who keeps a state to come back to
    /// it keeps them with it. A method goes on from any state, but may take a step from one that it has not left itself
    /// as the first of all.
    ///
    /// # Errors
    /// See [`StepError`]; on error `state` is as it was before.
    ///
    /// # Panics
    /// If `state` or `input.load` does not have the number of vertices that the solver was built for.
    fn step(&mut self, state: &mut State, input: StepInput<'_>) -> Result<StepReport, StepError>;

    /// Into how many equal substeps whoever runs the method is to cut a step, each a step of its own for air, contact
    /// and pins: 1, unless the method wants smaller steps than a scene has, and feels contact as an energy, which has
    /// no substeps.
    fn preferred_substeps(&self) -> u32 {
        1
    }

    /// From the next step on these vertices are prescribed (`true`), or free again. Returns whether the method can take
    /// notice of that as it is; if not, nothing has changed, and it has to be built anew.
    ///
    /// A prescribed vertex goes on with the velocity that it has in the state: one that is to be held where it is needs
    /// a velocity of zero there.
    ///
    /// # Panics
    /// If there is no such vertex.
    fn set_prescribed(&mut self, vertices: &[usize], are_prescribed: bool) -> bool {
        let _ = (vertices, are_prescribed);
        false
    }

    /// From the next step on these elements are gone, by the numbers of their families and their own in these, as they
    /// were given to the builder, each once. Returns whether the method can take notice of that as it is; if not,
    /// nothing has changed, and it has to be built anew.
    ///
    /// # Panics
    /// If there is no such element, or no longer.
    fn remove_elements(&mut self, gone: &[[usize; 2]]) -> bool {
        let _ = gone;
        false
    }
}

/// Everything outside the cloth that acts during one step.
#[non_exhaustive]
pub struct StepInput<'a> {
    /// Step size Δt (s), positive and finite.
    pub dt: Real,
    /// Acceleration of free fall (m/s²); zero unless set.
    pub gravity: Vec3,
    /// Further forces (N), one per vertex, constant during the step.
    pub load: Option<&'a [Vec3]>,
    /// The air around the cloth, which has begun the step ([`Air::load`]); its forces come on top of the load.
    pub air: Option<&'a mut Air>,
    /// What the cloth can touch. `None`: no code for contact runs.
    pub contacts: Option<&'a mut dyn ContactSource>,
    /// Watches the iterations. `None`: nothing is computed for it.
    pub observer: Option<&'a mut dyn Observer>,
    /// Gets the forces at prescribed vertices ([`pin_forces`](Self::pin_forces)). `None`: nothing is computed for it.
    pub pin_forces: Option<&'a mut [Vec3]>,
}

impl fmt::Debug for StepInput<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StepInput")
            .field("dt", &self.dt)
            .field("gravity", &self.gravity)
            .field("load", &self.load.map(<[Vec3]>::len))
            .field("air", &self.air.is_some())
            .field("contacts", &self.contacts.is_some())
            .field("observer", &self.observer.is_some())
            .field("pin_forces", &self.pin_forces.is_some())
            .finish()
    }
}

impl<'a> StepInput<'a> {
    /// A step of `dt` (s) on which nothing acts from outside.
    #[must_use]
    pub fn new(dt: Real) -> Self {
        Self {
            dt,
            gravity: Vec3::zeros(),
            load: None,
            air: None,
            contacts: None,
            observer: None,
            pin_forces: None,
        }
    }

    /// Sets the acceleration of free fall (m/s²).
    #[must_use]
    pub fn gravity(mut self, gravity: Vec3) -> Self {
        self.gravity = gravity;
        self
    }

    /// Sets further forces (N), one per vertex.
    #[must_use]
    pub fn load(mut self, load: &'a [Vec3]) -> Self {
        self.load = Some(load);
        self
    }

    /// Sets the air.
    #[must_use]
    pub fn air(mut self, air: &'a mut Air) -> Self {
        self.air = Some(air);
        self
    }

    /// Sets what the cloth can touch, if there is anything.
    #[must_use]
    pub fn contacts(mut self, contacts: &'a mut dyn ContactSource) -> Self {
        self.contacts = contacts.can_touch().then_some(contacts);
        self
    }

    /// Sets the observer.
    #[must_use]
    pub fn observer(mut self, observer: &'a mut dyn Observer) -> Self {
        self.observer = Some(observer);
        self
    }

    /// Asks for the force (N) with which the elements pull at each prescribed vertex, the mean of the step: the
    /// opposite of that by which the method has moved the others. So the momentum of the free vertices changes by Δt times what
    /// gravity and load do to them less the sum of `out`, in a method that takes the forces of a step from its end or
    /// from its substeps. Zero at free vertices. Contact, air and the weight of the vertex itself come on top.
    ///
    /// [`StepReport::tells_pin_forces`] says whether the method has written them.
    #[must_use]
    pub fn pin_forces(mut self, out: &'a mut [Vec3]) -> Self {
        self.pin_forces = Some(out);
        self
    }

    /// For methods: sets the [`pin_forces`](Self::pin_forces) to zero. Returns whether they are asked for.
    ///
    /// # Panics
    /// If there is not one for each of `vertex_count` vertices.
    pub fn begin_pin_forces(&mut self, vertex_count: usize) -> bool {
        let Some(out) = &mut self.pin_forces else {
            return false;
        };
        assert_eq!(out.len(), vertex_count, "number of forces at pins");
        out.fill(Vec3::zeros());
        true
    }

    /// For methods: adds a force (N) to those at a prescribed vertex, if they are asked for.
    #[inline]
    pub fn add_pin_force(&mut self, vertex: usize, force: Vec3) {
        if let Some(out) = &mut self.pin_forces {
            out[vertex] += force;
        }
    }

    /// Checks what a caller can get wrong with data; every method calls it first.
    ///
    /// # Errors
    /// [`StepError::InvalidTimeStep`]; [`StepError::InvalidTime`]; [`StepError::NonFiniteInput`] for gravity, a load, a
    /// position or a velocity that is not finite; [`StepError::Contact`] where contacts do not belong to the time of
    /// the state ([`ContactSource::check_time`]).
    ///
    /// # Panics
    /// If `state`, the load or the air does not have `vertex_count` entries.
    pub fn check(&self, state: &State, vertex_count: usize) -> Result<(), StepError> {
        assert_eq!(state.positions.len(), vertex_count, "number of positions");
        assert_eq!(state.velocities.len(), vertex_count, "number of velocities");
        if !(self.dt > 0.0 && self.dt.is_finite()) {
            return Err(StepError::InvalidTimeStep { dt: self.dt });
        }
        if !state.time.is_finite() {
            return Err(StepError::InvalidTime { time: state.time });
        }
        if !crate::math::is_finite(&self.gravity) {
            return Err(StepError::NonFiniteInput {
                what: "gravity",
                vertex: None,
            });
        }
        if let Some(load) = self.load {
            assert_eq!(load.len(), vertex_count, "number of loads");
            let bad = load.iter().position(|f| !crate::math::is_finite(f));
            if bad.is_some() {
                return Err(StepError::NonFiniteInput {
                    what: "the load",
                    vertex: bad,
                });
            }
        }
        if let Some(air) = &self.air {
            assert_eq!(air.forces().len(), vertex_count, "vertices in the air");
        }
        if let Some(vertex) = state.first_non_finite() {
            return Err(StepError::NonFiniteInput {
                what: "the state",
                vertex: Some(vertex),
            });
        }
        if state.steps == u64::MAX {
            return Err(StepError::NonFiniteInput {
                what: "the number of the next step",
                vertex: None,
            });
        }
        let source = self.contacts.as_ref();
        let fits = source.map_or(Ok(()), |source| source.check_time(state.time, self.dt));
        let step = state.steps + 1;
        fits.map_err(|reason| StepError::Contact { reason, step })
    }

    /// The contacts as constraints, if there are any.
    pub fn contact_constraints(&mut self) -> Option<&mut dyn ContactConstraints> {
        Some(self.contacts.as_mut()?.constraints())
    }

    /// The contacts as an energy, if there are any.
    pub fn contact_potential(&mut self) -> Option<&mut dyn ContactPotential> {
        Some(self.contacts.as_mut()?.potential())
    }

    /// The same step with these contacts lent to it: for a method around another one that goes on with them afterwards.
    #[must_use]
    pub fn lend<'b>(self, contacts: Option<&'b mut (dyn ContactSource + 'a)>) -> StepInput<'b>
    where
        'a: 'b,
    {
        StepInput {
            dt: self.dt,
            gravity: self.gravity,
            load: self.load,
            air: self.air,
            contacts: contacts.map(|contacts| contacts as &mut dyn ContactSource),
            observer: self.observer.map(|observer| observer as &mut dyn Observer),
            pin_forces: self.pin_forces,
        }
    }

    /// Acceleration (m/s²) of a vertex of inverse mass `w` (1/kg) by gravity, load and air, whose forces are those of
    /// [`Air::forces`] now; zero for a prescribed vertex.
    #[inline]
    #[must_use]
    pub fn external_acceleration(&self, vertex: usize, w: Real) -> Vec3 {
        match &self.air {
            Some(air) => self.steady_acceleration(vertex, w) + air.forces()[vertex] * w,
            None => self.steady_acceleration(vertex, w),
        }
    }

    /// The same without the air: what is constant during the step.
    #[inline]
    #[must_use]
    pub fn steady_acceleration(&self, vertex: usize, w: Real) -> Vec3 {
        if w == 0.0 {
            return Vec3::zeros();
        }
        match self.load {
            Some(load) => self.gravity + load[vertex] * w,
            None => self.gravity,
        }
    }
}

/// Watches one step from inside.
pub trait Observer {
    /// Called after every iteration of the method, numbered from 1, with the positions (m) it has reached.
    fn iteration(&mut self, iteration: u32, positions: &[Vec3]);
}

/// Whether an iteration ended because it was done, or because it was told to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The tolerance was met (or the method has no iteration).
    Converged,
    /// The iterations were spent before the tolerance was met (or no tolerance was set).
    BudgetSpent,
}

/// What one step did: only numbers that the method has at hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// How the iteration ended.
    pub outcome: Outcome,
    /// Iterations (sweeps, Newton steps, local–global pairs), summed over the substeps.
    pub iterations: u32,
    /// Numerical factorisations of a matrix, or what an iterative solver prepares in their place.
    pub factorizations: u32,
    /// Linear systems solved.
    pub linear_solves: u32,
    /// Iterations of the linear solver in them; a direct solver takes one.
    pub linear_iterations: u32,
    /// Step lengths that a line search tried and rejected, and Chebyshev extrapolations that projective dynamics took
    /// back.
    pub backtracks: u32,
    /// Substeps that gave up their Chebyshev extrapolation, because it made the corrections grow or something can be
    /// touched, and went on with plain sweeps.
    pub chebyshev_fallbacks: u32,
    /// Times that the step was repeated with more substeps, because it would have gained energy.
    pub refinements: u32,
    /// Coarse grids made, or made anew because pins or elements had changed.
    pub coarse_builds: u32,
    /// Iterations of a step, from its start to its end, that had to do without the coarse grid that the method was
    /// given, because it could not be made or factorised.
    pub coarse_fallbacks: u32,
    /// Minimisations that a quasi-Newton method did not bring to an end, so that Newton's method took over.
    pub newton_fallbacks: u32,
    /// Steps that a method of several steps (BDF2) took by its starting formula, of first order, because it could not
    /// go on from the step before: the first, one of another size or from another state, one after a jump. See the
    /// method.
    pub restarts: u32,
    /// Steps that ended at their most iterations, though they look for an end that they did not reach.
    pub unfinished: u32,
    /// What the method measures its convergence by, at the end, if it measures it; see the method.
    pub residual: Option<Real>,
    /// Work (J) that prescribed vertices did on the others, if the method adds it up over its substeps.
    pub pin_work: Option<Real>,
    /// Whether the method has written the [`pin_forces`](StepInput::pin_forces) that it was asked for.
    pub tells_pin_forces: bool,
    /// Work (J) of the load, if that is another than the load times the displacement.
    pub load_work: Option<Real>,
}

impl StepReport {
    /// A report of `iterations` and nothing else.
    #[must_use]
    pub fn new(outcome: Outcome, iterations: u32) -> Self {
        Self {
            outcome,
            iterations,
            factorizations: 0,
            linear_solves: 0,
            linear_iterations: 0,
            backtracks: 0,
            chebyshev_fallbacks: 0,
            refinements: 0,
            coarse_builds: 0,
            coarse_fallbacks: 0,
            newton_fallbacks: 0,
            restarts: 0,
            unfinished: 0,
            residual: None,
            pin_work: None,
            tells_pin_forces: false,
            load_work: None,
        }
    }

    /// The report of this step and of the next one, as if the two were one.
    #[must_use]
    pub fn and(self, next: Self) -> Self {
        Self {
            outcome: match self.outcome {
                Outcome::Converged => next.outcome,
                Outcome::BudgetSpent => self.outcome,
            },
            iterations: self.iterations + next.iterations,
            factorizations: self.factorizations + next.factorizations,
            linear_solves: self.linear_solves + next.linear_solves,
            linear_iterations: self.linear_iterations + next.linear_iterations,
            backtracks: self.backtracks + next.backtracks,
            chebyshev_fallbacks: self.chebyshev_fallbacks + next.chebyshev_fallbacks,
            refinements: self.refinements + next.refinements,
            coarse_builds: self.coarse_builds + next.coarse_builds,
            coarse_fallbacks: self.coarse_fallbacks + next.coarse_fallbacks,
            newton_fallbacks: self.newton_fallbacks + next.newton_fallbacks,
            restarts: self.restarts + next.restarts,
            unfinished: self.unfinished + next.unfinished,
            residual: next.residual,
            pin_work: self.pin_work.zip(next.pin_work).map(|(a, b)| a + b),
            tells_pin_forces: self.tells_pin_forces && next.tells_pin_forces,
            load_work: self.load_work.zip(next.load_work).map(|(a, b)| a + b),
        }
    }
}

/// Why a step was not taken. The state is left as it was.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum StepError {
    /// The step size is zero, negative or not finite.
    InvalidTimeStep {
        /// The step size (s).
        dt: Real,
    },
    /// The time of the state is NaN or infinite.
    InvalidTime {
        /// The time (s).
        time: Real,
    },
    /// Something that went in is NaN or infinite.
    NonFiniteInput {
        /// What.
        what: &'static str,
        /// At which vertex, if it has one entry per vertex.
        vertex: Option<usize>,
    },
    /// The result was not finite at a vertex.
    NonFinite {
        /// The first such vertex.
        vertex: usize,
        /// The step, counted from 1.
        step: u64,
    },
    /// An explicit method was asked for a step larger than the stable one.
    Unstable {
        /// The step asked for (s).
        dt: Real,
        /// The largest stable one (s), estimated.
        stable_dt: Real,
        /// The step, counted from 1.
        step: u64,
    },
    /// The cloth moves with far more energy than it was ever given, at a step that is not too large.
    EnergyGain {
        /// Its kinetic energy (J).
        kinetic: Real,
        /// The most that it was given by its start, external forces, pins and moving bodies (J).
        given: Real,
        /// The step, counted from 1.
        step: u64,
    },
    /// A method that does not damp has made energy in contact, at a step that does not resolve the cloth.
    EnergyGrowth {
        /// Kinetic energy before the step (J).
        before: Real,
        /// Kinetic energy after it (J).
        after: Real,
        /// The most that the cloth had and was given so far (J).
        given: Real,
        /// The step, counted from 1.
        step: u64,
    },
    /// A matrix that has to be positive definite is not.
    NotPositiveDefinite {
        /// The iteration, counted from 1.
        iteration: u32,
        /// The step, counted from 1.
        step: u64,
    },
    /// Contact could not be resolved.
    Contact {
        /// Why.
        reason: ContactError,
        /// The step, counted from 1.
        step: u64,
    },
    /// The method, as it is set, has no way to feel contact, and there is some.
    ContactNotFelt {
        /// What to set instead.
        remedy: &'static str,
    },
    /// A line search found no lower point although the gradient is not small.
    LineSearchStalled {
        /// The iteration, counted from 1.
        iteration: u32,
        /// Gradient norm there (dimensionless), relative to that of the inertial forces.
        residual: Real,
        /// The step, counted from 1.
        step: u64,
    },
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidTimeStep { dt } => write!(
                f,
                "the time step is {dt} s, but it has to be a positive finite number"
            ),
            Self::InvalidTime { time } => write!(
                f,
                "the time of the state is {time} s, but it has to be a finite number"
            ),
            Self::NonFiniteInput {
                what,
                vertex: Some(vertex),
            } => write!(f, "{what} is not finite at vertex {vertex}"),
            Self::NonFiniteInput { what, vertex: None } => write!(f, "{what} is not finite"),
            Self::NonFinite { vertex, step } => write!(
                f,
                "step {step} gave a result that is not finite at vertex {vertex}; the state before it was kept"
            ),
            Self::Unstable {
                dt,
                stable_dt,
                step,
            } if *stable_dt == 0.0 => write!(
                f,
                "step {step} is unstable: the time step is {dt:.4e} s, and no step is stable for this method"
            ),
            Self::Unstable {
                dt,
                stable_dt,
                step,
            } if dt / stable_dt > Real::from(u32::MAX) => write!(
                f,
                "step {step} is unstable: the time step is {dt:.4e} s, the largest stable one is {stable_dt:.4e} s: no \
                 number of substeps makes up for that"
            ),
            Self::Unstable {
                dt,
                stable_dt,
                step,
            } => write!(
                f,
                "step {step} is unstable: the time step is {dt:.4e} s, the largest stable one is {stable_dt:.4e} s: \
                 set at least {} times as many substeps, or take as many steps of that fraction of the size",
                (dt / stable_dt).ceil()
            ),
            Self::EnergyGain {
                kinetic,
                given,
                step,
            } => write!(
                f,
                "in step {step} the cloth moves with {kinetic:.3e} J, but was never given more than {given:.3e} J"
            ),
            Self::EnergyGrowth {
                before,
                after,
                given,
                step,
            } => write!(
                f,
                "in step {step} the kinetic energy of the cloth went from {before:.3e} J to {after:.3e} J, but it was \
                 never given more than {given:.3e} J: take implicit Euler or BDF2, or smaller steps"
            ),
            Self::NotPositiveDefinite { iteration, step } => write!(
                f,
                "the matrix of step {step}, iteration {iteration}, is not positive definite to rounding: where k Δt²/m \
                 is beyond some 10¹², an element is too stiff for the mass of its vertices and this step; a negative \
                 stiffness does it too"
            ),
            Self::Contact { reason, step } => write!(f, "step {step}: {reason}"),
            Self::ContactNotFelt { remedy } => {
                write!(f, "the method does not feel contact as it is set: {remedy}")
            }
            Self::LineSearchStalled {
                iteration,
                residual,
                step,
            } => write!(
                f,
                "the line search of step {step} stalled in iteration {iteration} at a relative gradient of \
                 {residual:.3e}"
            ),
        }
    }
}

impl std::error::Error for StepError {}

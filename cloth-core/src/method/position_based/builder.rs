//! The builder of a position-based solver.

use super::{Acceleration, ConstraintUpdate, Families, Motion, Sweep};
use crate::element::Constraint;
use crate::math::Real;
use crate::particles::Particles;
use crate::step::BuildError;
use std::fmt;

/// The settings of a position-based method, and the solver that they make of masses and constraints.
pub trait Settings: fmt::Debug + Default + Sized {
    /// The method's formula for Δλ.
    type Update: ConstraintUpdate;
    /// The method.
    type Solver;

    /// Sweeps per substep, substeps per step, and the order of a sweep.
    fn sweep_settings(&self) -> (u32, u32, Sweep);

    /// Relaxation and extrapolation of the sweeps; none, unless the method says so.
    fn acceleration(&self) -> Acceleration {
        Acceleration::default()
    }

    /// Checks what the method adds to its [`Settings::sweep_settings`] and [`Settings::acceleration`].
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`].
    fn check(&self) -> Result<(), BuildError> {
        Ok(())
    }

    /// The solver.
    fn assemble(self, motion: Motion, families: Families<Self::Update>) -> Self::Solver;
}

/// Adds one family once the order of the sweep is known.
type Plan<U> = Box<dyn FnOnce(&mut Families<U>) -> Result<(), BuildError>>;

/// Collects particles, elements and settings of a position-based solver.
pub struct Builder<S: Settings> {
    motion: Motion,
    plans: Vec<Plan<S::Update>>,
    settings: S,
}

impl<S: Settings> Builder<S> {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, without constraints and
    /// with the default settings.
    #[must_use]
    pub fn new(particles: &Particles) -> Self {
        Self {
            motion: Motion::new(particles),
            plans: Vec::new(),
            settings: S::default(),
        }
    }

    /// Adds a family of constraints. A sweep visits the families in the order in which they were added.
    #[must_use]
    pub fn energy<const N: usize, E: Constraint<N>>(mut self, elements: Vec<E>) -> Self {
        self.plans
            .push(Box::new(move |families| families.add(&elements)));
        self
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, settings: S) -> Self {
        self.settings = settings;
        self
    }

    /// The solver.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`]; [`BuildError::NoSuchVertex`] if an element names a vertex that the
    /// particles do not have.
    ///
    /// # Panics
    /// If an element of a coloured sweep names a vertex twice.
    pub fn build(self) -> Result<S::Solver, BuildError> {
        let (iterations, substeps, sweep) = self.settings.sweep_settings();
        at_least_one("the number of iterations", iterations)?;
        at_least_one("the number of substeps", substeps)?;
        self.settings.check()?;
        let acceleration = self.settings.acceleration();
        let mut families = Families::new(self.motion.vertex_count(), sweep, acceleration)?;
        for plan in self.plans {
            plan(&mut families)?;
        }
        Ok(self.settings.assemble(self.motion, families))
    }
}

impl<S: Settings> fmt::Debug for Builder<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Builder")
            .field("vertices", &self.motion.vertex_count())
            .field("families", &self.plans.len())
            .field("settings", &self.settings)
            .finish()
    }
}

fn at_least_one(name: &'static str, count: u32) -> Result<(), BuildError> {
    if count > 0 {
        return Ok(());
    }
    Err(BuildError::InvalidSetting {
        name,
        value: Real::from(count),
        range: "at least 1",
    })
}

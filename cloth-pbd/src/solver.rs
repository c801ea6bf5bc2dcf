//! The solver: the loop over substeps and sweeps.

mod builder;

pub use builder::PbdBuilder;

use crate::config::PbdConfig;
use crate::hierarchy::Hierarchy;
use crate::stiffness::Projection;
use cloth_core::error::within;
use cloth_core::math::Real;
use cloth_core::method::position_based::{Families, Motion};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepError, StepInput, StepReport, Stepper};

/// Position-based dynamics; see the [crate documentation](crate).
#[derive(Debug)]
pub struct PbdSolver {
    motion: Motion,
    families: Families<Projection>,
    /// Coarse levels, if any.
    hierarchy: Option<Hierarchy>,
    config: PbdConfig,
    /// The substep (s) that the cached stiffnesses belong to, once there is one.
    substep: Option<Real>,
}

impl PbdSolver {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without constraints.
    #[must_use]
    pub fn builder(particles: &Particles) -> PbdBuilder {
        PbdBuilder::new(particles)
    }

    /// The same solver with coarse levels, which correct the positions before the first sweep of each substep,
    /// or more often.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for a hierarchy of a mesh with another number of vertices.
    pub fn with_hierarchy(mut self, hierarchy: Hierarchy) -> Result<Self, BuildError> {
        let (name, count) = (
            "the number of vertices of the hierarchy",
            hierarchy.vertex_count(),
        );
        let is_right = count == self.motion.vertex_count();
        within(is_right, name, count as Real, "that of the particles")?;
        self.hierarchy = Some(hierarchy);
        Ok(self)
    }

    /// The settings.
    #[must_use]
    pub fn config(&self) -> &PbdConfig {
        &self.config
    }

    /// How many substeps, since the solver was built, disabled Chebyshev extrapolation because it made the
    /// corrections grow; see [`Chebyshev`](cloth_core::method::position_based::Chebyshev).
    #[must_use]
    pub fn chebyshev_fallbacks(&self) -> u64 {
        self.families.chebyshev_fallbacks()
    }

    /// The update for substeps of `h` (s).
    fn projection(&mut self, h: Real) -> Projection {
        let projection = Projection {
            stiffness: self.config.stiffness,
            substep: h,
            iterations: self.config.iterations,
            accumulates: self.motion.needs_pin_forces(),
        };
        if self.substep != Some(h) {
            let (w, x) = (self.motion.inverse_mass(), self.motion.positions());
            self.families.prepare(&projection, w, x);
            self.substep = Some(h);
        }
        projection
    }
}

impl Stepper for PbdSolver {
    fn name(&self) -> &'static str {
        "pbd"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        self.motion.begin(state, &mut input)?;
        let fallbacks_before = self.families.chebyshev_fallbacks();
        let h = input.dt / Real::from(self.config.substeps);
        let projection = self.projection(h);
        for substep in 1..=self.config.substeps {
            self.families.set_time(state.time + Real::from(substep) * h);
            if projection.accumulates {
                self.families.reset();
            }
            self.motion.predict(&mut input, h)?; // v ← v + h a, x̃ ← x + h v
            self.families.restart();
            for sweep in 0..self.config.iterations {
                let due = self.hierarchy.as_mut().filter(|h| h.is_due(sweep));
                self.motion.iterate(&mut input, |w, x| {
                    if let Some(hierarchy) = due {
                        hierarchy.correct(x);
                        self.families.restart();
                    }
                    self.families.sweep(&projection, w, x); // x ← x − s w ∂C C/w̃, row by row
                });
            }
            let motion = &mut self.motion;
            motion.count_pin_work(&mut input, &self.families, |seen| seen.memory.lambda);
            self.motion.update_velocities(&mut input)?; // v ← v + (x − x̃)/h
        }
        let report = self.motion.finish(state, &mut input)?;
        Ok(StepReport {
            chebyshev_fallbacks: (self.families.chebyshev_fallbacks() - fallbacks_before) as u32,
            ..report
        })
    }
}

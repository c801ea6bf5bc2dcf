//! The algorithm.

use crate::compliance::Compliance;
use crate::config::XpbdConfig;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::position_based::{Acceleration, Builder, Families, Motion, Settings, Sweep};
use cloth_core::step::{StepError, StepInput, StepReport, Stepper};

/// Extended position-based dynamics; see the [crate documentation](crate).
#[derive(Debug)]
pub struct XpbdSolver {
    motion: Motion,
    families: Families<Compliance>,
    config: XpbdConfig,
    /// With the substep of the last step, once there was one.
    last: Option<Compliance>,
}

impl Stepper for XpbdSolver {
    fn name(&self) -> &'static str {
        "xpbd"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        self.motion.begin(state, &input)?;
        let h = input.dt / Real::from(self.config.substeps);
        let compliance = Compliance { substep: h };
        self.last = Some(compliance);
        for _ in 0..self.config.substeps {
            self.motion.predict(&input, h); // S1 (24)
            self.families.forget(); // λ = 0, here and not in each iteration
            self.families.restart();
            for _ in 0..self.config.iterations {
                self.motion.iterate(&mut input, |w, x| {
                    self.families.sweep(&compliance, w, x); // S1 (36)
                });
            }
            self.motion.update_velocities(h); // S1 (26)
        }
        self.motion.finish(state, input.dt)
    }
}

impl XpbdSolver {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without constraints.
    #[must_use]
    pub fn builder(particles: &Particles) -> XpbdBuilder {
        XpbdBuilder::new(particles)
    }

    /// What it was built with.
    #[must_use]
    pub fn config(&self) -> &XpbdConfig {
        &self.config
    }

    /// How many substeps, since the solver was built, gave up their extrapolation because it made the corrections grow; see
    /// [`Chebyshev`](cloth_core::position_based::Chebyshev).
    #[must_use]
    pub fn surrendered(&self) -> u64 {
        self.families.surrendered()
    }

    /// `max |C + α̃λ|` over all rows (unit of C; m for springs and hinges) at `positions` (m), with the multipliers of the
    /// last substep: what the sweeps of that substep bring to zero. With the positions that the step ended at
    /// it tells how far they got.
    ///
    /// Rows that no multiplier can change (no stiffness; hard, with all vertices prescribed) are left out. Before the first step it is 0.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    #[must_use]
    pub fn compliance_residual(&self, positions: &[Vec3]) -> Real {
        assert_eq!(
            positions.len(),
            self.motion.vertex_count(),
            "number of positions"
        );
        let mut largest: Real = 0.0;
        if let Some(compliance) = self.last {
            self.families
                .each_row(self.motion.inverse_mass(), positions, |row, &multiplier| {
                    if let Some(violation) = compliance.violation(row, multiplier) {
                        largest = largest.max(violation.abs());
                    }
                });
        }
        largest
    }

    /// Writes the multipliers λ (kg m² per unit of C; kg m for springs and hinges) of the last substep to `out`: those of the family that
    /// was added as number `family` (from 0), element after element in the order given, row after row.
    ///
    /// `λ/h²` is the generalised force of the row: the tension of a spring is `−λ/h²` (N).
    ///
    /// # Panics
    /// If there is no such family.
    pub fn multipliers_into(&self, family: usize, out: &mut Vec<Real>) {
        self.families.remembered(family, out);
    }
}

/// Collects what an [`XpbdSolver`] is built of.
pub type XpbdBuilder = Builder<XpbdConfig>;

impl Settings for XpbdConfig {
    type Rule = Compliance;
    type Solver = XpbdSolver;

    fn pace(&self) -> (u32, u32, Sweep) {
        (self.iterations, self.substeps, self.sweep)
    }

    fn acceleration(&self) -> Acceleration {
        self.acceleration
    }

    fn assemble(self, motion: Motion, families: Families<Compliance>) -> XpbdSolver {
        XpbdSolver {
            motion,
            families,
            config: self,
            last: None,
        }
    }
}

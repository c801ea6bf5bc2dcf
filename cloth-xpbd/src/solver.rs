//! The algorithm.

use crate::compliance::Compliance;
use crate::config::XpbdConfig;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::position_based::{Acceleration, Builder, Families, Motion, Settings, Sweep};
use cloth_core::step::{BuildError, StepError, StepInput, StepReport, Stepper};

/// Extended position-based dynamics; see the [crate documentation](crate).
#[derive(Debug)]
pub struct XpbdSolver {
    pub(crate) motion: Motion,
    pub(crate) families: Families<Compliance>,
    config: XpbdConfig,
    /// With the substep of the last step, once one was taken.
    pub(crate) last: Option<Compliance>,
    /// For which the families know their α̃.
    prepared: Option<Compliance>,
    /// Positions (m) at the start of the last substep, one per vertex; empty if nothing is damped.
    pub(crate) start: Vec<Vec3>,
    /// `λ − ν` of the rows that hold on to a prescribed vertex, in the order of [`Families::inspect_held`], if such a vertex moves and there is damping.
    pub(crate) held_offsets: Vec<Real>,
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
        self.motion.begin(state, &mut input)?;
        let given_up = self.families.surrendered();
        self.last = None;
        let h = input.dt / Real::from(self.config.substeps);
        let compliance = Compliance::new(h, self.config.damping);
        for _ in 0..self.config.substeps {
            self.forget(compliance); // λ = 0, here and not in each iteration
            self.motion.predict(&mut input, h)?; // S1 (24)
            self.families.restart();
            for _ in 0..self.config.iterations {
                self.motion.iterate(&mut input, |w, x| {
                    self.families.sweep(&compliance, w, x); // S1 (36)
                });
            }
            self.count_pin_work(compliance);
            self.motion.update_velocities(&mut input)?; // S1 (26)
        }
        let report = self.motion.finish(state, &mut input)?;
        self.last = Some(compliance);
        Ok(StepReport {
            pin_work: Some(self.motion.pin_work()),
            chebyshev_fallbacks: (self.families.surrendered() - given_up) as u32,
            ..report
        })
    }
}

impl XpbdSolver {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without constraints.
    #[must_use]
    pub fn builder(particles: &Particles) -> XpbdBuilder {
        XpbdBuilder::new(particles)
    }

    /// Sets λ to zero, at the start of a substep.
    fn forget(&mut self, compliance: Compliance) {
        let damped = !self.start.is_empty();
        if !damped && self.prepared == Some(compliance) {
            self.families.forget();
            return;
        }
        let (w, x) = (self.motion.inverse_mass(), self.motion.positions());
        if damped {
            self.start.copy_from_slice(x);
        }
        self.families.prepare(&compliance, w, x);
        self.prepared = Some(compliance);
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

    /// `max |C + α̃λ|` (damped: `|C + α̃ν|`) over all rows (unit of C; m for springs and hinges) at `positions` (m), with the multipliers of the
    /// last substep: what the sweeps of that substep bring to zero. With the positions that the step ended at, where contact moved
    /// nothing, it tells how far they got.
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
                .each_row(self.motion.inverse_mass(), positions, |row, memory| {
                    if let Some(violation) = compliance.violation(row, memory.total()) {
                        largest = largest.max(violation.abs());
                    }
                });
        }
        largest
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

    fn check(&self) -> Result<(), BuildError> {
        if self.damping >= 0.0 && self.damping.is_finite() {
            return Ok(());
        }
        Err(BuildError::InvalidSetting {
            name: "the damping",
            value: self.damping,
            range: "zero or positive, and finite",
        })
    }

    fn assemble(self, motion: Motion, families: Families<Compliance>) -> XpbdSolver {
        let damped = if self.damping > 0.0 {
            motion.vertex_count()
        } else {
            0
        };
        XpbdSolver {
            start: vec![Vec3::zeros(); damped],
            held_offsets: Vec::new(),
            motion,
            families,
            config: self,
            last: None,
            prepared: None,
        }
    }
}

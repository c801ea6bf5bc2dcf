//! The solver: the loop over substeps and sweeps.

mod builder;

pub use builder::XpbdBuilder;

use crate::config::XpbdConfig;
use crate::update::XpbdUpdate;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{Families, Motion};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput, StepReport, Stepper};

/// Extended position-based dynamics; see the [crate documentation](crate).
#[derive(Debug)]
pub struct XpbdSolver {
    pub(crate) motion: Motion,
    pub(crate) families: Families<XpbdUpdate>,
    config: XpbdConfig,
    /// With the substep of the last step, once one was taken.
    pub(crate) last: Option<XpbdUpdate>,
    /// The update whose α̃ the families hold.
    prepared: Option<XpbdUpdate>,
    /// Positions (m) at the start of the last substep, one per vertex; empty if nothing is damped.
    pub(crate) start: Vec<Vec3>,
    /// `λ − ν` of the rows with a prescribed vertex, in the order of [`Families::inspect_prescribed`]; empty
    /// unless such a vertex moves and there is damping.
    pub(crate) prescribed_offsets: Vec<Real>,
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
        let fallbacks_before = self.families.chebyshev_fallbacks();
        self.last = None;
        let h = input.dt / Real::from(self.config.substeps);
        let update = XpbdUpdate::new(h, self.config.damping);
        for substep in 1..=self.config.substeps {
            self.families.set_time(state.time + Real::from(substep) * h);
            self.begin_substep(update); // λ = 0, here and not in each iteration
            self.motion.predict(&mut input, h)?; // v ← v + h a, x̃ ← x + h v
            self.families.restart();
            for _ in 0..self.config.iterations {
                self.motion.iterate(&mut input, |w, x| {
                    self.families.sweep(&update, w, x); // Δλ of every row, x moved along
                });
            }
            self.count_pin_work(update);
            self.motion.update_velocities(&mut input)?; // v ← v + (x − x̃)/h
        }
        let report = self.motion.finish(state, &mut input)?;
        self.last = Some(update);
        Ok(StepReport {
            pin_work: Some(self.motion.pin_work()),
            chebyshev_fallbacks: (self.families.chebyshev_fallbacks() - fallbacks_before) as u32,
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

    /// Sets λ of every row to zero (damped: ν to `−k h β C⁰`), once per substep.
    fn begin_substep(&mut self, update: XpbdUpdate) {
        let damped = !self.start.is_empty();
        if !damped && self.prepared == Some(update) {
            self.families.reset();
            return;
        }
        let (w, x) = (self.motion.inverse_mass(), self.motion.positions());
        if damped {
            self.start.copy_from_slice(x);
        }
        self.families.prepare(&update, w, x);
        self.prepared = Some(update);
    }

    /// The settings.
    #[must_use]
    pub fn config(&self) -> &XpbdConfig {
        &self.config
    }

    /// How many substeps, since the solver was built, disabled Chebyshev extrapolation because it made the
    /// corrections grow; see [`Chebyshev`](cloth_core::method::position_based::Chebyshev).
    #[must_use]
    pub fn chebyshev_fallbacks(&self) -> u64 {
        self.families.chebyshev_fallbacks()
    }

    /// `max |C + α̃λ|` (damped: `|C + α̃ν|`) over all rows (unit of C; m for springs and hinges) at `positions`
    /// (m), with the multipliers of the last substep: what the sweeps of that substep bring to zero. At the
    /// positions that the step ended at, and where contact moved nothing, it is the residual of the sweeps.
    ///
    /// Rows that no multiplier can change (no stiffness; hard, with all vertices prescribed) are left out.
    /// Before the first step it is 0.
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
        if let Some(update) = self.last {
            self.families
                .each_row(self.motion.inverse_mass(), positions, |row, memory| {
                    if let Some(violation) = update.violation(row, memory.lambda()) {
                        largest = largest.max(violation.abs());
                    }
                });
        }
        largest
    }
}

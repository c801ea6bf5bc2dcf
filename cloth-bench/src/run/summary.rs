//! What a run did and where it ended, and what of it is worth a warning.

use super::energy::{EnergyGain, WORTH_A_WARNING};
use cloth_core::math::Real;
use cloth_core::step::{Outcome, StepReport};
use serde::{Deserialize, Serialize};

/// Part of the steps that may end at their most iterations without a warning.
const UNFINISHED: Real = 0.1;

/// What a run did and where it ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Steps taken.
    pub steps: u32,
    /// Median time of a step (ms).
    pub ms_per_step_median: Real,
    /// Longest time of a step (ms).
    pub ms_per_step_max: Real,
    /// Median time of contact in it (ms); 0 where there is nothing to touch.
    pub contact_ms_median: Real,
    /// Parts of steps that ended with truncated displacements, see
    /// [`truncated_count`](cloth_core::contact::ContactSource::truncated_count).
    pub truncated_steps: u32,
    /// Those after which cloth that bodies had pinched was passing through one of them.
    pub pinched_steps: u32,
    /// How many of its vertices were at most.
    pub most_pinched: u32,
    /// A sentence about held vertices in bodies, which the triangles around them pass through.
    pub held_inside: Option<String>,
    /// Iterations, summed over the steps.
    pub iterations: u64,
    /// Iterations of the median step.
    pub iterations_per_step: u32,
    /// Iterations of the linear solver, summed over the steps; a direct solve counts as one.
    pub linear_iterations: u64,
    /// Substeps that gave up their Chebyshev extrapolation, summed over the steps.
    pub chebyshev_fallbacks: u64,
    /// Times that a step was taken again with more substeps because it would have gained energy, summed over the steps.
    pub refinements: u64,
    /// Coarse grids that projective dynamics made anew in the course of the run.
    pub coarse_builds: u64,
    /// Iterations of steps that had to do without the coarse grid, summed over the steps.
    pub coarse_fallbacks: u64,
    /// Minimisations in which Newton's method took over from the quasi-Newton method, summed over the steps.
    pub newton_fallbacks: u64,
    /// Steps of BDF2 that were taken by implicit Euler.
    pub restarts: u64,
    /// Changes of the cloth on the way for which the method had to be built anew.
    pub rebuilds: u32,
    /// Steps that ended at their most iterations, short of the end that they look for.
    pub unfinished_steps: u32,
    /// Steps that met their tolerance; methods without one meet it never.
    pub converged_steps: u32,
    /// Largest strain of a spring at the end (dimensionless).
    pub max_stretch: Real,
    /// Largest strain of a spring after any step (dimensionless).
    pub max_stretch_of_all: Real,
    /// A sentence about it, where it is larger than cloth can be stretched.
    pub stretched: Option<String>,
    /// Root mean square of the strains at the end (dimensionless).
    pub rms_strain: Real,
    /// Kinetic energy at the end (J).
    pub kinetic_energy: Real,
    /// Elastic energy at the end (J).
    pub elastic_energy: Real,
    /// Gravitational energy at the end relative to the start (J).
    pub gravity_energy: Real,
    /// Energy of contact at the end (J).
    pub contact_energy: Real,
    /// The sum of these three, and what sealed volumes store (J).
    pub potential_energy: Real,
    /// The most by which the cloth, and the bodies that it pushes, held more energy than they were given by their
    /// start, gravity, moving pins and bodies, air and gas (J); 0 if they never did but for rounding.
    pub energy_excess: Real,
    /// The most that they were given until any step (J).
    pub energy_given: Real,
    /// What lifts the cloth by the mean edge of its triangles (J).
    pub energy_scale: Real,
    /// The first step after which the cloth moved with energy that it had never been given.
    pub energy_gain: Option<EnergyGain>,
    /// Energy of contact at the start (J), of cloth that is nearer than the thickness to itself or to a body.
    pub contact_energy_at_start: Real,
    /// How far (m) that energy would throw the cloth up on Earth, if that is farther than the thickness.
    pub start_lift: Option<Real>,
    /// How far the centre of mass fell (m).
    pub center_of_mass_drop: Real,
    /// Crossing pairs of triangles at the end; none measured where the scene has no triangles.
    pub intersections: Option<usize>,
    /// Pairs of a triangle of the cloth and one of a body that cross at the end; none measured where no body has edges.
    pub obstacle_intersections: Option<usize>,
    /// Crossing pairs of triangles of the cloth before each step, of a scene that untangles, until nothing crossed.
    pub tangled_pairs: Vec<usize>,
    /// The same of a triangle of the cloth and one of a body.
    pub tangled_obstacle_pairs: Vec<usize>,
    /// Steps after which nothing of that crossed any more.
    pub untangled_after: Option<u32>,
    /// What is left of them at the end, and where; none if nothing is.
    pub tangled: Option<String>,
    /// Smallest distance (m) at the end between parts that share no vertex.
    pub min_distance: Option<Real>,
    /// Smallest distance (m) at the end of a vertex from a body, negative inside a rigid one and without a sign from an
    /// animated one; none where there are no bodies.
    pub min_clearance: Option<Real>,
    /// Largest distance (m) at the end of a vertex from what it is sewn to; none where there is no seam.
    pub max_seam_gap: Option<Real>,
    /// A sentence about it, where a seam that has closed is wide open.
    pub open_seam: Option<String>,
    /// Largest change of a sealed volume at the end (dimensionless, of its rest volume); none where there is none.
    pub max_volume_change: Option<Real>,
}

impl Summary {
    /// Adds what is counted of a step.
    pub(super) fn count(&mut self, report: &StepReport) {
        self.linear_iterations += u64::from(report.linear_iterations);
        self.chebyshev_fallbacks += u64::from(report.chebyshev_fallbacks);
        self.coarse_builds += u64::from(report.coarse_builds);
        self.coarse_fallbacks += u64::from(report.coarse_fallbacks);
        self.newton_fallbacks += u64::from(report.newton_fallbacks);
        self.restarts += u64::from(report.restarts);
        self.refinements += u64::from(report.refinements);
        self.unfinished_steps += u32::from(report.unfinished > 0);
        self.converged_steps += u32::from(report.outcome == Outcome::Converged);
    }

    /// A sentence about energy from nowhere, if there is so much of it that it is worth a warning.
    pub fn energy_warning(&self) -> Option<String> {
        let (excess, given) = (self.energy_excess, self.energy_given);
        (excess > WORTH_A_WARNING * given.max(self.energy_scale)).then(|| {
            format!(
                "energy from nowhere: the cloth held {excess:.3e} J more than it was given; its start, gravity, pins, bodies and air gave {given:.3e} J at most"
            )
        })
    }

    /// A sentence about steps that ended at their most iterations, if there are so many of them that it is worth a
    /// warning.
    pub fn budget_warning(&self) -> Option<String> {
        let (unfinished, steps) = (self.unfinished_steps, self.steps);
        (Real::from(unfinished) > UNFINISHED * Real::from(steps)).then(|| {
            format!(
                "{unfinished} of {steps} steps ended at their most iterations, short of the balance of forces that they look for: what the cloth holds there is not the material's"
            )
        })
    }
}

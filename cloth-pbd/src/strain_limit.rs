//! Strain limiting: after a step of any method, no element may be stretched or compressed beyond a range.
//!
//! X. Provot, "Deformation constraints in a mass-spring model to describe rigid cloth behavior", Graphics
//! Interface 1995; H. Wang, J. O'Brien, R. Ramamoorthi, "Multi-resolution isotropic strain limiting", ACM
//! Trans. Graph. 29(6), 2010, <https://doi.org/10.1145/1882261.1866182>, for principal stretches.

mod components;
mod limit;
mod with_strain_limit;

pub use with_strain_limit::WithStrainLimit;

use cloth_core::element::{Constraint, Element};
use cloth_core::energy::{ArapTriangle, AreaTriangle, Spring};
use cloth_core::error::{at_least_one, not_negative, within};
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::method::family::check_vertices;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, Outcome, StepError};
use components::Components;
use limit::{AnyLimits, Limit, Limits};

/// The range of a ratio of present to rest size (dimensionless): of lengths, of areas or of principal stretches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchRange {
    /// Smallest ratio σ_min, at least 0.
    pub min: Real,
    /// Largest ratio σ_max, at least σ_min and above 0; infinite for no upper limit.
    pub max: Real,
}

impl StretchRange {
    /// Stretched by no more than `strain` (dimensionless), compressed without limit, as cloth that buckles.
    #[must_use]
    pub fn stretch(strain: Real) -> Self {
        Self {
            min: 0.0,
            max: 1.0 + strain,
        }
    }

    /// Neither stretched nor compressed by more than `strain` (dimensionless).
    #[must_use]
    pub fn both(strain: Real) -> Self {
        Self {
            min: 1.0 - strain,
            max: 1.0 + strain,
        }
    }

    fn check(self) -> Result<(), BuildError> {
        not_negative("the smallest ratio of a strain limit", self.min)?;
        let is_right = self.max >= self.min && self.max > 0.0;
        let range = "above 0 and not below the smallest";
        within(
            is_right,
            "the largest ratio of a strain limit",
            self.max,
            range,
        )?;
        Ok(())
    }
}

/// Moves the vertices of a state, after whatever step led to it, until all ratios are in their ranges.
///
/// Passes of projections go over the elements, colour by colour. An element within its range is left alone; one
/// beyond it by more than the tolerance is moved to the end of the range along its gradient,
/// `Δxᵢ = −wᵢ ∂C/∂xᵢ (C − C_end)/w̃`, as in PBD. Then the velocities follow, so that momentum is conserved to
/// round-off:
///
/// - `v ← v + Δx/Δt`, Δx over all passes. Since `Σ m Δx = 0`, linear momentum is conserved.
/// - The vertices have moved, so their angular momentum `Σ m x × v` has changed. Each connected component of the limits
///   is given the angular velocity ω that restores it, `v ← v + ω × (x − c)`, c its centre of mass: a component that
///   becomes smaller turns faster, as a skater does. Of all changes of the velocities that do it, this is the smallest
///   in the metric of M. (Projection by projection it would be more local, but add energy in every pass.)
///
/// A component with one prescribed vertex conserves the angular momentum relative to it, `Σ m (x − c) × (v − u)` with c
/// and u its position and velocity; with two, none.
///
/// Limits: Gauss–Seidel, so a tight limit on a large cloth takes many passes, as the square of its vertices a side: a
/// sheet that hangs by its upper edge, stretched by 10 %, 112, 438, 1718 and 6752 to a limit of 5 % with 9, 17, 33
/// and 65 vertices a side (to 10⁻³; [`max_passes`](StrainLimiterBuilder::max_passes) is 100 unless set). Where the
/// ranges contradict each other or the prescribed vertices, there is no solution; the report then says
/// [`Outcome::BudgetSpent`] and the remaining violation. Kinetic energy is not conserved.
#[derive(Debug)]
pub struct StrainLimiter {
    inverse_mass: Vec<Real>,
    /// The new positions (m) and velocities (m/s).
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    limits: Vec<Box<dyn AnyLimits>>,
    components: Components,
    tolerance: Real,
    max_passes: u32,
}

/// The outcome of one application of a limiter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitReport {
    /// Converged if the last pass found nothing beyond its range by more than the tolerance.
    pub outcome: Outcome,
    /// Passes over all elements, the last one included.
    pub passes: u32,
    /// Largest excess of a ratio over its range in the last pass (dimensionless). Where contact then truncates a
    /// displacement ([`WithStrainLimit`]) it is still this, and only `outcome` says so.
    pub violation: Real,
}

impl StrainLimiter {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without limits.
    #[must_use]
    pub fn builder(particles: &Particles) -> StrainLimiterBuilder {
        StrainLimiterBuilder {
            limiter: Self {
                inverse_mass: particles.inverse_mass().to_vec(),
                x: vec![Vec3::zeros(); particles.len()],
                v: vec![Vec3::zeros(); particles.len()],
                limits: Vec::new(),
                components: Components::default(),
                tolerance: 1e-4,
                max_passes: 100,
            },
            pairs: Vec::new(),
            error: None,
        }
    }

    /// Brings `state`, the end of a step of `dt` (s), into the ranges. If it is there already, no bit of it changes.
    ///
    /// # Errors
    /// [`StepError::InvalidTimeStep`]; [`StepError::NonFiniteInput`] for a state that is not finite,
    /// [`StepError::NonFinite`] for a result that is not. The state is then as it was.
    ///
    /// # Panics
    /// If the state does not have as many vertices as the particles.
    pub fn apply(&mut self, state: &mut State, dt: Real) -> Result<LimitReport, StepError> {
        self.begin(state, dt)?;
        let mut report = LimitReport {
            outcome: Outcome::BudgetSpent,
            passes: 0,
            violation: 0.0,
        };
        while report.passes < self.max_passes {
            report.passes += 1;
            report.violation = 0.0;
            for limits in &mut self.limits {
                let violation = limits.pass(&self.inverse_mass, self.tolerance, &mut self.x);
                report.violation = report.violation.max(violation);
            }
            if report.violation <= self.tolerance {
                report.outcome = Outcome::Converged;
                break;
            }
        }
        // A first pass without violations changes nothing.
        if report.passes > 1 || report.outcome == Outcome::BudgetSpent {
            self.update_velocities(state, dt);
            self.finish(state)?;
        }
        Ok(report)
    }

    fn begin(&mut self, state: &State, dt: Real) -> Result<(), StepError> {
        let count = self.inverse_mass.len();
        assert_eq!(state.positions.len(), count, "number of positions");
        assert_eq!(state.velocities.len(), count, "number of velocities");
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(StepError::InvalidTimeStep { dt });
        }
        if let Some(vertex) = state.first_non_finite() {
            return Err(StepError::NonFiniteInput {
                what: "the state",
                vertex: Some(vertex),
            });
        }
        self.x.copy_from_slice(&state.positions);
        Ok(())
    }

    /// `v ← v + Δx/Δt`, then an angular-velocity correction per component that restores the angular momentum.
    fn update_velocities(&mut self, state: &State, dt: Real) {
        let before = state.positions.iter().zip(&state.velocities);
        for ((v, x), (x_before, v_before)) in self.v.iter_mut().zip(&self.x).zip(before) {
            *v = v_before + (x - x_before) / dt;
        }
        let before = [&state.positions[..], &state.velocities[..]];
        self.components
            .keep_angular_momentum(&self.inverse_mass, before, &self.x, &mut self.v);
    }

    fn finish(&self, state: &mut State) -> Result<(), StepError> {
        let mut moving = self.x.iter().zip(&self.v);
        if let Some(vertex) = moving.position(|(x, v)| !(is_finite(x) && is_finite(v))) {
            let step = state.steps;
            return Err(StepError::NonFinite { vertex, step });
        }
        state.positions.copy_from_slice(&self.x);
        state.velocities.copy_from_slice(&self.v);
        Ok(())
    }
}

/// Collects particles, limits and settings of a [`StrainLimiter`].
#[derive(Debug)]
pub struct StrainLimiterBuilder {
    limiter: StrainLimiter,
    /// Pairs of vertices in a common limit.
    pairs: Vec<[u32; 2]>,
    error: Option<BuildError>,
}

impl StrainLimiterBuilder {
    /// Keeps `length/rest length` of every spring in `range`. Springs without rest length have no such ratio
    /// and are left out.
    #[must_use]
    pub fn springs(self, springs: &[Spring], range: StretchRange) -> Self {
        let sized = springs.iter().filter(|s| s.rest_length > 0.0);
        let limits = sized
            .map(|&s| Limit::new(s, s.rest_length, range))
            .collect();
        self.limits(springs, limits, range)
    }

    /// Keeps `area/rest area` of every triangle in `range`. Shear is not limited. Triangles without rest area
    /// are left out.
    #[must_use]
    pub fn areas(self, triangles: &[AreaTriangle], range: StretchRange) -> Self {
        let sized = triangles.iter().filter(|t| t.rest_area > 0.0);
        let limit = |&t: &AreaTriangle| Limit::new(t, t.rest_area, range);
        self.limits(triangles, sized.map(limit).collect(), range)
    }

    /// Keeps both principal stretches of every triangle in `range`: the same in all directions, shear included,
    /// whatever the mesh.
    #[must_use]
    pub fn stretches(self, triangles: &[ArapTriangle], range: StretchRange) -> Self {
        let limit = |&t: &ArapTriangle| Limit::new(t, 1.0, range);
        self.limits(triangles, triangles.iter().map(limit).collect(), range)
    }

    /// How far a ratio may be beyond its range (dimensionless) without being touched; 1e-4 unless set.
    #[must_use]
    pub fn tolerance(mut self, tolerance: Real) -> Self {
        self.limiter.tolerance = tolerance;
        self
    }

    /// Most passes over all elements in one call; 100 unless set.
    #[must_use]
    pub fn max_passes(mut self, max_passes: u32) -> Self {
        self.limiter.max_passes = max_passes;
        self
    }

    /// The limiter.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`]; [`BuildError::RepeatedVertex`]; [`BuildError::OutOfRange`] for a range, a
    /// tolerance or a number of passes out of its own range.
    pub fn build(self) -> Result<StrainLimiter, BuildError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let mut limiter = self.limiter;
        not_negative("the tolerance of a strain limit", limiter.tolerance)?;
        at_least_one("the number of passes", limiter.max_passes)?;
        limiter.components = Components::new(&self.pairs, limiter.inverse_mass.len());
        Ok(limiter)
    }

    /// Adds `limits` on some of `elements`. The first error is kept for [`Self::build`].
    #[allow(clippy::needless_pass_by_value)] // made for this call
    fn limits<const N: usize, E: Constraint<N>>(
        mut self,
        elements: &[E],
        limits: Vec<Limit<E>>,
        range: StretchRange,
    ) -> Self {
        let vertex_count = self.limiter.inverse_mass.len();
        let checked = check_vertices(elements, vertex_count).and(range.check());
        self.error = self.error.or(checked.err());
        if self.error.is_none() {
            for limit in &limits {
                let vertices = limit.vertices();
                self.pairs.extend(vertices.windows(2).map(|p| [p[0], p[1]]));
            }
            let limits = Limits::new(&limits, vertex_count);
            self.limiter.limits.push(Box::new(limits));
        }
        self
    }
}

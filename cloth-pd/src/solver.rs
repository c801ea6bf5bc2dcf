//! The algorithm.

use crate::config::{PdConfig, Start};
use crate::global::GlobalSystem;
use crate::local::{Family, Projections};
use crate::residual::Residual;
use cloth_core::element::Projective;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, Outcome, StepError, StepInput, StepReport, Stepper};

/// Projective dynamics; see the [crate documentation](crate).
#[derive(Debug)]
pub struct PdSolver {
    particles: Particles,
    families: Vec<Box<dyn Projections>>,
    global: GlobalSystem,
    config: PdConfig,
    /// With a tolerance only.
    residual: Option<Residual>,
    /// y (m): the positions before the step, but prescribed vertices where they will be after it.
    origin: Vec<Vec3>,
    /// The part of b (N) that is the same in all iterations of a step.
    constant_pull: Vec<Vec3>,
    /// b (N).
    pull: Vec<Vec3>,
    /// `d = x − y` (m); zero for prescribed vertices.
    displacement: Vec<Vec3>,
    /// x (m), the iterate.
    positions: Vec<Vec3>,
}

impl Stepper for PdSolver {
    fn name(&self) -> &'static str {
        "pd"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.particles.len())?;
        let step = state.steps + 1;
        let prepared = self.global.prepare(input.dt);
        let factorizations =
            prepared.map_err(|_| StepError::NotPositiveDefinite { iteration: 1, step })?;
        self.predict(state, &input); // S1 (33)
        self.start();
        let mut iterations = 0;
        let outcome = loop {
            if self.global.is_empty() {
                break Outcome::Converged;
            }
            if iterations == self.config.iterations && self.residual.is_none() {
                break Outcome::BudgetSpent;
            }
            self.project(); // S1 (28)–(31)
            if self.is_converged() {
                break Outcome::Converged;
            }
            if iterations == self.config.iterations {
                break Outcome::BudgetSpent;
            }
            self.solve(); // S1 (34)
            iterations += 1;
            if let Some(observer) = &mut input.observer {
                observer.iteration(iterations, &self.positions);
            }
        };
        self.finish(state, input.dt)?; // S1 (35)
        Ok(StepReport {
            factorizations,
            linear_solves: iterations,
            residual: self.residual.as_ref().and_then(Residual::value),
            ..StepReport::new(outcome, iterations)
        })
    }
}

impl PdSolver {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without elements.
    #[must_use]
    pub fn builder(particles: &Particles) -> PdBuilder {
        PdBuilder {
            particles: particles.clone(),
            families: Ok(Vec::new()),
            config: PdConfig::default(),
        }
    }

    /// What it was built with.
    #[must_use]
    pub fn config(&self) -> &PdConfig {
        &self.config
    }

    /// S1 (33): goes to `x̃ = y + Δt v + Δt² a`, and gathers what depends on the step but not on the iteration,
    /// `M (x̃ − y)/Δt² + Σ w Gᵀ(p − G y)`, the last sum with p only where it is constant.
    fn predict(&mut self, state: &State, input: &StepInput<'_>) {
        let dt = input.dt;
        for vertex in 0..self.particles.len() {
            let (x, v) = (state.positions[vertex], state.velocities[vertex]);
            let w = self.particles.inverse_mass()[vertex];
            let a = input.external_acceleration(vertex, w);
            let way = (v + a * dt) * dt;
            (self.origin[vertex], self.displacement[vertex]) = if w == 0.0 {
                (x + way, Vec3::zeros())
            } else {
                (x, way)
            };
            self.positions[vertex] = x + way;
            self.constant_pull[vertex] =
                self.displacement[vertex] * (self.particles.mass()[vertex] / (dt * dt));
        }
        for family in &mut self.families {
            family.add_constant_pull(&self.origin, &mut self.constant_pull);
        }
    }

    /// Chooses `x⁽⁰⁾`, and measures `∇G(x̃)` if there is a tolerance to compare with it.
    fn start(&mut self) {
        if let Some(residual) = &mut self.residual {
            residual.begin(self.particles.inverse_mass(), |gradient| {
                for family in &mut self.families {
                    family.add_constant_pull(&self.positions, gradient);
                    family.add_projections(&self.positions, gradient);
                }
            });
            if residual.is_zero_at_prediction() {
                return;
            }
        }
        if self.config.start == Start::Previous {
            self.positions.copy_from_slice(&self.origin);
            self.displacement.fill(Vec3::zeros());
        }
    }

    /// The local step: `b = M (x̃ − y)/Δt² + Σ w Gᵀ(p(x) − G y)`.
    fn project(&mut self) {
        self.pull.copy_from_slice(&self.constant_pull);
        for family in &mut self.families {
            family.add_projections(&self.positions, &mut self.pull);
        }
    }

    fn is_converged(&mut self) -> bool {
        let inverse_mass = self.particles.inverse_mass();
        self.residual
            .as_mut()
            .is_some_and(|residual| residual.is_met(inverse_mass, &self.pull))
    }

    /// The global step: `A d = b`, `x = y + d`.
    fn solve(&mut self) {
        self.global.solve(&self.pull, &mut self.displacement);
        for vertex in 0..self.positions.len() {
            self.positions[vertex] = self.origin[vertex] + self.displacement[vertex];
        }
    }

    /// S1 (35): `x[1] = x`, `v[1] = d/Δt`.
    fn finish(&self, state: &mut State, dt: Real) -> Result<(), StepError> {
        let step = state.steps + 1;
        let is_finite = |v: &Vec3| v.iter().all(|c| c.is_finite());
        let mut moved = self.positions.iter().zip(&self.displacement);
        if let Some(vertex) = moved.position(|(x, d)| !is_finite(x) || !is_finite(&(d / dt))) {
            return Err(StepError::NonFinite { vertex, step });
        }
        state.positions.copy_from_slice(&self.positions);
        for (vertex, v) in state.velocities.iter_mut().enumerate() {
            if !self.particles.is_prescribed(vertex) {
                *v = self.displacement[vertex] / dt;
            }
        }
        state.time += dt;
        state.steps = step;
        Ok(())
    }
}

/// Collects what a [`PdSolver`] is built of.
#[derive(Debug)]
pub struct PdBuilder {
    particles: Particles,
    families: Result<Vec<Box<dyn Projections>>, BuildError>,
    config: PdConfig,
}

impl PdBuilder {
    /// Adds a family of elements. Those without weight or without a free vertex are left out.
    #[must_use]
    pub fn energy<const N: usize, const K: usize, E: Projective<N, K>>(
        mut self,
        elements: Vec<E>,
    ) -> Self {
        if let Ok(families) = &mut self.families {
            match Family::new(elements, &self.particles) {
                Ok(family) if family.is_empty() => {}
                Ok(family) => families.push(Box::new(family)),
                Err(error) => self.families = Err(error),
            }
        }
        self
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: PdConfig) -> Self {
        self.config = config;
        self
    }

    /// The solver: assembles the matrix and analyses it. It is factorised in the first step, which tells the step size.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`], also for a weight that is negative or not finite; [`BuildError::NoSuchVertex`] if an element names a
    /// vertex that the particles do not have; [`BuildError::MatrixTooLarge`].
    pub fn build(self) -> Result<PdSolver, BuildError> {
        self.config.check()?;
        let families = self.families?;
        let global = GlobalSystem::new(&self.particles, &families)
            .map_err(|_| BuildError::MatrixTooLarge)?;
        let vertex_count = self.particles.len();
        let zeros = vec![Vec3::zeros(); vertex_count];
        let residual = |tolerance| Residual::new(tolerance, vertex_count);
        Ok(PdSolver {
            residual: self.config.tolerance.map(residual),
            config: self.config,
            particles: self.particles,
            families,
            global,
            origin: zeros.clone(),
            constant_pull: zeros.clone(),
            pull: zeros.clone(),
            displacement: zeros.clone(),
            positions: zeros,
        })
    }
}

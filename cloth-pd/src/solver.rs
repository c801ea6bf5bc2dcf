//! The algorithm.

use crate::config::{PdConfig, Start};
use crate::global::GlobalSystem;
use crate::local::{Family, Projections};
use crate::residual::Residual;
use cloth_core::element::Projective;
use cloth_core::math::Vec3;
use cloth_core::measure::predict;
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
    /// x̃ (m); a prescribed vertex is where it will be after the step.
    predicted: Vec<Vec3>,
    /// The part of b (N) that is the same in all iterations of a step.
    constant_pull: Vec<Vec3>,
    /// b (N).
    pull: Vec<Vec3>,
    /// `d = x − x̃` (m); zero for prescribed vertices.
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
        self.start(state);
        let mut iterations = 0;
        let outcome = loop {
            if self.global.is_empty() {
                break Outcome::Converged;
            }
            if iterations == self.config.iterations && self.residual.is_none() {
                break Outcome::BudgetSpent;
            }
            self.project(); // S1 (28)–(31)
            if self.is_converged(iterations) {
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
        self.finish(state, &input)?; // S1 (35)
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

    /// S1 (33): goes to `x̃ = x[0] + Δt v + Δt² a`, and gathers `Σ w Gᵀ(p − G x̃)`, with p only where it is constant.
    fn predict(&mut self, state: &State, input: &StepInput<'_>) {
        predict(&self.particles, state, input, &mut self.predicted);
        self.positions.copy_from_slice(&self.predicted);
        self.displacement.fill(Vec3::zeros());
        self.constant_pull.fill(Vec3::zeros());
        for family in &mut self.families {
            family.add_constant_pull(&self.predicted, &mut self.constant_pull);
        }
    }

    /// Goes to `x⁽⁰⁾`. If that is not x̃, and there is a tolerance, looks at x̃ first.
    fn start(&mut self, state: &State) {
        if let Some(residual) = &mut self.residual {
            residual.begin();
        }
        if self.config.start == Start::Predicted {
            return;
        }
        if self.residual.is_some() {
            self.project();
            if self.is_converged(0) {
                return;
            }
        }
        for (vertex, x) in self.positions.iter_mut().enumerate() {
            if !self.particles.is_prescribed(vertex) {
                *x = state.positions[vertex];
            }
        }
    }

    /// The local step: `b = Σ w Gᵀ(p(x) − G x̃)`.
    fn project(&mut self) {
        self.pull.copy_from_slice(&self.constant_pull);
        for family in &mut self.families {
            family.add_projections(&self.positions, &mut self.pull);
        }
    }

    fn is_converged(&mut self, iterations: u32) -> bool {
        let inverse_mass = self.particles.inverse_mass();
        self.residual
            .as_mut()
            .is_some_and(|residual| residual.is_met(inverse_mass, &self.pull, iterations))
    }

    /// The global step: `A d = b`, `x = x̃ + d`.
    fn solve(&mut self) {
        self.global.solve(&self.pull, &mut self.displacement);
        for vertex in 0..self.positions.len() {
            self.positions[vertex] = self.predicted[vertex] + self.displacement[vertex];
        }
    }

    /// S1 (35): `x[1] = x`; and `v[1] = (x − x[0])/Δt`, written as `v + Δt a + d/Δt`, which does not subtract positions.
    fn finish(&mut self, state: &mut State, input: &StepInput<'_>) -> Result<(), StepError> {
        let step = state.steps + 1;
        for (vertex, d) in self.displacement.iter_mut().enumerate() {
            let a = input.external_acceleration(vertex, self.particles.inverse_mass()[vertex]);
            *d = state.velocities[vertex] + a * input.dt + *d / input.dt;
            if !cloth_core::math::is_finite(&self.positions[vertex])
                || !cloth_core::math::is_finite(d)
            {
                return Err(StepError::NonFinite { vertex, step });
            }
        }
        state.positions.copy_from_slice(&self.positions);
        state.velocities.copy_from_slice(&self.displacement);
        state.time += input.dt;
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
            predicted: zeros.clone(),
            constant_pull: zeros.clone(),
            pull: zeros.clone(),
            displacement: zeros.clone(),
            positions: zeros,
        })
    }
}

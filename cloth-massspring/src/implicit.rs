//! Implicit Euler as a minimisation (MS-2).

mod line_search;
mod newton;
mod system;

use crate::config::{ImplicitConfig, StartGuess};
use cloth_core::block_matrix::BlockMatrix;
use cloth_core::element::Energy;
use cloth_core::family::Energies;
use cloth_core::linear::BlockCholesky;
use cloth_core::math::Vec3;
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, Outcome, StepError, StepInput, StepReport, Stepper};
use newton::{Newton, Task};
use system::NewtonSystem;

/// Implicit Euler, S1 (7)–(15).
#[derive(Debug)]
pub struct ImplicitEuler {
    particles: Particles,
    energies: Energies,
    config: ImplicitConfig,
    /// x̃ (m).
    predicted: Vec<Vec3>,
    newton: Newton,
}

impl ImplicitEuler {
    /// Starts the description of a solver for these particles.
    #[must_use]
    pub fn builder(particles: &Particles) -> ImplicitBuilder {
        ImplicitBuilder {
            energies: Energies::new(particles.len()),
            particles: particles.clone(),
            config: ImplicitConfig::default(),
        }
    }

    /// The settings.
    #[must_use]
    pub fn config(&self) -> &ImplicitConfig {
        &self.config
    }

    /// Writes the start guess to the current point of Newton's method.
    fn start(&mut self, state: &State, input: &StepInput<'_>) {
        let start = &mut self.newton.current.positions;
        for (vertex, start) in start.iter_mut().enumerate() {
            let (x, v) = (state.positions[vertex], state.velocities[vertex]);
            *start = match self.config.start {
                _ if self.particles.is_prescribed(vertex) => self.predicted[vertex],
                StartGuess::Previous => x,
                StartGuess::Inertial => x + v * input.dt,
                StartGuess::Predicted => self.predicted[vertex],
            };
        }
    }
}

impl Stepper for ImplicitEuler {
    fn name(&self) -> &'static str {
        "implicit-euler"
    }

    fn step(&mut self, state: &mut State, input: StepInput<'_>) -> Result<StepReport, StepError> {
        input.check(state, self.particles.len())?;
        let step = state.steps + 1;
        predict(&self.particles, state, &input, &mut self.predicted);
        let potential = IncrementalPotential {
            particles: &self.particles,
            energies: &self.energies,
            predicted: &self.predicted,
            dt: input.dt,
        };
        // The gradient at x̃ is the unit in which the residual is measured; its place in the memory is free until the iteration starts.
        let gradient = &mut self.newton.current.gradient;
        potential.gradient_into(&self.predicted, gradient);
        let reference = potential.gradient_norm(gradient);
        self.start(state, &input);
        let task = Task {
            potential: IncrementalPotential {
                particles: &self.particles,
                energies: &self.energies,
                predicted: &self.predicted,
                dt: input.dt,
            },
            config: &self.config,
            reference,
            step,
        };
        let report = if self.particles.free_count() == 0 {
            StepReport::new(Outcome::Converged, 0)
        } else {
            self.newton.minimize(&task, input.observer)?
        };
        let solution = &self.newton.current.positions;
        for (vertex, x) in state.positions.iter_mut().enumerate() {
            if !self.particles.is_prescribed(vertex) {
                state.velocities[vertex] = (solution[vertex] - *x) / input.dt;
            }
            *x = solution[vertex];
        }
        state.time += input.dt;
        state.steps = step;
        Ok(report)
    }
}

/// Description of an [`ImplicitEuler`].
#[derive(Debug)]
pub struct ImplicitBuilder {
    particles: Particles,
    energies: Energies,
    config: ImplicitConfig,
}

impl ImplicitBuilder {
    /// Adds elements of one kind.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`].
    pub fn energy<const N: usize, E: Energy<N>>(
        mut self,
        elements: Vec<E>,
    ) -> Result<Self, BuildError> {
        self.energies = self.energies.with(elements)?;
        Ok(self)
    }

    /// Sets the settings.
    #[must_use]
    pub fn config(mut self, config: ImplicitConfig) -> Self {
        self.config = config;
        self
    }

    /// Builds the solver: looks up the pattern of the matrix and analyses it for factorisation.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`], [`BuildError::MatrixTooLarge`].
    pub fn build(mut self) -> Result<ImplicitEuler, BuildError> {
        self.config.check()?;
        let vertex_count = self.particles.len();
        let pattern = self.energies.bind_pattern();
        let is_free: Vec<bool> = (0..vertex_count)
            .map(|vertex| !self.particles.is_prescribed(vertex))
            .collect();
        let cholesky =
            BlockCholesky::analyze(&pattern, &is_free).map_err(|_| BuildError::MatrixTooLarge)?;
        let matrix = BlockMatrix::zeros(pattern);
        let system = NewtonSystem::new(matrix, cholesky, self.config.hessian);
        Ok(ImplicitEuler {
            newton: Newton::new(system, vertex_count),
            predicted: vec![Vec3::zeros(); vertex_count],
            particles: self.particles,
            energies: self.energies,
            config: self.config,
        })
    }
}

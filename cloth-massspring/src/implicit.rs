//! Implicit Euler, S1 (7), as the minimisation S1 (10) (MS-2).
//!
//! The forces are taken at the end of the step, where they are not known yet. The positions there are the minimum of
//! [`IncrementalPotential`]; the rooms below go down to it: the loop in `newton`, the matrix in `system`, the step length in
//! `line_search`.

mod line_search;
mod newton;
mod system;

use crate::config::{ImplicitConfig, StartGuess};
use cloth_core::block_matrix::BlockMatrix;
use cloth_core::element::Energy;
use cloth_core::family::Energies;
use cloth_core::linear::BlockCholesky;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, Outcome, StepError, StepInput, StepReport, Stepper};
use newton::{Newton, Task};
use system::NewtonSystem;

/// Implicit Euler, S1 (7)–(15): every step is a minimum of `G`, found by Newton's method with a line search and a sparse
/// Cholesky factorisation.
///
/// Stable for any step, of first order, and heavily damped: an oscillation ω shrinks by `1/√(1 + (Δt ω)²)` a step. Linear
/// momentum is kept (to the tolerance), angular momentum is not.
///
/// The residual in the report is `‖∇G(x)‖/‖∇G(x̃)‖` at the end, in the norm of M⁻¹ (VALIDATION 8.1). A step has converged when it
/// is below the tolerance, or when the gradient is as small as rounding lets it be: positions are stored to half a
/// unit in the last place of their coordinates, `½ ε |x|`, and a spring answers that with a force of `½ ε |x| k`.
/// For a sheet of 1 m with springs of 10⁴ N/m and Δt = 1/60 s this floor lies between 10⁻¹¹ and 10⁻¹³ of `‖∇G(x̃)‖`.
///
/// Most of the time goes to the factorisations. Coupling that is not there is not paid for, but prescribed vertices are
/// those of the particles the solver was built for.
///
/// # Errors of a step
/// [`StepError::LineSearchStalled`] where no lower point is found though the gradient is more than a hundred times what rounding
/// explains; [`StepError::NotPositiveDefinite`] under [`HessianPolicy::Always`](crate::HessianPolicy::Always) of a Hessian that
/// may be indefinite, or with an energy of the caller's whose clamped Hessian is;
/// [`StepError::NonFinite`] where numbers overflow.
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

    /// Where Newton's method starts at a vertex (m).
    fn start(&self, vertex: usize, state: &State, dt: Real) -> Vec3 {
        let (x, v) = (state.positions[vertex], state.velocities[vertex]);
        match self.config.start {
            _ if self.particles.is_prescribed(vertex) => self.predicted[vertex],
            StartGuess::Previous => x,
            StartGuess::Inertial => x + v * dt,
            StartGuess::Predicted => self.predicted[vertex],
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
        for vertex in 0..self.particles.len() {
            self.newton.current.positions[vertex] = self.start(vertex, state, input.dt);
        }
        let mut report = StepReport::new(Outcome::Converged, 0);
        if self.particles.free_count() > 0 {
            let potential = IncrementalPotential {
                particles: &self.particles,
                energies: &self.energies,
                predicted: &self.predicted,
                dt: input.dt,
            };
            // The place of the gradient is free until the iteration starts.
            let gradient = &mut self.newton.current.gradient;
            potential.gradient_into(&self.predicted, gradient);
            let task = Task {
                potential,
                config: &self.config,
                reference: potential.gradient_norm(gradient),
                step,
            };
            report = self.newton.minimize(&task, input.observer)?;
        }
        let solution = &self.newton.current.positions;
        let overflow = |vertex: &usize| {
            let velocity = (solution[*vertex] - state.positions[*vertex]) / input.dt;
            !velocity.iter().all(|c| c.is_finite())
        };
        if let Some(vertex) = (0..self.particles.len()).find(overflow) {
            return Err(StepError::NonFinite { vertex, step });
        }
        for vertex in 0..self.particles.len() {
            if !self.particles.is_prescribed(vertex) {
                state.velocities[vertex] = (solution[vertex] - state.positions[vertex]) / input.dt;
            }
            state.positions[vertex] = solution[vertex];
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

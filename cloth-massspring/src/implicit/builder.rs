//! From a description to a solver.

use super::Implicit;
use super::damper::Damper;
use super::newton::Newton;
use super::system::NewtonSystem;
use crate::config::ImplicitConfig;
use cloth_core::block_matrix::BlockMatrix;
use cloth_core::element::Energy;
use cloth_core::family::Energies;
use cloth_core::math::Vec3;
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;
use std::sync::Arc;

/// Description of an [`ImplicitEuler`](crate::ImplicitEuler), an [`ImplicitMidpoint`](crate::ImplicitMidpoint) or a
/// [`Bdf2`](crate::Bdf2).
#[derive(Debug)]
pub struct ImplicitBuilder<S> {
    particles: Particles,
    energies: Energies,
    config: ImplicitConfig,
    finish: fn(Implicit) -> S,
}

impl<S> ImplicitBuilder<S> {
    pub(super) fn new(particles: &Particles, finish: fn(Implicit) -> S) -> Self {
        Self {
            energies: Energies::new(particles.len()),
            particles: particles.clone(),
            config: ImplicitConfig::default(),
            finish,
        }
    }

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

    /// Builds the solver: looks up the pattern of the matrix and analyses it for the linear solver.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`], [`BuildError::SettingsConflict`], [`BuildError::MatrixTooLarge`].
    pub fn build(mut self) -> Result<S, BuildError> {
        self.config.check()?;
        let vertex_count = self.particles.len();
        let pattern = self.energies.bind_pattern();
        let is_free: Vec<bool> = (0..vertex_count)
            .map(|vertex| !self.particles.is_prescribed(vertex))
            .collect();
        let solver = self.config.linear.build(&pattern, &is_free)?;
        let beta = self.config.damping.stiffness;
        let damper = (beta > 0.0).then(|| Damper::new(beta, Arc::clone(&pattern)));
        let matrix = BlockMatrix::zeros(pattern);
        let system = NewtonSystem::new(matrix, solver, self.config.hessian);
        let zeros = vec![Vec3::zeros(); vertex_count];
        Ok((self.finish)(Implicit {
            newton: Newton::new(system, vertex_count),
            base: zeros.clone(),
            predicted: zeros.clone(),
            found: [zeros.clone(), zeros],
            damper,
            particles: self.particles,
            energies: self.energies,
            config: self.config,
        }))
    }
}

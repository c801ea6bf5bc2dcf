//! From a description to a solver.

use super::Model;
use crate::config::ExplicitConfig;
use cloth_core::element::Energy;
use cloth_core::method::family::Energies;
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Description of an [`ExplicitEuler`](crate::ExplicitEuler) or a [`SymplecticEuler`](crate::SymplecticEuler).
#[derive(Debug)]
pub struct ExplicitBuilder<S> {
    model: Model,
    finish: fn(Model) -> S,
}

impl<S> ExplicitBuilder<S> {
    pub(super) fn new(particles: &Particles, finish: fn(Model) -> S) -> Self {
        Self {
            model: Model {
                particles: particles.clone(),
                energies: Energies::new(particles.len()),
                config: ExplicitConfig::default(),
            },
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
        self.model.energies = self.model.energies.with(elements)?;
        Ok(self)
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: ExplicitConfig) -> Self {
        self.model.config = config;
        self
    }

    /// Builds the solver.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`].
    pub fn build(self) -> Result<S, BuildError> {
        self.model.config.check()?;
        Ok((self.finish)(self.model))
    }
}

//! From a description to a solver.

use super::Parts;
use crate::config::ExplicitConfig;
use cloth_core::element::Energy;
use cloth_core::family::Energies;
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Description of an [`ExplicitEuler`](crate::ExplicitEuler) or a [`SymplecticEuler`](crate::SymplecticEuler).
#[derive(Debug)]
pub struct ExplicitBuilder<S> {
    parts: Parts,
    finish: fn(Parts) -> S,
}

impl<S> ExplicitBuilder<S> {
    pub(super) fn new(particles: &Particles, finish: fn(Parts) -> S) -> Self {
        Self {
            parts: Parts {
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
        self.parts.energies = self.parts.energies.with(elements)?;
        Ok(self)
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: ExplicitConfig) -> Self {
        self.parts.config = config;
        self
    }

    /// Builds the solver.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`].
    pub fn build(self) -> Result<S, BuildError> {
        self.parts.config.check()?;
        Ok((self.finish)(self.parts))
    }
}

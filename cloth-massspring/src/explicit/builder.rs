//! From a description to a solver.

use super::Model;
use crate::config::ExplicitConfig;
use cloth_core::cloth::Elements;
use cloth_core::element::Energy;
use cloth_core::method::family::Energies;
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Description of an [`ExplicitEuler`](crate::ExplicitEuler) or a [`SymplecticEuler`](crate::SymplecticEuler).
#[derive(Debug)]
pub struct ExplicitBuilder<S> {
    particles: Particles,
    energies: Result<Energies, BuildError>,
    config: ExplicitConfig,
    finish: fn(Model) -> S,
}

impl<S> ExplicitBuilder<S> {
    pub(super) fn new(particles: &Particles, finish: fn(Model) -> S) -> Self {
        Self {
            particles: particles.clone(),
            energies: Ok(Energies::new(particles.len())),
            config: ExplicitConfig::default(),
            finish,
        }
    }

    /// Adds elements of one kind.
    #[must_use]
    pub fn energy<const N: usize, E: Energy<N>>(mut self, elements: Vec<E>) -> Self {
        self.energies = self.energies.and_then(|sum| sum.with(elements));
        self
    }

    /// Adds all elements of a cloth, as [`ClothModel::families`](cloth_core::ClothModel::families) has them.
    #[must_use]
    pub fn elements(mut self, families: Vec<Elements>) -> Self {
        self.energies = self.energies.and_then(|sum| sum.with_elements(families));
        self
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: ExplicitConfig) -> Self {
        self.config = config;
        self
    }

    /// Builds the solver.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a vertex that the particles
    /// do not have, or one twice; [`BuildError::InvalidElement`] for a number of one; [`BuildError::OutOfRange`].
    pub fn build(self) -> Result<S, BuildError> {
        self.config.check()?;
        Ok((self.finish)(Model {
            particles: self.particles,
            energies: self.energies?,
            config: self.config,
        }))
    }
}

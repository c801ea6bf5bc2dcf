//! From a description to a solver.

use super::Implicit;
use super::at_end::Room;
use super::damper::Damper;
use super::minimizer::Minimizer;
use crate::config::ImplicitConfig;
use cloth_core::cloth::Elements;
use cloth_core::element::Energy;
use cloth_core::math::Vec3;
use cloth_core::method::family::Energies;
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Description of an [`ImplicitEuler`](crate::ImplicitEuler), an [`ImplicitMidpoint`](crate::ImplicitMidpoint) or a
/// [`Bdf2`](crate::Bdf2).
#[derive(Debug)]
pub struct ImplicitBuilder<S> {
    particles: Particles,
    energies: Result<Energies, BuildError>,
    config: ImplicitConfig,
    finish: fn(Implicit) -> S,
}

impl<S> ImplicitBuilder<S> {
    pub(super) fn new(particles: &Particles, finish: fn(Implicit) -> S) -> Self {
        Self {
            energies: Ok(Energies::new(particles.len())),
            particles: particles.clone(),
            config: ImplicitConfig::default(),
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

    /// Sets the settings.
    #[must_use]
    pub fn config(mut self, config: ImplicitConfig) -> Self {
        self.config = config;
        self
    }

    /// Builds the solver: looks up the pattern of the matrix, and analyses it for the linear solver if that is what the
    /// step begins with.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] if an element names a vertex that the particles do not have;
    /// [`BuildError::OutOfRange`], [`BuildError::SettingsConflict`], [`BuildError::MatrixTooLarge`].
    pub fn build(self) -> Result<S, BuildError> {
        self.config.check()?;
        let energies = self.energies?;
        let vertex_count = self.particles.len();
        let beta = self.config.damping.stiffness;
        let damper = (beta > 0.0).then(|| Damper::new(beta, energies.assembly()));
        let minimizer = Minimizer::new(&self.particles, &energies, &self.config)?;
        let zeros = vec![Vec3::zeros(); vertex_count];
        Ok((self.finish)(Implicit {
            minimizer,
            base: zeros.clone(),
            predicted: zeros.clone(),
            before: (zeros, 0.0),
            damper,
            room: Room::default(),
            particles: self.particles,
            energies,
            config: self.config,
        }))
    }
}

//! Pins that move on a prescribed path.

use crate::math::{Real, Vec3};
use crate::particles::{ParticleError, Particles, State};
use std::fmt;
use std::sync::Arc;

/// Position (m) of a pin as a function of time (s).
type Path = Arc<dyn Fn(Real) -> Vec3 + Send + Sync>;

/// Prescribed vertices and the paths they follow.
///
/// A prescribed vertex travels with its own velocity. Before each step [`Pins::steer`] sets the velocity that takes it
/// to where its path is at the end of the step, so that every method sees the same motion without knowing of paths.
#[derive(Clone, Default)]
pub struct Pins {
    paths: Vec<(usize, Path)>,
}

impl fmt::Debug for Pins {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vertices: Vec<usize> = self.paths.iter().map(|(vertex, _)| *vertex).collect();
        f.debug_struct("Pins").field("vertices", &vertices).finish()
    }
}

impl Pins {
    /// No pins.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether no vertex follows a path.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.paths.is_empty()
    }

    /// Prescribes `vertex` in `particles` and makes it follow `path` (time in s to position in m).
    ///
    /// # Errors
    /// [`ParticleError::NoSuchVertex`].
    pub fn follow(
        &mut self,
        particles: &mut Particles,
        vertex: usize,
        path: impl Fn(Real) -> Vec3 + Send + Sync + 'static,
    ) -> Result<(), ParticleError> {
        particles.prescribe(vertex)?;
        self.paths.push((vertex, Arc::new(path)));
        Ok(())
    }

    /// Lets `vertex` go in `particles`; it follows no path any more.
    ///
    /// # Errors
    /// [`ParticleError::NoSuchVertex`].
    pub fn release(
        &mut self,
        particles: &mut Particles,
        vertex: usize,
    ) -> Result<(), ParticleError> {
        particles.release(vertex)?;
        self.paths.retain(|(held, _)| *held != vertex);
        Ok(())
    }

    /// Sets the velocities (m/s) with which the pins reach their paths after a step of `dt` (s).
    ///
    /// # Panics
    /// If `dt` is not a positive number, or `state` has fewer vertices than the particles the pins were made for.
    pub fn steer(&self, state: &mut State, dt: Real) {
        assert!(dt > 0.0, "the step is {dt} s, but it has to be positive");
        for (vertex, path) in &self.paths {
            let goal = path(state.time + dt);
            state.velocities[*vertex] = (goal - state.positions[*vertex]) / dt;
        }
    }
}

//! Pins that move on a prescribed path.

use crate::math::{Real, Vec3, is_finite};
use crate::particles::{ParticleError, Particles, State};
use nalgebra::{Rotation3, Unit};
use std::fmt;
use std::sync::Arc;

/// Position (m) of a pin as a function of time (s).
type Path = Arc<dyn Fn(Real) -> Vec3 + Send + Sync>;

/// A turn about an axis and a shift at the same time, at a constant rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinMotion {
    /// The whole shift (m).
    pub shift: Vec3,
    /// The whole rotation (rad): its direction is the axis, its length the angle.
    pub turn: Vec3,
    /// A point on the axis (m).
    pub centre: Vec3,
    /// How long it takes (s); rest after it. With 0 all of it is at once.
    pub duration: Real,
}

impl PinMotion {
    /// Rest.
    pub const NONE: Self = Self {
        shift: Vec3::new(0.0, 0.0, 0.0),
        turn: Vec3::new(0.0, 0.0, 0.0),
        centre: Vec3::new(0.0, 0.0, 0.0),
        duration: 1.0,
    };

    /// Where (m) a point is at a time (s) that is at `start` (m) until the time `since` (s).
    ///
    /// ```
    /// use cloth_core::{math::Vec3, pin::PinMotion};
    /// let motion = PinMotion { shift: Vec3::x(), duration: 2.0, ..PinMotion::NONE };
    /// let [before, halfway, after] = [0.5, 2.0, 9.0].map(|time| motion.position(Vec3::y(), 1.0, time));
    /// assert_eq!([before, halfway, after], [0.0, 0.5, 1.0].map(|part| Vec3::y() + Vec3::x() * part));
    /// let at_once = PinMotion { duration: 0.0, ..motion };
    /// assert_eq!(at_once.position(Vec3::y(), 1.0, 1.0), Vec3::y() + Vec3::x());
    /// ```
    #[must_use]
    pub fn position(&self, start: Vec3, since: Real, time: Real) -> Vec3 {
        let from_centre = start - self.centre;
        let elapsed = time - since;
        let part = if elapsed < self.duration {
            (elapsed / self.duration).max(0.0)
        } else {
            1.0
        };
        let turned = match Unit::try_new_and_get(self.turn, 0.0) {
            Some((axis, angle)) => Rotation3::from_axis_angle(&axis, part * angle) * from_centre,
            None => from_centre,
        };
        self.centre + turned + self.shift * part
    }

    /// The greatest speed (m/s) of a point that is at `start` (m) before it, or more: of the shift and of the turn
    /// together. 0 for what is all at once.
    #[must_use]
    pub fn max_speed(&self, start: Vec3) -> Real {
        let length = self.shift.norm() + self.turn.norm() * (start - self.centre).norm();
        if self.duration > 0.0 {
            length / self.duration
        } else {
            0.0
        }
    }
}

/// Prescribed vertices and the paths they follow.
///
/// A prescribed vertex travels with its own velocity. Before each step [`Pins::set_velocities`] sets the velocity that
/// takes it to where its path is at the end of the step, so that every method sees the same motion without knowing of
/// paths.
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

    /// Prescribes `vertex` in `particles` and makes it follow `path` (time in s to position in m), in place of one that
    /// it may have followed before.
    ///
    /// # Errors
    /// [`ParticleError::NoSuchVertex`].
    pub fn add_path(
        &mut self,
        particles: &mut Particles,
        vertex: usize,
        path: impl Fn(Real) -> Vec3 + Send + Sync + 'static,
    ) -> Result<(), ParticleError> {
        particles.prescribe(vertex)?;
        self.paths.retain(|(held, _)| *held != vertex);
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

    /// The greatest speed (m/s) of a pin on its path within `dt` (s) after `time` (s), in the mean over that; 0 without
    /// any.
    #[must_use]
    pub fn max_speed(&self, time: Real, dt: Real) -> Real {
        let paths = self.paths.iter();
        let speeds = paths.map(|(_, path)| (path(time + dt) - path(time)).norm() / dt);
        speeds.fold(0.0, Real::max)
    }

    /// Sets the velocities (m/s) with which the pins reach their paths after a step of `dt` (s).
    ///
    /// # Errors
    /// [`ParticleError::InvalidTimeStep`] if `dt` is not positive and finite; [`ParticleError::NoSuchVertex`] if
    /// `state` has fewer vertices than the particles the pins were made for; [`ParticleError::InvalidPath`] if the
    /// velocity of a pin would not be finite. Nothing has changed then.
    pub fn set_velocities(&self, state: &mut State, dt: Real) -> Result<(), ParticleError> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(ParticleError::InvalidTimeStep { dt });
        }
        let vertex_count = state.positions.len().min(state.velocities.len());
        let last = self.paths.iter().map(|(vertex, _)| *vertex).max();
        if let Some(vertex) = last.filter(|last| *last >= vertex_count) {
            return Err(ParticleError::NoSuchVertex {
                vertex,
                vertex_count,
            });
        }
        let time = state.time + dt;
        let reaches = |vertex: usize, path: &Path| (path(time) - state.positions[vertex]) / dt;
        let is_bad = |(vertex, path): &&(usize, Path)| !is_finite(&reaches(*vertex, path));
        if let Some(&(vertex, _)) = self.paths.iter().find(is_bad) {
            return Err(ParticleError::InvalidPath { vertex, time });
        }
        for (vertex, path) in &self.paths {
            state.velocities[*vertex] = (path(time) - state.positions[*vertex]) / dt;
        }
        Ok(())
    }
}

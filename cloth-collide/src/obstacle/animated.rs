//! A surface that changes its shape in a given way: a moving character.

use super::{ObstacleError, positive};
use crate::bounds::farthest;
use cloth_core::error::{number, within};
use cloth_core::math::{Real, Vec3, is_finite};
use std::sync::Arc;

/// The vertices of a surface at times that are equally far apart; in between they go straight.
///
/// It is the first shape before time 0, and the last one from the last time on.
#[derive(Clone, Debug)]
pub struct AnimatedMesh {
    shapes: Arc<[Vec<Vec3>]>,
    interval: Real,
}

impl AnimatedMesh {
    /// Goes through `shapes` (m), one every `interval` (s).
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`] without any, or for the interval, [`ObstacleError::ShapeSize`] if not all have as
    /// many vertices, [`ObstacleError::NonFinite`].
    pub fn new(shapes: Vec<Vec<Vec3>>, interval: Real) -> Result<Self, ObstacleError> {
        let interval = positive("time between two shapes (s)", interval)?;
        positive(
            "number of shapes of an animated surface",
            shapes.len() as Real,
        )?;
        let expected = shapes[0].len();
        for (shape, positions) in shapes.iter().enumerate() {
            let found = positions.len();
            if found != expected {
                return Err(ObstacleError::ShapeSize {
                    shape,
                    found,
                    expected,
                });
            }
            if !positions.iter().all(is_finite) {
                let name = "vertex of an animated surface";
                return Err(ObstacleError::NonFinite { name });
            }
        }
        Ok(Self {
            shapes: shapes.into(),
            interval,
        })
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.shapes[0].len()
    }

    /// Number of shapes.
    #[must_use]
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// The greatest speed (m/s) of a vertex, between any two shapes.
    #[must_use]
    pub fn max_speed(&self) -> Real {
        let pairs = self.shapes.windows(2);
        let farthest = pairs.map(|pair| farthest(&pair[0], &pair[1], Vec3::zeros()));
        farthest.fold(0.0, Real::max) / self.interval
    }

    /// Writes where the vertices are at `time` (s) to `out` (m).
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`] if `out` does not have one place per vertex, or the time is not a number (it may
    /// be infinite). Nothing is written then.
    pub fn place(&self, time: Real, out: &mut [Vec3]) -> Result<(), ObstacleError> {
        number("time of an animated surface (s)", time)?;
        let (found, expected) = (out.len(), self.vertex_count());
        let name = "number of places of an animated surface";
        within(
            found == expected,
            name,
            found as Real,
            "that of its vertices",
        )?;
        self.interpolate(time, out);
        Ok(())
    }

    /// The same, of a `time` (s) that is a number, to one place per vertex.
    pub(crate) fn interpolate(&self, time: Real, out: &mut [Vec3]) {
        let (first, second, fraction) = self.between(time);
        let (a, b) = (&self.shapes[first], &self.shapes[second]);
        for ((x, a), b) in out.iter_mut().zip(a).zip(b) {
            *x = a + (b - a) * fraction;
        }
    }

    /// Where one vertex is (m) at a `time` (s) that is a number.
    pub(super) fn vertex(&self, vertex: usize, time: Real) -> Vec3 {
        let (first, second, fraction) = self.between(time);
        let (a, b) = (self.shapes[first][vertex], self.shapes[second][vertex]);
        a + (b - a) * fraction
    }

    /// The two shapes around a time (s), and what part of the way to the second it is.
    fn between(&self, time: Real) -> (usize, usize, Real) {
        let last = self.shapes.len() - 1;
        let place = (time / self.interval).clamp(0.0, last as Real);
        let first = (place as usize).min(last.saturating_sub(1));
        (first, (first + 1).min(last), place - first as Real)
    }
}

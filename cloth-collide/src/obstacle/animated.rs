//! A surface that changes its shape in a given way: a moving character.

use super::ObstacleError;
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
    /// [`ObstacleError::NoShape`] without any, [`ObstacleError::ShapeSize`] if not all have as many vertices,
    /// [`ObstacleError::NotPositive`], [`ObstacleError::NonFinite`].
    pub fn new(shapes: Vec<Vec<Vec3>>, interval: Real) -> Result<Self, ObstacleError> {
        let interval = super::positive("time between two shapes (s)", interval)?;
        let expected = shapes.first().ok_or(ObstacleError::NoShape)?.len();
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

    /// How long it moves (s).
    #[must_use]
    pub fn duration(&self) -> Real {
        self.interval * (self.shapes.len() - 1) as Real
    }

    /// Writes where the vertices are at `time` (s) to `out` (m), as many as there are.
    pub fn place(&self, time: Real, out: &mut [Vec3]) {
        let last = self.shapes.len() - 1;
        let place = (time / self.interval).clamp(0.0, last as Real);
        let first = (place as usize).min(last.saturating_sub(1));
        let part = place - first as Real;
        let (a, b) = (&self.shapes[first], &self.shapes[(first + 1).min(last)]);
        for ((x, a), b) in out.iter_mut().zip(a).zip(b) {
            *x = a + (b - a) * part;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goes_straight_from_shape_to_shape_and_stays_at_the_ends() {
        let at = |x: Real| vec![Vec3::x() * x, Vec3::y() * x];
        let mesh = AnimatedMesh::new(vec![at(1.0), at(2.0), at(4.0)], 0.5).unwrap();
        assert_eq!((mesh.vertex_count(), mesh.duration()), (2, 1.0));
        for (time, expected) in [
            (-1.0, 1.0),
            (0.0, 1.0),
            (0.25, 1.5),
            (0.5, 2.0),
            (0.875, 3.5),
            (1.0, 4.0),
            (9.0, 4.0),
        ] {
            let mut out = vec![Vec3::zeros(); 2];
            mesh.place(time, &mut out);
            assert_eq!(out, at(expected), "at {time} s");
        }
        let one = AnimatedMesh::new(vec![at(3.0)], 1.0).unwrap();
        let mut out = vec![Vec3::zeros(); 2];
        one.place(7.0, &mut out);
        assert_eq!(out, at(3.0));
    }

    #[test]
    fn what_is_no_animation_is_named() {
        let one = || vec![Vec3::zeros()];
        let made = |shapes, interval| AnimatedMesh::new(shapes, interval).unwrap_err();
        assert_eq!(made(vec![], 1.0), ObstacleError::NoShape);
        let (shape, found, expected) = (1, 2, 1);
        let size = ObstacleError::ShapeSize {
            shape,
            found,
            expected,
        };
        assert_eq!(made(vec![one(), vec![Vec3::zeros(); 2]], 1.0), size);
        let nan = vec![Vec3::x() * Real::NAN];
        assert!(matches!(
            made(vec![nan], 1.0),
            ObstacleError::NonFinite { .. }
        ));
        assert!(matches!(
            made(vec![one()], 0.0),
            ObstacleError::NotPositive { .. }
        ));
    }
}

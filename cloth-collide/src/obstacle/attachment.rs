//! A point that a moving surface takes along.

use super::{AnimatedMesh, ObstacleError, finite};
use crate::closest::point_triangle;
use cloth_core::error::{OutOfRange, within};
use cloth_core::math::{Real, Vec3};
use nalgebra::Matrix3;

/// A point fixed to the triangle of an animated surface that is nearest to it: a button, a waistband, a pin.
///
/// With the nearest point Σ wᵢ xᵢ of the triangle and a frame F of its first edge, its normal and what is across, it is
/// at Σ wᵢ xᵢ(t) + F(t) d, where d does not change. So it goes along with translations and turns exactly, and keeps its
/// height above the plane of a triangle that is stretched.
#[derive(Clone, Debug)]
pub struct Attachment {
    animation: AnimatedMesh,
    corners: [usize; 3],
    weights: [Real; 3],
    /// From the nearest point (m), in the frame of the triangle.
    offset: Vec3,
}

impl AnimatedMesh {
    /// Fixes a `point` (m) to the triangle that is nearest to it at `time` (s); the first one of several.
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`] if a triangle has a vertex beyond those of the surface, if there is none with an
    /// area then, or if the time is not finite; [`ObstacleError::NonFinite`] for the point.
    ///
    /// ```
    /// use cloth_collide::obstacle::AnimatedMesh;
    /// use cloth_core::math::Vec3;
    ///
    /// let down = vec![Vec3::zeros(), Vec3::x(), Vec3::y()];
    /// let up = down.iter().map(|x| x + Vec3::z()).collect();
    /// let lift = AnimatedMesh::new(vec![down, up], 1.0)?;
    /// let button = lift.attach(&[[0, 1, 2]], Vec3::new(0.25, 0.25, 0.01), 0.0)?;
    /// assert!((button.position(0.5) - Vec3::new(0.25, 0.25, 0.51)).norm() < 1e-15);
    /// # Ok::<(), cloth_collide::obstacle::ObstacleError>(())
    /// ```
    pub fn attach(
        &self,
        triangles: &[[u32; 3]],
        point: Vec3,
        time: Real,
    ) -> Result<Attachment, ObstacleError> {
        finite("point that goes with a surface", point)?;
        let name = "time of an attachment (s)";
        within(time.is_finite(), name, time, "finite")?;
        let last = triangles.iter().flatten().max().map_or(0, |&v| v as usize);
        let (name, range) = ("vertex of a triangle", "one of the animated surface");
        within(last < self.vertex_count(), name, last as Real, range)?;
        let mut nearest: Option<Attachment> = None;
        let mut distance = Real::INFINITY;
        for triangle in triangles {
            let corners = triangle.map(|v| v as usize);
            let placed = corners.map(|v| self.vertex(v, time));
            let Some(frame) = frame(placed) else {
                continue;
            };
            let near = point_triangle(point, placed);
            if near.distance() < distance {
                distance = near.distance();
                nearest = Some(Attachment {
                    animation: self.clone(),
                    corners,
                    weights: near.weights,
                    offset: frame.transpose() * near.separation,
                });
            }
        }
        nearest.ok_or(ObstacleError::OutOfRange(OutOfRange {
            name: "number of triangles with an area",
            value: 0.0,
            range: "at least 1, to fix a point to",
        }))
    }
}

impl Attachment {
    /// Where the point is at `time` (s); not a number where its triangle has no area.
    #[must_use]
    pub fn position(&self, time: Real) -> Vec3 {
        let placed = self.corners.map(|v| self.animation.vertex(v, time));
        let frame = frame(placed).unwrap_or_else(|| Matrix3::repeat(Real::NAN));
        let [a, b, c] = placed;
        let [wa, wb, wc] = self.weights;
        a * wa + b * wb + c * wc + frame * self.offset
    }
}

/// Along the first edge of a triangle, across it in its plane, and along its normal; nothing without an area.
fn frame([a, b, c]: [Vec3; 3]) -> Option<Matrix3<Real>> {
    let along = (b - a).try_normalize(0.0)?;
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
    Some(Matrix3::from_columns(&[
        along,
        normal.cross(&along),
        normal,
    ]))
}

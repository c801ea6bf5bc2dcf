//! A shape in its place.

use super::{Distance, ObstacleError, RigidMotion, SignedDistance};
use cloth_core::math::{Real, Vec3};
use std::sync::Arc;

/// A shape that stands still or moves as a rigid body.
///
/// The shape is shared, not copied: one mesh may stand in many places. Moving it costs nothing, because points are
/// taken to the shape and not the shape to the points.
///
/// ```
/// use cloth_collide::obstacle::{Obstacle, Pose, RigidMotion, Sphere};
/// use cloth_core::math::Vec3;
/// let rising = RigidMotion { velocity: Vec3::z(), ..RigidMotion::default() };
/// let ball = Obstacle::moving(Sphere::new(0.5)?, rising)?;
/// // After 2 s its centre is at z = 2 m.
/// assert_eq!(ball.signed_distance(Vec3::new(0.0, 0.0, 3.0), 2.0).value, 0.5);
/// # Ok::<(), cloth_collide::obstacle::ObstacleError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Obstacle {
    shape: Arc<dyn SignedDistance>,
    motion: RigidMotion,
}

impl Obstacle {
    /// `shape` where its own frame is the world's.
    #[must_use]
    pub fn new(shape: impl SignedDistance + 'static) -> Self {
        Self {
            shape: Arc::new(shape),
            motion: RigidMotion::default(),
        }
    }

    /// `shape` on its path.
    ///
    /// # Errors
    /// As [`Obstacle::set_motion`].
    pub fn moving(
        shape: impl SignedDistance + 'static,
        motion: RigidMotion,
    ) -> Result<Self, ObstacleError> {
        let mut obstacle = Self::new(shape);
        obstacle.set_motion(motion)?;
        Ok(obstacle)
    }

    /// Replaces the motion. Its time starts at 0 again.
    ///
    /// # Errors
    /// [`ObstacleError::NonFinite`], or [`ObstacleError::OutOfRange`] for a quaternion that is not of unit length. The
    /// obstacle then moves as before.
    pub fn set_motion(&mut self, motion: RigidMotion) -> Result<(), ObstacleError> {
        self.motion = motion.checked()?;
        Ok(())
    }

    /// Lets `time` (s) pass: where the obstacle is then becomes where it is at time 0.
    ///
    /// # Errors
    /// [`ObstacleError::NonFinite`] if that is nowhere. The obstacle then stays where it was.
    pub fn advance(&mut self, time: Real) -> Result<(), ObstacleError> {
        let pose = self.motion.pose_at(time);
        self.set_motion(RigidMotion {
            pose,
            ..self.motion
        })
    }

    /// The same shape, standing still where it is at time 0.
    #[must_use]
    pub(crate) fn stopped(&self) -> Self {
        Self {
            shape: Arc::clone(&self.shape),
            motion: RigidMotion::still(self.motion.pose),
        }
    }

    /// How it moves.
    #[must_use]
    pub fn motion(&self) -> &RigidMotion {
        &self.motion
    }

    /// The shape, in its own frame.
    #[must_use]
    pub fn shape(&self) -> &dyn SignedDistance {
        &*self.shape
    }

    /// Signed distance (m) and normal at `point` (m) of the world, after `time` (s).
    #[must_use]
    pub fn signed_distance(&self, point: Vec3, time: Real) -> Distance {
        let pose = self.motion.pose_at(time);
        let local = self.shape.signed_distance(pose.to_local(point));
        Distance {
            normal: pose.orientation * local.normal,
            ..local
        }
    }

    /// [`SignedDistance::each_part`] at `point` (m) of the world, at time 0.
    pub fn each_part(&self, point: Vec3, range: Real, visit: &mut dyn FnMut(Distance, Real)) {
        let pose = self.motion.pose;
        let local = pose.to_local(point);
        self.shape.each_part(local, range, &mut |at, weight| {
            let normal = pose.orientation * at.normal;
            visit(Distance { normal, ..at }, weight);
        });
    }
}

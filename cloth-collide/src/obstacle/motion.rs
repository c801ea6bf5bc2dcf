//! Where a rigid body is, and how it moves.

use super::{ObstacleError, finite};
use cloth_core::error::within;
use cloth_core::math::{Real, Vec3};
use nalgebra::UnitQuaternion;

/// How far the length of a quaternion may be from 1.
const UNIT: Real = 1e-6;

/// Place of a rigid body: x = p + R y takes a point y (m) of its own frame into the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Where the origin of its frame is, p (m).
    pub position: Vec3,
    /// How its frame is turned, R.
    pub orientation: UnitQuaternion<Real>,
}

impl Pose {
    /// At `position` (m), not turned.
    #[must_use]
    pub fn at(position: Vec3) -> Self {
        Self {
            position,
            ..Self::default()
        }
    }

    /// The same place, turned by `rotation` (rad) first: its direction is the axis, its length the angle.
    #[must_use]
    pub fn turned(self, rotation: Vec3) -> Self {
        Self {
            orientation: UnitQuaternion::new(rotation) * self.orientation,
            ..self
        }
    }

    /// A point (m) of the world, in the frame of the body (m).
    #[must_use]
    pub fn to_local(&self, point: Vec3) -> Vec3 {
        self.orientation.inverse() * (point - self.position)
    }

    /// A point (m) of the body, in the world (m).
    #[must_use]
    pub fn to_world(&self, point: Vec3) -> Vec3 {
        self.position + self.orientation * point
    }
}

/// A pose at time 0, and the velocities that it keeps: over one step every motion is one of these.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidMotion {
    /// The pose at time 0.
    pub pose: Pose,
    /// Velocity v of the origin of the frame (m/s).
    pub velocity: Vec3,
    /// Angular velocity ω (rad/s), about the origin of the frame, which moves along; in world axes.
    pub angular_velocity: Vec3,
}

impl RigidMotion {
    /// No motion.
    #[must_use]
    pub fn still(pose: Pose) -> Self {
        Self {
            pose,
            ..Self::default()
        }
    }

    /// The pose after `time` (s).
    #[must_use]
    pub fn pose_at(&self, time: Real) -> Pose {
        let mut pose = self.pose;
        pose.position += self.velocity * time;
        let turn = self.angular_velocity * time;
        // After no time the pose itself: a step begins where the last one has ended, to the last digit.
        if turn == Vec3::zeros() {
            return pose;
        }
        let mut pose = pose.turned(turn);
        // Products of many turns drift away from unit length.
        pose.orientation.renormalize();
        pose
    }

    /// Velocity (m/s) that the body has at `point` (m) of the world after `time` (s): v + ω × (x − p).
    #[must_use]
    pub fn velocity_at(&self, point: Vec3, time: Real) -> Vec3 {
        let centre = self.pose.position + self.velocity * time;
        self.velocity + self.angular_velocity.cross(&(point - centre))
    }

    /// Whether nothing moves.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.velocity == Vec3::zeros() && self.angular_velocity == Vec3::zeros()
    }

    /// The motion, if all its numbers are finite and its orientation is a rotation.
    pub(super) fn checked(self) -> Result<Self, ObstacleError> {
        finite("position of an obstacle", self.pose.position)?;
        finite("velocity of an obstacle", self.velocity)?;
        finite("angular velocity of an obstacle", self.angular_velocity)?;
        let turned = self.pose.orientation * Vec3::new(1.0, 1.0, 1.0);
        finite("orientation of an obstacle", turned)?;
        let (name, length) = (
            "length of the quaternion of an obstacle",
            self.pose.orientation.quaternion().norm(),
        );
        within((length - 1.0).abs() < UNIT, name, length, "1")?;
        Ok(self)
    }
}

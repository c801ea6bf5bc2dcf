//! How fast the cloth of a scene can become, or be made: what the number of substeps of sweeps is chosen by.

use super::{Change, ChangeKind, ContactSetup, HeldMotion, Scene};
use crate::bounds::bounds;
use cloth_collide::obstacle::Obstacle;
use cloth_core::math::{Real, Vec3};

/// Time (s) in which speeds of pins are measured.
const INSTANT: Real = 1e-6;

impl Scene {
    /// The greatest height (m) through which any part of the cloth can fall: its own length, for it may swing, and its
    /// distance from the obstacle that is farthest away; no more than what is above a floor, if nothing can lift it.
    pub fn fall(&self) -> Real {
        let places = &self.start.positions;
        let [low, high] = bounds(places.iter().copied());
        let touch = self.touch.iter().filter(|touch| !touch.is_idle());
        let obstacles = touch.flat_map(ContactSetup::obstacles);
        let obstacles = obstacles.filter(|o| o.shape().error_bound() < Real::INFINITY);
        let (mut below, mut above): (Real, Real) = (0.0, Real::INFINITY);
        for obstacle in obstacles {
            let distance = |&x: &Vec3| obstacle.signed_distance(x, 0.0).value;
            let distances = places.iter().map(distance);
            if obstacle.shape().bounds().is_none() && self.lies_level(obstacle) {
                above = above.min(distances.clone().fold(0.0, Real::max));
            }
            below = below.max(distances.fold(Real::INFINITY, Real::min));
        }
        let fall = (high - low).amax() + below;
        if self.is_left_alone() {
            fall.min(above)
        } else {
            fall
        }
    }

    /// Whether the plane is a floor, across gravity.
    fn lies_level(&self, plane: &Obstacle) -> bool {
        let up = plane.signed_distance(self.start.positions[0], 0.0).normal;
        -up.dot(&self.gravity) >= (1.0 - 1e-9) * self.gravity.norm()
    }

    /// Whether nothing moves the cloth but gravity: neither pins nor bodies, air or what is inside of it.
    fn is_left_alone(&self) -> bool {
        let mut touch = self.touch.iter();
        self.pins.is_none()
            && self.changes.is_empty()
            && self.air.is_none()
            && self.gases.is_empty()
            && self.volumes.is_empty()
            && self.start.velocities.iter().all(|v| *v == Vec3::zeros())
            && touch.all(ContactSetup::stands_still)
    }

    /// The greatest speed (m/s) with which pins or bodies move at any time, or the cloth at the start where something
    /// can stop it.
    pub fn driving_speed(&self) -> Real {
        let now = self.start.time;
        let pins = self.pins.iter().map(|pins| pins.max_speed(now, INSTANT));
        let soft = self.model.soft_pins();
        let soft = soft.map(|pin| pin.motion().max_speed(pin.target_at(now)));
        let changes = self.changes.iter().map(|change| self.speed_of(change));
        let bodies = self.touch.iter().map(ContactSetup::max_speed);
        let is_stopped = self.can_touch() || self.pins.is_some();
        let own = self.start.velocities.iter().filter(|_| is_stopped);
        let speeds = pins.chain(soft).chain(changes).chain(bodies);
        speeds.chain(own.map(Vec3::norm)).fold(0.0, Real::max)
    }

    /// The greatest speed (m/s) of what a change sets in motion.
    fn speed_of(&self, change: &Change) -> Real {
        let (vertices, motion) = match &change.kind {
            ChangeKind::Hold {
                vertices,
                motion: HeldMotion::Own(motion),
            }
            | ChangeKind::Tie {
                vertices, motion, ..
            } => (vertices, motion),
            ChangeKind::Drive { body, velocities } => {
                let touch = self.touch.as_ref();
                return touch.map_or(0.0, |touch| touch.speed_with(*body, *velocities));
            }
            _ => return 0.0,
        };
        let speeds = vertices.iter();
        let speeds = speeds.map(|&v| motion.max_speed(self.start.positions[v]));
        speeds.fold(0.0, Real::max)
    }
}

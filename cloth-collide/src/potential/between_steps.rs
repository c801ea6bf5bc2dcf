//! What a caller reads and changes between steps: where bodies are, and friction.

use super::free::FreeBody;
use super::surfaces::PotentialContacts;
use crate::obstacle::RigidMotion;
use cloth_core::error::{OutOfRange, not_negative, within};
use cloth_core::math::Real;

impl PotentialContacts {
    /// Where an obstacle is after the last step, and how it moves, by its number (from 0 in the order of
    /// [`PotentialBuilder::obstacle`](super::PotentialBuilder::obstacle)): the position (m) of the origin of its frame
    /// in the world, the rotation that takes vectors of its frame to the world, the velocity of that origin (m/s) and
    /// the angular velocity (rad/s), both in world axes. [`Pose::to_world`](crate::obstacle::Pose::to_world) takes
    /// points of its frame along.
    ///
    /// Velocities are those that it was told last; of a body that the cloth pushes, those that its momenta give it
    /// where it is. After a step that has failed or was taken back, everything is as that step began. `None` where
    /// there is no such obstacle: surfaces that change their shape have no pose.
    ///
    /// ```
    /// use cloth_collide::obstacle::{Obstacle, Pose, RigidMotion, Sphere};
    /// use cloth_collide::potential::PotentialContacts;
    /// use cloth_core::math::Vec3;
    /// use cloth_core::mesh::generate::{Diagonals, grid};
    ///
    /// let sheet = grid(3, 3, 0.1, 0.1, Diagonals::OneWay)?;
    /// let below = RigidMotion::still(Pose::at(Vec3::new(0.05, 0.05, -0.2)));
    /// let ball = Obstacle::moving(Sphere::new(0.1)?, below)?;
    /// let contacts = PotentialContacts::builder(&sheet).obstacle(ball, 0.3).build()?;
    /// assert_eq!(contacts.motion(0), Some(below));
    /// assert_eq!(contacts.motion(1), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn motion(&self, number: usize) -> Option<RigidMotion> {
        let contacts = &self.contacts;
        let (body, _) = contacts.bodies.get(number)?;
        // What the next step would put back does not count.
        let before = contacts.before.get(number).filter(|_| contacts.is_open);
        let motion = *before.unwrap_or(body).motion();
        let is_it = |(_, free): &(usize, &FreeBody)| free.number == number;
        let Some((place, free)) = contacts.free.list.iter().enumerate().find(is_it) else {
            return Some(motion);
        };
        let momenta = contacts.free.before.get(place);
        let momenta = momenta.filter(|_| contacts.is_open);
        let momenta = *momenta.unwrap_or(&free.momenta);
        Some(free.body.motion(motion.pose, momenta, 0.0))
    }

    /// Where the bodies that the cloth pushes are, with the velocities that their momenta give them, by the numbers of
    /// their obstacles; see [`motion`](Self::motion).
    pub fn free_motions(&self) -> impl Iterator<Item = (usize, RigidMotion)> + '_ {
        let list = self.contacts.free.list.iter();
        list.filter_map(|free| Some((free.number, self.motion(free.number)?)))
    }

    /// Changes the coefficient of friction μ (dimensionless) of cloth on cloth from the next step on, for all vertices
    /// alike: in place of [those of vertices](super::PotentialBuilder::friction_of_vertices), too. What sticks keeps
    /// its tangential displacement, so its force changes with μ.
    ///
    /// Thickness and stiffness cannot be changed like this, since detection is laid out by them and cloth may be nearer
    /// than the new ones: build contact anew, from [the time of the state](super::PotentialBuilder::begins_at).
    ///
    /// # Errors
    /// [`OutOfRange`] if it is negative or not finite; nothing has changed then.
    pub fn set_friction(&mut self, friction: Real) -> Result<(), OutOfRange> {
        let own = &mut self.contacts.near.own;
        own.friction = not_negative("friction of contact", friction)?;
        own.frictions.clear();
        self.contacts.constraints.took_last = false;
        Ok(())
    }

    /// The same of cloth on a body, by its number, counted as in
    /// [`ContactForces::bodies`](super::ContactForces::bodies): obstacles first, then surfaces that change their shape.
    ///
    /// # Errors
    /// [`OutOfRange`] if no body has this number, or the coefficient is negative or not finite; nothing has changed
    /// then.
    pub fn set_body_friction(&mut self, number: usize, friction: Real) -> Result<(), OutOfRange> {
        let count = self.contacts.bodies.len() + self.surfaces.animated_count();
        let name = "number of a body";
        let range = "below the number of bodies";
        within(number < count, name, number as Real, range)?;
        not_negative("friction of a body", friction)?;
        if let Some((_, own)) = self.contacts.bodies.get_mut(number) {
            *own = friction;
        }
        self.contacts.near.set_body_friction(number, friction);
        self.contacts.constraints.took_last = false;
        Ok(())
    }
}

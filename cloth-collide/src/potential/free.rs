//! Bodies that the cloth pushes: the impulses of contact on them, and what they make of these; see the
//! [chapter](super#bodies-that-the-cloth-pushes).

use super::PotentialContacts;
use super::source::Contacts;
use crate::obstacle::{Obstacle, ObstacleError, Pose, RigidBody, RigidMotion};
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3};

/// One of them.
#[derive(Clone, Debug)]
pub(super) struct FreeBody {
    /// The number of its obstacle.
    pub(super) number: usize,
    pub(super) body: RigidBody,
    /// Momentum (N·s) and angular momentum (N·m·s).
    pub(super) momenta: [Vec3; 2],
    /// That of the step (N·s, N·m·s) about its position at the end.
    impulse: [Vec3; 2],
    /// That of what stops it, and the friction (N·s) in it.
    pub(super) stop: [Vec3; 3],
    /// What that has changed of its velocities (m/s, rad/s) so far.
    pub(super) change: [Vec3; 2],
    /// By how far (m) the push of the cloth in the last step would have changed its displacement in that step: it has
    /// moved before the cloth.
    pub(super) pushed: Real,
    /// Whether it stays where it is in this step, and whether it does so until it is released.
    pub(super) is_halted: bool,
    pub(super) is_held: bool,
    /// Where it is at the start of the step.
    pub(super) place: Pose,
    /// No point of it is farther from its position than `radius` (m); `extent` (m) is that of its smallest side.
    pub(super) radius: Real,
    pub(super) extent: Real,
    /// Vertices of its surface (m), in its own frame.
    pub(super) surface: Vec<Vec3>,
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(super) struct FreeBodies {
    pub(super) list: Vec<FreeBody>,
    /// Momenta before the step, as obstacles are kept.
    pub(super) before: Vec<[Vec3; 2]>,
    pub(super) before_step: Vec<[Vec3; 2]>,
    /// Size (s) of a step of a method that minimises.
    pub(super) dt: Real,
    /// Whether the substep only finds a feasible start, so that impulses are none of theirs.
    pub(super) finds_feasible_start: bool,
    /// Work (J) in this step that they have done on the cloth, and that what stops them has done on them.
    pub(super) work: [Real; 2],
}

impl FreeBody {
    pub(super) fn new(
        number: usize,
        body: RigidBody,
        obstacle: &Obstacle,
        surface: Vec<Vec3>,
    ) -> Self {
        let (radius, extent) = obstacle
            .shape()
            .bounds()
            .map_or((Real::INFINITY, 1.0), |box_| {
                let farthest = box_.lower.abs().sup(&box_.upper.abs());
                (farthest.norm(), (box_.upper - box_.lower).min())
            });
        Self {
            number,
            body,
            momenta: body.momenta(obstacle.motion()),
            impulse: [Vec3::zeros(); 2],
            stop: [Vec3::zeros(); 3],
            change: [Vec3::zeros(); 2],
            pushed: 0.0,
            is_halted: false,
            is_held: false,
            place: obstacle.motion().pose,
            radius,
            extent,
            surface,
        }
    }

    /// Work (J) of the impulses of contact with the cloth, and of `stop` (N·s, N·m·s), at these velocities (m/s,
    /// rad/s).
    fn works(&self, by_cloth: [Vec3; 2], stop: [Vec3; 3], velocities: [Vec3; 2]) -> [Real; 2] {
        let work = |impulse: &[Vec3]| -> Real {
            let parts = impulse.iter().zip(&velocities);
            parts.map(|(impulse, velocity)| impulse.dot(velocity)).sum()
        };
        [-work(&by_cloth), work(&stop)]
    }

    fn add(&mut self, impulse: Vec3, arm: Vec3) {
        self.impulse[0] += impulse;
        self.impulse[1] += arm.cross(&impulse);
    }
}

impl FreeBodies {
    /// Notes the momenta before a step.
    pub(super) fn remember(&mut self) {
        self.before.clear();
        self.before
            .extend(self.list.iter().map(|free| free.momenta));
        self.work = [0.0; 2];
    }

    pub(super) fn undo(&mut self) {
        for (free, before) in self.list.iter_mut().zip(&self.before) {
            free.momenta = *before;
        }
    }
}

impl PotentialContacts {
    /// A body that the cloth pushes stays where it is from now on, until it is released; it then starts from rest.
    /// Gives whether there is such a body at all, by the number of its obstacle.
    pub fn hold_body(&mut self, number: usize, is_held: bool) -> bool {
        // A step that has failed is over: what it would put back must not undo this.
        self.contacts.take_back();
        let mut bodies = self.contacts.free.list.iter_mut();
        let Some(free) = bodies.find(|free| free.number == number) else {
            return false;
        };
        (free.is_held, free.is_halted) = (is_held, is_held);
        free.momenta = [Vec3::zeros(); 2];
        true
    }

    /// Changes the velocity (m/s) and angular velocity (rad/s, about the origin of its frame) of an obstacle that moves
    /// as it is told, from the next step on. Gives whether there is such an obstacle.
    ///
    /// # Errors
    /// [`ObstacleError::NonFinite`]. The obstacle then moves as before.
    pub fn set_velocities(
        &mut self,
        number: usize,
        [velocity, angular_velocity]: [Vec3; 2],
    ) -> Result<bool, ObstacleError> {
        // As in `hold_body`.
        self.contacts.take_back();
        let Contacts {
            bodies,
            free,
            constraints,
            ..
        } = &mut self.contacts;
        let is_free = free.list.iter().any(|free| free.number == number);
        let Some((obstacle, _)) = bodies.get_mut(number).filter(|_| !is_free) else {
            return Ok(false);
        };
        // What has been found far away may have counted on the old motion.
        constraints.took_last = false;
        let pose = obstacle.motion().pose;
        obstacle.set_motion(RigidMotion {
            pose,
            velocity,
            angular_velocity,
        })?;
        Ok(true)
    }

    /// Kinetic energy (J) of the bodies that the cloth pushes, where they are: ½ v·p, with the velocity v on the way
    /// there and the momentum p on the way from there, and the same of the rotation. Bodies move before the cloth pushes
    /// them, which is symplectic Euler: half a push is on either side of where they are, and so a harmonic spring keeps
    /// its energy to rounding in this measure (Hairer, Lubich, Wanner 2006, *Geometric Numerical Integration*, I.1 and
    /// IX.3).
    #[must_use]
    pub fn free_kinetic_energy(&self) -> Real {
        let Contacts { bodies, free, .. } = &self.contacts;
        let energy = |free: &FreeBody| {
            let motion = bodies[free.number].0.motion();
            let [linear, angular] = free.momenta;
            0.5 * (motion.velocity.dot(&linear) + motion.angular_velocity.dot(&angular))
        };
        free.list.iter().map(energy).sum()
    }

    /// Work (J) in the last step that bodies which the cloth pushes did on it, a part of
    /// [`ContactSource::work`](cloth_core::contact::ContactSource::work), and that other bodies and prescribed vertices
    /// which stop those did on them.
    #[must_use]
    pub fn free_work(&self) -> [Real; 2] {
        self.contacts.free.work
    }

    /// By how far (m) the cloth has pushed a body off the path on which it has moved in the last step, of a method that
    /// minimises: the body moves before the cloth, and takes up its push after it. Where that is more than the
    /// thickness, the cloth has felt a body that is not where it would be, and the step is better taken back
    /// ([`PotentialContacts::take_back`]) and taken again as shorter ones. 0 of methods that project positions.
    #[must_use]
    pub fn largest_push(&self) -> Real {
        let pushed = self.contacts.free.list.iter().map(|free| free.pushed);
        pushed.fold(0.0, Real::max)
    }
}

impl Contacts {
    /// Free bodies move as their momenta and what stops them say, in a (sub)step of `dt` (s).
    pub(super) fn move_free(&mut self, dt: Real) {
        for free in &mut self.free.list {
            let (obstacle, _) = &mut self.bodies[free.number];
            free.place = obstacle.motion().pose;
            let momenta = [0, 1].map(|k| free.momenta[k] + free.stop[k]);
            let mut motion = free.body.motion(free.place, momenta, dt);
            if free.is_halted {
                let [needed, _] = free.body.momenta(&motion);
                free.stop = [free.stop[0] - needed, -free.momenta[1], Vec3::zeros()];
                motion = RigidMotion::still(free.place);
            }
            let moved = obstacle.set_motion(motion);
            debug_assert!(moved.is_ok(), "finite momenta");
        }
    }

    /// Adds up the impulses of the constraints on free bodies in a substep that ends at `x` (m), the bodies still
    /// being where they are at its start.
    pub(super) fn collect_impulses(&mut self, step: &ContactStep<'_>, x: &[Vec3]) {
        if self.free.finds_feasible_start {
            return;
        }
        let constraints = &self.constraints;
        for free in &mut self.free.list {
            let number = free.number;
            let motion = self.bodies[number].0.motion();
            let centre = motion.pose_at(step.dt).position;
            free.impulse = [Vec3::zeros(); 2];
            constraints
                .bodies
                .each_impulse(number, step.dt, |v, impulse| {
                    free.add(-impulse, x[v] - centre);
                });
            for contact in constraints.touching() {
                let impulse =
                    (contact.normal * contact.state.lambda + contact.state.friction) / step.dt;
                for (v, weight) in contact.pair.vertices.into_iter().zip(contact.weights) {
                    if self.near.body_of(v) == Some(number) {
                        free.add(impulse * weight, x[v as usize] - centre);
                    }
                }
            }
            let velocities = [motion.velocity, motion.angular_velocity];
            let works = free.works(free.impulse, free.stop, velocities);
            (0..2).for_each(|k| self.free.work[k] += works[k]);
        }
    }

    /// Halts the free body that is nearest to a vertex (m) which has no feasible path, if there is one that moves: what
    /// the cloth between it and something else cannot give way to has to stop. Returns whether there was.
    pub(super) fn halt_near(&mut self, x: Vec3) -> bool {
        let distance = |free: &FreeBody| self.bodies[free.number].0.signed_distance(x, 0.0).value;
        let moving = self.free.list.iter_mut().filter(|free| !free.is_halted);
        let nearest = moving.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.is_some_and(|free| !std::mem::replace(&mut free.is_halted, true))
    }

    /// The same of a potential, by the forces that have been recorded where a step ends.
    pub(super) fn take_forces(&mut self) {
        let Some(ledger) = &self.ledger else {
            return;
        };
        let dt = self.free.dt;
        for free in &mut self.free.list {
            let on = ledger.forces.bodies[free.number];
            free.impulse = [on.force * dt, on.torque * dt];
            let by_cloth = [0, 1].map(|k| free.impulse[k] - free.stop[k]);
            let [before, after] = [&self.before[free.number], &self.bodies[free.number].0];
            let moved = after.motion().pose.position - before.motion().pose.position;
            let velocities = [moved / dt, after.motion().angular_velocity];
            let works = free.works(by_cloth, free.stop, velocities);
            (0..2).for_each(|k| self.free.work[k] += works[k]);
            let [linear, angular] = free.body.velocity_by(&free.place, by_cloth);
            let turning = angular.norm() * free.radius;
            free.pushed = match free.is_held {
                true => 0.0,
                false => (linear.norm() + if turning.is_finite() { turning } else { 0.0 }) * dt,
            };
            // It is among them.
            free.stop = [Vec3::zeros(); 3];
        }
        self.push_free(dt);
    }

    /// Free bodies take up their impulses of a (sub)step of `dt` (s).
    pub(super) fn push_free(&mut self, dt: Real) {
        if !self.free.finds_feasible_start {
            for free in &mut self.free.list {
                let impulse = [0, 1].map(|k| free.impulse[k] + free.stop[k]);
                free.body.push(&mut free.momenta, impulse, dt);
                (free.impulse, free.stop) = ([Vec3::zeros(); 2], [Vec3::zeros(); 3]);
                free.is_halted = free.is_held;
            }
        }
    }
}

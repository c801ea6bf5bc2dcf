//! Forces of contact, on every vertex and on every body.

use super::bodies::Body;
use super::free::FreeBodies;
use super::friction::Key;
use super::near::Near;
use super::source::Contacts;
use super::stops::Stops;
use crate::pair::ends;
use cloth_core::math::{Real, Vec3};

/// Forces of contact in a step, averaged over it where a method takes several substeps; of a method that minimises,
/// those of the potential where the step ends.
///
/// What the last resort does (vertices that go back on their path) is no force, and not in them; impacts that it
/// resolves count as pressure, for the vertices alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactForces {
    /// Pressure (N) on each vertex of the cloth, by the cloth itself and by bodies.
    pub normal: Vec<Vec3>,
    /// Friction (N), the same.
    pub friction: Vec<Vec3>,
    /// On each body: obstacles first, in their order, then animated surfaces.
    pub bodies: Vec<BodyForce>,
}

/// What the cloth does to a body, and bodies to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyForce {
    /// Force (N): pressure, friction, and what stops a free body, on it and on what stops it, but not what holds one
    /// until it is released.
    pub force: Vec3,
    /// The friction (N) in it.
    pub friction: Vec3,
    /// Torque (N·m) about the position of an obstacle, or the origin for an animated surface.
    pub torque: Vec3,
}

/// What adds them up.
#[derive(Clone, Debug)]
pub(super) struct Ledger {
    /// Impulses (N·s, N·m·s) so far: on all vertices, those of surfaces too, and on bodies.
    impulses: ContactForces,
    /// Over which time (s).
    time: Real,
    pub(super) forces: ContactForces,
}

impl Ledger {
    pub(super) fn new(vertices: usize, cloth: usize, bodies: usize) -> Self {
        let none = |vertices: usize| ContactForces {
            normal: vec![Vec3::zeros(); vertices],
            friction: vec![Vec3::zeros(); vertices],
            bodies: vec![BodyForce::default(); bodies],
        };
        Self {
            impulses: none(vertices),
            time: 0.0,
            forces: none(cloth),
        }
    }

    pub(super) fn begin(&mut self) {
        self.impulses.normal.fill(Vec3::zeros());
        self.impulses.friction.fill(Vec3::zeros());
        self.impulses.bodies.fill(BodyForce::default());
        self.time = 0.0;
    }

    /// A substep of `dt` (s) is over.
    pub(super) fn pass(&mut self, dt: Real) {
        self.time += dt;
    }

    /// Pressure and friction (N·s) that act on the vertices of a pair with these weights.
    pub(super) fn add_pair(
        &mut self,
        vertices: [u32; 4],
        weights: [Real; 4],
        [normal, friction]: [Vec3; 2],
    ) {
        for (v, weight) in ends(vertices, weights) {
            self.impulses.normal[v] += normal * weight;
            self.impulses.friction[v] += friction * weight;
        }
    }

    /// Pressure (N·s) on one vertex.
    pub(super) fn add(&mut self, vertex: usize, normal: Vec3) {
        self.impulses.normal[vertex] += normal;
    }

    /// Pressure and friction (N·s) of an obstacle on a vertex that is that far (m) from its position.
    pub(super) fn add_obstacle(
        &mut self,
        [vertex, number]: [usize; 2],
        [normal, friction]: [Vec3; 2],
        arm: Vec3,
    ) {
        self.impulses.normal[vertex] += normal;
        self.impulses.friction[vertex] += friction;
        self.impulses.bodies[number].add([-normal, -friction], arm);
    }

    /// Impulses (N·s, N·m·s) of what stops free bodies, and those on the bodies that do.
    pub(super) fn add_stops(&mut self, free: &FreeBodies, stops: &Stops, per: Real) {
        let free = free.list.iter().filter(|free| !free.is_held);
        let stopped = free.map(|free| (free.number, free.stop));
        let reactions = stops.reactions.iter().copied().enumerate();
        for (number, [impulse, angular, friction]) in stopped.chain(reactions) {
            let body = &mut self.impulses.bodies[number];
            body.force += impulse * per;
            body.friction += friction * per;
            body.torque += angular * per;
        }
    }

    /// The step is over, with all vertices at `x` (m).
    pub(super) fn end(&mut self, near: &Near, obstacles: &[Body], x: &[Vec3]) {
        let impulses = &mut self.impulses;
        for (v, body) in (near.cloth..).zip(near.bodies()) {
            let obstacle = obstacles.get(body);
            let position = obstacle.map_or(Vec3::zeros(), |(body, _)| body.motion().pose.position);
            let parts = [impulses.normal[v], impulses.friction[v]];
            if parts != [Vec3::zeros(); 2] {
                impulses.bodies[body].add(parts, x[v] - position);
            }
        }
        let per_time = 1.0 / self.time;
        self.forces
            .change(impulses, |force, impulse| *force = impulse * per_time);
    }
}

impl ContactForces {
    /// These and others times a `weight` (dimensionless): the terms of a mean.
    #[must_use]
    pub fn plus(mut self, other: &Self, weight: Real) -> Self {
        self.normal.resize(other.normal.len(), Vec3::zeros());
        self.friction.resize(other.friction.len(), Vec3::zeros());
        self.bodies.resize(other.bodies.len(), BodyForce::default());
        self.change(other, |sum, term| *sum += term * weight);
        self
    }

    /// Changes each vector by that of `other` in its place.
    fn change(&mut self, other: &Self, change: impl Fn(&mut Vec3, Vec3)) {
        for (own, other) in [
            (&mut self.normal, &other.normal),
            (&mut self.friction, &other.friction),
        ] {
            let both = own.iter_mut().zip(other);
            both.for_each(|(own, other)| change(own, *other));
        }
        for (own, other) in self.bodies.iter_mut().zip(&other.bodies) {
            change(&mut own.force, other.force);
            change(&mut own.friction, other.friction);
            change(&mut own.torque, other.torque);
        }
    }
}

impl BodyForce {
    /// What is not friction (N): along the normals of contact, and what holds a body that nothing else can stop.
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        self.force - self.friction
    }

    fn add(&mut self, [normal, friction]: [Vec3; 2], arm: Vec3) {
        let force = normal + friction;
        self.force += force;
        self.friction += friction;
        self.torque += arm.cross(&force);
    }
}

impl Contacts {
    /// Enters the forces of the potential at `x` (m), where the step ends, with its friction.
    pub(super) fn record_forces(&mut self, x: &[Vec3]) {
        let Some(mut ledger) = self.ledger.take() else {
            return;
        };
        ledger.begin();
        // A force for a time of 1 s.
        ledger.pass(1.0);
        self.pair_gradients(x, |vertex, g| ledger.add(vertex, -g));
        let arm = |v: usize, number: usize| x[v] - self.bodies[number].0.motion().pose.position;
        for contact in self.obstacle_contacts(x) {
            let (v, number) = (contact.vertex, contact.number);
            let forces = [-contact.value_and_gradient().1, Vec3::zeros()];
            ledger.add_obstacle([v, number], forces, arm(v, number));
        }
        let reach = self.reach();
        for contact in &self.friction {
            let friction = -contact.force(reach, x).0;
            let forces = [Vec3::zeros(), friction];
            match contact.key {
                Key::Obstacle(key) => {
                    let [v, number] = key.map(|n| n as usize);
                    ledger.add_obstacle([v, number], forces, arm(v, number));
                }
                Key::Pair(pair) => ledger.add_pair(pair.vertices, contact.weights, forces),
            }
        }
        ledger.add_stops(&self.free, &self.stops, 1.0 / self.free.dt);
        ledger.end(&self.near, &self.bodies, x);
        self.ledger = Some(ledger);
    }
}

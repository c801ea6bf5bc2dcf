//! Bodies that the cloth pushes: the impulses of contact on them, and what they make of these.
//!
//! In each (sub)step a body moves on as its momentum says, the cloth feels it as it feels any moving body, and the
//! impulses of contact on the cloth are taken off the momentum of the body at the end. So the two have their momentum
//! together, whatever the method, its iterations and the step. The coupling is staggered: a step has to resolve the
//! frequency of the body on the contact ([`RigidBody::highest_frequency`]), or the body trembles.

use super::row::Row;
use super::source::Contacts;
use crate::obstacle::{Momenta, RigidBody, RigidMotion};
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3};

/// One of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeBody {
    /// The number of its obstacle.
    pub(super) number: usize,
    pub(super) body: RigidBody,
    pub(super) momenta: Momenta,
    /// That of the step (N·s, N·m·s) about its position at the end.
    impulse: [Vec3; 2],
}

/// All of them.
#[derive(Debug, Default)]
pub(super) struct FreeBodies {
    pub(super) list: Vec<FreeBody>,
    /// Their momenta before the step.
    before: Vec<Momenta>,
    /// Size (s) of a step of a method that minimises.
    pub(super) dt: Real,
    /// Whether a start is led to where bodies go, so that impulses are none of theirs.
    pub(super) is_led: bool,
}

impl FreeBody {
    pub(super) fn new(number: usize, body: RigidBody, motion: &RigidMotion) -> Self {
        Self {
            number,
            body,
            momenta: body.momenta(motion),
            impulse: [Vec3::zeros(); 2],
        }
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
    }

    /// Goes back to them.
    pub(super) fn undo(&mut self) {
        let both = self.list.iter_mut().zip(&self.before);
        both.for_each(|(free, before)| free.momenta = *before);
    }
}

impl Contacts {
    /// Where free bodies are now, and how they move, by the number of the obstacle.
    pub(super) fn free_motions(&self) -> impl Iterator<Item = (usize, RigidMotion)> + '_ {
        self.free.list.iter().map(|free| {
            let pose = self.bodies[free.number].0.motion().pose;
            let motion = free.body.motion(pose, &free.momenta, 0.0);
            (free.number, motion)
        })
    }

    /// Free bodies set out on a (sub)step of `dt` (s).
    pub(super) fn set_out(&mut self, dt: Real) {
        for free in &self.free.list {
            let (obstacle, _) = &mut self.bodies[free.number];
            let motion = free.body.motion(obstacle.motion().pose, &free.momenta, dt);
            let moved = obstacle.set_motion(motion);
            debug_assert!(moved.is_ok(), "finite momenta");
        }
    }

    /// Adds up the impulses of the constraints on free bodies in a substep that ends at `x` (m), the bodies still
    /// being where they are at its start.
    pub(super) fn collect_impulses(&mut self, step: &ContactStep<'_>, x: &[Vec3]) {
        let Self {
            rows,
            near,
            bodies: obstacles,
            free,
            ..
        } = self;
        if free.is_led {
            return;
        }
        let bodies = &rows.bodies;
        for free in &mut free.list {
            let number = free.number;
            let motion = obstacles[number].0.motion();
            let centre = motion.pose_at(step.dt).position;
            free.impulse = [Vec3::zeros(); 2];
            for (v, impulse) in bodies.impulses_of(number, step.dt) {
                free.add(-impulse, x[v] - centre);
            }
            rows_impulses(&rows.rows, step.dt, |v, impulse| {
                if near.body_of(v) == Some(number) {
                    free.add(impulse, x[v as usize] - centre);
                }
            });
        }
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
        }
        self.push_free(dt);
    }

    /// Free bodies take up their impulses of a (sub)step of `dt` (s).
    pub(super) fn push_free(&mut self, dt: Real) {
        if !self.free.is_led {
            for free in &mut self.free.list {
                free.body.push(&mut free.momenta, free.impulse, dt);
                free.impulse = [Vec3::zeros(); 2];
            }
        }
    }
}

/// The impulses (N·s) of constraints in a substep of `dt` (s), vertex by vertex.
fn rows_impulses(rows: &[Row], dt: Real, mut visit: impl FnMut(u32, Vec3)) {
    for row in rows.iter().filter(|row| row.lambda > 0.0) {
        let impulse = (row.normal * row.lambda + row.friction) / dt;
        for (v, weight) in row.vertices.into_iter().zip(row.weights) {
            visit(v, impulse * weight);
        }
    }
}

//! Work that moving bodies do on a cloth.

use super::ObstacleContacts;
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3};

/// `Σ J·u` over the vertices: the impulse J = m Δv that contact has given to each, times the velocity u of the body
/// there at the end of the step.
///
/// Contact of the cloth with itself is in J too, and has no part in the sum: opposite impulses at one place cancel in
/// the velocity field of a rigid body. Where there are several bodies, each vertex goes by the nearest.
#[derive(Debug, Default)]
pub(crate) struct BodyWork {
    /// Velocities (m/s) before contact; none where no body moves.
    before: Vec<Vec3>,
    work: Real,
}

impl BodyWork {
    /// Notes the velocities (m/s) that contact begins with.
    pub(crate) fn begin(&mut self, bodies: Option<&ObstacleContacts>, velocities: &[Vec3]) {
        self.work = 0.0;
        self.before.clear();
        let mut bodies = bodies.into_iter().flat_map(ObstacleContacts::obstacles);
        if bodies.any(|body| !body.motion().is_still()) {
            self.before.extend_from_slice(velocities);
        }
    }

    /// Compares them with those that it ends with, before the bodies' time starts anew.
    pub(crate) fn end(
        &mut self,
        bodies: Option<&ObstacleContacts>,
        step: &ContactStep<'_>,
        positions: &[Vec3],
        velocities: &[Vec3],
    ) {
        let Some(bodies) = bodies.filter(|_| !self.before.is_empty()) else {
            return;
        };
        for (vertex, before) in self.before.iter().enumerate() {
            let (x, w) = (positions[vertex], step.inverse_mass[vertex]);
            let push = velocities[vertex] - before;
            if w == 0.0 || push == Vec3::zeros() {
                continue;
            }
            let nearest = bodies.obstacles().min_by(|a, b| {
                let distance = |body: &super::Obstacle| body.signed_distance(x, step.dt).value;
                distance(a).total_cmp(&distance(b))
            });
            if let Some(body) = nearest {
                self.work += push.dot(&body.velocity_at(x, step.dt)) / w;
            }
        }
    }

    /// The sum of the last step (J).
    pub(crate) fn work(&self) -> Real {
        self.work
    }
}

//! What starts inside of a body, and is led out in the first step: that is no motion.
//!
//! A method that minimises takes `(x[1] − x[0])/Δt` for the velocity. Of a vertex that started at the depth d that has
//! the speed d/Δt in it, 3 m/s of 5 cm in 1/60 s, which the cloth would fly off with.

use super::source::Contacts;
use cloth_core::contact::ContactStep;
use cloth_core::math::Vec3;

/// The vertices that have started inside in this step, and the directions in which they are led out, times the speeds
/// (m/s) that this makes.
#[derive(Clone, Debug, Default)]
pub(super) struct LedOut(Vec<(usize, Vec3)>);

impl LedOut {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Takes these speeds from velocities (m/s), as far as they are there.
    pub(super) fn stop(&mut self, velocities: &mut [Vec3]) {
        for (vertex, outwards) in self.0.drain(..) {
            let speed = outwards.norm();
            let own = velocities[vertex].dot(&outwards) / speed;
            velocities[vertex] -= outwards * (own.clamp(0.0, speed) / speed);
        }
    }
}

impl Contacts {
    /// Finds what starts inside in a step that does not go on from the last one.
    pub(super) fn find_led_out(&mut self, step: &ContactStep<'_>) {
        for (number, (body, _)) in self.bodies.iter().enumerate() {
            for (vertex, from) in step.from.iter().enumerate() {
                let is_free = step.inverse_mass[vertex] > 0.0 && !self.near.is_inside(vertex);
                if !is_free || self.near.pinched.passes(vertex, number) {
                    continue;
                }
                let distance = body.signed_distance(*from, 0.0);
                let speed = -distance.value / step.dt;
                if speed > 0.0 {
                    self.led_out.0.push((vertex, distance.normal * speed));
                }
            }
        }
    }
}

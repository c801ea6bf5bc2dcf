//! One mass that flies, bounces, slides and rests: the exact cases of contact.

use cloth_collide::obstacle::{ImpactLaw, Obstacle, VertexPath, first_contact};
use cloth_core::math::{Real, Vec3};

/// A point mass among obstacles, moved from impact to impact.
///
/// Between impacts it follows its parabola exactly. An impact is found by [`first_contact`] and changes the velocity as
/// [`ImpactLaw`] says. What is left of the step goes on from there. Once the mass does not leave the surface any more,
/// it *slides* for the rest of the step: gravity changes the velocity, the law takes away what goes into the surface
/// and what friction can hold, and the position follows the mean of the old and the new velocity.
///
/// | exact to rounding | first order in Δt |
/// |---|---|
/// | flight, and impacts on anything convex | sliding on a curved or turning surface |
/// | sliding and resting on a plane | the one step in which sliding ends or turns round |
///
/// A solver for a whole cloth treats all vertices at once and cannot stop at each impact; this is what it is measured
/// against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    /// Position (m).
    pub position: Vec3,
    /// Velocity (m/s).
    pub velocity: Vec3,
    /// Mass (kg).
    pub mass: Real,
}

/// Most impacts in a step. A mass that bounces ever lower would otherwise need infinitely many.
const MOST_IMPACTS: u32 = 64;

impl PointMass {
    /// Moves the mass for `dt` (s) under `gravity` (m/s²), kept at the distance `thickness` (m) from `obstacle`, which
    /// is taken at its own time `start` (s) and not changed. Returns the impulse (N·s) that the obstacle has given to
    /// the mass: m times the change of velocity, less that by gravity.
    ///
    /// # Panics
    /// If `dt` is not a positive number.
    pub fn advance(
        &mut self,
        obstacle: &Obstacle,
        law: ImpactLaw,
        thickness: Real,
        gravity: Vec3,
        start: Real,
        dt: Real,
    ) -> Vec3 {
        assert!(dt > 0.0, "the step is {dt} s, but it has to be positive");
        let mut impulse = Vec3::zeros();
        let mut elapsed = 0.0;
        for _ in 0..MOST_IMPACTS {
            let path = VertexPath {
                from: self.position,
                velocity: self.velocity,
                acceleration: gravity,
            };
            let left = dt - elapsed;
            let Some(hit) = first_contact(obstacle, &path, start + elapsed, left, thickness) else {
                self.position = path.position(left);
                self.velocity = path.velocity_at(left);
                return impulse;
            };
            elapsed += hit.time;
            self.position = path.position(hit.time);
            self.velocity = path.velocity_at(hit.time);
            let normal = hit.distance.normal;
            let surface = obstacle
                .motion()
                .velocity_at(self.position, start + elapsed);
            impulse += self.hit(law, normal, surface);
            // Gravity takes the mass back at once if it leaves no faster than rounding.
            let leaving = normal.dot(&(self.velocity - surface));
            let speeds = self.velocity.norm() + surface.norm() + gravity.norm() * dt;
            if leaving <= 1e-12 * speeds {
                break;
            }
        }
        impulse
            + self.slide(
                obstacle,
                law,
                thickness,
                gravity,
                start + elapsed,
                dt - elapsed,
            )
    }

    /// Applies the law, and returns the impulse (N·s).
    fn hit(&mut self, law: ImpactLaw, normal: Vec3, surface: Vec3) -> Vec3 {
        let change = law.velocity_change(self.velocity - surface, normal);
        self.velocity += change;
        change * self.mass
    }

    /// Moves the mass along the surface, from the time `start` (s) for `dt` (s). Returns the impulse (N·s).
    fn slide(
        &mut self,
        obstacle: &Obstacle,
        law: ImpactLaw,
        thickness: Real,
        gravity: Vec3,
        start: Real,
        dt: Real,
    ) -> Vec3 {
        let before = self.velocity;
        let normal = obstacle.signed_distance(self.position, start).normal;
        let surface = obstacle.motion().velocity_at(self.position, start);
        self.velocity += gravity * dt;
        let impulse = self.hit(law.inelastic(), normal, surface);
        self.position += (before + self.velocity) * (0.5 * dt);
        let after = obstacle.signed_distance(self.position, start + dt);
        if after.value < thickness {
            self.position += after.normal * (thickness - after.value);
        }
        impulse
    }
}

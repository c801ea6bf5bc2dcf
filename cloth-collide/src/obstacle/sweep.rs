//! The first contact of a vertex on its path with an obstacle that moves.

use super::{Distance, Obstacle};
use cloth_core::math::{Real, Vec3};

/// The straight path of a vertex: x(t) = x₀ + t v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexPath {
    /// Where it starts, x₀ (m).
    pub from: Vec3,
    /// Velocity, v (m/s).
    pub velocity: Vec3,
}

impl VertexPath {
    /// That between two positions (m), taken in `duration` (s).
    #[must_use]
    pub fn straight(from: Vec3, to: Vec3, duration: Real) -> Self {
        Self {
            from,
            velocity: (to - from) / duration,
        }
    }

    /// Position (m) after `time` (s).
    #[must_use]
    pub fn position(&self, time: Real) -> Vec3 {
        self.from + self.velocity * time
    }
}

/// The first contact of a vertex on its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstContact {
    /// When (s), from the start of the path. Never later than the true contact.
    pub time: Real,
    /// Distance (m) and normal in the world, at that time.
    pub distance: Distance,
    /// How often the distance was evaluated: at most 512 times.
    pub evaluations: u32,
    /// Whether the vertex is in contact then, to rounding. If not, the evaluations were spent, and all that is known is
    /// that there is no contact before.
    pub certain: bool,
}

/// Most evaluations of the distance in one search.
const MOST_EVALUATIONS: u32 = 512;

/// The first time within `duration` (s) at which a vertex on `path` is no farther than `thickness` (m) from `obstacle`
/// and does not move away from it; nothing if there is none. The obstacle is taken at its own time `start` (s) when the
/// path begins.
///
/// *Conservative advancement*: from the distance f = φ − h at one time, its rate ḟ and bounds on how fast it can
/// change, follows a time until which there is no contact; that long the vertex is moved on, and asked again. With Λ of
/// [`super::SignedDistance::lipschitz`], the obstacle's origin p, its velocity v_p there and its angular velocity ω,
/// the relative velocity u of vertex and surface, and bounds over the rest of the path for its size, S = ‖v − v_p‖ +
/// ‖ω‖ max ‖x − p‖, and for its change in the frame of the obstacle, A = 2‖ω‖ ‖v − v_p‖ + ‖ω‖² max ‖x − p‖, the best of
/// these counts:
///
/// - f(t + s) ≥ f − Λ S s;
/// - f(t + s) ≥ f − Λ (‖u‖ s + ½ A s²): each evaluation leaves 1 − cos α of f, α the angle between −u and the normal;
/// - f(t + s) ≥ f + ḟ s − ½ A s², if φ is convex and Λ = 1. It is Newton's method coming from the safe side: without
///   rotation, a plane takes two evaluations, now and then a third for rounding, and a sphere a
///   few.
///
/// So the time is never late: the vertex is not inside before. It is zero only if the start is in contact. A graze of a
/// convex shape is Newton's method near a double root, which halves what is left in each evaluation; straight along a
/// plane is one. For shapes that are not convex, a vertex that slides along the surface at the distance f goes on by
/// f/Λ in each evaluation: a path of more than 512 f/Λ spends them and stops early, see [`FirstContact::certain`].
///
/// A vertex that is nearer than h from the start is in contact at once if it comes nearer; if it moves away (known for
/// convex shapes only), it is passed over, and found when it comes back.
///
/// Arguments that are not finite give a contact at time 0 that is not certain.
#[must_use]
pub fn first_contact(
    obstacle: &Obstacle,
    path: &VertexPath,
    start: Real,
    duration: Real,
    thickness: Real,
) -> Option<FirstContact> {
    let motion = obstacle.motion();
    let shape = obstacle.shape();
    let spin = motion.angular_velocity.norm();
    let speed = (path.velocity - motion.velocity).norm();
    let mut time = 0.0;
    let mut evaluations = 0;
    loop {
        let position = path.position(time);
        let there = obstacle.signed_distance(position, start + time);
        evaluations += 1;
        let found = |certain| {
            Some(FirstContact {
                time,
                distance: there,
                evaluations,
                certain,
            })
        };
        let centre = motion.pose.position + motion.velocity * (start + time);
        let surface = motion.velocity_at(position, start + time);
        let distance = there.value - thickness;
        let rate = there.gradient().dot(&(path.velocity - surface));
        // What rounding may do to the distance.
        let far = path.from.amax() + position.amax() + centre.amax() + thickness;
        let turned = spin * (start + time).abs();
        let rounding = 16.0 * Real::EPSILON * (far + turned * (position - centre).amax());
        if !(distance.is_finite() && rate.is_finite() && (start + duration).is_finite()) {
            return found(false);
        }
        if distance <= rounding && (rate <= 0.0 || !shape.is_convex()) {
            return found(true);
        }
        if evaluations == MOST_EVALUATIONS {
            return found(false);
        }
        let reach = (position - centre).norm() + (duration - time) * speed;
        let safe = (distance - 0.5 * rounding).max(0.0);
        let by_speed = safe / (shape.lipschitz() * (speed + spin * reach));
        let acceleration = 2.0 * spin * speed + spin * spin * reach;
        let by_rate = if shape.is_convex() {
            free_time(safe, rate, acceleration)
        } else {
            let steepest = shape.lipschitz() * (path.velocity - surface).norm();
            free_time(safe, -steepest, shape.lipschitz() * acceleration)
        };
        let step = by_speed.max(by_rate);
        if step.is_nan() {
            // Numbers too large to say anything.
            return found(false);
        }
        // Where nothing moves, the step is infinite.
        if time + step > duration {
            return None;
        }
        if time + step == time {
            // The contact is nearer than time can be told apart.
            return found(true);
        }
        time += step;
    }
}

/// How long f + ḟ s − ½ A s² stays positive (s), for f, A ≥ 0.
fn free_time(distance: Real, rate: Real, acceleration: Real) -> Real {
    let root = (rate * rate + 2.0 * acceleration * distance).sqrt();
    if rate < 0.0 {
        2.0 * distance / (root - rate)
    } else if acceleration > 0.0 {
        (rate + root) / acceleration
    } else {
        Real::INFINITY
    }
}

//! What stops a body that the cloth pushes: prescribed vertices, and other bodies.
//!
//! These do not give way, so the velocity of the body has to change. Before a (sub)step of Δt, the distance φ of points
//! of the one from the other is asked for at moments so close that the body goes a quarter of its smallest extent in
//! between, but at 64 at most: what is faster than that can pass through a thin one unseen. Let d be the distance to
//! keep and φ₀ that at the start. Nothing happens while φ stays above 0.98 d or, where φ₀ is below that already, above
//! φ₀ − 10⁻⁶ d. Where it falls lower, the body gets the impulse λ n (N·s) that brings it back to min(d, φ₀):
//!
//! n·(K λ n) = (min(d, φ₀) − φ)/τ, λ ≥ 0, K = 1/m − \[r\]ₓ J⁻¹ \[r\]ₓ
//!
//! at the time τ at which that is first seen, r being the arm from the centre there, all of them together by projected
//! Gauss–Seidel sweeps, and again until nothing is seen: a perfectly inelastic impact. Friction is an impulse across n
//! that takes the velocity away with which the two slip, and is no more than μ λ. Below 0.98 d the tolerance is only
//! 10⁻⁶ d, since each step measures from its own φ₀, and the losses of many steps add up. Each impulse is a projection,
//! in the norm of the kinetic energy, onto the motions that keep the distance, or towards those that do not slip. Rest
//! is one of both where the obstacle is at rest, so the body gains no energy from it. Source: Guendelman et al. 2003
//! (see the [chapter](super#references)).

use super::free::{FreeBodies, FreeBody};
use super::near::Near;
use super::source::Contacts;
use super::tangent::{across, clamp_to_friction_cone};
use crate::closest::point_triangle;
use crate::obstacle::{Distance, Obstacle};
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3, gather};

/// Distance to keep (in thicknesses) from prescribed vertices, which are cloth, and from bodies: cloth between the two
/// carries the weight up to the pressure κ h/2, which leaves half of a thickness on either side of it.
const FROM_PRESCRIBED: Real = 0.5;
const FROM_BODIES: Real = 1.0;
/// Fraction of it that may be missing; and what may be missing again where more is, so that nothing wears off step by
/// step.
const MISSING: Real = 0.02;
const ROUNDING: Real = 1e-6;
/// Rounds of detection, and sweeps in each.
const ROUNDS: u32 = 20;
const SWEEPS: u32 = 20;
/// Distance that a body goes between two moments of a step at which it is tested, over its smallest extent; and the
/// most moments.
const SAMPLE_SPACING: Real = 0.25;
const MOST_SAMPLES: Real = 64.0;
/// How far before a body points are whose feet are foremost (in radii of the body), steps there, and how near (in
/// radii) two such points are the same.
const FAR: [Real; 2] = [10.0, 1.0];
const SUPPORTS: u32 = 4;
const SAME: Real = 1e-3;
/// Parts of a triangle that are asked for the distance of their middles, at most, and steps down from the best.
const POINTS: usize = 32;
const DESCENTS: u32 = 24;

/// What is prescribed, and what is met.
#[derive(Clone, Debug, Default)]
pub(super) struct Stops {
    is_prescribed: Vec<bool>,
    /// Triangles of which all vertices are prescribed, then such edges (the last vertex twice) and vertices (three
    /// times) that are in none of those.
    prescribed: Vec<[u32; 3]>,
    meetings: Vec<Meeting>,
    /// Impulses (N·s, N·m·s about their positions) on bodies that have stopped free ones in the (sub)step, and are not
    /// free themselves; and the friction (N·s) in them.
    pub(super) reactions: Vec<[Vec3; 3]>,
}

/// A point at which a body is stopped.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    /// The numbers of the body in the list of free ones, and of the other one, if that is free too, or else among all
    /// bodies, if it is one; and the arms (m) from their centres to the point.
    body: usize,
    other: Option<usize>,
    against: Option<usize>,
    arms: [Vec3; 2],
    /// The direction in which the body is pushed, the speed (m/s) that is missing along it, and the velocity (m/s) with
    /// which the body slips across it.
    normal: Vec3,
    missing: Real,
    slip: Vec3,
    /// μ (dimensionless).
    coefficient: Real,
    /// λ (N·s), and the impulse of friction (N·s).
    impulse: Real,
    friction: Vec3,
}

/// What meets where, after some time.
#[derive(Clone, Copy, Debug)]
struct Place {
    body: usize,
    other: Option<usize>,
    against: Option<usize>,
    arms: [Vec3; 2],
    normal: Vec3,
    /// Velocity (m/s) of the body there relative to what it meets.
    velocity: Vec3,
    coefficient: Real,
}

impl Place {
    /// What is met if its distance (m) is too much below what it was at the `start` and what it should `keep`, after
    /// `time` (s).
    fn met(&self, [start, now, keep]: [Real; 3], time: Real) -> Option<Meeting> {
        let least = (1.0 - MISSING) * keep;
        let allowed = if start < least {
            start - ROUNDING * keep
        } else {
            least
        };
        (now < allowed).then(|| Meeting {
            body: self.body,
            other: self.other,
            against: self.against,
            arms: self.arms,
            normal: self.normal,
            missing: (start.min(keep) - now) / time,
            slip: across(self.velocity, self.normal),
            coefficient: self.coefficient,
            impulse: 0.0,
            friction: Vec3::zeros(),
        })
    }
}

impl Meeting {
    /// The free bodies, the sense in which each is pushed, and its arm (m).
    fn ends(&self) -> impl Iterator<Item = (usize, Real, Vec3)> + use<> {
        let other = self.other.map(|other| (other, -1.0, self.arms[1]));
        std::iter::once((self.body, 1.0, self.arms[0])).chain(other)
    }

    /// By how much (m/s) impulses have changed the velocity with which the body leaves the other one there.
    fn change(&self, bodies: &[FreeBody]) -> Vec3 {
        let change = |(number, sign, arm): (usize, Real, Vec3)| {
            let [v, w] = bodies[number].change;
            (v + w.cross(&arm)) * sign
        };
        self.ends().map(change).sum()
    }

    /// By how much (m/s) an impulse of 1 N·s along `direction` changes that.
    fn inverse_effective_mass(&self, bodies: &[FreeBody], direction: Vec3) -> Real {
        let of = |(number, _, arm): (usize, Real, Vec3)| {
            let [v, w] = bodies[number].velocity_by(direction, arm);
            direction.dot(&(v + w.cross(&arm)))
        };
        self.ends().map(of).sum()
    }

    /// Gives the bodies an impulse (N·s), and the `friction` in it (N·s).
    fn push(&self, bodies: &mut [FreeBody], push: Vec3, friction: Vec3) {
        for (number, sign, arm) in self.ends() {
            let free = &mut bodies[number];
            let change = free.velocity_by(push * sign, arm);
            for (sum, change) in free.change.iter_mut().zip(change) {
                *sum += change;
            }
            free.stop[0] += push * sign;
            free.stop[1] += arm.cross(&(push * sign));
            free.stop[2] += friction * sign;
        }
    }
}

impl Stops {
    /// Records which vertices of the cloth are prescribed.
    fn update_prescribed(&mut self, near: &Near, inverse_mass: &[Real]) {
        let now = || inverse_mass.iter().map(|w| *w == 0.0);
        if now().eq(self.is_prescribed.iter().copied()) {
            return;
        }
        self.is_prescribed.clear();
        self.is_prescribed.extend(now());
        self.prescribed.clear();
        let is_prescribed = |v: &u32| {
            self.is_prescribed
                .get(*v as usize)
                .is_some_and(|prescribed| *prescribed)
        };
        let mut is_in_one = vec![false; self.is_prescribed.len()];
        let mut is_side = vec![false; near.incidence.edges.len()];
        let mut take = |part: [u32; 3]| {
            part.iter().for_each(|&v| is_in_one[v as usize] = true);
            self.prescribed.push(part);
        };
        let triangles = near.incidence.triangles.iter();
        for (corners, sides) in triangles.zip(&near.incidence.triangle_edges) {
            if corners.iter().all(is_prescribed) {
                take(*corners);
                sides.iter().for_each(|&e| is_side[e as usize] = true);
            }
        }
        for (&[a, b], is_side) in near.incidence.edges.iter().zip(&is_side) {
            if !is_side && is_prescribed(&a) && is_prescribed(&b) {
                take([a, b, b]);
            }
        }
        let alone = (0u32..).zip(&self.is_prescribed).zip(&is_in_one);
        let alone = alone.filter(|((_, prescribed), is_in_one)| **prescribed && !**is_in_one);
        self.prescribed.extend(alone.map(|((v, _), _)| [v; 3]));
    }
}

impl Stops {
    /// Enters the impulses of the meetings on the bodies that are met.
    fn react(&mut self) {
        for meeting in &self.meetings {
            if let Some(number) = meeting.against {
                let impulse = -(meeting.normal * meeting.impulse + meeting.friction);
                self.reactions[number][0] += impulse;
                self.reactions[number][1] += meeting.arms[1].cross(&impulse);
                self.reactions[number][2] -= meeting.friction;
            }
        }
    }
}

impl Contacts {
    /// Free bodies begin a (sub)step in which the cloth would go to `to` (m), as far as what does not give way
    /// lets them.
    pub(super) fn start_free_bodies(&mut self, step: &ContactStep<'_>, to: &[Vec3]) {
        self.free
            .list
            .iter_mut()
            .for_each(|free| free.stop = [Vec3::zeros(); 3]);
        if self.free.list.is_empty() {
            return;
        }
        self.stops.reactions.clear();
        self.stops
            .reactions
            .resize(self.bodies.len(), [Vec3::zeros(); 3]);
        let cloth = self.near.cloth;
        self.stops
            .update_prescribed(&self.near, &step.inverse_mass[..cloth]);
        for _ in 0..ROUNDS {
            self.move_free(step.dt);
            self.meet(step, to);
            self.stops
                .meetings
                .retain(|meeting| !self.free.list[meeting.body].is_halted);
            if self.stops.meetings.is_empty() {
                return;
            }
            self.free.stop_at(&mut self.stops.meetings);
            self.stops.react();
        }
        // Nothing else is sure.
        for meeting in &self.stops.meetings {
            self.free.list[meeting.body].is_halted = true;
        }
        self.move_free(step.dt);
    }

    /// Finds where free bodies first meet something.
    fn meet(&mut self, step: &ContactStep<'_>, to: &[Vec3]) {
        self.stops.meetings.clear();
        for number in 0..self.free.list.len() {
            let free = &self.free.list[number];
            let motion = self.bodies[free.number].0.motion();
            let turning = motion.angular_velocity.norm() * free.radius;
            let path = (motion.velocity.norm() + turning) * step.dt;
            let samples = (path / (SAMPLE_SPACING * free.extent))
                .ceil()
                .clamp(1.0, MOST_SAMPLES);
            let known = self.stops.meetings.len();
            for sample in 1..=samples as u32 {
                let time = step.dt * Real::from(sample) / samples;
                self.meet_prescribed(number, step, to, time);
                self.meet_bodies(number, time);
                if self.stops.meetings.len() > known {
                    break;
                }
            }
        }
    }

    /// Finds where a free body meets prescribed vertices, and what is between them, after `time` (s).
    fn meet_prescribed(&mut self, number: usize, step: &ContactStep<'_>, to: &[Vec3], time: Real) {
        let free = &self.free.list[number];
        let obstacle = &self.bodies[free.number].0;
        let centre = obstacle.motion().pose_at(time).position;
        let keep = FROM_PRESCRIBED * self.near.law.range();
        let fraction = time / step.dt;
        for &corners in &self.stops.prescribed {
            let from = gather(step.from, corners);
            let ends = gather(to, corners);
            let then: [Vec3; 3] = std::array::from_fn(|k| from[k] + (ends[k] - from[k]) * fraction);
            let size = (then[1] - then[0]).norm().max((then[2] - then[0]).norm());
            if (then[0] - centre).norm() > free.radius + size + keep {
                continue;
            }
            let weights = nearest(obstacle, &then, time, keep);
            let at = |x: &[Vec3; 3]| x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2];
            let (start, point) = (at(&from), at(&then));
            let distance = obstacle.signed_distance(point, time);
            let start = obstacle.signed_distance(start, 0.0).value;
            let moves = (at(&ends) - at(&from)) / step.dt;
            let vertex = corners[0] as usize;
            let place = Place {
                body: number,
                other: None,
                against: None,
                arms: [point - centre, Vec3::zeros()],
                normal: -distance.normal,
                velocity: obstacle.motion().velocity_at(point, time) - moves,
                coefficient: self.near.friction_on(vertex, self.bodies[free.number].1),
            };
            let met = place.met([start, distance.value, keep], time);
            self.stops.meetings.extend(met);
        }
    }

    /// Finds where the surface of a free body meets other bodies after `time` (s).
    fn meet_bodies(&mut self, number: usize, time: Real) {
        let free = &self.free.list[number];
        let own = self.bodies[free.number].0.motion();
        let [before, then] = [0.0, time].map(|time| own.pose_at(time));
        let keep = FROM_BODIES * self.near.law.range();
        for (index, (obstacle, friction)) in self.bodies.iter().enumerate() {
            let lipschitz = obstacle.shape().lipschitz();
            let between = obstacle.signed_distance(then.position, time).value / lipschitz;
            if index == free.number || between > free.radius + keep {
                continue;
            }
            let gives_way = |free: &FreeBody| free.number == index && !free.is_held;
            let other = self.free.list.iter().position(gives_way);
            let known = self.stops.meetings.len();
            for vertex in &free.surface {
                let distance = obstacle.signed_distance(then.to_world(*vertex), time);
                if distance.value >= keep {
                    continue;
                }
                let (local, distance) = self.support(number, time, (*vertex, distance), obstacle);
                let point = then.to_world(local);
                let is_known = |met: &Meeting| {
                    met.other == other
                        && (met.arms[0] + then.position - point).norm() <= SAME * free.radius
                };
                if self.stops.meetings[known..].iter().any(is_known) {
                    continue;
                }
                let start = obstacle.signed_distance(before.to_world(local), 0.0);
                let motion = obstacle.motion();
                let centres = [then.position, motion.pose_at(time).position];
                let place = Place {
                    body: number,
                    other,
                    against: other.is_none().then_some(index),
                    arms: centres.map(|centre| point - centre),
                    normal: distance.normal,
                    velocity: own.velocity_at(point, time) - motion.velocity_at(point, time),
                    coefficient: (self.bodies[free.number].1 * friction).sqrt(),
                };
                let met = place.met([start.value, distance.value, keep], time);
                self.stops.meetings.extend(met);
            }
        }
    }

    /// The point (m) of the surface of a free body after `time` (s), in its frame, that is nearest to an obstacle around
    /// a `vertex` of the surface, or the vertex where none is nearer; and the distance there. A round body rolls on its
    /// surface, not on these vertices.
    fn support(
        &self,
        number: usize,
        time: Real,
        (vertex, distance): (Vec3, Distance),
        obstacle: &Obstacle,
    ) -> (Vec3, Distance) {
        let free = &self.free.list[number];
        let (body, _) = &self.bodies[free.number];
        let pose = body.motion().pose_at(time);
        let (mut best, mut least) = (vertex, distance);
        for _ in 0..SUPPORTS {
            // The feet of points in front: the far one is soon foremost before a plane, the near one before a ball.
            let normal = pose.orientation.inverse_transform_vector(&least.normal);
            let ahead = normal * free.radius;
            let from = best;
            for far in FAR {
                let before = from - ahead * far;
                let foot = body.shape().signed_distance(before);
                let point = before - foot.normal * foot.value;
                let there = obstacle.signed_distance(pose.to_world(point), time);
                let is_on_surface = || {
                    let off = body.shape().signed_distance(point).value.abs();
                    off <= ROUNDING * free.radius
                };
                if there.value < least.value && is_on_surface() {
                    (best, least) = (point, there);
                }
            }
            if best == from {
                break;
            }
        }
        (best, least)
    }
}

impl FreeBodies {
    fn stop_at(&mut self, meetings: &mut [Meeting]) {
        let zeros = [Vec3::zeros(); 2];
        self.list.iter_mut().for_each(|free| free.change = zeros);
        for _ in 0..SWEEPS {
            for meeting in &mut *meetings {
                let normal = meeting.normal;
                let missing = meeting.missing - normal.dot(&meeting.change(&self.list));
                let more = missing / meeting.inverse_effective_mass(&self.list, normal);
                let impulse = (meeting.impulse + more).max(0.0);
                let push = normal * (impulse - meeting.impulse);
                meeting.push(&mut self.list, push, Vec3::zeros());
                meeting.impulse = impulse;
                let slip = meeting.slip + across(meeting.change(&self.list), normal);
                let Some(direction) = slip.try_normalize(0.0) else {
                    continue;
                };
                let inverse_effective_mass = meeting.inverse_effective_mass(&self.list, direction);
                let friction = clamp_to_friction_cone(
                    meeting.friction - slip / inverse_effective_mass,
                    meeting.coefficient * impulse,
                );
                let push = friction - meeting.friction;
                meeting.push(&mut self.list, push, push);
                meeting.friction = friction;
            }
        }
    }
}

impl FreeBody {
    /// What an impulse (N·s) at the end of an arm (m) makes of its velocities (m/s, rad/s).
    fn velocity_by(&self, impulse: Vec3, arm: Vec3) -> [Vec3; 2] {
        self.body
            .velocity_by(&self.place, [impulse, arm.cross(&impulse)])
    }
}

/// The weights of a point of a triangle (corners in m) that is nearest to an obstacle after `time` (s): parts that are
/// farther than `enough` (m) are left out. The best of a few points, and from there down φ along the triangle.
fn nearest(obstacle: &Obstacle, corners: &[Vec3; 3], time: Real, enough: Real) -> [Real; 3] {
    let pose = obstacle.motion().pose_at(time);
    let shape = obstacle.shape();
    let at = |w: &Vec3| corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
    let distance = |x: Vec3| shape.signed_distance(pose.to_local(x));
    let lower = |best: (Real, Vec3), w: Vec3| {
        let value = distance(at(&w)).value;
        if value < best.0 { (value, w) } else { best }
    };
    let mut rest = [[Vec3::zeros(); 3]; 2 * POINTS];
    rest[0] = [Vec3::x(), Vec3::y(), Vec3::z()];
    let mut best = rest[0].into_iter().fold((Real::INFINITY, Vec3::x()), lower);
    let (mut first, mut count) = (0, 1);
    while first < count.min(POINTS) {
        let part = rest[first];
        first += 1;
        let centre = part.iter().sum::<Vec3>() / 3.0;
        let places = part.each_ref().map(at);
        let far = places.iter().map(|x| (x - at(&centre)).norm());
        let size = far.fold(0.0, Real::max);
        let value = distance(at(&centre)).value;
        best = if value < best.0 {
            (value, centre)
        } else {
            best
        };
        if size == 0.0 || value - shape.lipschitz() * size >= best.0.min(enough) {
            continue;
        }
        let length = |k: usize| (places[(k + 1) % 3] - places[k]).norm();
        let longest = (0..3).max_by(|a, b| length(*a).total_cmp(&length(*b)));
        let [a, b, c] = [0, 1, 2].map(|k| part[(longest.unwrap_or(0) + k) % 3]);
        let middle = (a + b) / 2.0;
        if count + 2 <= rest.len() {
            (rest[count], rest[count + 1]) = ([a, middle, c], [middle, b, c]);
            count += 2;
        }
    }
    let sides = [1, 2].map(|k| (corners[k] - corners[0]).norm());
    if best.0 >= enough + shape.lipschitz() * (sides[0] + sides[1]) {
        return best.1.into();
    }
    let mut length = sides[0].max(sides[1]);
    for _ in 0..DESCENTS {
        let x = at(&best.1);
        let down = pose.orientation * distance(x).normal;
        let next = lower(
            best,
            point_triangle(x - down * length, *corners).weights.into(),
        );
        if next.0 == best.0 {
            length *= 0.5;
        }
        best = next;
    }
    best.1.into()
}

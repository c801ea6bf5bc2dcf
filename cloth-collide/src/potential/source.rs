//! The contact of a cloth as a potential.

use super::bodies::Body;
use super::constraints::Constraints;
use super::filter::shorten_all;
use super::forces::Ledger;
use super::free::FreeBodies;
use super::friction::{ALONE, FrictionContact, Key, TangentialDisplacements};
use super::groups::longest_of_groups;
use super::last_resort::LastResort;
use super::led_out::LedOut;
use super::multipliers::Multipliers;
use super::near::Near;
use super::near_pairs::NearPairs;
use super::obstacle_contact::ObstacleContact;
use super::stops::Stops;
use crate::obstacle::Obstacle;
use crate::pair::{Gap, weighted};
use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactRow, ContactStep,
};
use cloth_core::element::Energy;
use cloth_core::math::{Real, Vec3, gather, is_finite};

/// Paths longer than this many thicknesses, relative to the mean motion of what is near, are tested up to there only.
const LONGEST: Real = 10.0;
/// Times that pairs are chosen anew because vertices were cut, before all are cut alike.
const MOST_ROUNDS: u32 = 10;
/// Coordinates (m) from which on squares are beyond all numbers.
const LARGEST: Real = 1e150;
/// Displacement (in thicknesses) below which friction is a spring.
const STICKING: Real = 1e-2;

/// Contact among the vertices of a cloth, and of surfaces of bodies that follow them as prescribed ones, and with
/// obstacles.
#[derive(Clone, Debug)]
pub(super) struct Contacts {
    /// For methods that project positions.
    pub(super) constraints: Constraints,
    pub(super) near: Near,
    pub(super) pairs: NearPairs,
    multipliers: Multipliers,
    /// Where the last step has ended (m), free of crossings.
    pub(super) safe: Vec<Vec3>,
    pub(super) friction: Vec<FrictionContact>,
    pub(super) tangential: TangentialDisplacements,
    /// Of moving bodies in the last step (J).
    pub(super) work: Real,
    pub(super) bodies: Vec<Body>,
    pub(super) last_resort: LastResort,
    /// None unless forces are wanted, or a body is free.
    pub(super) ledger: Option<Ledger>,
    /// Obstacles that the cloth pushes.
    pub(super) free: FreeBodies,
    pub(super) stops: Stops,
    /// The obstacles at the end of the step.
    pub(super) still: Vec<Obstacle>,
    /// The obstacles before the step; and a place for those before it while what it has done is kept free.
    pub(super) before: Vec<Obstacle>,
    before_step: Vec<Obstacle>,
    /// Whether a step has begun and not ended.
    pub(super) is_open: bool,
    /// Whether a step that had not ended was taken back, or other pairs were excluded, so that nothing is known of the
    /// next one.
    pub(super) is_anew: bool,
    /// Prescribed vertices that move, and their displacements (m) in the step.
    moved: Vec<(u32, Vec3)>,
    pub(super) led_out: LedOut,
    /// Where the method would begin to iterate (m).
    wanted: Vec<Vec3>,
    scratch: Vec<Vec3>,
    pub(super) energy: Real,
    /// Vertices whose path the last step has truncated.
    pub(super) truncated: usize,
}

impl Contacts {
    pub(super) fn new(near: Near, bodies: Vec<Body>) -> Self {
        Self {
            constraints: Constraints::default(),
            scratch: vec![Vec3::zeros(); near.vertex_area.len()],
            near,
            pairs: NearPairs::default(),
            multipliers: Multipliers::default(),
            safe: Vec::new(),
            friction: Vec::new(),
            tangential: TangentialDisplacements::default(),
            work: 0.0,
            bodies,
            last_resort: LastResort::default(),
            ledger: None,
            free: FreeBodies::default(),
            stops: Stops::default(),
            still: Vec::new(),
            before: Vec::new(),
            before_step: Vec::new(),
            is_open: false,
            is_anew: false,
            moved: Vec::new(),
            led_out: LedOut::default(),
            wanted: Vec::new(),
            energy: 0.0,
            truncated: 0,
        }
    }

    /// See [`ContactSource::keep_free`](cloth_core::contact::ContactSource::keep_free).
    pub(super) fn keep_free(
        &mut self,
        step: &ContactStep<'_>,
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        // What the step has done stays what it has done, and bodies are where it has left them.
        let (work, energy, truncated) = (self.work, self.energy, self.truncated);
        let of_free = self.free.work;
        let ledger = self.ledger.take();
        self.swap_before();
        let kept = self
            .begin_step(step)
            .and_then(|()| self.begin_substep(step, x))
            .and_then(|()| self.end_substep(step, x));
        self.ledger = ledger;
        kept?;
        let moved = std::mem::take(&mut self.constraints.report.shortened) as usize;
        self.end_step(x);
        self.is_open = true;
        self.undo();
        self.swap_before();
        (self.work, self.energy, self.truncated) = (work, energy, truncated + moved);
        self.free.work = of_free;
        Ok(())
    }
}

impl ContactPotential for Contacts {
    fn begin(&mut self, step: &ContactStep<'_>, start: &mut [Vec3]) -> Result<(), ContactError> {
        let goes_on = self.check_start(step)? && !self.near.starts_moving(step.from, start);
        self.near.check_range(start)?;
        self.truncated = 0;
        self.free.remember();
        self.free.dt = step.dt;
        self.remember_bodies();
        self.constraints.took_last = false;
        let mut wanted = std::mem::take(&mut self.wanted);
        start.clone_into(&mut wanted);
        let is_still = self.is_still(step, &wanted);
        self.moved.clear();
        let prescribed = (0..wanted.len()).filter(|&v| step.inverse_mass[v] == 0.0);
        let displacements = prescribed.map(|v| (v as u32, wanted[v] - step.from[v]));
        let moved = displacements.filter(|(_, displacement)| *displacement != Vec3::zeros());
        self.moved.extend(moved);
        self.is_open = true;
        self.led_out.clear();
        if !goes_on {
            self.find_led_out(step);
        }
        if !is_still {
            self.find_feasible_start(step, goes_on, start)?;
        }
        self.still.clear();
        let still = self.bodies.iter().map(|(body, _)| body.stopped());
        self.still.extend(still);
        self.pairs.begin(step.from, &self.near.is_resting, goes_on);
        self.multipliers.clear();
        let goal = if is_still { &wanted[..] } else { step.from };
        self.prepare(step.from, goal, false)?;
        self.freeze_friction(step);
        if is_still {
            let fraction = self.safe_fraction(step.from, &wanted);
            for ((x, from), to) in start.iter_mut().zip(step.from).zip(&wanted) {
                *x = if fraction < 1.0 {
                    from + (to - from) * fraction
                } else {
                    *to
                };
            }
        }
        self.wanted = wanted;
        self.prepare(start, start, false)
    }

    fn limit(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<Real, ContactError> {
        let fraction = self.tested_fraction(from, to);
        if fraction < 1.0 {
            let mut near_end = std::mem::take(&mut self.scratch);
            let displacements = from.iter().zip(to).zip(&mut near_end);
            displacements.for_each(|((a, b), end)| *end = a + (b - a) * fraction);
            let safe = self.limit_short(from, &near_end);
            self.scratch = near_end;
            return Ok(fraction * safe?);
        }
        self.limit_short(from, to)
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        fractions.fill(1.0);
        shorten_all(from, to, fractions, self.tested_fraction(from, to));
        for round in 0..MOST_ROUNDS {
            // What is cut stays behind what flew along with it, and other pairs may be near on what is left of the
            // paths.
            let known = self.pairs.choices;
            self.prepare(from, to, true)?;
            if round > 0 && self.pairs.choices == known {
                return Ok(());
            }
            let path = (from, &mut *to);
            if !self.pairs.shorten(&self.near, path, fractions, &self.still) {
                return Ok(());
            }
        }
        self.prepare(from, to, true)?;
        let fraction = self.safe_fraction(from, to);
        shorten_all(from, to, fractions, fraction);
        Ok(())
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let mut sum = self.pair_gradients(x, |vertex, g| out[vertex] += g);
        for contact in self.obstacle_contacts(x) {
            let (value, gradient) = contact.value_and_gradient();
            sum += value;
            out[contact.vertex] += gradient;
        }
        let reach = self.reach();
        for contact in &self.friction {
            sum += contact.add_gradient(reach, x, out);
        }
        sum
    }

    fn linearize(&self, x: &[Vec3], out: &mut Vec<ContactRow>) {
        let mut push = |vertices, weights, normal, stiffness: Real| {
            if stiffness > 0.0 {
                out.push(ContactRow {
                    vertices,
                    weights,
                    normal,
                    stiffness,
                });
            }
        };
        for near in self.pairs.iter_at(x) {
            let places = gather(x, near.pair.vertices);
            let gap = Gap::new(near.pair.kind, &places);
            if gap.distance < near.law.range() {
                let area = near.area_at(&places);
                let stiffness = self.multipliers.stiffness(near, &gap, area);
                push(near.pair.vertices, gap.weights, gap.normal, stiffness);
            }
        }
        for contact in self.obstacle_contacts(x) {
            contact.each_stiffness(|normal, stiffness| {
                push([contact.vertex as u32; 4], ALONE, normal, stiffness);
            });
        }
        let reach = self.reach();
        let contacts = self.friction.iter();
        out.extend(contacts.flat_map(|contact| contact.rows(reach, x)));
    }

    fn linearization_errors(&self, x: &[Vec3], to: &[Vec3], out: &mut Vec<Real>) {
        for near in self.pairs.iter_at(x) {
            let places = gather(x, near.pair.vertices);
            let gap = Gap::new(near.pair.kind, &places);
            if gap.distance < near.law.range() {
                let area = near.area_at(&places);
                if self.multipliers.stiffness(near, &gap, area) > 0.0 {
                    let there = Gap::new(near.pair.kind, &gather(to, near.pair.vertices));
                    let signed = there.distance.copysign(there.normal.dot(&gap.normal));
                    let linear = gap
                        .normal
                        .dot(&weighted(near.pair.vertices, gap.weights, to));
                    out.push(signed - linear);
                }
            }
        }
    }

    fn update_multipliers(&mut self, x: &[Vec3], direction: &[Vec3]) {
        self.multipliers.update(&self.pairs, x, direction);
    }

    fn has_free_bodies(&self) -> bool {
        !self.free.list.is_empty()
    }

    fn end(&mut self, x: &[Vec3], v: &mut [Vec3]) {
        self.is_open = false;
        self.led_out.stop(v);
        let reach = self.reach();
        self.tangential.replace(&self.friction, reach, x);
        self.work = self.work_of_bodies(x) + self.work_of_prescribed(x);
        self.record_forces(x);
        self.take_forces();
        // Friction stores nothing that it gives back.
        self.friction.clear();
        let mut unused = std::mem::take(&mut self.scratch);
        self.energy = self.add_gradient(x, &mut unused);
        self.scratch = unused;
        x.clone_into(&mut self.safe);
    }
}

impl Contacts {
    /// Whether nothing that is evaluated has a vertex of a body's surface.
    pub(super) fn is_clear_of_surfaces(&self) -> bool {
        let is_own = |v: &u32| (*v as usize) < self.near.cloth;
        let mut pairs = self.pairs.iter();
        pairs.all(|chosen| chosen.contact.pair.vertices.iter().all(is_own))
            && self.friction.iter().all(|s| s.vertices.iter().all(is_own))
    }

    /// The fraction of paths (m) that is tested: they are too long beyond.
    fn tested_fraction(&self, from: &[Vec3], to: &[Vec3]) -> Real {
        let path = [from, to].map(|x| self.near.own(x));
        let range = self.near.law.range();
        (LONGEST * range / longest_of_groups(&self.near.components, path, range)).min(1.0)
    }

    /// ε (m): the displacement below which friction is a spring.
    pub(super) fn reach(&self) -> Real {
        STICKING * self.near.law.range()
    }

    pub(super) fn remember_bodies(&mut self) {
        self.before.clear();
        let bodies = self.bodies.iter().map(|(body, _)| body.clone());
        self.before.extend(bodies);
    }

    /// Puts aside what bodies were before the last step, or takes it up again.
    fn swap_before(&mut self) {
        std::mem::swap(&mut self.before, &mut self.before_step);
        let FreeBodies {
            before,
            before_step,
            ..
        } = &mut self.free;
        std::mem::swap(before, before_step);
    }

    /// Takes a step back that has begun and not ended, if there is one. Returns whether there was.
    pub(super) fn take_back(&mut self) -> bool {
        let was_open = self.is_open;
        self.undo();
        self.is_anew |= was_open;
        was_open
    }

    /// Takes bodies back to where they were before a step that has begun and not ended.
    pub(super) fn undo(&mut self) {
        if std::mem::take(&mut self.is_open) {
            let bodies = self.bodies.iter_mut().zip(&self.before);
            bodies.for_each(|((body, _), before)| body.clone_from(before));
            self.free.undo();
        }
    }

    /// Lets the cloth pass through a body where the last step, which began at `from` (m), found no feasible path.
    /// Returns whether it could not before.
    pub(super) fn let_pass(&mut self, from: &[Vec3]) -> bool {
        let blocked = std::mem::take(&mut self.last_resort.blocked);
        let more = self.near.let_pass(&blocked);
        if more {
            self.is_anew = true;
            self.constraints
                .start_anew(&self.near, from, self.bodies.len());
        }
        more
    }

    /// Cloth that passes through a body no more, at `x` (m), is kept out of it again.
    pub(super) fn unpinch(&mut self, x: &[Vec3]) -> Result<(), ContactError> {
        for number in self.near.unpinched(x)? {
            let body = self.bodies.get(number);
            let is_out =
                |v: usize| body.is_none_or(|(body, _)| body.signed_distance(x[v], 0.0).value > 0.0);
            let are_out = self.near.pinched.vertices(number).all(is_out);
            if are_out {
                self.near.pinched.release(number);
                self.is_anew = true;
            }
        }
        Ok(())
    }

    /// Whether nothing moves but what is free to, and that is outside of all bodies: the path to begin needs no help
    /// then.
    fn is_still(&self, step: &ContactStep<'_>, wanted: &[Vec3]) -> bool {
        let ends = step.inverse_mass.iter().zip(step.from.iter().zip(wanted));
        let mut pins = ends.filter(|(w, _)| **w == 0.0);
        let mut bodies = self.before.iter();
        let is_outside = |v: usize| {
            step.inverse_mass[v] == 0.0
                || self.near.is_inside(v)
                || self.before.iter().enumerate().all(|(number, body)| {
                    let x = step.from[v];
                    self.near.pinched.passes(v, number)
                        || self.pairs.known_distance([v, number], &self.before, x) > 0.0
                        || body.signed_distance(x, 0.0).value > 0.0
                })
        };
        bodies.all(|body| body.motion().is_still())
            && pins.all(|(_, (a, b))| a == b)
            && (0..step.from.len()).all(is_outside)
    }

    /// Finds the contacts at the start of a step that have friction in it.
    fn freeze_friction(&mut self, step: &ContactStep<'_>) {
        let (near, tangential, frictions) = (&self.near, &self.tangential, &mut self.friction);
        let x = step.from;
        frictions.clear();
        for contact in self.pairs.iter_at(x) {
            let (key, vertices) = (Key::Pair(contact.pair), contact.pair.vertices);
            let places = gather(x, vertices);
            let gap = Gap::new(contact.pair.kind, &places);
            let force = -contact.area_at(&places) * contact.law.slope(gap.distance);
            let most = near.friction(vertices) * force;
            if most > 0.0 {
                frictions.push(FrictionContact {
                    key,
                    vertices,
                    weights: gap.weights,
                    normal: gap.normal,
                    most,
                    origin: weighted(vertices, gap.weights, x) - tangential.of(key),
                });
            }
        }
        let pairs = &self.pairs;
        let bodies = self.before.iter().zip(&self.still).zip(&self.bodies);
        for (number, ((before, after), (_, friction))) in (0u32..).zip(bodies) {
            for (vertex, place) in (0u32..).zip(near.own(x)) {
                let v = vertex as usize;
                let passes = near.is_inside(v) || near.pinched.passes(v, number as usize);
                if step.inverse_mass[v] == 0.0 || *friction == 0.0 || passes {
                    continue;
                }
                let known = pairs.known_distance([v, number as usize], &self.before, *place);
                if known >= near.law.range() {
                    continue;
                }
                let contact = near.before(before, [v, number as usize], *place);
                let (_, gradient) = contact.value_and_gradient();
                let force = gradient.norm();
                if force > 0.0 {
                    let key = Key::Obstacle([vertex, number]);
                    let moved = after.motion().pose;
                    let moved = moved.to_world(before.motion().pose.to_local(*place));
                    frictions.push(FrictionContact {
                        key,
                        vertices: [vertex; 4],
                        weights: ALONE,
                        normal: gradient / -force,
                        most: near.friction_on(v, *friction) * force,
                        origin: moved - tangential.of(key),
                    });
                }
            }
        }
    }

    /// Hands `add` the gradients (N) of the energies of pairs at `x` (m), vertex by vertex, and returns their sum (J).
    pub(super) fn pair_gradients(&self, x: &[Vec3], mut add: impl FnMut(usize, Vec3)) -> Real {
        let mut sum = 0.0;
        for near in self.pairs.iter_at(x) {
            let vertices = near.pair.vertices;
            let (value, gradient) = near.value_and_gradient(&gather(x, vertices));
            if value != 0.0 {
                for (vertex, g) in vertices.into_iter().zip(gradient) {
                    add(vertex as usize, g);
                }
            }
            sum += value;
        }
        sum
    }

    /// The vertices that may touch an obstacle, with the cloth at `x` (m).
    pub(super) fn obstacle_contacts<'a>(
        &'a self,
        x: &'a [Vec3],
    ) -> impl Iterator<Item = ObstacleContact<'a>> + 'a {
        self.pairs.vertex_obstacle.iter().map(move |pair| {
            let [vertex, number] = pair.map(|n| n as usize);
            let place = x[vertex];
            self.near
                .before(&self.still[number], [vertex, number], place)
        })
    }

    /// Work (J) of what is prescribed against the forces of pairs at `x` (m), where the step ends.
    fn work_of_prescribed(&mut self, x: &[Vec3]) -> Real {
        if self.moved.is_empty() {
            return 0.0;
        }
        let mut gradient = std::mem::take(&mut self.scratch);
        gradient.fill(Vec3::zeros());
        self.add_gradient(x, &mut gradient);
        let works = self
            .moved
            .iter()
            .map(|(v, displacement)| gradient[*v as usize].dot(displacement));
        let work = works.sum();
        self.scratch = gradient;
        work
    }

    /// Work (J) that bodies did on the cloth, which has come to `x` (m): the force on each vertex times the
    /// displacement of the body there.
    fn work_of_bodies(&self, x: &[Vec3]) -> Real {
        let mut work = 0.0;
        let mut add = |[v, number]: [usize; 2], gradient: &dyn Fn() -> Vec3| {
            let before = self.before[number].motion();
            if !before.is_still() {
                let local = self.still[number].motion().pose.to_local(x[v]);
                work -= gradient().dot(&(x[v] - before.pose.to_world(local)));
            }
        };
        for contact in self.obstacle_contacts(x) {
            let gradient = || contact.value_and_gradient().1;
            add([contact.vertex, contact.number], &gradient);
        }
        for contact in &self.friction {
            if let Key::Obstacle(key) = contact.key {
                let gradient = || contact.force(self.reach(), x).0;
                add(key.map(|n| n as usize), &gradient);
            }
        }
        work
    }

    /// The same as [`ContactPotential::limit`] for a path that is not too long to be tested as a whole.
    fn limit_short(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<Real, ContactError> {
        self.prepare(from, to, true)?;
        Ok(self.safe_fraction(from, to))
    }

    /// Chooses pairs for a path (m); see [`NearPairs::prepare`].
    fn prepare(&mut self, from: &[Vec3], to: &[Vec3], stay: bool) -> Result<(), ContactError> {
        let count = if stay { self.near.cloth } else { from.len() };
        let bad = |x: &Vec3| x.amax() >= LARGEST || !is_finite(x);
        if let Some(vertex) = (0..count).find(|&v| bad(&from[v]) || bad(&to[v])) {
            return Err(ContactError::NonFinite { vertex });
        }
        self.pairs
            .prepare(&self.near, [from, to], &self.still, stay);
        Ok(())
    }

    fn safe_fraction(&self, from: &[Vec3], to: &[Vec3]) -> Real {
        self.pairs.safe_fraction(&self.near, from, to, &self.still)
    }

    /// Begins a step, after one that may not have ended: whether its start is in order, and whether it is where the
    /// last one has ended.
    pub(super) fn check_start(&mut self, step: &ContactStep<'_>) -> Result<bool, ContactError> {
        step.check(self.near.vertex_area.len(), step.from, step.from)?;
        self.take_back();
        let was_open = std::mem::take(&mut self.is_anew);
        let is_same = !self.near.begin(step.inverse_mass);
        let goes_on = !was_open && is_same && self.safe == step.from;
        if goes_on && !self.prescribed_inside_moves() {
            return Ok(true);
        }
        self.safe.clear();
        let before = self.near.prescribed_inside.clone();
        let Near {
            prescribed_inside,
            is_free,
            ..
        } = &mut self.near;
        prescribed_inside.retain(|v, body| {
            let body = self.bodies.get(body).filter(|_| !is_free[v]);
            body.is_some_and(|(body, _)| body.signed_distance(step.from[v], 0.0).value <= 0.0)
        });
        self.near.check_crossing(step.from)?;
        Ok(goes_on && self.near.prescribed_inside == before)
    }

    /// Whether prescribed vertices in bodies may be there no more.
    fn prescribed_inside_moves(&self) -> bool {
        let stands = |body: u32| {
            let body = self.bodies.get(body as usize);
            body.is_some_and(|(body, _)| body.motion().is_still())
        };
        let moves = |[v, body]: &[u32; 2]| !self.near.is_resting[*v as usize] || !stands(*body);
        self.near.prescribed_inside.pairs().iter().any(moves)
    }
}

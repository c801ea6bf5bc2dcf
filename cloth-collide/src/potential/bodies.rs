//! Vertices before bodies, as constraints whose distance is evaluated in every sweep.

use super::constraints::{DETECTION_MARGIN, KEPT, LEAST};
use super::forces::Ledger;
use super::friction::ALONE;
use super::near::Near;
use super::rebound::Rebound;
use super::tangent::{ConstraintState, Tangent};
use crate::obstacle::{Obstacle, VertexPath, first_contact};
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3};

/// A rigid body with a signed distance, and the coefficient of friction μ (dimensionless) on it.
pub(super) type Body = (Obstacle, Real);

/// A substep, of the cloth alone or of all vertices, and what it meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Substep<'a> {
    pub(super) near: &'a Near,
    pub(super) bodies: &'a [Body],
    pub(super) step: ContactStep<'a>,
}

impl<'a> Substep<'a> {
    /// That of the cloth alone.
    pub(super) fn of_cloth(near: &'a Near, bodies: &'a [Body], step: &ContactStep<'a>) -> Self {
        Self {
            near,
            bodies,
            step: ContactStep {
                from: near.own(step.from),
                inverse_mass: &step.inverse_mass[..near.cloth],
                dt: step.dt,
            },
        }
    }

    fn body(&self, contact: &BodyConstraint) -> &'a Obstacle {
        &self.bodies[contact.body as usize].0
    }
}

/// A vertex that can touch a body in this substep.
#[derive(Clone, Copy, Debug, Default)]
struct BodyConstraint {
    vertex: u32,
    body: u32,
    /// At the start of the substep (m).
    distance: Real,
    /// h (m).
    thickness: Real,
    state: ConstraintState,
    is_violated: bool,
    /// That of the last visit, and the push (kg m) along those of all visits.
    normal: Vec3,
    pressure: Vec3,
    /// By how much it would get nearer in the substep (m), if that is wanted.
    approach: Real,
}

/// All vertices and bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies {
    list: Vec<BodyConstraint>,
    /// Of each body and each vertex: a lower bound of its distance (m) where it was at `places` (m), with the body
    /// where it is at the start of the substep.
    bounds: Vec<Real>,
    places: Vec<Vec3>,
    /// Tangential displacement there (m).
    tangential: Vec<Vec3>,
    /// Whether the approach of constraints is wanted.
    pub(super) measures_approach: bool,
    /// Whether a vertex has a constraint for a body.
    has_constraint: Vec<bool>,
}

/// How far a body can go at `x` (m) in `dt` (s).
fn displacement_of(body: &Obstacle, x: Vec3, dt: Real) -> Real {
    let motion = body.motion();
    if motion.is_still() {
        return 0.0;
    }
    let arm = (x - motion.pose.position).norm() + motion.velocity.norm() * dt;
    dt * (motion.velocity.norm() + motion.angular_velocity.norm() * arm)
}

impl Bodies {
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Forgets all that is known of distances and friction.
    pub(super) fn forget(&mut self, vertices: usize, bodies: usize) {
        self.list.clear();
        let count = vertices * bodies;
        self.bounds.clear();
        self.bounds.resize(count, Real::NEG_INFINITY);
        self.places.clear();
        self.places.resize(count, Vec3::zeros());
        self.tangential.clear();
        self.tangential.resize(count, Vec3::zeros());
        self.has_constraint.clear();
        self.has_constraint.resize(count, false);
    }

    /// Begins a substep: constraints for the vertices that can touch a body on their path to `to` (m).
    pub(super) fn begin(&mut self, substep: &Substep<'_>, to: &[Vec3]) {
        self.list.clear();
        self.has_constraint.fill(false);
        let reach = substep.near.law.range() * (1.0 + DETECTION_MARGIN);
        self.each_near(substep, to, reach, |bodies, index, contact| {
            contact.set_law(substep);
            contact.state.origin -= bodies.tangential[index];
            bodies.has_constraint[index] = true;
            bodies.list.push(*contact);
        });
    }

    /// Hands `visit` each vertex without a constraint that can come as near as `reach` (m) to a body, with its index.
    fn each_near(
        &mut self,
        Substep { near, bodies, step }: &Substep<'_>,
        to: &[Vec3],
        reach: Real,
        mut visit: impl FnMut(&mut Self, usize, &mut BodyConstraint),
    ) {
        for (number, (body, _)) in bodies.iter().enumerate() {
            let (lipschitz, is_still) = (body.shape().lipschitz(), body.motion().is_still());
            let first = number * step.from.len();
            for (vertex, (from, to)) in step.from.iter().zip(to).enumerate() {
                let index = first + vertex;
                let of_body = if is_still {
                    0.0
                } else {
                    displacement_of(body, *from, step.dt)
                };
                let place = self.places[index];
                let displacement = (from - place)
                    .norm_squared()
                    .max((to - place).norm_squared());
                let left = (self.bounds[index] - reach) / lipschitz - of_body;
                let is_far = left >= 0.0 && displacement <= left * left;
                if is_far || self.has_constraint[index] || step.inverse_mass[vertex] == 0.0 {
                    continue;
                }
                if near.is_inside(vertex) || near.pinched.passes(vertex, number) {
                    continue;
                }
                let at = body.signed_distance(*from, 0.0);
                (self.bounds[index], self.places[index]) = (at.value, *from);
                if at.value - lipschitz * ((to - from).norm() + of_body) >= reach {
                    self.tangential[index] = Vec3::zeros();
                    continue;
                }
                let motion = body.motion();
                let local = motion.pose.to_local(*from);
                let mut contact = BodyConstraint {
                    vertex: vertex as u32,
                    body: number as u32,
                    distance: at.value,
                    normal: at.normal,
                    approach: match self.measures_approach {
                        true => at.value - body.signed_distance(*to, step.dt).value,
                        false => 0.0,
                    },
                    ..BodyConstraint::default()
                };
                contact.state.origin = motion.pose_at(step.dt).to_world(local);
                visit(self, index, &mut contact);
            }
        }
    }

    /// How far (m) every vertex may go from `x` (m) while none comes within the thickness of a body; nothing if bodies
    /// move.
    pub(super) fn margin(&self, substep: &Substep<'_>, x: &[Vec3]) -> Option<Real> {
        let h = substep.near.law.range();
        let mut least = Real::INFINITY;
        for (number, (body, _)) in substep.bodies.iter().enumerate() {
            if !body.motion().is_still() {
                return None;
            }
            let first = number * substep.near.cloth;
            for (vertex, (x, w)) in x.iter().zip(substep.step.inverse_mass).enumerate() {
                if *w > 0.0 && !substep.near.is_inside(vertex) {
                    let bound = self.bounds[first + vertex] - h * (1.0 + DETECTION_MARGIN);
                    let displacement = (x - self.places[first + vertex]).norm();
                    least = least.min(bound / body.shape().lipschitz() - displacement);
                }
            }
        }
        Some(least)
    }

    /// Projects each vertex out of the bodies, where they are at the end of the substep.
    pub(super) fn sweep(&mut self, substep: &Substep<'_>, x: &mut [Vec3]) {
        for contact in &mut self.list {
            let v = contact.vertex as usize;
            let at = substep.body(contact).signed_distance(x[v], substep.step.dt);
            let (inverse_mass, before) = (substep.step.inverse_mass[v], contact.state.lambda);
            if let Some(push) = contact.state.project(&at, x[v], inverse_mass) {
                contact.normal = at.normal;
                contact.pressure += at.gradient() * (contact.state.lambda - before);
                x[v] += push * inverse_mass;
            }
        }
    }

    /// How many vertices come too near on their path to `x` (m); those get constraints.
    pub(super) fn violations(&mut self, substep: &Substep<'_>, x: &[Vec3]) -> u32 {
        let reach = KEPT * substep.near.law.range();
        self.each_near(substep, x, reach, |bodies, index, contact| {
            if !contact.is_safe(substep, x) {
                contact.set_law(substep);
                bodies.has_constraint[index] = true;
                bodies.list.push(*contact);
            }
        });
        let mut count = 0;
        for contact in &mut self.list {
            contact.is_violated = !contact.is_safe(substep, x);
            count += u32::from(contact.is_violated);
        }
        count
    }

    /// The constraints that push.
    fn touching(&self) -> impl Iterator<Item = &BodyConstraint> + '_ {
        let all = self.list.iter();
        all.filter(|contact| contact.state.lambda > 0.0)
    }

    /// The vertices that have come too near.
    pub(super) fn violated(&self) -> impl Iterator<Item = u32> + '_ {
        let violated = self.list.iter().filter(|contact| contact.is_violated);
        violated.map(|contact| contact.vertex)
    }

    /// Takes the compliance from the constraints of those, on the path to `x` (m).
    pub(super) fn harden(&mut self, substep: &Substep<'_>, x: &[Vec3]) {
        for contact in self.list.iter_mut().filter(|contact| contact.is_violated) {
            let at = substep
                .body(contact)
                .signed_distance(x[contact.vertex as usize], substep.step.dt);
            contact
                .state
                .harden(contact.distance, LEAST * contact.thickness, at.value);
        }
    }

    /// What is inside comes out in this substep, not in as many as its law would take.
    pub(super) fn move_out(&mut self) {
        let inside = self.list.iter_mut();
        for contact in inside.filter(|contact| contact.distance <= 0.0) {
            (contact.state.compliance, contact.state.range) = (0.0, LEAST * contact.thickness);
        }
    }

    /// The substep ends at `x` (m), the bodies still being where they are at its start. Tangential displacements of up
    /// to `reach` (m) are kept for the next one. Returns the work (J) that the bodies did.
    pub(super) fn end(&mut self, substep: &Substep<'_>, reach: Real, x: &[Vec3]) -> Real {
        let Substep { bodies, step, .. } = substep;
        for (number, (body, _)) in bodies.iter().enumerate() {
            if !body.motion().is_still() {
                let first = number * step.from.len();
                for (bound, from) in self.bounds[first..].iter_mut().zip(step.from) {
                    *bound -= displacement_of(body, *from, step.dt) * body.shape().lipschitz();
                }
            }
        }
        let mut work = 0.0;
        for contact in &self.list {
            let v = contact.vertex as usize;
            let index = contact.body as usize * step.from.len() + v;
            self.tangential[index] = contact.state.tangential(x[v], contact.normal, reach);
            let impulse = (contact.pressure + contact.state.friction) / step.dt;
            work += impulse.dot(&substep.body(contact).motion().velocity_at(x[v], step.dt));
        }
        work
    }

    /// Appends the vertices that touch a body and approached it, or left it, by more than `least` (m) in a substep that
    /// ends at `x` (m), the bodies still being where they are at its start.
    pub(super) fn rebounds(
        &self,
        substep: &Substep<'_>,
        least: Real,
        x: &[Vec3],
        out: &mut Vec<Rebound>,
    ) {
        let step = &substep.step;
        for contact in self
            .touching()
            .filter(|contact| contact.approach.abs() > least)
        {
            let v = contact.vertex as usize;
            out.push(Rebound {
                vertices: [contact.vertex; 4],
                weights: ALONE,
                normal: contact.normal,
                inverse_mass: [step.inverse_mass[v]; 4],
                inverse_effective_mass: step.inverse_mass[v],
                approach: contact.approach / step.dt,
                of_body: -contact
                    .normal
                    .dot(&substep.body(contact).motion().velocity_at(x[v], step.dt)),
            });
        }
    }

    /// Hands `visit` the vertices that touch body `number`, and the impulses (N·s) on them in a substep of `dt` (s).
    pub(super) fn each_impulse(&self, number: usize, dt: Real, mut visit: impl FnMut(usize, Vec3)) {
        let of_body = |contact: &&BodyConstraint| contact.body as usize == number;
        for contact in self.list.iter().filter(of_body) {
            let impulse = (contact.pressure + contact.state.friction) / dt;
            visit(contact.vertex as usize, impulse);
        }
    }

    /// Enters the impulses of a substep that ends at `x` (m), the bodies still being where they are at its start.
    pub(super) fn record(&self, substep: &Substep<'_>, x: &[Vec3], ledger: &mut Ledger) {
        let dt = substep.step.dt;
        for contact in &self.list {
            let (v, number) = (contact.vertex as usize, contact.body as usize);
            let arm = x[v] - substep.body(contact).motion().pose_at(dt).position;
            let impulses = [contact.pressure, contact.state.friction].map(|push| push / dt);
            ledger.add_obstacle([v, number], impulses, arm);
        }
    }

    /// Energy (J) that is stored at `x` (m).
    pub(super) fn energy(&self, bodies: &[Body], near: &Near, x: &[Vec3]) -> Real {
        let energy = |contact: &BodyConstraint| {
            let v = contact.vertex as usize;
            let at = bodies[contact.body as usize].0.signed_distance(x[v], 0.0);
            near.vertex_area[v] * near.law_at(v).energy(at.value)
        };
        self.touching().map(energy).sum()
    }
}

impl BodyConstraint {
    fn set_law(&mut self, Substep { near, bodies, step }: &Substep<'_>) {
        let (v, (_, friction)) = (self.vertex as usize, &bodies[self.body as usize]);
        let law = near.law_at(v);
        self.thickness = law.range();
        self.state.coefficient = near.friction_on(v, *friction);
        let tangent = Tangent::of(law, near.vertex_area[v], self.distance);
        self.state.range = tangent.range;
        self.state.compliance = tangent.compliance(step.dt);
    }

    /// Whether the vertex does not come too near on its path to `x` (m).
    fn is_safe(&self, substep: &Substep<'_>, x: &[Vec3]) -> bool {
        let (body, step) = (substep.body(self), &substep.step);
        let v = self.vertex as usize;
        let h = substep.near.law_at(v).range();
        let (from, to) = (step.from[v], x[v]);
        if self.distance <= 0.0 {
            // It has been inside before, and must not end deeper than there and a hundredth of h.
            return body.signed_distance(to, step.dt).value >= self.distance - 1e-2 * h;
        }
        let kept = KEPT * self.distance.clamp(0.0, h);
        let displacement = (to - from).norm() + displacement_of(body, from, step.dt);
        if self.distance - displacement * body.shape().lipschitz() > kept {
            return true;
        }
        let path = VertexPath::straight(from, to, step.dt);
        first_contact(body, &path, 0.0, step.dt, kept).is_none()
    }
}

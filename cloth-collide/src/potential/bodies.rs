//! Vertices before bodies, as constraints whose distance is evaluated in every sweep.

use super::constraints::{KEPT, LEAST, SLACK};
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

    fn body(&self, constraint: &BodyConstraint) -> &'a Obstacle {
        &self.bodies[constraint.body as usize].0
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
#[derive(Debug, Default)]
pub(super) struct Bodies {
    constraints: Vec<BodyConstraint>,
    /// Of each body and each vertex: a lower bound of its distance (m) where it was at `places` (m), with the body
    /// where it is at the start of the substep.
    bounds: Vec<Real>,
    places: Vec<Vec3>,
    /// Tangential displacement there (m).
    tangential_displacements: Vec<Vec3>,
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
        self.constraints.len()
    }

    /// Forgets all that is known of distances and friction.
    pub(super) fn forget(&mut self, vertices: usize, bodies: usize) {
        self.constraints.clear();
        let count = vertices * bodies;
        self.bounds.clear();
        self.bounds.resize(count, Real::NEG_INFINITY);
        self.places.clear();
        self.places.resize(count, Vec3::zeros());
        self.tangential_displacements.clear();
        self.tangential_displacements.resize(count, Vec3::zeros());
        self.has_constraint.clear();
        self.has_constraint.resize(count, false);
    }

    /// Begins a substep: constraints for the vertices that can touch a body on their path to `to` (m).
    pub(super) fn begin(&mut self, substep: &Substep<'_>, to: &[Vec3]) {
        self.constraints.clear();
        self.has_constraint.fill(false);
        let reach = substep.near.law.range() * (1.0 + SLACK);
        self.each_near(substep, to, reach, |list, index, constraint| {
            constraint.set_law(substep);
            constraint.state.origin -= list.tangential_displacements[index];
            list.has_constraint[index] = true;
            list.constraints.push(*constraint);
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
                if near.pinched.passes(vertex, number) {
                    continue;
                }
                let at = body.signed_distance(*from, 0.0);
                (self.bounds[index], self.places[index]) = (at.value, *from);
                if at.value - lipschitz * ((to - from).norm() + of_body) >= reach {
                    self.tangential_displacements[index] = Vec3::zeros();
                    continue;
                }
                let motion = body.motion();
                let local = motion.pose.to_local(*from);
                let mut constraint = BodyConstraint {
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
                constraint.state.origin = motion.pose_at(step.dt).to_world(local);
                visit(self, index, &mut constraint);
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
                if *w > 0.0 {
                    let bound = self.bounds[first + vertex] - h * (1.0 + SLACK);
                    let displacement = (x - self.places[first + vertex]).norm();
                    least = least.min(bound / body.shape().lipschitz() - displacement);
                }
            }
        }
        Some(least)
    }

    /// Projects each vertex out of the bodies, where they are at the end of the substep.
    pub(super) fn sweep(&mut self, substep: &Substep<'_>, x: &mut [Vec3]) {
        for constraint in &mut self.constraints {
            let v = constraint.vertex as usize;
            let at = substep
                .body(constraint)
                .signed_distance(x[v], substep.step.dt);
            let (inverse_effective_mass, before) =
                (substep.step.inverse_mass[v], constraint.state.lambda);
            if let Some(push) = constraint.state.project(&at, x[v], inverse_effective_mass) {
                constraint.normal = at.normal;
                constraint.pressure += at.gradient() * (constraint.state.lambda - before);
                x[v] += push * inverse_effective_mass;
            }
        }
    }

    /// How many vertices come too near on their path to `x` (m); those get constraints.
    pub(super) fn violations(&mut self, substep: &Substep<'_>, x: &[Vec3]) -> u32 {
        let reach = KEPT * substep.near.law.range();
        self.each_near(substep, x, reach, |list, index, constraint| {
            if !constraint.is_safe(substep, x) {
                constraint.set_law(substep);
                list.has_constraint[index] = true;
                list.constraints.push(*constraint);
            }
        });
        let mut count = 0;
        for constraint in &mut self.constraints {
            constraint.is_violated = !constraint.is_safe(substep, x);
            count += u32::from(constraint.is_violated);
        }
        count
    }

    /// The vertices that have come too near.
    pub(super) fn violated(&self) -> impl Iterator<Item = u32> + '_ {
        let constraints = self
            .constraints
            .iter()
            .filter(|constraint| constraint.is_violated);
        constraints.map(|constraint| constraint.vertex)
    }

    /// Constraints of those, on the way to `x` (m), give in no more.
    pub(super) fn harden(&mut self, substep: &Substep<'_>, x: &[Vec3]) {
        for constraint in self
            .constraints
            .iter_mut()
            .filter(|constraint| constraint.is_violated)
        {
            let at = substep
                .body(constraint)
                .signed_distance(x[constraint.vertex as usize], substep.step.dt);
            constraint
                .state
                .harden(constraint.distance, LEAST * constraint.thickness, at.value);
        }
    }

    /// What is inside comes out in this substep, not in as many as its law would take.
    pub(super) fn lead_out(&mut self) {
        for constraint in self
            .constraints
            .iter_mut()
            .filter(|constraint| constraint.distance <= 0.0)
        {
            (constraint.state.compliance, constraint.state.range) =
                (0.0, LEAST * constraint.thickness);
        }
    }

    /// The substep ends at `x` (m), the bodies still being where they are at its start. Friction gives in by `reach`
    /// (m). Returns the work (J) that they did.
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
        for constraint in &self.constraints {
            let v = constraint.vertex as usize;
            let index = constraint.body as usize * step.from.len() + v;
            self.tangential_displacements[index] =
                constraint
                    .state
                    .tangential_displacement(x[v], constraint.normal, reach);
            let impulse =
                (constraint.normal * constraint.state.lambda + constraint.state.friction) / step.dt;
            work += impulse.dot(&substep.body(constraint).motion().velocity_at(x[v], step.dt));
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
        let touching = self
            .constraints
            .iter()
            .filter(|constraint| constraint.state.lambda > 0.0);
        for constraint in touching.filter(|constraint| constraint.approach.abs() > least) {
            let v = constraint.vertex as usize;
            out.push(Rebound {
                vertices: [constraint.vertex; 4],
                weights: ALONE,
                normal: constraint.normal,
                inverse_mass: [step.inverse_mass[v]; 4],
                inverse_effective_mass: step.inverse_mass[v],
                approach: constraint.approach / step.dt,
                of_body: -constraint
                    .normal
                    .dot(&substep.body(constraint).motion().velocity_at(x[v], step.dt)),
            });
        }
    }

    /// Hands `visit` the vertices that touch body `number`, and the impulses (N·s) on them in a substep of `dt` (s).
    pub(super) fn each_impulse(&self, number: usize, dt: Real, mut visit: impl FnMut(usize, Vec3)) {
        for constraint in self
            .constraints
            .iter()
            .filter(|constraint| constraint.body as usize == number)
        {
            let impulse = (constraint.pressure + constraint.state.friction) / dt;
            visit(constraint.vertex as usize, impulse);
        }
    }

    /// Enters the impulses of a substep that ends at `x` (m), the bodies still being where they are at its start.
    pub(super) fn record(&self, substep: &Substep<'_>, x: &[Vec3], ledger: &mut Ledger) {
        let dt = substep.step.dt;
        for constraint in &self.constraints {
            let (v, number) = (constraint.vertex as usize, constraint.body as usize);
            let arm = x[v] - substep.body(constraint).motion().pose_at(dt).position;
            let impulses = [constraint.pressure, constraint.state.friction].map(|push| push / dt);
            ledger.add_obstacle([v, number], impulses, arm);
        }
    }

    /// Energy (J) that is stored at `x` (m).
    pub(super) fn energy(&self, bodies: &[Body], near: &Near, x: &[Vec3]) -> Real {
        let energy = |constraint: &BodyConstraint| {
            let v = constraint.vertex as usize;
            let at = bodies[constraint.body as usize]
                .0
                .signed_distance(x[v], 0.0);
            near.vertex_area[v] * near.law_at(v).energy(at.value)
        };
        let pushing = self
            .constraints
            .iter()
            .filter(|constraint| constraint.state.lambda > 0.0);
        pushing.map(energy).sum()
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
            // It has been inside before, and must not get deeper.
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

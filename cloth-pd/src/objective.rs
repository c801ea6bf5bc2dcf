//! The function that a step minimises, and a point with its value and gradient.
//!
//! *Why an iteration lowers `G`.* Hold the p of the iterate x: `Q(y) = ‖y − x̃‖²_M/(2Δt²) + Σ ½ w ‖S y − p‖²`. Every p
//! is in its set and E takes the nearest, so Q ≥ `G`; Q(x) = `G(x)`, ∇Q(x) = `∇G(x)` = g, and the Hessian of Q is A.
//! The minimum x⁺ of Q solves `A (x⁺ − x) = −g`, and
//!
//! `G(x⁺) ≤ Q(x⁺) = G(x) − ½ gᵀ A⁻¹ g`.
//!
//! The last is Q at its minimum, a quadratic function with the Hessian A and the gradient g at x. That is descent
//! without a line search, from any x. As `G ≥ 0`, the numbers gᵀA⁻¹g add up to at most 2 `G(x⁰)`: they tend to 0, and
//! the least of n is at most 2 `G(x⁰)`/n. Near a minimum the rate is linear, by the largest eigenvalue of I − A⁻¹ ∇²G.
//! What breaks the bound, and what stands in for it:
//!
//! | | why | instead |
//! |---|---|---|
//! | bending left out of A (quasi-Newton) | A is not the Hessian of Q | line search, as far as it goes (below) |
//! | drag of the air (quasi-Newton) | A lacks D/Δt | line search, as far as it goes |
//! | pairs, coarse grid | the direction is not −A⁻¹g | line search |
//! | extrapolation (Chebyshev) | x⁺ is not the minimum of Q | `G` is compared |
//! | contact, friction | no squared distance, stiffness unbounded | another matrix (`hessian.rs`), line search |
//! | p not the nearest point, or w that depends on x | Q ≥ `G` or ∇Q = ∇G fails | none: the element is wrong |
//! | another energy, such as neo-Hookean | its Hessian may exceed A | not taken |
//! | rounding of `G` | two values agree to 10⁻¹² of their size | the slope decides (`quasi_newton.rs`) |
//!
//! *What `G(x[1]) ≤ G(x[0])` says of energy.* With `x[1] = x[0] + Δt v[1]` and weight alone for f_ext = M a,
//! `G(x[1]) = ½ ‖v[1] − v[0] − Δt a‖²_M + E(x[1])` and `G(x[0]) = ½ ‖v[0] + Δt a‖²_M + E(x[0])`. The squares have the
//! terms `−Δt (v[1] − v[0])ᵀM a` and `Δt v[0]ᵀM a`, and ½ Δt² aᵀM a in both; so what is left of the inequality is
//! `½ ‖v[1] − v[0]‖²_M − (x[1] − x[0])ᵀM a + E(x[1]) ≤ ½ ‖v[0]‖²_M + E(x[0])`, and `−xᵀM a` is the energy of gravity:
//! `W(x[1]) + ½ ‖v[1] − v[0]‖²_M ≤ W(x[0]) + ½ ‖v[0]‖²_M`. Where E is convex `G` has a Hessian of at least M/Δt², so
//! from its minimum `x[1]` it rises by `‖x[0] − x[1]‖²_M/(2Δt²) = ½ ‖v[1]‖²_M` at least to `x[0]`: that stands on the
//! left too.
//!
//! *The damping of implicit Euler.* Its step of ẍ = −ω² x has `x₀ = x₁ − Δt v₁` and `v₀ = v₁ + Δt ω² x₁`. Squared, the
//! first times ω², and added, the products ∓2 Δt ω² x₁ v₁ cancel: `ω² x₀² + v₀² = (1 + (ω Δt)²) (ω² x₁² + v₁²)`. So the
//! energy ½ (ω² x² + v²) is divided by 1 + (ω Δt)² in every step, whatever the phase.
//!
//! *Damping in `G`.* Let D be symmetric and constant in the step, and `y = v[1] − v₀` with `v[1] = q/Δt`. The force
//! −D y is minus the gradient of `½ Δt yᵀD y` by q, which adds D/Δt to the Hessian. The drag of the air is such a term.
//! Rayleigh damping is not offered. It would have v₀ = 0, and:
//!
//! | D | in A | but |
//! |---|---|---|
//! | α M | α M/Δt, constant | a free vertex gets `(v[0] + Δt a)/(1 + α Δt)`: scaling velocities is nearly the same |
//! | β Σ w SᵀS | β Σ w SᵀS/Δt, constant | resists turning as it resists stretch: folding and swinging are damped away |
//! | β Σ w Sᵀ n nᵀ S, n = z/‖z‖ at `x[0]` | changes with it | a factorisation in every step, three times as many rows |
//!
//! (First row: `m (q − u)/Δt² + α m q/Δt = 0` has q = u/(1 + α Δt).) The third resists the rate of strain of springs,
//! and nothing else; Newton's method, whose matrix is new in any case, takes it (`cloth-massspring`).
//!
//! A line search tries twelve lengths. Along −A⁻¹g with bending left out of A, or in air, the last of them is taken
//! even if `G` rose (`quasi_newton.rs`).
//!
//! All numbers are double precision, but those of the multigrid cycles (of the coarse grid, and of `hessian.rs`), which
//! are single and only precondition. The rounding of a solve changes a direction and nothing else: g is computed anew
//! from x in every iteration, so errors of solves do not add up. In single precision two values of `G` could not be
//! told apart below some 10⁻⁷ of their size.

use crate::components::{FreeComponents, Momentum};
use crate::contact::Contact;
use crate::local::Projections;
use crate::quadratic::{Padded, Quadratic};
use cloth_core::energy::Attachment;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::chunked::map_reduce;
use cloth_core::method::pieces::Pieces;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput};
use sprs::CsMat;
use std::ops::AddAssign;

/// `G(x) = ‖x − x̃‖²_M/(2Δt²) + E(x)` of one step, E with contact and the drag of the air where they are felt, in terms
/// of the displacement `q = x − x[0]`.
///
/// With `u = x̃ − x[0] = Δt v + Δt² a` the inertia is `m q·(q − 2u)/(2Δt²)` and a constant, and its gradient
/// `m (q − u)/Δt²`. Neither subtracts positions: free fall loses no digits, and neither does a step so long that x̃ is
/// out of all proportion.
#[derive(Debug)]
pub(crate) struct Objective {
    pub(crate) particles: Particles,
    pub(crate) families: Vec<Box<dyn Projections>>,
    /// All families whose projection is constant, as one matrix.
    quadratic: Quadratic,
    /// Attachments that came after the solver was built; without stiffness where one has gone.
    pub(crate) attachments: Vec<Attachment>,
    /// How many attachments have been taken away from each of these places.
    pub(crate) attachment_numbers: Vec<u32>,
    /// What is measured piece by piece.
    pub(crate) pieces: Pieces,
    /// x[0] (m).
    from: Vec<Vec3>,
    /// u (m).
    pub(crate) inertial: Vec<Vec3>,
    /// `Σ w Sᵀ(S x[0] − p)` (N) over the families of constant projection.
    constant_gradient: Vec<Vec3>,
    /// D (kg/s) of the air at each vertex, and its velocity (m/s) before the step; empty without.
    pub(crate) drag: Vec<(Mat3, Vec3)>,
    /// Δt (s).
    dt: Real,
    /// q (m) of the point that is evaluated, with a fourth number.
    padded: Vec<Padded>,
}

/// A displacement, and what is known there.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// q (m); u at prescribed vertices.
    pub(crate) displacement: Vec<Vec3>,
    /// x (m).
    pub(crate) positions: Vec<Vec3>,
    /// `∂G/∂x` (N), zero at prescribed vertices.
    pub(crate) gradient: Vec<Vec3>,
    /// `G` (J), up to a constant of the step.
    pub(crate) value: Real,
    /// Sum of the sizes of its parts (J): `value` is rounded to this times the precision of a number.
    pub(crate) size: Real,
    /// Whether all but the displacement belong to it.
    pub(crate) is_evaluated: bool,
}

impl Point {
    pub(crate) fn new(vertex_count: usize) -> Self {
        let zeros = vec![Vec3::zeros(); vertex_count];
        Self {
            displacement: zeros.clone(),
            positions: zeros.clone(),
            gradient: zeros,
            value: 0.0,
            size: 0.0,
            is_evaluated: false,
        }
    }

    /// Moves to `from + length · direction`.
    pub(crate) fn move_to(&mut self, from: &[Vec3], direction: &[Vec3], length: Real) {
        map_reduce(
            (&mut self.displacement[..], (from, direction)),
            #[inline(always)]
            |_, (q, (from, direction))| {
                let (q, from, direction): (&mut [Vec3], &[Vec3], &[Vec3]) = (q, from, direction);
                for ((q, from), d) in q.iter_mut().zip(from).zip(direction) {
                    *q = from + d * length;
                }
                []
            },
        );
        self.is_evaluated = false;
    }
}

impl Objective {
    pub(crate) fn new(particles: Particles, families: Vec<Box<dyn Projections>>) -> Self {
        let zeros = vec![Vec3::zeros(); particles.len()];
        let padded = vec![[0.0; 4]; particles.len()];
        Self {
            quadratic: Quadratic::of(particles.len(), &families),
            attachments: Vec::new(),
            attachment_numbers: Vec::new(),
            pieces: Pieces::default(),
            particles,
            families,
            from: zeros.clone(),
            inertial: zeros.clone(),
            constant_gradient: zeros,
            drag: Vec::new(),
            dt: 1.0,
            padded,
        }
    }

    /// Sums the quadratic families anew, after elements were removed.
    pub(crate) fn refresh(&mut self) {
        self.quadratic = Quadratic::of(self.particles.len(), &self.families);
    }

    /// The unconstrained components of the cloth; `stiffness` is the lower half of `Σ w SᵀS` (N/m), with or without
    /// the families of constant projection.
    pub(crate) fn free_components(&self, stiffness: &CsMat<Real>) -> FreeComponents {
        let kept = stiffness.iter().map(|(&value, (i, j))| (i, j, value));
        let entries: Vec<_> = kept.chain(self.quadratic.lower_half()).collect();
        FreeComponents::of(&entries, &self.particles)
    }

    /// Takes up the step that begins at `state`, with the drag of the air in `G` or without.
    pub(crate) fn begin(
        &mut self,
        state: &State,
        input: &StepInput<'_>,
        is_air_implicit: bool,
    ) -> Result<(), StepError> {
        self.dt = input.dt;
        self.from.copy_from_slice(&state.positions);
        self.drag.clear();
        if let Some(air) = input.air.as_ref().filter(|_| is_air_implicit) {
            let both = air.drag().iter().zip(air.velocities());
            self.drag.extend(both.map(|(drag, v)| (*drag, *v)));
        }
        for (vertex, u) in self.inertial.iter_mut().enumerate() {
            let a = input.external_acceleration(vertex, self.particles.inverse_mass()[vertex]);
            *u = (state.velocities[vertex] + a * input.dt) * input.dt;
            if !cloth_core::math::is_finite(u) {
                let step = state.steps + 1;
                return Err(StepError::NonFinite { vertex, step });
            }
        }
        self.constant_gradient.fill(Vec3::zeros());
        for family in &mut self.families {
            family.set_time(state.time + input.dt);
            family.add_constant_gradient(&self.from, &mut self.constant_gradient);
        }
        Ok(())
    }

    /// Whether the drag of the air is in `G`.
    pub(crate) fn is_dragged(&self) -> bool {
        !self.drag.is_empty()
    }

    /// What the momentum of the cloth comes to if nothing stops it.
    pub(crate) fn momentum(&self) -> Momentum<'_> {
        Momentum {
            inertial: &self.inertial,
            drag: &self.drag,
            dt: self.dt,
        }
    }

    /// Δt (s) of the step.
    pub(crate) fn dt(&self) -> Real {
        self.dt
    }

    /// Whether a prescribed vertex moves in the step.
    pub(crate) fn is_driven(&self) -> bool {
        let displacements = self.inertial.iter().enumerate();
        let mut prescribed = displacements.filter(|(v, _)| self.particles.is_prescribed(*v));
        prescribed.any(|(_, u)| *u != Vec3::zeros())
    }

    /// Fills in the positions that belong to the displacement of `point`.
    pub(crate) fn write_positions(&self, point: &mut Point) {
        let moved = self.from.iter().zip(&point.displacement);
        for (x, (from, q)) in point.positions.iter_mut().zip(moved) {
            *x = from + q;
        }
    }

    /// Fills in everything that belongs to the displacement of `point`.
    pub(crate) fn evaluate(&mut self, point: &mut Point, contact: &Contact<'_>) {
        self.spread(point);
        let Point {
            positions,
            gradient,
            ..
        } = point;
        let own = |family: &mut Box<dyn Projections>| family.add_gradient(positions, gradient);
        let mut elastic: Real = self.families.iter_mut().map(own).sum();
        for attachment in &self.attachments {
            let vertex = attachment.vertex as usize;
            let offset = positions[vertex] - attachment.target;
            gradient[vertex] += offset * attachment.stiffness;
            elastic += 0.5 * attachment.stiffness * offset.norm_squared();
        }
        for (vertex, (drag, before)) in self.drag.iter().enumerate() {
            if !self.particles.is_prescribed(vertex) {
                let change = point.displacement[vertex] / self.dt - before;
                let force = drag * change;
                gradient[vertex] += force;
                elastic += 0.5 * self.dt * force.dot(&change);
            }
        }
        if let Some(contact) = contact {
            elastic += contact.add_gradient(positions, gradient);
        }
        let [inertia, bending] = self.collect(point);
        point.value = inertia + bending + elastic;
        point.size = inertia.abs() + bending.abs() + elastic;
        point.is_evaluated = true;
    }

    /// The entries of the lower half of `Σ w SᵀS` (N/m) over the families of constant projection: row, column, value.
    pub(crate) fn quadratic_entries(&self) -> impl Iterator<Item = (usize, usize, Real)> {
        self.quadratic.lower_half()
    }

    /// Writes down x, q with a fourth number, and no gradient yet.
    fn spread(&mut self, point: &mut Point) {
        let (from, q) = (&self.from[..], &point.displacement[..]);
        let moved = (&mut point.positions[..], &mut self.padded[..]);
        map_reduce(
            (moved, &mut point.gradient[..]),
            #[inline(always)]
            |start, ((x, padded), gradient)| {
                let x: &mut [Vec3] = x;
                let padded: &mut [Padded] = padded;
                let gradient: &mut [Vec3] = gradient;
                let range = start..start + x.len();
                for ((x, from), q) in x
                    .iter_mut()
                    .zip(&from[range.clone()])
                    .zip(&q[range.clone()])
                {
                    *x = from + q;
                }
                for (padded, q) in padded.iter_mut().zip(&q[range]) {
                    *padded = [q.x, q.y, q.z, 0.0];
                }
                gradient.fill(Vec3::zeros());
                []
            },
        );
    }

    /// Adds inertia and the quadratic energies to the gradient of the other elements. Returns the energies of the two
    /// (J).
    fn collect(&self, point: &mut Point) -> [Real; 2] {
        let q = &point.displacement[..];
        let (constant, inertial) = (&self.constant_gradient[..], &self.inertial[..]);
        let (mass, inverse_mass) = (self.particles.mass(), self.particles.inverse_mass());
        let (quadratic, padded) = (&self.quadratic, &self.padded[..]);
        let per_dt_squared = 1.0 / self.dt / self.dt;
        map_reduce(
            &mut point.gradient[..],
            #[inline(always)]
            |start, gradient: &mut [Vec3]| {
                // Sums of whole registers; the fourth number of each is zero.
                let (mut inertia, mut bending) = (0.0, [0.0; 4]);
                for (vertex, gradient) in (start..).zip(gradient) {
                    let own = q[vertex];
                    let mut force = constant[vertex];
                    if !quadratic.is_empty() {
                        let product = quadratic.times(vertex, padded);
                        let constant = [force.x, force.y, force.z, 0.0];
                        for lane in 0..4 {
                            bending[lane] +=
                                (0.5 * product[lane] + constant[lane]) * padded[vertex][lane];
                        }
                        force += Vec3::new(product[0], product[1], product[2]);
                    }
                    // Nothing moves a prescribed vertex.
                    if inverse_mass[vertex] == 0.0 {
                        *gradient = Vec3::zeros();
                        continue;
                    }
                    let mass = mass[vertex] * per_dt_squared;
                    let u = inertial[vertex];
                    inertia += 0.5 * mass * own.dot(&(own - u * 2.0));
                    *gradient += (own - u) * mass + force;
                }
                [inertia, bending.iter().sum()]
            },
        )
    }

    /// Writes `∂E/∂x` (N) without contact to `out`, at all vertices, prescribed ones too. `point` has to be the one
    /// that was evaluated last.
    pub(crate) fn write_forces(&mut self, point: &Point, out: &mut [Vec3]) {
        for (vertex, out) in out.iter_mut().enumerate() {
            *out = self.constant_gradient[vertex];
            if !self.quadratic.is_empty() {
                let [x, y, z, _] = self.quadratic.times(vertex, &self.padded);
                *out += Vec3::new(x, y, z);
            }
        }
        for family in &mut self.families {
            family.add_gradient(&point.positions, out);
        }
    }

    /// Norm of a gradient in the metric of M⁻¹ (N/√kg); prescribed vertices do not count.
    pub(crate) fn norm(&self, gradient: &[Vec3]) -> Real {
        let squares = self.particles.inverse_mass().iter().zip(gradient);
        let squares = squares.map(|(w, g)| w * g.norm_squared());
        squares.sum::<Real>().sqrt()
    }

    /// Writes to `out` the squares of velocities of each piece at the point.
    pub(crate) fn find_squares(&self, point: &Point, out: &mut Vec<Squares>) {
        let (mass, inverse_mass) = (self.particles.mass(), self.particles.inverse_mass());
        let dt_squared = self.dt * self.dt;
        let per_time = 1.0 / dt_squared;
        self.pieces.sum(out, |v| {
            let (displacement, w) = (point.displacement[v], inverse_mass[v]);
            let mass = if w == 0.0 { 0.0 } else { mass[v] * per_time };
            Squares {
                forced: mass * (displacement - self.inertial[v]).norm_squared(),
                speed: mass * displacement.norm_squared(),
                way: mass * point.positions[v].norm_squared(),
                left: w * point.gradient[v].norm_squared() * dt_squared,
            }
        });
    }
}

/// Squares of velocities of a piece (J), in the norm of M over its free vertices.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Squares {
    /// `‖x − x̃‖²_M/Δt²`: the change of velocity by elastic and contact forces.
    pub(crate) forced: Real,
    /// `‖x − x[0]‖²_M/Δt²`: the velocity with which the step would end at the point.
    pub(crate) speed: Real,
    /// `‖x‖²_M/Δt²`: what a rounding error of positions makes of velocities, over the relative error.
    pub(crate) way: Real,
    /// `Δt² ‖∇G‖²` in the norm of M⁻¹: the change of velocity by the forces that are left.
    pub(crate) left: Real,
}

impl AddAssign for Squares {
    fn add_assign(&mut self, other: Self) {
        self.forced += other.forced;
        self.speed += other.speed;
        self.way += other.way;
        self.left += other.left;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::Family;
    use crate::matrix::assemble;
    use cloth_core::cloth::{Cloth, Membrane};
    use cloth_core::mesh::generate::{Diagonals, grid};

    /// A cut through all springs leaves the halves coupled by hinges, which the matrix may lack.
    #[test]
    fn hinges_alone_connect_a_component_to_its_pin() {
        let mesh = grid(6, 3, 5.0, 2.0, Diagonals::Alternating).unwrap();
        let cloth = Cloth {
            areal_density: 0.2,
            membrane: Membrane::SpringStiffness(10.0),
            bending_rigidity: 1e-3,
        };
        let mut model = cloth.on(&mesh).unwrap();
        model.particles.prescribe(0).unwrap();
        let is_left = |vertex: u32| mesh.positions()[vertex as usize].x < 2.5;
        let mut springs = model.springs;
        springs.retain(|spring| is_left(spring.vertices[0]) == is_left(spring.vertices[1]));
        let springs: Box<dyn Projections> =
            Box::new(Family::new(springs, &model.particles).unwrap());
        let hinges: Box<dyn Projections> =
            Box::new(Family::new(model.hinges, &model.particles).unwrap());
        let matrix = assemble(18, [&springs].into_iter());

        let cut = Objective::new(model.particles.clone(), vec![springs]);
        assert!(!cut.free_components(&matrix).is_empty());
        let Objective { mut families, .. } = cut;
        families.push(hinges);
        let coupled = Objective::new(model.particles, families);
        assert!(coupled.free_components(&matrix).is_empty());
    }
}

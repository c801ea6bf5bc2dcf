//! The function that a step minimises, and a point with its value and gradient.

use crate::local::Projections;
use crate::pieces::together;
use crate::quadratic::Quadratic;
use cloth_core::energy::Attachment;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput};

/// `G(x) = ‖x − x̃‖²_M/(2Δt²) + E(x)` of one step, in terms of the displacement `q = x − x[0]`.
///
/// With `h = x̃ − x[0] = Δt v + Δt² a` the inertia is `m q·(q − 2h)/(2Δt²)` and a constant, and its gradient `m (q − h)/Δt²`. Neither
/// subtracts positions: free fall loses no digits, and neither does a step so long that x̃ is out of all proportion.
#[derive(Debug)]
pub(crate) struct Objective {
    pub(crate) particles: Particles,
    pub(crate) families: Vec<Box<dyn Projections>>,
    /// All families whose projection is constant, as one matrix.
    quadratic: Quadratic,
    /// Attachments that came after the solver was built; without stiffness where one has gone.
    pub(crate) attachments: Vec<Attachment>,
    /// x[0] (m).
    from: Vec<Vec3>,
    /// h (m).
    pub(crate) inertial: Vec<Vec3>,
    /// `Σ w Gᵀ(G x[0] − p)` (N) over the families of constant projection.
    constant_gradient: Vec<Vec3>,
    /// Δt (s).
    dt: Real,
}

/// A displacement, and what is known there.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// q (m); h at prescribed vertices.
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
    pub(crate) fn go(&mut self, from: &[Vec3], direction: &[Vec3], length: Real) {
        for ((q, from), p) in self.displacement.iter_mut().zip(from).zip(direction) {
            *q = from + p * length;
        }
        self.is_evaluated = false;
    }
}

impl Objective {
    pub(crate) fn new(particles: Particles, families: Vec<Box<dyn Projections>>) -> Self {
        let zeros = vec![Vec3::zeros(); particles.len()];
        Self {
            quadratic: Quadratic::of(particles.len(), &families),
            attachments: Vec::new(),
            particles,
            families,
            from: zeros.clone(),
            inertial: zeros.clone(),
            constant_gradient: zeros,
            dt: 1.0,
        }
    }

    /// Takes notice of elements that are gone.
    pub(crate) fn refresh(&mut self) {
        self.quadratic = Quadratic::of(self.particles.len(), &self.families);
    }

    /// Takes up the step that begins at `state`.
    pub(crate) fn begin(&mut self, state: &State, input: &StepInput<'_>) -> Result<(), StepError> {
        self.dt = input.dt;
        self.from.copy_from_slice(&state.positions);
        for (vertex, h) in self.inertial.iter_mut().enumerate() {
            let a = input.external_acceleration(vertex, self.particles.inverse_mass()[vertex]);
            *h = (state.velocities[vertex] + a * input.dt) * input.dt;
            if !cloth_core::math::is_finite(h) {
                let step = state.steps + 1;
                return Err(StepError::NonFinite { vertex, step });
            }
        }
        self.constant_gradient.fill(Vec3::zeros());
        for family in &mut self.families {
            family.add_constant_gradient(&self.from, &mut self.constant_gradient);
        }
        Ok(())
    }

    /// Δt (s) of the step.
    pub(crate) fn dt(&self) -> Real {
        self.dt
    }

    /// Fills in the positions that belong to the displacement of `point`.
    pub(crate) fn place(&self, point: &mut Point) {
        let moved = self.from.iter().zip(&point.displacement);
        for (x, (from, q)) in point.positions.iter_mut().zip(moved) {
            *x = from + q;
        }
    }

    /// Fills in everything that belongs to the displacement of `point`.
    pub(crate) fn evaluate(&mut self, point: &mut Point) {
        self.place(point);
        let q = &point.displacement;
        let gradient = &mut point.gradient;
        gradient.fill(Vec3::zeros());
        let (families, quadratic) = (&mut self.families, &mut self.quadratic);
        let positions = &point.positions;
        let mut own = |family: &mut Box<dyn Projections>| family.add_gradient(positions, gradient);
        let (mut elastic, product) = together(
            q.len(),
            || families.iter_mut().map(&mut own).sum::<Real>(),
            || quadratic.times(q),
        );
        for attachment in &self.attachments {
            let vertex = attachment.vertex as usize;
            let pull = point.positions[vertex] - attachment.target;
            gradient[vertex] += pull * attachment.stiffness;
            elastic += 0.5 * attachment.stiffness * pull.norm_squared();
        }
        let (mut inertia, mut bending) = (0.0, 0.0);
        let per_dt_squared = 1.0 / self.dt / self.dt;
        for vertex in 0..q.len() {
            let (own, constant) = (q[vertex], self.constant_gradient[vertex]);
            let pull = Vec3::new(product[vertex][0], product[vertex][1], product[vertex][2]);
            bending += (pull * 0.5 + constant).dot(&own);
            if self.particles.is_prescribed(vertex) {
                gradient[vertex] = Vec3::zeros();
                continue;
            }
            let mass = self.particles.mass()[vertex] * per_dt_squared;
            let h = self.inertial[vertex];
            inertia += 0.5 * mass * own.dot(&(own - h * 2.0));
            gradient[vertex] += (own - h) * mass + (pull + constant);
        }
        point.value = inertia + bending + elastic;
        point.size = inertia.abs() + bending.abs() + elastic;
        point.is_evaluated = true;
    }

    /// Norm of a gradient in the metric of M⁻¹ (N/√kg); prescribed vertices do not count.
    pub(crate) fn norm(&self, gradient: &[Vec3]) -> Real {
        let squares = self.particles.inverse_mass().iter().zip(gradient);
        let squares = squares.map(|(w, g)| w * g.norm_squared());
        squares.sum::<Real>().sqrt()
    }
}

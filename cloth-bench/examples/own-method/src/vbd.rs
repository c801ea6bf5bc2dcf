//! Vertex block descent: implicit Euler by Gauss–Seidel over vertices.
//!
//! A. H. Chen, Z. Liu, Y. Yang and C. Yuksel, "Vertex block descent", ACM Transactions on Graphics 43(4), 2024,
//! <https://doi.org/10.1145/3658179>. Equations below are numbered as there.
//!
//! # The method
//!
//! A step of implicit Euler ends at the minimum of the incremental potential (1)
//!
//! `G(x) = ‖x − y‖²_M/(2Δt²) + E(x)`, with `y = xₜ + Δt vₜ + Δt² a` where the cloth would be without elasticity.
//!
//! Newton's method moves all vertices at once and has a large system to solve. Here one vertex moves at a time, the
//! others stay, and the system is 3 × 3: `Hᵢ Δxᵢ = fᵢ` (8), with
//!
//! | equation | code |
//! |---|---|
//! | `fᵢ = −mᵢ/Δt² (xᵢ − yᵢ) − Σⱼ ∂Eⱼ/∂xᵢ` (9) | [`Energies::add_at_vertices`], the gradient |
//! | `Hᵢ = mᵢ/Δt² I + Σⱼ ∂²Eⱼ/∂xᵢ²` (10) | the same, the Hessian |
//! | vertices of one colour share no element | [`Energies::vertex_colors`] |
//! | start between xₜ + Δt vₜ and y (section 3.7) | `VertexBlockDescent::start` |
//! | `x⁽ᵏ⁺¹⁾ ← ω (x⁽ᵏ⁺¹⁾ − x⁽ᵏ⁻¹⁾) + x⁽ᵏ⁻¹⁾` (18), `ω ← 4/(4 − ρ²ω)` (19) | `VertexBlockDescent::accelerate` |
//!
//! Elements are projected to positive semi-definite Hessians, so Hᵢ is positive definite and Δxᵢ goes down; the paper
//! keeps the indefinite ones, and skips a vertex where Hᵢ is nearly singular.
//!
//! # Contact
//!
//! The contact potential is one more term of G. It is linearised at the start of an iteration, `g + K (x − x₀)` with
//! rows `K = Σ k J Jᵀ`, and a vertex that moves sees in it where all others are now ([`crate::contact`]). Two vertices
//! of one colour may touch each other, therefore those with contacts move one after another. After an iteration the
//! displacements are truncated vertex by vertex until they are free of crossings, and halved while G is higher than
//! before: two vertices that each take most of the gap between them press much harder than either saw.
//!
//! # Limits
//!
//! - In one iteration a vertex hears of its neighbours, and through the colours of a few beyond: stiff or fine cloth
//!   needs many iterations, or a small Δt, for which `m/Δt²` outweighs the stiffness. Cut short, cloth is too soft.
//! - Cut short, momentum is not conserved either: what one vertex takes up its neighbour has not given.
//! - In hard contact a start that the cloth is truncated to may lie so near something that a hundred iterations leave
//!   more energy than the step had: a sheet of 33 × 33 vertices on a sphere holds twice what gravity has given, once.
//! - Damping (section 3.5) is not here: what the method loses is implicit Euler's.

use crate::contact::LinearizedContact;
use cloth_core::contact::{ContactError, ContactPotential, ContactStep, GlobalRows};
use cloth_core::element::Convexity;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::family::{Energies, Incidence};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};

/// Times that an iterate is brought half-way back at most.
const HALVINGS: u32 = 8;
/// Part of G that is rounding of its sums.
const ROUNDING: Real = 1e-12;

/// The method, for one cloth.
pub struct VertexBlockDescent {
    mass: Vec<Real>,
    inverse_mass: Vec<Real>,
    energies: Energies,
    incidence: Incidence,
    /// Free vertices, by colour.
    colors: Vec<Vec<u32>>,
    iterations: u32,
    /// ρ of the acceleration, 0 for none.
    radius: Real,
    /// y (m).
    inertial: Vec<Vec3>,
    /// The iterate (m), and those of one and two iterations before.
    x: Vec<Vec3>,
    before: Vec<Vec3>,
    earlier: Vec<Vec3>,
    /// −fᵢ (N) and Hᵢ (N/m) of one colour.
    gradient: Vec<Vec3>,
    hessian: Vec<Mat3>,
    velocities: Vec<Vec3>,
    /// Number and start velocities (m/s) of the last step.
    last_step: Option<u64>,
    last_velocities: Vec<Vec3>,
    contact: LinearizedContact,
    fractions: Vec<Real>,
}

impl VertexBlockDescent {
    /// For these masses and this energy, with so many iterations a step, accelerated with a spectral radius ρ in
    /// [0, 1); 0 does without.
    pub fn new(particles: &Particles, energies: Energies, iterations: u32, radius: Real) -> Self {
        let count = particles.len();
        let mut colors = energies.vertex_colors();
        for color in &mut colors {
            color.retain(|&vertex| !particles.is_prescribed(vertex as usize));
        }
        let largest = colors.iter().map(Vec::len).max().unwrap_or(0);
        let zeros = vec![Vec3::zeros(); count];
        Self {
            mass: particles.mass().to_vec(),
            inverse_mass: particles.inverse_mass().to_vec(),
            incidence: energies.incidence(),
            energies,
            colors,
            iterations,
            radius,
            inertial: zeros.clone(),
            x: zeros.clone(),
            before: zeros.clone(),
            earlier: zeros.clone(),
            gradient: vec![Vec3::zeros(); largest],
            hessian: vec![Mat3::zeros(); largest],
            velocities: zeros.clone(),
            last_step: None,
            last_velocities: zeros,
            contact: LinearizedContact::new(count),
            fractions: vec![1.0; count],
        }
    }

    /// y, and where to begin: with as much of the acceleration from outside as the last step had of it, so that
    /// falling cloth begins at y and hanging cloth where it is.
    fn start(&mut self, state: &State, input: &StepInput<'_>) {
        let dt = input.dt;
        let follows = self.last_step == Some(state.steps);
        for v in 0..self.x.len() {
            let outside = input.external_acceleration(v, self.inverse_mass[v]);
            let flight = state.positions[v] + state.velocities[v] * dt;
            self.inertial[v] = flight + outside * (dt * dt);
            let mut fraction = 1.0;
            if follows && outside != Vec3::zeros() {
                let last = (state.velocities[v] - self.last_velocities[v]) / dt;
                fraction = (last.dot(&outside) / outside.norm_squared()).clamp(0.0, 1.0);
            }
            self.x[v] = flight + outside * (fraction * dt * dt);
        }
    }

    /// One iteration: every free vertex to the minimum of its own model, colour by colour.
    fn sweep(&mut self, dt: Real) {
        for vertices in &self.colors {
            let gradient = &mut self.gradient[..vertices.len()];
            let hessian = &mut self.hessian[..vertices.len()];
            for (i, &vertex) in vertices.iter().enumerate() {
                let v = vertex as usize;
                let inertia = self.mass[v] / (dt * dt);
                gradient[i] = (self.x[v] - self.inertial[v]) * inertia;
                hessian[i] = Mat3::from_diagonal_element(inertia);
            }
            self.energies.add_at_vertices(
                &self.incidence,
                vertices,
                &self.x,
                Convexity::Clamp,
                gradient,
                hessian,
            );
            for (i, &vertex) in vertices.iter().enumerate() {
                let (mut gradient, mut hessian) = (gradient[i], hessian[i]);
                self.contact
                    .add(vertex, &self.x, &mut gradient, &mut hessian);
                // Singular only where numbers have overflowed; the step then ends with an error.
                if let Some(inverse) = hessian.try_inverse() {
                    self.x[vertex as usize] -= inverse * gradient;
                }
            }
        }
    }

    /// Extrapolates from the iterate before the last one, where nothing touches.
    fn accelerate(&mut self, omega: Real) {
        for v in 0..self.x.len() {
            if self.inverse_mass[v] > 0.0 && !self.contact.touches(v) {
                self.x[v] = (self.x[v] - self.earlier[v]) * omega + self.earlier[v];
            }
        }
    }

    fn iterate(
        &mut self,
        input: &mut StepInput<'_>,
        contact: &mut Option<&mut dyn ContactPotential>,
    ) -> Result<(), ContactError> {
        let (mut omega, mut least) = (1.0, Real::INFINITY);
        for iteration in 1..=self.iterations {
            if let Some(contact) = contact {
                self.descend(input.dt, *contact, &mut least);
            }
            std::mem::swap(&mut self.earlier, &mut self.before);
            self.before.copy_from_slice(&self.x);
            self.sweep(input.dt);
            if self.radius > 0.0 && iteration > 1 {
                let square = self.radius * self.radius;
                omega = match iteration {
                    2 => 2.0 / (2.0 - square),
                    _ => 4.0 / (4.0 - square * omega),
                };
                self.accelerate(omega);
            }
            if let Some(contact) = contact {
                contact.limit_each(&self.before, &mut self.x, &mut self.fractions)?;
            }
            if let Some(observer) = &mut input.observer {
                observer.iteration(iteration, &self.x);
            }
        }
        if let Some(contact) = contact {
            self.descend(input.dt, *contact, &mut least);
        }
        Ok(())
    }

    /// Linearises contact at the iterate, and goes half-way back to the one before as long as G (J) is above the
    /// `least` so far: a barrier is steeper than what has been linearised farther away.
    fn descend(&mut self, dt: Real, contact: &dyn ContactPotential, least: &mut Real) {
        for _ in 0..HALVINGS {
            self.contact.linearize(contact, &self.x);
            let value = self.value(dt) + self.contact.energy();
            if value <= *least + ROUNDING * least.abs() {
                *least = least.min(value);
                return;
            }
            for (x, before) in self.x.iter_mut().zip(&self.before) {
                *x = 0.5 * (*x + *before);
            }
        }
        self.x.copy_from_slice(&self.before);
        self.contact.linearize(contact, &self.x);
    }

    /// G (J) without contact.
    fn value(&self, dt: Real) -> Real {
        let away = self.x.iter().zip(&self.inertial).zip(&self.mass);
        let inertia: Real = away.map(|((x, y), m)| m * (x - y).norm_squared()).sum();
        0.5 * inertia / (dt * dt) + self.energies.value(&self.x)
    }

    /// Begins contact where the cloth is, and goes towards the start of the iteration as far as is free of crossings.
    fn begin_contact(
        &mut self,
        from: &[Vec3],
        dt: Real,
        contact: &mut dyn ContactPotential,
    ) -> Result<(), ContactError> {
        let feasible = &mut self.before;
        for (v, feasible) in feasible.iter_mut().enumerate() {
            let is_free = self.inverse_mass[v] > 0.0;
            *feasible = if is_free { from[v] } else { self.x[v] };
        }
        let step = ContactStep {
            from,
            inverse_mass: &self.inverse_mass,
            dt,
        };
        contact.begin(&step, feasible)?;
        contact.limit_each(feasible, &mut self.x, &mut self.fractions)
    }
}

impl Stepper for VertexBlockDescent {
    fn name(&self) -> &'static str {
        "vbd"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.mass.len())?;
        let (dt, step) = (input.dt, state.steps + 1);
        let failed = |reason| StepError::Contact { reason, step };
        self.energies.set_time(state.time + dt);
        self.start(state, &input);
        let mut source = input.contacts.take();
        let mut contact = source.as_mut().map(|source| source.potential());
        self.contact.clear();
        if let Some(contact) = &mut contact {
            let mut rows = GlobalRows::default();
            contact.linearize_globally(&state.positions, &mut rows);
            if !rows.rows().is_empty() {
                let remedy = "vertex block descent has no place for sealed volumes";
                return Err(StepError::ContactNotFelt { remedy });
            }
            self.begin_contact(&state.positions, dt, *contact)
                .map_err(failed)?;
        }
        self.iterate(&mut input, &mut contact).map_err(failed)?;
        for v in 0..self.x.len() {
            self.velocities[v] = (self.x[v] - state.positions[v]) / dt;
        }
        let is_finite = |v: &usize| self.velocities[*v].iter().all(|c| c.is_finite());
        if let Some(vertex) = (0..self.x.len()).find(|v| !is_finite(v)) {
            return Err(StepError::NonFinite { vertex, step });
        }
        if let Some(contact) = contact {
            contact.end(&self.x, &self.velocities);
        }
        self.last_velocities.copy_from_slice(&state.velocities);
        self.last_step = Some(step);
        state.positions.copy_from_slice(&self.x);
        state.velocities.copy_from_slice(&self.velocities);
        state.time += dt;
        state.steps = step;
        Ok(StepReport::new(Outcome::BudgetSpent, self.iterations))
    }
}

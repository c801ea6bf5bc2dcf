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
//! | `fᵢ ← fᵢ − k_d/Δt Kᵢ (xᵢ − xₜᵢ)`, `Hᵢ ← Hᵢ + k_d/Δt Kᵢ` (section 3.3) | `stiffness_damping`, see below |
//! | contacts are terms of E (section 3.5), and friction (3.6) | [`crate::contact`] |
//! | first guess between xₜ + Δt vₜ and y (section 3.7) | `VertexBlockDescent::predict` |
//! | `x⁽ᵏ⁺¹⁾ ← ω (x⁽ᵏ⁺¹⁾ − x⁽ᵏ⁻¹⁾) + x⁽ᵏ⁻¹⁾` (18), `ω ← 4/(4 − ρ²ω)` (19) | `VertexBlockDescent::accelerate` |
//!
//! The paper keeps indefinite Hessians, and skips a vertex where Hᵢ is nearly singular. Here negative eigenvalues of
//! elements count by their absolute values, so Hᵢ is positive definite and Δxᵢ goes down. With zeros in their place a
//! vertex between compressed springs has nothing but its inertia across them, and leaps: steps that are accelerated in
//! contact then come to a halt where no sweep leads down.
//!
//! # First guess
//!
//! A sweep moves a vertex among its neighbours; what all of them have in common it hardly changes. So the guess
//! decides. In the sixteenth step of the hanging sheet of 64 × 64 vertices (10⁴ N/m, Δt = 1/60 s) ten plain sweeps
//! leave, of `(G − G*)/(G(y) − G*)`, 1.35 from xₜ, 0.19 from y and 0.11 from xₜ + Δt vₜ. The adaptive guess takes as
//! much of the acceleration a from outside as the last step had of it, vertex by vertex: falling cloth begins at y,
//! which is exact for it, and hanging cloth at xₜ + Δt vₜ.
//!
//! Along a only: cloth that slides down a slope begins too far up, and too deep in the slope. In twenty parts of five
//! sweeps a sheet on 40° slid 0.411 m in half a second where the closed form says 0.507 m. So in parts of a step a
//! vertex that has touched something takes the acceleration of the last part as it was, no larger than a, and the sheet
//! slides 0.509 m. In whole steps that is noise of Δt² a, a sixth of an edge, and the adaptive guess is the better one.
//!
//! Where G is higher at the guess than at xₜ, the cloth would have more energy there than it has. A hundred sweeps do
//! not take it away: a falling sheet of 64 × 64 vertices kept 39 J as strain, where gravity had given 0.8 J. Such a
//! guess is brought half-way back until G is no higher. What is left then is the opposite: the sheet floats, and has
//! fallen 0.15 m after half a second instead of 0.50 m.
//!
//! # Small parts of a step
//!
//! How many sweeps a step needs is decided by k Δt²/m, 57,000 for that sheet. Small steps divide it by their square,
//! small parts of a step as well; this is what XPBD does, and its rule for their number holds here too, since a sweep
//! of either leaves a spring longer by what its neighbour moves. So a run takes `substeps=auto`, one sweep or a few in
//! each: that sheet falls 0.480 m in 177 parts, stretched by 2.4 %, and holds no energy that it was not given, for the
//! time of 177 sweeps. A guess for a small part is near, and taken as it is. The studies compare
//! `substeps=1`, 100 sweeps, as the paper has it, beside XPBD with its published 20 substeps.
//!
//! # Acceleration
//!
//! The extrapolation (18) diverges from some ρ on, for these sheets from 0.99, short of the spectral radius of their
//! sweeps. So an iterate higher than the one before it is brought half-way back to that, and ω begins at 1 again. Then
//! no ρ diverges, and the error left of the same step, of the drape with contact at 25 × 25 vertices at last, is
//!
//! | ρ | 32 × 32: 20, 100 sweeps | 64 × 64: 20, 100 | 128 × 128: 20, 100 | contact: 20, 100 |
//! |---|---|---|---|---|
//! | 0 | 0.077, 0.045 | 0.112, 0.064 | 0.312, 0.088 | 0.86, 0.67 |
//! | 0.95 | 0.055, 0.031 | 0.075, 0.047 | 0.111, 0.062 | 0.76, 0.33 |
//! | 0.99 | 0.056, 0.023 | 0.071, 0.037 | 0.098, 0.051 | 0.65, 0.15 |
//!
//! so 0.99 is the default. After five sweeps it may be worse than none (0.22 beside 0.14 at 32 × 32): fewer than 20 are
//! not accelerated. The guard takes one energy an iteration, a fifth of its time.
//!
//! # Damping
//!
//! The paper damps a vertex by its own block, `k_d/Δt Kᵢ (xᵢ − xₜᵢ)` with `Kᵢ = Σⱼ ∂²Eⱼ/∂xᵢ²`, as if its neighbours
//! stood still: cloth that flies is held back as well. Here the whole force of the elements is damped, by its change
//! over the step, `β/Δt (∂E/∂x(x) − ∂E/∂x(xₜ))`: for small steps −β K v, the `stiffness_damping` of the implicit
//! integrators, whose closed form an oscillator follows. Hᵢ is the paper's with k_d = β, there is a term of G for it,
//! and what moves as a rigid body keeps its speed. `air_drag` is −α m v.
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
//!   needs many iterations, or small parts of a step. Cut short, it floats.
//! - Cut short, momentum is not conserved either: what one vertex takes up its neighbour has not given.
//! - The guards bound G, and with it the potential energy after a step by all energy before it. They do not bound the
//!   kinetic energy.
//! - In parts of a step cloth slides and swings as it does in short steps, and not as in long ones of implicit Euler,
//!   which damp: the scene `handkerchief` slides off the table as far as it does with implicit Euler in steps of 1/1800
//!   s.
//! - One sweep in each part may gain energy where little is dissipated: the scene `twist` holds 1.5 mJ more within a
//!   second than the 5.2 mJ that it is given; with two sweeps, or twice as many parts, none.
//! - A sealed volume couples all of its vertices, and is refused.

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

/// What can be set of the method.
#[derive(Clone, Copy, Debug)]
pub struct VbdConfig {
    /// Sweeps over all vertices a part of a step.
    pub iterations: u32,
    /// Parts of a step.
    pub substeps: u32,
    /// ρ of the acceleration, in [0, 1); 0 does without.
    pub chebyshev_radius: Real,
    /// α (1/s): a force −α m v.
    pub air_drag: Real,
    /// β (s): a force −β K v.
    pub stiffness_damping: Real,
}

/// The method, for one cloth.
pub struct VertexBlockDescent {
    config: VbdConfig,
    mass: Vec<Real>,
    inverse_mass: Vec<Real>,
    energies: Energies,
    incidence: Incidence,
    /// Free vertices, by colour.
    colors: Vec<Vec<u32>>,
    /// xₜ and y (m).
    from: Vec<Vec3>,
    inertial: Vec<Vec3>,
    /// ∂E/∂x at xₜ (N), if the material damps.
    last_gradient: Vec<Vec3>,
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
    /// For these masses and this energy.
    pub fn new(particles: &Particles, energies: Energies, config: VbdConfig) -> Self {
        let count = particles.len();
        let mut colors = energies.vertex_colors();
        for color in &mut colors {
            color.retain(|&vertex| !particles.is_prescribed(vertex as usize));
        }
        let largest = colors.iter().map(Vec::len).max().unwrap_or(0);
        let zeros = vec![Vec3::zeros(); count];
        Self {
            config,
            mass: particles.mass().to_vec(),
            inverse_mass: particles.inverse_mass().to_vec(),
            incidence: energies.incidence(),
            energies,
            colors,
            from: zeros.clone(),
            inertial: zeros.clone(),
            last_gradient: zeros.clone(),
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

    /// y, where the step is without elasticity, and the first guess: with as much of the acceleration from outside as
    /// the last step had of it, so that falling cloth begins at y and hanging cloth where it is; in parts of a step
    /// with the acceleration of the last one where it touched something, no larger than that from outside.
    fn predict(&mut self, state: &State, input: &StepInput<'_>) {
        let dt = input.dt;
        let follows = self.last_step == Some(state.steps);
        self.from.copy_from_slice(&state.positions);
        for v in 0..self.x.len() {
            let outside = input.external_acceleration(v, self.inverse_mass[v]);
            let flight = state.positions[v] + state.velocities[v] * dt;
            self.inertial[v] = flight + outside * (dt * dt);
            let mut guess = outside;
            if follows && outside != Vec3::zeros() {
                let last = (state.velocities[v] - self.last_velocities[v]) / dt;
                let (most, size) = (outside.norm(), last.norm());
                let in_parts = self.config.substeps > 1;
                guess = if in_parts && self.contact.touches(v) {
                    last * (most / size).min(1.0)
                } else {
                    outside * (last.dot(&outside) / (most * most)).clamp(0.0, 1.0)
                };
            }
            self.x[v] = flight + guess * (dt * dt);
            let is_free = self.inverse_mass[v] > 0.0;
            self.before[v] = if is_free { self.from[v] } else { self.x[v] };
        }
        if self.config.stiffness_damping > 0.0 {
            self.last_gradient.fill(Vec3::zeros());
            self.energies
                .add_gradient(&self.from, &mut self.last_gradient);
        }
    }

    /// One iteration: every free vertex to the minimum of its own model, colour by colour.
    fn sweep(&mut self, dt: Real) {
        let (drag, rate) = self.damping(dt);
        for vertices in &self.colors {
            let gradient = &mut self.gradient[..vertices.len()];
            let hessian = &mut self.hessian[..vertices.len()];
            gradient.fill(Vec3::zeros());
            hessian.fill(Mat3::zeros());
            self.energies.add_at_vertices(
                &self.incidence,
                vertices,
                &self.x,
                Convexity::Abs,
                gradient,
                hessian,
            );
            for (i, &vertex) in vertices.iter().enumerate() {
                let v = vertex as usize;
                let x = self.x[v];
                let [inertia, drag] = [1.0 / (dt * dt), drag].map(|factor| self.mass[v] * factor);
                let mut gradient = gradient[i] * (1.0 + rate) - self.last_gradient[v] * rate;
                gradient += (x - self.inertial[v]) * inertia + (x - self.from[v]) * drag;
                let mut hessian = hessian[i] * (1.0 + rate);
                hessian += Mat3::from_diagonal_element(inertia + drag);
                self.contact
                    .add(vertex, &self.x, &mut gradient, &mut hessian);
                // Singular only where numbers have overflowed; the step then ends with an error.
                if let Some(inverse) = hessian.try_inverse() {
                    self.x[v] -= inverse * gradient;
                }
            }
        }
    }

    /// α/Δt (1/s²) and β/Δt.
    fn damping(&self, dt: Real) -> (Real, Real) {
        (
            self.config.air_drag / dt,
            self.config.stiffness_damping / dt,
        )
    }

    /// G (J), without contact.
    fn value(&self, x: &[Vec3], dt: Real) -> Real {
        let (drag, rate) = self.damping(dt);
        let mut sum = (1.0 + rate) * self.energies.value(x);
        for (v, x) in x.iter().enumerate() {
            let away = (x - self.inertial[v]).norm_squared() / (dt * dt);
            let moved = (x - self.from[v]).norm_squared() * drag;
            sum += 0.5 * self.mass[v] * (away + moved) - rate * self.last_gradient[v].dot(x);
        }
        sum
    }

    /// Extrapolates from the iterate before the last one, where nothing touches.
    fn accelerate(&mut self, omega: Real) {
        for v in 0..self.x.len() {
            if self.inverse_mass[v] > 0.0 && !self.contact.touches(v) {
                self.x[v] = (self.x[v] - self.earlier[v]) * omega + self.earlier[v];
            }
        }
    }

    /// From the first guess downwards.
    fn iterate(
        &mut self,
        input: &mut StepInput<'_>,
        contact: &mut Option<&mut dyn ContactPotential>,
    ) -> Result<StepReport, ContactError> {
        let dt = input.dt;
        let radius = self.config.chebyshev_radius;
        let mut least = self.begin(dt, contact)?;
        let mut report = StepReport::new(Outcome::BudgetSpent, 0);
        if contact.is_some() || least.is_finite() {
            report.backtracks = self.descend(dt, contact, &mut least);
        }
        let (mut omega, mut extrapolated) = (1.0, 0);
        for iteration in 1..=self.config.iterations {
            std::mem::swap(&mut self.earlier, &mut self.before);
            self.before.copy_from_slice(&self.x);
            self.sweep(dt);
            report.iterations = iteration;
            if radius > 0.0 {
                omega = match extrapolated {
                    0 => 1.0,
                    1 => 2.0 / (2.0 - radius * radius),
                    _ => 4.0 / (4.0 - radius * radius * omega),
                };
                extrapolated += 1;
                if extrapolated > 1 {
                    self.accelerate(omega);
                }
            }
            if let Some(contact) = contact {
                contact.limit_each(&self.before, &mut self.x, &mut self.fractions)?;
            }
            if contact.is_some() || extrapolated > 1 {
                let halved = self.descend(dt, contact, &mut least);
                report.backtracks += halved;
                if halved > HALVINGS && extrapolated <= 1 {
                    break; // the next sweep would be the same
                }
                if halved > 0 {
                    extrapolated = 0;
                }
            }
            if let Some(observer) = &mut input.observer {
                observer.iteration(iteration, &self.x);
            }
        }
        Ok(report)
    }

    /// Begins contact where the cloth is, and goes towards the first guess as far as is free of crossings. Returns the
    /// most that G (J) may be there: what it is where the cloth is, with prescribed vertices at their ends. In parts of
    /// a step guesses are near, and two energies would cost as much as half a sweep: no bound but for acceleration.
    fn begin(
        &mut self,
        dt: Real,
        contact: &mut Option<&mut dyn ContactPotential>,
    ) -> Result<Real, ContactError> {
        self.contact.clear();
        if let Some(contact) = contact {
            let step = ContactStep {
                from: &self.from,
                inverse_mass: &self.inverse_mass,
                dt,
            };
            contact.begin(&step, &mut self.before)?;
        }
        let mut most = Real::INFINITY;
        if self.config.substeps == 1 || self.config.chebyshev_radius > 0.0 {
            if let Some(contact) = contact {
                self.contact.linearize(&**contact, &self.before);
            }
            most = self.value(&self.before, dt) + self.contact.energy();
        }
        if let Some(contact) = contact {
            contact.limit_each(&self.before, &mut self.x, &mut self.fractions)?;
        }
        Ok(most)
    }

    /// Linearises contact at the iterate, and goes half-way back to the one before as long as G is above the `least`
    /// (J) so far: a barrier is steeper than what has been linearised farther away. Returns how often.
    fn descend(
        &mut self,
        dt: Real,
        contact: &Option<&mut dyn ContactPotential>,
        least: &mut Real,
    ) -> u32 {
        for halvings in 0..=HALVINGS {
            if let Some(contact) = contact {
                self.contact.linearize(&**contact, &self.x);
            }
            let value = self.value(&self.x, dt) + self.contact.energy();
            if value <= *least + ROUNDING * least.abs() {
                *least = least.min(value);
                return halvings;
            }
            let nearer = if halvings < HALVINGS { 0.5 } else { 0.0 };
            for (x, before) in self.x.iter_mut().zip(&self.before) {
                *x = *before + (*x - *before) * nearer;
            }
        }
        if let Some(contact) = contact {
            self.contact.linearize(&**contact, &self.x);
        }
        HALVINGS + 1
    }
}

impl Stepper for VertexBlockDescent {
    fn name(&self) -> &'static str {
        "vbd"
    }

    fn preferred_substeps(&self) -> u32 {
        self.config.substeps
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
        self.predict(state, &input);
        let mut source = input.contacts.take();
        let mut contact = source.as_mut().map(|source| source.potential());
        if let Some(contact) = &mut contact {
            let mut rows = GlobalRows::default();
            contact.linearize_globally(&state.positions, &mut rows);
            if !rows.rows().is_empty() {
                let remedy = "vertex block descent has no place for sealed volumes";
                return Err(StepError::ContactNotFelt { remedy });
            }
        }
        let mut report = self.iterate(&mut input, &mut contact).map_err(failed)?;
        report.tells_pin_forces = input.begin_pin_forces(self.x.len());
        if report.tells_pin_forces {
            let gradient = &mut self.before; // free until the next step
            gradient.fill(Vec3::zeros());
            self.energies.add_gradient(&self.x, gradient);
            let pins = (0..self.x.len()).filter(|&v| self.inverse_mass[v] == 0.0);
            pins.for_each(|v| input.add_pin_force(v, -gradient[v]));
        }
        for v in 0..self.x.len() {
            self.velocities[v] = (self.x[v] - state.positions[v]) / dt;
        }
        let is_finite = |v: &usize| self.velocities[*v].iter().all(|c| c.is_finite());
        if let Some(vertex) = (0..self.x.len()).find(|v| !is_finite(v)) {
            return Err(StepError::NonFinite { vertex, step });
        }
        if let Some(contact) = contact {
            contact.end(&self.x, &mut self.velocities);
        }
        self.last_velocities.copy_from_slice(&state.velocities);
        self.last_step = Some(step);
        state.positions.copy_from_slice(&self.x);
        state.velocities.copy_from_slice(&self.velocities);
        state.time += dt;
        state.steps = step;
        Ok(report)
    }
}

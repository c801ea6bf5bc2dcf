//! Implicit Euler as a minimisation, by the simplest method that always goes down.
//!
//! A time step minimises G(x) = (x − y)ᵀ M (x − y)/2Δt² + E(x), where y is where the cloth would be without elasticity. Each iteration goes along −P ∇G, where P is the
//! inverse of the 3 × 3 blocks on the diagonal of M/Δt² + ∂²E, with the largest of the lengths s, s/2, s/4, … that lowers G enough.
//!
//! Neighbours hear of each other one edge an iteration, so stiff or large cloth needs many: that is what the comparison shows.

use cloth_core::block_matrix::BlockMatrix;
use cloth_core::contact::{ContactStep, Projection};
use cloth_core::element::Convexity;
use cloth_core::family::{Assembly, Energies};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};

/// Share of the decrease that the slope promises which a length has to bring (Armijo's condition).
const ENOUGH: Real = 1e-4;
/// Halvings of a length before the search ends.
const HALVINGS: u32 = 30;
/// Sweeps over the contacts of a step.
const CONTACT_SWEEPS: u32 = 10;

/// The method.
pub struct Descent {
    mass: Vec<Real>,
    inverse_mass: Vec<Real>,
    energies: Energies,
    assembly: Assembly,
    hessian: BlockMatrix,
    /// Place of the block on the diagonal of each row.
    diagonal: Vec<usize>,
    iterations: u32,
    free_flight: Vec<Vec3>,
    gradient: Vec<Vec3>,
    direction: Vec<Vec3>,
    preconditioner: Vec<Mat3>,
    trial: Vec<Vec3>,
    /// The end of the step.
    next: State,
    projection: Projection,
}

impl Descent {
    /// For these masses and this energy, with so many iterations per step.
    pub fn new(particles: &Particles, energies: Energies, iterations: u32) -> Self {
        let count = particles.len();
        let assembly = energies.assembly();
        let hessian = BlockMatrix::zeros(assembly.pattern().clone());
        let place = |vertex: u32| hessian.pattern().slot(vertex, vertex);
        let diagonal = (0..count as u32)
            .filter_map(place)
            .map(|slot| slot as usize);
        let zeros = vec![Vec3::zeros(); count];
        Self {
            mass: particles.mass().to_vec(),
            inverse_mass: particles.inverse_mass().to_vec(),
            diagonal: diagonal.collect(),
            energies,
            assembly,
            hessian,
            iterations,
            free_flight: zeros.clone(),
            gradient: zeros.clone(),
            direction: zeros.clone(),
            preconditioner: vec![Mat3::zeros(); count],
            trial: zeros.clone(),
            next: State::at_rest(zeros),
            projection: Projection::default(),
        }
    }

    /// G(x) (J).
    fn objective(&self, x: &[Vec3], dt: Real) -> Real {
        let away = x.iter().zip(&self.free_flight).zip(&self.mass);
        let inertia: Real = away.map(|((x, y), m)| m * (x - y).norm_squared()).sum();
        inertia / (2.0 * dt * dt) + self.energies.value(x)
    }

    /// ∇G at the end of the step so far (N); zero where a vertex is held.
    fn differentiate(&mut self, dt: Real) {
        let x = &self.next.positions;
        for (v, gradient) in self.gradient.iter_mut().enumerate() {
            *gradient = (x[v] - self.free_flight[v]) * (self.mass[v] / (dt * dt));
        }
        self.energies.add_gradient(x, &mut self.gradient);
        for (gradient, w) in self.gradient.iter_mut().zip(&self.inverse_mass) {
            if *w == 0.0 {
                *gradient = Vec3::zeros();
            }
        }
    }

    fn precondition(&mut self, dt: Real) {
        self.hessian.clear();
        let x = &self.next.positions;
        self.energies
            .add_hessian(&self.assembly, x, 1.0, Convexity::Clamp, &mut self.hessian);
        for (v, inverse) in self.preconditioner.iter_mut().enumerate() {
            let block = self.hessian.blocks()[self.diagonal[v]]
                + Mat3::identity() * (self.mass[v] / (dt * dt));
            // Masses are positive and the blocks have no negative eigenvalues.
            *inverse = block.try_inverse().unwrap_or_else(Mat3::zeros);
        }
    }
}

impl Stepper for Descent {
    fn name(&self) -> &'static str {
        "descent"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.mass.len())?;
        let dt = input.dt;
        for (v, y) in self.free_flight.iter_mut().enumerate() {
            let acceleration = input.external_acceleration(v, self.inverse_mass[v]);
            *y = state.positions[v] + (state.velocities[v] + acceleration * dt) * dt;
        }
        self.next.positions.copy_from_slice(&self.free_flight);
        self.precondition(dt);
        let mut value = self.objective(&self.next.positions, dt);
        let mut length: Real = 1.0;
        let mut report = StepReport::new(Outcome::BudgetSpent, 0);
        for iteration in 1..=self.iterations {
            self.differentiate(dt);
            let mut slope = 0.0;
            for v in 0..self.gradient.len() {
                self.direction[v] = -(self.preconditioner[v] * self.gradient[v]);
                slope += self.direction[v].dot(&self.gradient[v]);
            }
            // A length that was too long once may be right later.
            length = (2.0 * length).min(1.0);
            let mut halvings = 0;
            let lower = loop {
                for v in 0..self.trial.len() {
                    self.trial[v] = self.next.positions[v] + self.direction[v] * length;
                }
                let there = self.objective(&self.trial, dt);
                if there <= value + ENOUGH * length * slope {
                    break Some(there);
                }
                if halvings == HALVINGS {
                    break None;
                }
                halvings += 1;
                length /= 2.0;
            };
            report.backtracks += halvings;
            // Nothing is lower to rounding: this is the minimum.
            let Some(lower) = lower else {
                report.outcome = Outcome::Converged;
                break;
            };
            value = lower;
            std::mem::swap(&mut self.next.positions, &mut self.trial);
            report.iterations = iteration;
            if let Some(observer) = &mut input.observer {
                observer.iteration(iteration, &self.next.positions);
            }
        }
        for v in 0..self.mass.len() {
            self.next.velocities[v] = (self.next.positions[v] - state.positions[v]) / dt;
        }
        let State {
            positions,
            velocities,
            ..
        } = &mut self.next;
        let step = state.steps + 1;
        if let Some(contacts) = input.contact_constraints() {
            let taken = ContactStep {
                from: &state.positions,
                inverse_mass: &self.inverse_mass,
                dt,
            };
            let touched =
                self.projection
                    .step(contacts, &taken, CONTACT_SWEEPS, positions, velocities);
            touched.map_err(|reason| StepError::Contact { reason, step })?;
        }
        if let Some(vertex) = self.next.first_non_finite() {
            return Err(StepError::NonFinite { vertex, step });
        }
        state.positions.copy_from_slice(&self.next.positions);
        state.velocities.copy_from_slice(&self.next.velocities);
        state.time += dt;
        state.steps = step;
        Ok(report)
    }
}

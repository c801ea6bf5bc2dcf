//! Inertial prediction before the sweeps, velocities after them, contact and the work of prescribed vertices.

use super::{ConstraintUpdate, Families, RowView};
use crate::contact::{ContactConstraints, ContactError, ContactStep};
use crate::math::{Real, Vec3};
use crate::particles::{Particles, State, first_non_finite};
use crate::step::{Outcome, StepError, StepInput, StepReport};

/// Most times in a step that the forces of the air are linearised; in the substeps between they go on linearly with the
/// velocities. A flag that takes 619 substeps in a wind of 8 m/s moves by 4e-4 more in four steps, in half the time.
const MAX_AIR_LINEARIZATIONS: Real = 64.0;

/// A working copy of the state, and the four stages of a step.
///
/// In the order of a step: [`begin`](Self::begin); for each substep [`predict`](Self::predict), any number of
/// [`iterate`](Self::iterate), [`update_velocities`](Self::update_velocities); [`finish`](Self::finish). The
/// caller's state is written in the last one only, so that an error leaves it as it was.
///
/// Contact constraints ([`ContactConstraints`]) take part in all of them, last in each iteration.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Inverse masses (1/kg), one per vertex.
    inverse_mass: Vec<Real>,
    /// Positions (m), one per vertex: moved by the sweeps.
    positions: Vec<Vec3>,
    /// Velocities (m/s), one per vertex.
    velocities: Vec<Vec3>,
    /// Positions (m) before the sweeps, one per vertex.
    predicted: Vec<Vec3>,
    /// Positions (m) at the start of the substep, if there are contact constraints.
    start: Vec<Vec3>,
    /// The substep (s).
    substep: Real,
    /// Time (s) since the forces of the air were linearised.
    since_air_linearized: Real,
    /// Whether a prescribed vertex moves in this step, whether the forces at all of them are asked for, and told.
    pins_move: bool,
    asks_pin_forces: bool,
    tells_pin_forces: bool,
    /// Work (J) of prescribed vertices since `begin`.
    pin_work: Real,
    /// Iterations since `begin`.
    iterations: u32,
    /// The step, counted from 1.
    step: u64,
}

impl Motion {
    /// With the masses and prescribed vertices of `particles` as they are now.
    #[must_use]
    pub fn new(particles: &Particles) -> Self {
        let zeros = || vec![Vec3::zeros(); particles.len()];
        Self {
            inverse_mass: particles.inverse_mass().to_vec(),
            positions: zeros(),
            velocities: zeros(),
            predicted: zeros(),
            start: Vec::new(),
            substep: 0.0,
            since_air_linearized: Real::INFINITY,
            pins_move: false,
            asks_pin_forces: false,
            tells_pin_forces: false,
            pin_work: 0.0,
            iterations: 0,
            step: 0,
        }
    }

    /// Number of vertices V.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.inverse_mass.len()
    }

    /// Inverse masses (1/kg), one per vertex.
    #[must_use]
    pub fn inverse_mass(&self) -> &[Real] {
        &self.inverse_mass
    }

    /// Positions (m) as they are now, one per vertex.
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Velocities (m/s) as they are now, one per vertex.
    #[must_use]
    pub fn velocities(&self) -> &[Vec3] {
        &self.velocities
    }

    /// Iterations since [`begin`](Self::begin).
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.iterations
    }

    /// Checks the input and copies the state.
    ///
    /// # Errors
    /// Those of [`StepInput::check`]; [`StepError::Contact`].
    ///
    /// # Panics
    /// If `state` or the load does not have V entries.
    pub fn begin(&mut self, state: &State, input: &mut StepInput<'_>) -> Result<(), StepError> {
        input.check(state, self.vertex_count())?;
        self.positions.copy_from_slice(&state.positions);
        self.velocities.copy_from_slice(&state.velocities);
        let mut moving = self.inverse_mass.iter().zip(&self.velocities);
        self.pins_move = moving.any(|(w, v)| *w == 0.0 && *v != Vec3::zeros());
        self.asks_pin_forces = input.begin_pin_forces(self.vertex_count());
        self.tells_pin_forces = false;
        self.pin_work = 0.0;
        self.iterations = 0;
        self.step = state.steps + 1;
        if let Some(air) = &mut input.air {
            air.restart();
        }
        self.since_air_linearized = Real::INFINITY;
        let step = ContactStep {
            from: &state.positions,
            inverse_mass: &self.inverse_mass,
            dt: input.dt,
        };
        let begun = input.contact_constraints().map(|c| c.begin_step(&step));
        begun
            .transpose()
            .map_err(|reason| self.contact_error(reason))?;
        Ok(())
    }

    /// Inertial prediction over `h` (s): `v ← v + h a`, `x ← x + h v`. A prescribed vertex keeps its v.
    ///
    /// # Errors
    /// [`StepError::Contact`], [`StepError::NonFinite`].
    pub fn predict(&mut self, input: &mut StepInput<'_>, h: Real) -> Result<(), StepError> {
        self.substep = h;
        if input.contact_constraints().is_some() {
            self.start.clone_from(&self.positions);
        }
        if let Some(air) = &mut input.air {
            self.since_air_linearized += h;
            if self.since_air_linearized * MAX_AIR_LINEARIZATIONS >= input.dt * (1.0 - 1e-9) {
                self.since_air_linearized = 0.0;
                air.linearize(&self.positions, &self.velocities);
                air.begin_projection(&self.inverse_mass, h);
            } else {
                air.continue_linearly(&self.positions, &self.velocities);
            }
        }
        for vertex in 0..self.vertex_count() {
            let a = input.external_acceleration(vertex, self.inverse_mass[vertex]);
            self.velocities[vertex] += a * h;
            self.positions[vertex] += self.velocities[vertex] * h;
        }
        self.predicted.copy_from_slice(&self.positions);
        self.with_contacts(input, |contacts, step, x| contacts.begin_substep(step, x))
    }

    /// One iteration: `sweep` gets the inverse masses (1/kg) and the positions (m), and the drag of the air and contact
    /// come after it; then the observer is called.
    pub fn iterate(&mut self, input: &mut StepInput<'_>, sweep: impl FnOnce(&[Real], &mut [Vec3])) {
        sweep(&self.inverse_mass, &mut self.positions);
        if let Some(air) = &mut input.air {
            air.project(&mut self.positions);
        }
        if let Some(contacts) = input.contact_constraints() {
            let (step, x) = self.split();
            contacts.sweep(&step, x);
        }
        self.iterations += 1;
        if let Some(observer) = &mut input.observer {
            observer.iteration(self.iterations, &self.positions);
        }
    }

    /// Whether the forces at prescribed vertices count in this step: one moves, or they are asked for.
    #[must_use]
    pub fn needs_pin_forces(&self) -> bool {
        self.pins_move || self.asks_pin_forces
    }

    /// Work (J) of prescribed vertices in this step, as far as it was added.
    #[must_use]
    pub fn pin_work(&self) -> Real {
        self.pin_work
    }

    /// Adds the work of prescribed vertices in the substep whose sweeps have ended: each moved by `h v` against
    /// the force `Jᵀλ/h²` on it, with the λ of each row (kg m² per unit of C) from `multiplier` and J at the
    /// end of the sweeps; and these forces to those that `input` asks for. Nothing is done where no such vertex moves
    /// and nobody asks.
    ///
    /// The row has moved the others by `wᵢ ∂C/∂xᵢ λ`, so this is the work done on them, whatever the residual.
    /// The error is that of J where a row turns during the sweeps, and falls with the angle.
    pub fn count_pin_work<R: ConstraintUpdate>(
        &mut self,
        input: &mut StepInput<'_>,
        families: &Families<R>,
        mut multiplier: impl FnMut(&RowView<'_, R::Memory>) -> Real,
    ) {
        if !self.needs_pin_forces() {
            return;
        }
        let (w, v, h) = (&self.inverse_mass, &self.velocities, self.substep);
        let mut work = 0.0;
        families.inspect_prescribed(w, &self.positions, |seen| {
            let impulse = multiplier(&seen) / h;
            for (&vertex, gradient) in seen.vertices.iter().zip(seen.gradient) {
                if w[vertex as usize] == 0.0 {
                    work -= gradient.dot(&v[vertex as usize]) * impulse;
                    input.add_pin_force(vertex as usize, gradient * (impulse / input.dt));
                }
            }
        });
        self.pin_work += work;
        self.tells_pin_forces = self.asks_pin_forces;
    }

    /// The same for a method with families of its own, where [`needs_pin_forces`](Self::needs_pin_forces) says so:
    /// `Jᵀλ` (kg m) of a row at a prescribed vertex, in the substep whose sweeps have ended.
    pub fn add_pin_impulse(&mut self, input: &mut StepInput<'_>, vertex: usize, impulse: Vec3) {
        let h = self.substep;
        self.pin_work -= impulse.dot(&self.velocities[vertex]) / h;
        input.add_pin_force(vertex, impulse / (h * input.dt));
        self.tells_pin_forces = self.asks_pin_forces;
    }

    /// `v ← v + (x − x̃)/h`, with x̃ the prediction and h its substep; contact changes x before it, and v after it.
    ///
    /// Since `x̃ = x₀ + h v` this is the published `(x − x₀)/h` (Müller et al. 2007). In this form a vertex that no
    /// constraint moved keeps its velocity to the last bit, a prescribed one in particular; the other one divides the
    /// rounding of `x₀ + h v` by h.
    ///
    /// # Errors
    /// [`StepError::Contact`], [`StepError::NonFinite`].
    pub fn update_velocities(&mut self, input: &mut StepInput<'_>) -> Result<(), StepError> {
        self.with_contacts(input, |contacts, step, x| contacts.end_substep(step, x))?;
        let h = self.substep;
        let moved = self.positions.iter().zip(&self.predicted);
        for (v, (x, predicted)) in self.velocities.iter_mut().zip(moved) {
            *v += (x - predicted) / h;
        }
        if let Some(air) = &mut input.air {
            air.end(&self.positions, &self.velocities, &self.inverse_mass);
        }
        if let Some(contacts) = input.contact_constraints() {
            contacts.change_velocities(&mut self.velocities);
        }
        Ok(())
    }

    /// Applies contact constraints, if there are any, to the positions of the substep.
    fn with_contacts(
        &mut self,
        input: &mut StepInput<'_>,
        act: impl FnOnce(
            &mut dyn ContactConstraints,
            &ContactStep<'_>,
            &mut [Vec3],
        ) -> Result<(), ContactError>,
    ) -> Result<(), StepError> {
        let Some(contacts) = input.contact_constraints() else {
            return Ok(());
        };
        let (step, x) = self.split();
        act(contacts, &step, x).map_err(|reason| self.contact_error(reason))
    }

    /// The substep, and the positions (m) in it.
    fn split(&mut self) -> (ContactStep<'_>, &mut [Vec3]) {
        let step = ContactStep {
            from: &self.start,
            inverse_mass: &self.inverse_mass,
            dt: self.substep,
        };
        (step, &mut self.positions)
    }

    fn contact_error(&self, reason: ContactError) -> StepError {
        let step = self.step;
        match reason {
            ContactError::NonFinite { vertex } => StepError::NonFinite { vertex, step },
            reason => StepError::Contact { reason, step },
        }
    }

    /// Writes the result to `state`, and advances its time by Δt.
    ///
    /// # Errors
    /// [`StepError::NonFinite`], [`StepError::Contact`]; `state` is then as it was.
    pub fn finish(
        &mut self,
        state: &mut State,
        input: &mut StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        let step = self.step;
        if let Some(vertex) = first_non_finite(&self.positions, &self.velocities) {
            return Err(StepError::NonFinite { vertex, step });
        }
        if let Some(contacts) = input.contact_constraints() {
            contacts.end_step(&self.positions);
        }
        state.positions.copy_from_slice(&self.positions);
        state.velocities.copy_from_slice(&self.velocities);
        state.time += input.dt;
        state.steps = step;
        Ok(StepReport {
            pin_work: Some(self.pin_work),
            tells_pin_forces: self.tells_pin_forces,
            ..StepReport::new(Outcome::BudgetSpent, self.iterations)
        })
    }
}

//! One implicit step as a problem with a known answer, and how far a method is from it.

use crate::error::BenchError;
use crate::method::Method;
use crate::scene::Scene;
use crate::settings::Settings;
use cloth_core::cloth::ClothModel;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::method::family::Energies;
use cloth_core::particles::State;
use cloth_core::step::{Observer, StepInput, StepReport, Stepper};
use cloth_massspring::{ImplicitConfig, ImplicitEuler};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// One step from a given state, with the minimiser of `G` found by Newton's method to rounding.
#[derive(Debug)]
pub struct StepProblem {
    model: ClothModel,
    energies: Energies,
    state: State,
    gravity: Vec3,
    dt: Real,
    predicted: Vec<Vec3>,
    minimiser: Vec<Vec3>,
    minimum: Real,
    start_gap: Real,
    start_gradient: Real,
}

/// How far from the minimiser some positions are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepError {
    /// `(G − G*)/(G(x̃) − G*)` (dimensionless): 1 at the inertial prediction, 0 at the minimum.
    #[serde(rename = "objective error")]
    pub objective: Real,
    /// `‖∇G‖/‖∇G(x̃)‖` in the norm of M⁻¹ (dimensionless).
    #[serde(rename = "gradient error")]
    pub gradient: Real,
}

/// What one iteration reached.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Iterations so far.
    #[serde(rename = "iterations")]
    pub iteration: u32,
    /// Seconds so far, without the time spent measuring.
    pub seconds: Real,
    /// Distance from the minimiser.
    pub error: StepError,
}

impl StepProblem {
    /// The step of size `dt` (s) from `state`.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if Newton's method does not reach its floor, or if the prediction is already the
    /// minimiser.
    pub fn new(
        model: &ClothModel,
        state: &State,
        gravity: Vec3,
        dt: Real,
    ) -> Result<Self, BenchError> {
        let springs = model.springs.iter();
        if springs.map(|s| s.stiffness).any(Real::is_infinite) {
            let message = "hard constraints (stiffness=inf) have no minimiser to compare with";
            return Err(BenchError::Usage(message.into()));
        }
        let energies = model.energies()?;
        let input = StepInput::new(dt).gravity(gravity);
        let mut predicted = state.positions.clone();
        predict(&model.particles, state, &input, &mut predicted);
        let mut end = state.clone();
        let report = reference(model)?.step(&mut end, input)?;
        let mut problem = Self {
            model: model.clone(),
            energies,
            state: state.clone(),
            gravity,
            dt,
            predicted,
            minimiser: end.positions,
            minimum: 0.0,
            start_gap: 1.0,
            start_gradient: 1.0,
        };
        let (at_minimiser, at_prediction) = {
            let potential = problem.potential();
            (
                potential.value(&problem.minimiser),
                potential.value(&problem.predicted),
            )
        };
        problem.minimum = at_minimiser;
        problem.start_gap = at_prediction - at_minimiser;
        problem.start_gradient = problem.gradient_norm(&problem.predicted);
        let relative = problem.error(&problem.minimiser).gradient;
        if !(problem.start_gap > 0.0 && relative < 1e-8) {
            return Err(BenchError::Failed(format!(
                "the reference did not converge: relative gradient {relative:e} after {} iterations, gap {:e} J",
                report.iterations, problem.start_gap
            )));
        }
        Ok(problem)
    }

    /// The step that follows after `steps` steps of `dt` (s) of implicit Euler from the start of a scene: the same step
    /// for every method.
    pub fn after(scene: &Scene, steps: u32, dt: Real) -> Result<Self, BenchError> {
        let mut newton = Method::find("implicit-euler")?.build(scene, &Settings::default(), dt)?;
        let mut state = scene.start.clone();
        for _ in 0..steps {
            let input = StepInput::new(dt).gravity(scene.gravity);
            newton.step(&mut state, input)?;
        }
        Self::new(&scene.model, &state, scene.gravity, dt)
    }

    fn potential(&self) -> IncrementalPotential<'_> {
        IncrementalPotential {
            particles: &self.model.particles,
            energies: &self.energies,
            predicted: &self.predicted,
            dt: self.dt,
        }
    }

    fn gradient_norm(&self, positions: &[Vec3]) -> Real {
        let mut gradient = vec![Vec3::zeros(); positions.len()];
        let potential = self.potential();
        potential.gradient_into(positions, &mut gradient);
        potential.gradient_norm(&gradient)
    }

    /// Distance of `positions` (m) from the minimiser.
    pub fn error(&self, positions: &[Vec3]) -> StepError {
        StepError {
            objective: (self.potential().value(positions) - self.minimum) / self.start_gap,
            gradient: self.gradient_norm(positions) / self.start_gradient,
        }
    }

    /// `‖M(x − x̃) − ∇Cᵀλ‖/‖Δt² ∇G(x̃)‖` in the norm of M⁻¹ (dimensionless): what XPBD's multipliers λ (kg m), one a
    /// spring, leave of the balance of momentum at `positions` (m). Where C + α̃λ = 0 it is the error of the gradient.
    pub fn momentum_residual(&self, positions: &[Vec3], multipliers: &[Real]) -> Real {
        let mass = self.model.particles.mass().iter();
        let moved = positions.iter().zip(&self.predicted).zip(mass);
        let mut residual: Vec<Vec3> = moved.map(|((x, free), m)| (x - free) * *m).collect();
        for (spring, multiplier) in self.model.springs.iter().zip(multipliers) {
            let [a, b] = spring.vertices.map(|v| v as usize);
            let along = (positions[b] - positions[a]).normalize() * *multiplier;
            residual[a] += along;
            residual[b] -= along;
        }
        let norm = self.potential().gradient_norm(&residual);
        norm / (self.dt * self.dt * self.start_gradient)
    }

    /// The state that the step starts from.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Relative gradient norm at the reference: how exactly it is known.
    pub fn reference_gradient(&self) -> Real {
        self.error(&self.minimiser).gradient
    }

    /// Takes the step with a method and measures after every iteration.
    pub fn trace(&self, stepper: &mut dyn Stepper) -> Result<Vec<Sample>, BenchError> {
        let mut samples = Vec::new();
        let mut recorder = Recorder::new(|iteration, seconds, positions: &[Vec3]| {
            samples.push(Sample {
                iteration,
                seconds,
                error: self.error(positions),
            });
        });
        self.take(stepper, Some(&mut recorder))?;
        Ok(samples)
    }

    /// Takes the step, in as many parts as the method wants.
    fn take(
        &self,
        stepper: &mut dyn Stepper,
        mut observer: Option<&mut dyn Observer>,
    ) -> Result<(State, StepReport), BenchError> {
        let mut state = self.state.clone();
        let parts = stepper.preferred_substeps();
        let mut report: Option<StepReport> = None;
        for _ in 0..parts {
            let mut input = StepInput::new(self.dt / Real::from(parts)).gravity(self.gravity);
            if let Some(observer) = &mut observer {
                input = input.observer(&mut **observer);
            }
            let next = stepper.step(&mut state, input)?;
            report = Some(report.map_or(next, |report| report.and(next)));
        }
        let report = report.ok_or_else(|| BenchError::Failed("a step of no parts".into()))?;
        Ok((state, report))
    }

    /// Takes the step with a method, unwatched; returns the error at its end, its report and the seconds it took.
    pub fn solve(
        &self,
        stepper: &mut dyn Stepper,
    ) -> Result<(StepError, StepReport, Real), BenchError> {
        let started = Instant::now();
        let (state, report) = self.take(stepper, None)?;
        let seconds = started.elapsed().as_secs_f64();
        Ok((self.error(&state.positions), report, seconds))
    }
}

/// Newton's method to rounding, and to a minimum: the reference.
pub fn reference(model: &ClothModel) -> Result<ImplicitEuler, BenchError> {
    ImplicitEuler::builder(&model.particles)
        .elements(model.families())
        .config(ImplicitConfig::reference())
        .build()
        .map_err(BenchError::failed)
}

/// Looks at every iteration of a step: at its number from 1, the seconds until then, and the positions (m). Its clock
/// stands still meanwhile.
#[derive(Debug)]
pub(crate) struct Recorder<F> {
    look: F,
    started: Instant,
    looking: Real,
    count: u32,
}

impl<F: FnMut(u32, Real, &[Vec3])> Recorder<F> {
    pub(crate) fn new(look: F) -> Self {
        Self {
            look,
            started: Instant::now(),
            looking: 0.0,
            count: 0,
        }
    }

    /// Seconds so far.
    pub(crate) fn seconds(&self) -> Real {
        self.started.elapsed().as_secs_f64() - self.looking
    }
}

impl<F: FnMut(u32, Real, &[Vec3])> Observer for Recorder<F> {
    fn iteration(&mut self, _: u32, positions: &[Vec3]) {
        let called = self.started.elapsed().as_secs_f64();
        self.count += 1;
        (self.look)(self.count, called - self.looking, positions);
        self.looking += self.started.elapsed().as_secs_f64() - called;
    }
}

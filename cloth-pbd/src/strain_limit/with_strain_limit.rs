//! Strain limiting after every step of a method.

use super::{LimitReport, StrainLimiter};
use cloth_core::contact::ContactSource;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};

/// A method and a limiter, as one method.
///
/// The limiter changes positions and velocities between the steps. A method that keeps earlier states sees a
/// new start.
///
/// Contact takes part in the method's step; the displacements by the limits after it are truncated so that they cross
/// nothing. Where that truncates one, the outcome says that the limits were not met; the violation is still that
/// before. All else in the report, the work of prescribed vertices too, is that of the method alone.
pub struct WithStrainLimit {
    method: Box<dyn Stepper>,
    limiter: StrainLimiter,
    /// The state before the step, restored on an error.
    before: State,
    /// Positions (m) after the method's step.
    stepped: Vec<Vec3>,
    /// Positions (m) after the limits, before contact truncates them.
    limited: Vec<Vec3>,
    report: Option<LimitReport>,
}

impl WithStrainLimit {
    /// `method`, whose state is brought into the ranges of `limiter` after each step.
    #[must_use]
    pub fn new(method: Box<dyn Stepper>, limiter: StrainLimiter) -> Self {
        Self {
            method,
            limiter,
            before: State::default(),
            stepped: Vec::new(),
            limited: Vec::new(),
            report: None,
        }
    }

    /// The limiter's report of the last step, once there was one.
    #[must_use]
    pub fn last_report(&self) -> Option<LimitReport> {
        self.report
    }
}

impl std::fmt::Debug for WithStrainLimit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WithStrainLimit")
            .field("method", &self.method.name())
            .field("limiter", &self.limiter)
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

impl Stepper for WithStrainLimit {
    fn name(&self) -> &'static str {
        self.method.name()
    }

    fn preferred_substeps(&self) -> u32 {
        self.method.preferred_substeps()
    }

    /// The method's report, converged only if the limiter is too.
    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        copy(state, &mut self.before);
        let dt = input.dt;
        let mut contacts = input.contacts.take();
        let mut report = self
            .method
            .step(state, input.lend(contacts.as_deref_mut()))?;
        self.stepped.clone_from(&state.positions);
        let limited = self
            .limiter
            .apply(state, dt)
            .and_then(|limited| match contacts {
                Some(contacts) => self.keep_free(contacts, state, dt, limited),
                None => Ok(limited),
            });
        match limited {
            Ok(limited) => {
                if limited.outcome == Outcome::BudgetSpent {
                    report.outcome = Outcome::BudgetSpent;
                }
                self.report = Some(limited);
                Ok(report)
            }
            Err(error) => {
                copy(&self.before, state);
                Err(error)
            }
        }
    }
}

impl WithStrainLimit {
    /// Truncates the displacements by the limits, to `state`, so that they cross nothing.
    fn keep_free(
        &mut self,
        contacts: &mut dyn ContactSource,
        state: &mut State,
        dt: Real,
        report: LimitReport,
    ) -> Result<LimitReport, StepError> {
        if state.positions == self.stepped {
            return Ok(report);
        }
        self.limited.clone_from(&state.positions);
        let w = &self.limiter.inverse_mass;
        let kept = contacts.keep_free(&self.stepped, w, &mut state.positions);
        kept.map_err(|reason| StepError::Contact {
            reason,
            step: self.before.steps + 1,
        })?;
        let displaced = state.positions.iter().zip(&self.limited);
        let mut is_limited = true;
        for (v, (x, limited)) in state.velocities.iter_mut().zip(displaced) {
            is_limited &= x == limited;
            *v += (x - limited) / dt;
        }
        Ok(LimitReport {
            outcome: match is_limited {
                true => report.outcome,
                false => Outcome::BudgetSpent,
            },
            ..report
        })
    }
}

/// Copies without allocating.
fn copy(from: &State, to: &mut State) {
    to.positions.clone_from(&from.positions);
    to.velocities.clone_from(&from.velocities);
    (to.time, to.steps) = (from.time, from.steps);
}

//! A method whose every step is followed by strain limiting.

use super::{LimitReport, StrainLimiter};
use cloth_core::particles::State;
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};

/// Any method and a limiter, as one method.
///
/// The limiter changes positions and velocities behind the method's back. A method that remembers earlier states sees a new start.
pub struct Limited {
    method: Box<dyn Stepper>,
    limiter: StrainLimiter,
    /// The state before the step, to go back to.
    before: State,
    report: Option<LimitReport>,
}

impl Limited {
    /// `method`, whose state is brought into the ranges of `limiter` after each step.
    #[must_use]
    pub fn new(method: Box<dyn Stepper>, limiter: StrainLimiter) -> Self {
        Self {
            method,
            limiter,
            before: State::default(),
            report: None,
        }
    }

    /// What the limiter did in the last step, once there was one.
    #[must_use]
    pub fn limited(&self) -> Option<LimitReport> {
        self.report
    }
}

impl std::fmt::Debug for Limited {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Limited")
            .field("method", &self.method.name())
            .field("limiter", &self.limiter)
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

impl Stepper for Limited {
    fn name(&self) -> &'static str {
        self.method.name()
    }

    /// The method's report, converged only if the limiter is too.
    fn step(&mut self, state: &mut State, input: StepInput<'_>) -> Result<StepReport, StepError> {
        copy(state, &mut self.before);
        let dt = input.dt;
        let (alone, mut contact) = input.apart();
        let mut report = self.method.step(state, alone)?;
        let limited = self.limiter.apply(state, dt).and_then(|limited| {
            let (w, x, v) = (
                &self.limiter.inverse_mass,
                &mut state.positions,
                &mut state.velocities,
            );
            contact.resolve_contacts(&self.before, w, x, v)?;
            Ok(limited)
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

/// Into the memory that is there.
fn copy(from: &State, to: &mut State) {
    to.positions.clone_from(&from.positions);
    to.velocities.clone_from(&from.velocities);
    (to.time, to.steps) = (from.time, from.steps);
}

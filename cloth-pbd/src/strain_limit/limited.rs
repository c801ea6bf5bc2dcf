//! A method whose every step is followed by strain limiting.

use super::{LimitReport, StrainLimiter};
use cloth_core::contact::{ContactConstraints, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::step::{Outcome, StepError, StepInput, StepReport, Stepper};

/// Any method and a limiter, as one method.
///
/// The limiter changes positions and velocities behind the method's back. A method that remembers earlier states sees a new start.
///
/// Contact comes with the limits, not with the method: it has the last word in every pass over them, as in every sweep of position based dynamics.
pub struct Limited {
    method: Box<dyn Stepper>,
    limiter: StrainLimiter,
    /// The state before the step, to go back to.
    before: State,
    /// Where the method and the limits alone would take the cloth (m).
    alone: Vec<Vec3>,
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
            alone: Vec::new(),
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
        let limited =
            self.limiter
                .apply(state, dt)
                .and_then(|limited| match contact.contact_constraints() {
                    Some(contacts) => self.touch(contacts, state, dt, limited),
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

impl Limited {
    /// Contact in the step of `dt` (s) that has led to `state` without it, with the limits in turns until both hold.
    fn touch(
        &mut self,
        contacts: &mut dyn ContactConstraints,
        state: &mut State,
        dt: Real,
        mut report: LimitReport,
    ) -> Result<LimitReport, StepError> {
        let refused = |reason| StepError::Contact {
            reason,
            step: self.before.steps + 1,
        };
        let limiter = &mut self.limiter;
        self.alone.clone_from(&state.positions);
        let x = &mut limiter.x;
        x.copy_from_slice(&state.positions);
        let step = ContactStep {
            from: &self.before.positions,
            inverse_mass: &limiter.inverse_mass,
            dt,
        };
        contacts.begin_step(&step).map_err(refused)?;
        contacts.begin_substep(&step, x).map_err(refused)?;
        contacts.sweep(&step, x);
        if *x != self.alone {
            report.outcome = Outcome::BudgetSpent;
            while report.passes < limiter.max_passes && report.outcome == Outcome::BudgetSpent {
                report.passes += 1;
                report.violation = 0.0;
                for limits in &mut limiter.limits {
                    let violation = limits.pass(&limiter.inverse_mass, limiter.tolerance, x);
                    report.violation = report.violation.max(violation);
                }
                if report.violation <= limiter.tolerance {
                    report.outcome = Outcome::Converged;
                }
                contacts.sweep(&step, x);
            }
        }
        contacts.end_substep(&step, x).map_err(refused)?;
        let ways = limiter.x.iter().zip(&self.alone);
        for (v, (x, alone)) in state.velocities.iter_mut().zip(ways) {
            *v += (x - alone) / dt;
        }
        contacts.change_velocities(&mut state.velocities);
        state.positions.copy_from_slice(&limiter.x);
        contacts.end_step(&state.positions);
        Ok(report)
    }
}

/// Into the memory that is there.
fn copy(from: &State, to: &mut State) {
    to.positions.clone_from(&from.positions);
    to.velocities.clone_from(&from.velocities);
    (to.time, to.steps) = (from.time, from.steps);
}

//! Contact in the substeps of the direct solver: last, on what the system has found.

use cloth_core::contact::{ContactError, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::step::{StepError, StepInput};

/// Sweeps over the contacts of a substep. Nothing of the cloth comes between them.
const SWEEPS: u32 = 4;

/// Begins a step at `state`, if there are contact constraints.
pub(super) fn begin_step(
    input: &mut StepInput<'_>,
    inverse_mass: &[Real],
    state: &State,
) -> Result<(), StepError> {
    let step = ContactStep {
        from: &state.positions,
        inverse_mass,
        dt: input.dt,
    };
    let begun = input.contact_constraints().map(|c| c.begin_step(&step));
    begun.transpose().map_err(|reason| refused(reason, state))?;
    Ok(())
}

/// Projects `x` (m), to which the cloth would go in a substep from `state`, onto the contact constraints.
pub(super) fn project(
    input: &mut StepInput<'_>,
    inverse_mass: &[Real],
    state: &State,
    x: &mut [Vec3],
) -> Result<(), StepError> {
    let step = ContactStep {
        from: &state.positions,
        inverse_mass,
        dt: input.dt,
    };
    let Some(contacts) = input.contact_constraints() else {
        return Ok(());
    };
    let refused = |reason| refused(reason, state);
    contacts.begin_substep(&step, x).map_err(refused)?;
    for _ in 0..SWEEPS {
        contacts.sweep(&step, x);
    }
    contacts.end_substep(&step, x).map_err(refused)
}

/// `state` is where the step, or a substep of it, begins.
fn refused(reason: ContactError, state: &State) -> StepError {
    let step = state.steps + 1;
    match reason {
        ContactError::NonFinite { vertex } => StepError::NonFinite { vertex, step },
        reason => StepError::Contact { reason, step },
    }
}

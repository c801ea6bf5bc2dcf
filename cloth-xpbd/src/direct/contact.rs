//! Contact constraints in the substeps of the direct solver, swept after its linear system.

use cloth_core::contact::{ContactError, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::step::{StepError, StepInput};

/// Sweeps over the contact constraints of a substep.
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
    begun
        .transpose()
        .map_err(|reason| contact_error(reason, state))?;
    Ok(())
}

/// Projects the positions `x` (m) at the end of a substep from `state` onto the contact constraints.
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
    let error = |reason| contact_error(reason, state);
    contacts.begin_substep(&step, x).map_err(error)?;
    for _ in 0..SWEEPS {
        contacts.sweep(&step, x);
    }
    contacts.end_substep(&step, x).map_err(error)
}

/// The error of a step that begins, as a whole or in a substep, at `state`.
fn contact_error(reason: ContactError, state: &State) -> StepError {
    let step = state.steps + 1;
    match reason {
        ContactError::NonFinite { vertex } => StepError::NonFinite { vertex, step },
        reason => StepError::Contact { reason, step },
    }
}

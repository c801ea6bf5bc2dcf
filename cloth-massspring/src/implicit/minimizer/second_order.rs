//! Second-order correction of a direction that contact would cut short
//! ([`ContactHessian::correct`](cloth_core::method::contact_hessian::ContactHessian::correct)).

use super::{Contact, Minimizer, QuasiNewton, Task};
use cloth_core::math::Real;
use cloth_core::step::StepError;

/// How many times farther a corrected direction has to lead.
const MIN_GAIN: Real = 2.0;

impl Minimizer {
    /// Corrects the direction, of which contact leaves `most` where `fraction` of it is trusted, if it then leads much
    /// farther. Returns how far; if it does not, nothing has changed.
    pub(super) fn correct(
        &mut self,
        method: &mut QuasiNewton,
        task: &Task<'_>,
        contact: &mut Contact<'_>,
        fraction: Real,
        most: Real,
    ) -> Result<Option<Real>, StepError> {
        let Some(source) = contact.as_deref() else {
            return Ok(None);
        };
        self.shortened.clone_from(&self.direction);
        let x = &self.current.positions;
        if !method.correct(source, x, fraction, &mut self.direction) {
            return Ok(None);
        }
        let farther = self.longest_step(task, contact, fraction)?;
        if farther >= MIN_GAIN * most {
            return Ok(Some(farther));
        }
        std::mem::swap(&mut self.shortened, &mut self.direction);
        self.longest_step(task, contact, fraction)?;
        Ok(None)
    }
}

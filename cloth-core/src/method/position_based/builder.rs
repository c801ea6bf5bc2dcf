//! What the builders of position-based solvers share: constraints collected before the order of the sweeps is known.

use super::{Acceleration, ConstraintUpdate, Families, Sweep};
use crate::cloth::{ConstraintVisitor, Elements};
use crate::element::Constraint;
use crate::error::at_least_one;
use crate::step::BuildError;
use std::fmt;

/// Adds one family once the order of the sweep is known.
type Plan<U> = Box<dyn FnOnce(&mut Families<U>) -> Result<(), BuildError> + Send + Sync>;

/// Families of constraints to be built once the settings are known. What is wrong with one is said then.
pub struct FamilyPlans<U: ConstraintUpdate> {
    plans: Result<Vec<Plan<U>>, BuildError>,
}

impl<U: ConstraintUpdate> FamilyPlans<U> {
    /// Adds a family. A sweep visits the families in the order in which they were added.
    pub fn add<const N: usize, E: Constraint<N>>(&mut self, elements: Vec<E>) {
        if let Ok(plans) = &mut self.plans {
            plans.push(Box::new(move |families| families.add(&elements)));
        }
    }

    /// Adds families of a cloth.
    pub fn add_elements(&mut self, families: Vec<Elements>) {
        for family in families {
            let added = family.as_constraints(&mut *self);
            if let (Err(error), Ok(_)) = (added, &self.plans) {
                self.plans = Err(error);
            }
        }
    }

    /// The families, on `vertex_count` vertices.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for an acceleration out of range; [`BuildError::UnsupportedElements`] for elements
    /// that are no constraints; [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a
    /// vertex that does not exist, or one twice; [`BuildError::InvalidElement`] for a number of one.
    pub fn build(
        self,
        vertex_count: usize,
        sweep: Sweep,
        acceleration: Acceleration,
    ) -> Result<Families<U>, BuildError> {
        let mut families = Families::new(vertex_count, sweep, acceleration)?;
        for plan in self.plans? {
            plan(&mut families)?;
        }
        Ok(families)
    }
}

impl<U: ConstraintUpdate> ConstraintVisitor for &mut FamilyPlans<U> {
    type Output = ();

    fn visit<const N: usize, E: Constraint<N>>(self, elements: Vec<E>) {
        self.add(elements);
    }
}

impl<U: ConstraintUpdate> Default for FamilyPlans<U> {
    fn default() -> Self {
        Self {
            plans: Ok(Vec::new()),
        }
    }
}

impl<U: ConstraintUpdate> fmt::Debug for FamilyPlans<U> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.plans.as_ref().map(Vec::len);
        f.debug_struct("FamilyPlans")
            .field("families", &count)
            .finish()
    }
}

/// Checks how often a step is cut, and how often the constraints are swept in each part.
///
/// # Errors
/// [`BuildError::OutOfRange`] if one of the two is zero.
pub fn check_counts(iterations: u32, substeps: u32) -> Result<(), BuildError> {
    at_least_one("the number of iterations", iterations)?;
    at_least_one("the number of substeps", substeps)?;
    Ok(())
}

//! The builder of the solver.

use super::PbdSolver;
use crate::config::PbdConfig;
use crate::stiffness::Projection;
use cloth_core::cloth::Elements;
use cloth_core::element::Constraint;
use cloth_core::method::position_based::{FamilyPlans, Motion, check_counts};
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Collects particles, elements and settings of a [`PbdSolver`].
#[derive(Debug)]
pub struct PbdBuilder {
    motion: Motion,
    families: FamilyPlans<Projection>,
    config: PbdConfig,
}

impl PbdBuilder {
    pub(super) fn new(particles: &Particles) -> Self {
        Self {
            motion: Motion::new(particles),
            families: FamilyPlans::default(),
            config: PbdConfig::default(),
        }
    }

    /// Adds a family of constraints. A sweep visits the families in the order in which they were added.
    #[must_use]
    pub fn energy<const N: usize, E: Constraint<N>>(mut self, elements: Vec<E>) -> Self {
        if E::IS_IN_ELEMENTS {
            return self.elements(vec![E::into_elements(elements)]);
        }
        self.families.add(elements);
        self
    }

    /// Adds all elements of a cloth, as [`ClothModel::families`](cloth_core::ClothModel::families) has them.
    #[must_use]
    pub fn elements(mut self, families: Vec<Elements>) -> Self {
        self.families.add_elements(families);
        self
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: PbdConfig) -> Self {
        self.config = config;
        self
    }

    /// The solver.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for a setting outside its range; [`BuildError::UnsupportedElements`] for elements
    /// that are no constraints; [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a
    /// vertex that the particles do not have, or one twice; [`BuildError::InvalidElement`] for a number of one.
    pub fn build(self) -> Result<PbdSolver, BuildError> {
        let (motion, config) = (self.motion, self.config);
        check_counts(config.iterations, config.substeps)?;
        config.stiffness.check()?;
        let vertex_count = motion.vertex_count();
        let families = self
            .families
            .build(vertex_count, config.sweep, config.acceleration)?;
        Ok(PbdSolver {
            motion,
            families,
            hierarchy: None,
            config,
            substep: None,
        })
    }
}

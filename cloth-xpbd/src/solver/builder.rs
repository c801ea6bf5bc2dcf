//! The builder of the solver.

use super::XpbdSolver;
use crate::config::XpbdConfig;
use crate::refinement::Refinement;
use crate::update::XpbdUpdate;
use cloth_core::cloth::Elements;
use cloth_core::element::Constraint;
use cloth_core::error::{not_negative, positive};
use cloth_core::math::Vec3;
use cloth_core::method::position_based::{FamilyPlans, Motion, check_counts};
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Collects particles, elements and settings of a [`XpbdSolver`].
#[derive(Debug)]
pub struct XpbdBuilder {
    motion: Motion,
    families: FamilyPlans<XpbdUpdate>,
    config: XpbdConfig,
}

impl XpbdBuilder {
    pub(super) fn new(particles: &Particles) -> Self {
        Self {
            motion: Motion::new(particles),
            families: FamilyPlans::default(),
            config: XpbdConfig::default(),
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
    pub fn config(mut self, config: XpbdConfig) -> Self {
        self.config = config;
        self
    }

    /// The solver.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`]; [`BuildError::NoSuchView`] for elements that are no constraints;
    /// [`BuildError::NoSuchVertex`] if an element names a vertex that the particles do not have.
    ///
    /// # Panics
    /// If an element of a coloured sweep names a vertex twice.
    pub fn build(self) -> Result<XpbdSolver, BuildError> {
        let (motion, config) = (self.motion, self.config);
        check_counts(config.iterations, config.substeps)?;
        not_negative("the damping", config.damping)?;
        if let Some(gain) = config.energy_gain {
            positive("the energy gain", gain)?;
        }
        let vertex_count = motion.vertex_count();
        let families = self
            .families
            .build(vertex_count, config.sweep, config.acceleration)?;
        let damped = if config.damping > 0.0 {
            vertex_count
        } else {
            0
        };
        Ok(XpbdSolver {
            start: vec![Vec3::zeros(); damped],
            prescribed_offsets: Vec::new(),
            motion,
            families,
            refinement: config.energy_gain.map(Refinement::new),
            config,
            last: None,
            prepared: None,
        })
    }
}

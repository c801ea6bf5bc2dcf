//! The builder of the direct solver.

use super::config::DirectConfig;
use super::kkt::{Kkt, KktVector};
use super::linear::Solver;
use super::merit::Merit;
use super::rows::{RowFamily, Rows, family};
use super::solver::DirectXpbd;
use cloth_core::cloth::{ConstraintVisitor, Elements};
use cloth_core::element::Constraint;
use cloth_core::error::{at_least_one, not_negative};
use cloth_core::math::Vec3;
use cloth_core::method::block_matrix::{BlockMatrix, PatternBuilder};
use cloth_core::method::position_based::check_counts;
use cloth_core::particles::{Particles, State};
use cloth_core::step::BuildError;

/// Collects particles, elements and settings of a [`DirectXpbd`].
#[derive(Debug)]
pub struct DirectBuilder {
    particles: Particles,
    families: Result<Vec<Box<dyn RowFamily>>, BuildError>,
    config: DirectConfig,
}

/// Makes elements of one kind a family.
struct Family {
    vertex_count: usize,
}

impl ConstraintVisitor for Family {
    type Output = Result<Box<dyn RowFamily>, BuildError>;

    fn visit<const N: usize, E: Constraint<N>>(self, elements: Vec<E>) -> Self::Output {
        family(elements, self.vertex_count)
    }
}

impl DirectBuilder {
    pub(super) fn new(particles: &Particles) -> Self {
        Self {
            particles: particles.clone(),
            families: Ok(Vec::new()),
            config: DirectConfig::default(),
        }
    }

    /// Adds a family of constraints.
    #[must_use]
    pub fn energy<const N: usize, E: Constraint<N>>(mut self, elements: Vec<E>) -> Self {
        if E::IS_IN_ELEMENTS {
            return self.elements(vec![E::into_elements(elements)]);
        }
        let vertex_count = self.particles.len();
        self.families = self.families.and_then(|mut families| {
            let number = families.len();
            let added = family(elements, vertex_count);
            families.push(added.map_err(|error| error.in_family(number))?);
            Ok(families)
        });
        self
    }

    /// Adds all elements of a cloth, as [`ClothModel::families`](cloth_core::ClothModel::families) has them.
    #[must_use]
    pub fn elements(mut self, families: Vec<Elements>) -> Self {
        for family in families {
            let into = Family {
                vertex_count: self.particles.len(),
            };
            self.families = self.families.and_then(|mut families| {
                let number = families.len();
                let added = family.as_constraints(into)?;
                families.push(added.map_err(|error| error.in_family(number))?);
                Ok(families)
            });
        }
        self
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: DirectConfig) -> Self {
        self.config = config;
        self
    }

    /// The solver; the sparsity pattern is built and analysed here, once.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`]; [`BuildError::UnsupportedElements`] for elements that are no constraints;
    /// [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a vertex that the particles
    /// do not have, or one twice; [`BuildError::InvalidElement`] for a number of one; [`BuildError::MatrixTooLarge`].
    pub fn build(self) -> Result<DirectXpbd, BuildError> {
        let config = self.config;
        check_counts(config.max_iterations, config.substeps)?;
        not_negative("the tolerance", config.tolerance)?;
        not_negative("the damping", config.damping)?;
        not_negative("the Krylov tolerance", config.krylov_tolerance)?;
        at_least_one("the number of Krylov iterations", config.max_krylov)?;
        let mut families = self.families?;
        let vertex_count = self.particles.len();
        let mut pattern = PatternBuilder::new(vertex_count);
        let mut rows = Rows::default();
        rows.offsets.push(0);
        for family in &families {
            family.append(&mut rows);
            if config.geometric_stiffness && !config.system.is_dual() {
                family.add_pattern(&mut pattern);
            }
        }
        let pattern = pattern.build();
        if config.geometric_stiffness && !config.system.is_dual() {
            for family in &mut families {
                family.bind(&pattern);
            }
        }
        let w = self.particles.inverse_mass();
        let kkt = Kkt::new(&rows, w, BlockMatrix::zeros(pattern));
        let solver = Solver::new(&kkt, &config).map_err(|_| BuildError::MatrixTooLarge)?;
        let masses = self.particles.mass().iter().zip(w);
        let mass = masses.map(|(m, w)| if *w == 0.0 { 0.0 } else { *m });
        let pair = || KktVector::zeros(vertex_count, rows.len());
        let zeros = || vec![Vec3::zeros(); vertex_count];
        Ok(DirectXpbd {
            mass: mass.collect(),
            particles: self.particles,
            config,
            families,
            merit: Merit::new(rows.len()),
            start_value: vec![0.0; rows.len()],
            multipliers: vec![0.0; rows.len()],
            trial_multipliers: vec![0.0; rows.len()],
            scaled_compliance: vec![0.0; rows.len()],
            right: pair(),
            change: pair(),
            correction: pair(),
            predicted: zeros(),
            positions: zeros(),
            direction: zeros(),
            trial: zeros(),
            current: State::at_rest(zeros()),
            last: None,
            residuals: Default::default(),
            solver,
            kkt,
            rows,
        })
    }
}

//! The builder of the solver: elements, coarse grid and settings, checked and assembled.

use super::end::PieceNorms;
use super::start::Before;
use super::{Method, PdSolver};
use crate::chebyshev::Chebyshev;
use crate::coarse::CoarseGrid;
use crate::config::{Acceleration, PdConfig};
use crate::global::GlobalSystem;
use crate::local::{Family, Projections};
use crate::matrix::negligible;
use crate::objective::{Objective, Point};
use crate::quasi_newton::QuasiNewton;
use cloth_core::cloth::{Elements, ProjectiveVisitor};
use cloth_core::contact::FadingTruncation;
use cloth_core::element::Projective;
use cloth_core::error::within;
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Collects what a [`PdSolver`] is built of.
#[derive(Debug)]
pub struct PdBuilder {
    particles: Particles,
    families: Result<Vec<Box<dyn Projections>>, BuildError>,
    coarse: Option<(Vec<Vec3>, u32)>,
    config: PdConfig,
}

/// A builder that elements are being added to.
struct Adding<'a>(&'a mut PdBuilder);

impl ProjectiveVisitor for Adding<'_> {
    type Output = ();

    fn visit<const N: usize, const K: usize, E: Projective<N, K>>(self, elements: Vec<E>) {
        self.0.add(elements);
    }
}

impl PdBuilder {
    pub(super) fn new(particles: &Particles) -> Self {
        Self {
            particles: particles.clone(),
            families: Ok(Vec::new()),
            coarse: None,
            config: PdConfig::default(),
        }
    }

    /// Adds a family of elements. Those without weight are left out.
    ///
    /// # Example
    /// An element of one's own ([crate page](crate#add-an-element)):
    /// ```
    /// use cloth_pd::cloth_core::element::{Element, Projective};
    /// use cloth_pd::cloth_core::math::Mat3;
    /// use cloth_pd::{Particles, PdSolver, State, StepInput, Stepper, Vec3};
    ///
    /// /// Pulls a vertex to a plane through the origin: `E = ½ w (n·x)²` (J).
    /// #[derive(Clone, Copy, Debug)]
    /// struct NearPlane { vertex: u32, normal: Vec3, stiffness: f64 }
    ///
    /// impl Element<1> for NearPlane {
    ///     fn vertices(&self) -> [u32; 1] {
    ///         [self.vertex]
    ///     }
    /// }
    ///
    /// impl Projective<1, 1> for NearPlane {
    ///     fn operator(&self) -> [[f64; 1]; 1] {
    ///         [[1.0]] // z = x
    ///     }
    ///     fn weight(&self) -> f64 {
    ///         self.stiffness
    ///     }
    ///     fn project(&self, [z]: [Vec3; 1]) -> [Vec3; 1] {
    ///         [z - self.normal * self.normal.dot(&z)]
    ///     }
    ///     fn projected_hessian(&self, _: [Vec3; 1]) -> [[Mat3; 1]; 1] {
    ///         [[self.normal * self.normal.transpose()]] // I − ∂p/∂z
    ///     }
    /// }
    ///
    /// let plane = NearPlane { vertex: 0, normal: Vec3::y(), stiffness: 50.0 };
    /// let particles = Particles::new(vec![0.5])?;
    /// let mut solver = PdSolver::builder(&particles).energy(vec![plane]).build()?;
    /// let mut state = State::at_rest(vec![Vec3::new(0.3, 0.2, 0.0)]);
    /// solver.step(&mut state, StepInput::new(0.1))?;
    /// // Implicit Euler in closed form: y/(1 + w Δt²/m).
    /// assert!((state.positions[0] - Vec3::new(0.3, 0.1, 0.0)).norm() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn energy<const N: usize, const K: usize, E: Projective<N, K>>(
        mut self,
        elements: Vec<E>,
    ) -> Self {
        if E::IS_IN_ELEMENTS {
            return self.elements(vec![E::into_elements(elements)]);
        }
        self.add(elements);
        self
    }

    /// Adds all elements of a cloth, as [`ClothModel::families`](cloth_core::ClothModel::families) has them.
    #[must_use]
    pub fn elements(mut self, families: Vec<Elements>) -> Self {
        for family in families {
            let added = family.as_projections(Adding(&mut self));
            if let (Err(error), Ok(_)) = (added, &self.families) {
                self.families = Err(error);
            }
        }
        self
    }

    fn add<const N: usize, const K: usize, E: Projective<N, K>>(&mut self, elements: Vec<E>) {
        if let Ok(families) = &mut self.families {
            match Family::new(elements, &self.particles) {
                Ok(family) => families.push(Box::new(family)),
                Err(error) => self.families = Err(error.in_family(families.len())),
            }
        }
    }

    /// Lays a coarse grid over each connected piece of the cloth, of `cells` cubes along the longest side of the box
    /// around its rest positions (m). [`Acceleration::QuasiNewton`] takes a Newton step on it in every iteration, the other methods have no use
    /// for it. A few cells are enough, 12 for instance, whatever the resolution of the cloth; there are fewer where a
    /// node would have less than two vertices.
    #[must_use]
    pub fn coarse_grid(mut self, rest_positions: &[Vec3], cells: u32) -> Self {
        self.coarse = Some((rest_positions.to_vec(), cells));
        self
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: PdConfig) -> Self {
        self.config = config;
        self
    }

    /// The solver: assembles the matrix and analyses it. It is factorised in the first step, which tells the step size.
    ///
    /// # Errors
    /// [`BuildError::UnsupportedElements`] for elements that are no squared distances to sets;
    /// [`BuildError::OutOfRange`], also for a weight that is negative or not finite, and for a coarse grid of no or too
    /// many cells or of positions that are not one finite position per vertex; [`BuildError::NoSuchVertex`] or
    /// [`BuildError::RepeatedVertex`] if an element names a vertex that the particles do not have, or one twice;
    /// [`BuildError::InvalidElement`] for a number of one; [`BuildError::MatrixTooLarge`].
    pub fn build(self) -> Result<PdSolver, BuildError> {
        self.config.check()?;
        let families = self.families?;
        let too_large = |_| BuildError::MatrixTooLarge;
        let vertex_count = self.particles.len();
        let is_left_out = match self.config.acceleration {
            // Its matrix is only the initial inverse Hessian.
            Acceleration::QuasiNewton { .. } => negligible(vertex_count, &families),
            _ => vec![false; families.len()],
        };
        let global = GlobalSystem::new(&self.particles, &families, is_left_out);
        let global = global.map_err(too_large)?;
        let zeros = vec![Vec3::zeros(); vertex_count];
        let mut objective = Objective::new(self.particles, families);
        let free_components = objective.free_components(global.stiffness());
        objective.pieces = free_components.pieces().clone();
        let method = match self.config.acceleration {
            Acceleration::None => Method::Plain {
                increment: zeros.clone(),
            },
            Acceleration::Chebyshev { spectral_radius } => {
                Method::Chebyshev(Box::new(Chebyshev::new(spectral_radius, vertex_count)))
            }
            Acceleration::QuasiNewton { history } => Method::QuasiNewton(Box::new(
                QuasiNewton::new(history as usize, &objective.pieces),
            )),
        };
        let (particles, families) = (&objective.particles, &mut objective.families);
        let coarse = match (&method, &self.coarse) {
            (Method::QuasiNewton(_), Some((rest, cells))) => {
                check_coarse(rest, *cells, vertex_count)?;
                Some(CoarseGrid::new(
                    rest,
                    *cells,
                    particles,
                    &global,
                    &free_components,
                    families,
                ))
            }
            _ => None,
        };
        Ok(PdSolver {
            free_components,
            config: self.config,
            objective,
            global,
            lattice: coarse.as_ref().and(self.coarse),
            coarse,
            is_stale: false,
            are_attachments_stale: false,
            method,
            contact_method: None,
            point: Point::new(vertex_count),
            fallback: Point::new(vertex_count),
            feasible: zeros.clone(),
            truncation: FadingTruncation::default(),
            velocities: zeros,
            before: Before::default(),
            norms: PieceNorms::default(),
        })
    }
}

/// Finer grids than this cost more to factorise than they save.
const MAX_CELLS: u32 = 1000;

fn check_coarse(rest: &[Vec3], cells: u32, vertex_count: usize) -> Result<(), BuildError> {
    let (is_right, value) = ((1..=MAX_CELLS).contains(&cells), Real::from(cells));
    within(is_right, "coarse cells", value, "between 1 and 1000")?;
    let (is_right, count) = (rest.len() == vertex_count, rest.len() as Real);
    within(
        is_right,
        "the number of rest positions",
        count,
        "one per vertex",
    )?;
    match rest.iter().find(|x| !is_finite(x)) {
        Some(x) => Ok(within(false, "a rest position", x.sum(), "finite").map(drop)?),
        None => Ok(()),
    }
}

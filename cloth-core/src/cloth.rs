//! One description of a cloth in SI units, from which every method gets its constants.

mod elements;

pub use elements::Elements;

use crate::energy::{CurvatureHinge, Spring};
use crate::family::Energies;
use crate::math::Real;
use crate::mesh::{MeshError, TriMesh};
use crate::particles::{ParticleError, Particles};
use crate::step::BuildError;
use crate::topology::{EdgeTable, HingeTable};
use std::fmt;

/// How the cloth resists being stretched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Membrane {
    /// The same spring stiffness k (N/m) on every edge. What modulus that makes depends on the pattern of the mesh (VALIDATION 3).
    SpringStiffness(Real),
    /// Membrane modulus Y (N/m): Young's modulus times thickness.
    ///
    /// Every edge gets `k = 3 Y A/Σ n L²`, with A the area of the mesh and n half the number of triangles at an edge (1 inside, ½ on the rim);
    /// rim edges get half of it. Then the springs, averaged over all directions, make an isotropic sheet of modulus Y and Poisson's ratio 1/3.
    /// For the equilateral lattice (`Y = 2k/√3`) and the alternating grid (`Y = 4k/3`) it is exact in every direction.
    Modulus(Real),
}

/// A cloth, stated once: the same numbers mean the same cloth in every method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cloth {
    /// Mass per area (kg/m²).
    pub areal_density: Real,
    /// Resistance to stretching.
    pub membrane: Membrane,
    /// Bending rigidity D (N·m). With 0 nothing is built for bending.
    pub bending_rigidity: Real,
}

/// A cloth cut to a mesh: masses and elements, ready for any solver.
#[derive(Clone, Debug, PartialEq)]
pub struct ClothModel {
    /// Masses; pin vertices here before building a solver.
    pub particles: Particles,
    /// Structural springs, one per edge.
    pub springs: Vec<Spring>,
    /// Bending elements, one per inner edge; none if the rigidity is 0.
    pub hinges: Vec<CurvatureHinge>,
}

impl Cloth {
    /// Masses and elements of this cloth on a mesh at rest.
    ///
    /// # Errors
    /// [`ClothError`] if a number is out of range or an edge of the mesh is not manifold.
    pub fn on(&self, mesh: &TriMesh) -> Result<ClothModel, ClothError> {
        let particles = Particles::from_areal_density(mesh, self.areal_density)?;
        let edges = EdgeTable::build(mesh)?;
        let springs = self.membrane.springs(mesh, &edges)?;
        if !(self.bending_rigidity >= 0.0 && self.bending_rigidity.is_finite()) {
            return Err(ClothError::OutOfRange {
                name: "bending rigidity",
                value: self.bending_rigidity,
                unit: "N·m",
            });
        }
        let hinges = if self.bending_rigidity > 0.0 {
            CurvatureHinge::across(
                mesh,
                &HingeTable::build(mesh, &edges),
                self.bending_rigidity,
            )
        } else {
            Vec::new()
        };
        Ok(ClothModel {
            particles,
            springs,
            hinges,
        })
    }
}

impl Membrane {
    /// One spring per edge.
    fn springs(self, mesh: &TriMesh, edges: &EdgeTable) -> Result<Vec<Spring>, ClothError> {
        let (name, value) = match self {
            Self::SpringStiffness(k) => ("spring stiffness", k),
            Self::Modulus(y) => ("membrane modulus", y),
        };
        if !(value >= 0.0 && value.is_finite()) {
            return Err(ClothError::OutOfRange {
                name,
                value,
                unit: "N/m",
            });
        }
        let mut springs = Spring::along(mesh.positions(), edges.ends(), value);
        if let Self::Modulus(y) = self {
            let share = |edge: usize| if edges.is_boundary(edge) { 0.5 } else { 1.0 };
            let square = |(edge, s): (usize, &Spring)| share(edge) * s.rest_length * s.rest_length;
            let squares: Real = springs.iter().enumerate().map(square).sum();
            let stiffness = 3.0 * y * mesh.area() / squares;
            for (edge, spring) in springs.iter_mut().enumerate() {
                spring.stiffness = share(edge) * stiffness;
            }
        }
        Ok(springs)
    }
}

impl ClothModel {
    /// The elastic energy.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] if an element was changed to name a vertex that does not exist.
    pub fn energies(&self) -> Result<Energies, BuildError> {
        Energies::new(self.particles.len())
            .with(self.springs.clone())?
            .with(self.hinges.clone())
    }
}

/// Why a cloth could not be cut to a mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ClothError {
    /// The mesh does not serve.
    Mesh(MeshError),
    /// The density does not serve.
    Particles(ParticleError),
    /// A number of the description is negative or not finite.
    OutOfRange {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: Real,
        /// Its unit.
        unit: &'static str,
    },
}

impl fmt::Display for ClothError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(error) => error.fmt(f),
            Self::Particles(error) => error.fmt(f),
            Self::OutOfRange { name, value, unit } => write!(
                f,
                "the {name} is {value} {unit}, but it has to be zero or a positive finite number"
            ),
        }
    }
}

impl std::error::Error for ClothError {}

impl From<MeshError> for ClothError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

impl From<ParticleError> for ClothError {
    fn from(error: ParticleError) -> Self {
        Self::Particles(error)
    }
}

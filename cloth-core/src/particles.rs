//! Masses, and what moves: positions and velocities.

use crate::math::{Real, Vec3};
use crate::mesh::TriMesh;
use std::fmt;
use std::sync::Arc;

/// Lumped masses (kg) and their inverses (1/kg), both of length `V`, the diagonal of the mass matrix `M`.
///
/// Linear triangles of areal density ρ (kg/m²) have the consistent mass matrix `∫ ρ φᵢ φⱼ`, with φᵢ linear on each
/// triangle, 1 at vertex i and 0 at all others. A triangle of area A adds `ρA/6` to it for each corner and `ρA/12` for
/// each pair of corners. *Lumped* means that each row is summed onto the diagonal: `ρA/6 + 2ρA/12 = ρA/3` for each
/// corner. Total mass and centre of mass stay the same. `M⁻¹` is then one number per vertex: explicit and
/// position-based methods need that, as they move vertices without solving for all of them. The price is an error of
/// second order in the edge length, of the moments of inertia for instance.
///
/// A vertex with inverse mass 0 is *prescribed* (pinned): no force moves it. It travels with
/// its own velocity, which the caller sets: zero holds it still, and [`crate::pin::Pins`] makes it
/// follow a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Particles {
    mass: Vec<Real>,
    inverse_mass: Vec<Real>,
    rest_positions: Option<Arc<[Vec3]>>,
}

impl Particles {
    /// Particles of given masses (kg), none prescribed.
    ///
    /// # Errors
    /// [`ParticleError::InvalidMass`] if a mass is not a positive finite number.
    pub fn new(mass: Vec<Real>) -> Result<Self, ParticleError> {
        if let Some(vertex) = mass
            .iter()
            .position(|&m| !(m > 0.0 && (1.0 / m).is_finite() && m.is_finite()))
        {
            return Err(ParticleError::InvalidMass {
                vertex,
                mass: mass[vertex],
            });
        }
        let inverse_mass = mass.iter().map(|m| 1.0 / m).collect();
        Ok(Self {
            mass,
            inverse_mass,
            rest_positions: None,
        })
    }

    /// The same particles with the positions (m) at which they are at rest. Methods with coarse levels lay them out by
    /// these; without, by the positions of the first step.
    ///
    /// # Panics
    /// If there is not one finite position per vertex.
    #[must_use]
    pub fn resting_at(mut self, positions: &[Vec3]) -> Self {
        assert_eq!(positions.len(), self.len(), "one rest position per vertex");
        assert!(
            positions.iter().all(crate::math::is_finite),
            "rest positions have to be finite"
        );
        self.rest_positions = Some(positions.into());
        self
    }

    /// Positions at rest (m), if they are known; those of the mesh for particles made from one.
    #[must_use]
    pub fn rest_positions(&self) -> Option<&[Vec3]> {
        self.rest_positions.as_deref()
    }

    /// A third of each triangle's mass to each of its corners, the sum of a row of its consistent mass matrix;
    /// `density` in kg/m².
    ///
    /// # Errors
    /// [`ParticleError::InvalidDensity`] if the density is not a positive finite number, [`ParticleError::InvalidMass`]
    /// if it makes a mass too small to be inverted.
    pub fn from_areal_density(mesh: &TriMesh, density: Real) -> Result<Self, ParticleError> {
        Self::check_density(density)?;
        let mut mass = vec![0.0; mesh.vertex_count()];
        for (triangle, area) in mesh.triangles().iter().zip(mesh.areas()) {
            for &vertex in triangle {
                mass[vertex as usize] += density * area / 3.0;
            }
        }
        Ok(Self::new(mass)?.resting_at(mesh.positions()))
    }

    pub(crate) fn check_density(density: Real) -> Result<(), ParticleError> {
        if density > 0.0 && density.is_finite() {
            Ok(())
        } else {
            Err(ParticleError::InvalidDensity { density })
        }
    }

    /// Replaces the mass (kg) of one vertex. A prescribed vertex stays prescribed.
    ///
    /// # Errors
    /// [`ParticleError::InvalidMass`], [`ParticleError::NoSuchVertex`].
    pub fn set_mass(&mut self, vertex: usize, mass: Real) -> Result<(), ParticleError> {
        self.require(vertex)?;
        if !(mass > 0.0 && (1.0 / mass).is_finite() && mass.is_finite()) {
            return Err(ParticleError::InvalidMass { vertex, mass });
        }
        self.mass[vertex] = mass;
        if self.inverse_mass[vertex] != 0.0 {
            self.inverse_mass[vertex] = 1.0 / mass;
        }
        Ok(())
    }

    /// Gives a vertex infinite mass: it moves with its own velocity whatever the forces.
    ///
    /// # Errors
    /// [`ParticleError::NoSuchVertex`].
    pub fn prescribe(&mut self, vertex: usize) -> Result<(), ParticleError> {
        self.require(vertex)?;
        self.inverse_mass[vertex] = 0.0;
        Ok(())
    }

    /// Takes the infinite mass away again.
    ///
    /// # Errors
    /// [`ParticleError::NoSuchVertex`].
    pub fn release(&mut self, vertex: usize) -> Result<(), ParticleError> {
        self.require(vertex)?;
        self.inverse_mass[vertex] = 1.0 / self.mass[vertex];
        Ok(())
    }

    fn require(&self, vertex: usize) -> Result<(), ParticleError> {
        if vertex < self.mass.len() {
            Ok(())
        } else {
            Err(ParticleError::NoSuchVertex {
                vertex,
                vertex_count: self.mass.len(),
            })
        }
    }

    /// Number of vertices V.
    #[must_use]
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Whether there is no vertex at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Lumped masses (kg), one per vertex; a prescribed vertex keeps its own.
    #[must_use]
    pub fn mass(&self) -> &[Real] {
        &self.mass
    }

    /// Inverse masses (1/kg), one per vertex; 0 for a prescribed one.
    #[must_use]
    pub fn inverse_mass(&self) -> &[Real] {
        &self.inverse_mass
    }

    /// Whether the vertex is prescribed.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[must_use]
    pub fn is_prescribed(&self, vertex: usize) -> bool {
        self.inverse_mass[vertex] == 0.0
    }

    /// Number of vertices that forces can move.
    #[must_use]
    pub fn free_count(&self) -> usize {
        self.inverse_mass.iter().filter(|&&w| w != 0.0).count()
    }
}

/// What moves: positions (m) and velocities (m/s), both of length `V`, the time (s) and the number of
/// steps taken.
///
/// The positions need not be those of the mesh: the mesh is the rest shape, and cloth may start from any pose, as long
/// as it does not pass through itself where contact counts.
///
/// To save a run, keep these four; to resume it, build the solver anew from the same particles and elements and go on
/// from them. What a solver keeps beside the state is where its iteration starts: implicit Euler by default, and PD in
/// contact, which also knows what held its free pieces up. That changes a step within the tolerance at which the
/// iteration ends, in contact by millimetres where cloth slides or buckles; with `StartGuess::Previous` nothing is kept.
/// Two keep more: BDF2 of `cloth-massspring`, which starts again with one step of implicit Euler, and friction, which
/// forgets what sticks. Contacts that are built anew have to begin at
/// the time of the state, with bodies where they are; the order in which they find pairs is that of a new start, and
/// sweeps that end before they converge, as those of XPBD, leave something else after another order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Positions (m), one per vertex.
    pub positions: Vec<Vec3>,
    /// Velocities (m/s), one per vertex.
    pub velocities: Vec<Vec3>,
    /// Time (s) since the start.
    pub time: Real,
    /// Steps taken since the start.
    pub steps: u64,
}

impl State {
    /// The given positions (m), at rest, at time 0.
    #[must_use]
    pub fn at_rest(positions: Vec<Vec3>) -> Self {
        let velocities = vec![Vec3::zeros(); positions.len()];
        Self {
            positions,
            velocities,
            time: 0.0,
            steps: 0,
        }
    }

    /// The first vertex whose position or velocity is not finite.
    #[must_use]
    pub fn first_non_finite(&self) -> Option<usize> {
        first_non_finite(&self.positions, &self.velocities)
    }
}

/// The first vertex whose position or velocity is not finite.
pub(crate) fn first_non_finite(positions: &[Vec3], velocities: &[Vec3]) -> Option<usize> {
    let bad = |v: &Vec3| !crate::math::is_finite(v);
    let mut both = positions.iter().zip(velocities);
    both.position(|(x, v)| bad(x) || bad(v))
}

/// Why masses or pins were refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParticleError {
    /// A mass is zero, negative, not finite, or too small to be inverted.
    InvalidMass {
        /// The vertex.
        vertex: usize,
        /// Its mass (kg).
        mass: Real,
    },
    /// The areal density is zero, negative or not finite.
    InvalidDensity {
        /// The density (kg/m²).
        density: Real,
    },
    /// A vertex was named that does not exist.
    NoSuchVertex {
        /// The vertex.
        vertex: usize,
        /// How many there are.
        vertex_count: usize,
    },
    /// The step in which pins are to reach their paths is zero, negative or not finite.
    InvalidTimeStep {
        /// The step size (s).
        dt: Real,
    },
    /// A pin is nowhere, or so far from its path that no finite velocity takes it there.
    InvalidPath {
        /// The vertex.
        vertex: usize,
        /// When it would have to be there (s).
        time: Real,
    },
}

impl fmt::Display for ParticleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidMass { vertex, mass } => write!(
                f,
                "vertex {vertex} has mass {mass:e} kg, but a mass has to be above 0, finite, and not too small to be \
                 inverted; a vertex in no triangle, or in no piece of a cloth of pieces, has mass 0"
            ),
            Self::InvalidDensity { density } => write!(
                f,
                "the areal density is {density} kg/m², but it has to be a positive finite number"
            ),
            Self::NoSuchVertex {
                vertex,
                vertex_count,
            } => write!(
                f,
                "there is no vertex {vertex}: the cloth has {vertex_count} vertices, numbered from 0"
            ),
            Self::InvalidTimeStep { dt } => write!(
                f,
                "the time step is {dt} s, but it has to be a positive finite number"
            ),
            Self::InvalidPath { vertex, time } => write!(
                f,
                "no finite velocity takes pinned vertex {vertex} to where its path is at {time} s"
            ),
        }
    }
}

impl std::error::Error for ParticleError {}

//! Gas of constant pressure, as a load on the vertices around it.
//!
//! A gas of the gauge pressure p (Pa) does the work p dV on the surface around it, so the force on a vertex is p ∂V/∂x:
//! of each triangle around it p (b × c)/6 with its other two corners, which sums up to p A n/3. The forces of a closed
//! surface cancel, and have no torque.
//!
//! # Limits
//! - The pressure does not depend on the volume: a pump keeps it. What is sealed in is a
//!   [`ClosedVolume`](super::ClosedVolume).
//! - The force is that at the start of a step.

use super::EnclosureError;
use super::surface::ClosedSurface;
use crate::error::finite;
use crate::math::{Real, Vec3};
use crate::mesh::TriMesh;

/// Gas of constant pressure inside a closed piece of a mesh.
///
/// ```
/// use cloth_core::mesh::generate::sphere;
/// use cloth_core::math::Vec3;
/// use cloth_core::enclosure::Pressure;
///
/// let ball = sphere(4, 0.1)?; // m
/// let gas = Pressure::new(200.0, &ball)?; // Pa
/// let mut load = vec![Vec3::zeros(); ball.vertex_count()];
/// gas.add_load(ball.positions(), &mut load);
/// // Σ F·x = 3 p V
/// let virial: f64 = load.iter().zip(ball.positions()).map(|(f, x)| f.dot(x)).sum();
/// assert!((virial / (3.0 * 200.0 * gas.volume(ball.positions())) - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Pressure {
    /// p (Pa).
    pressure: Real,
    surface: ClosedSurface,
}

impl Pressure {
    /// Gas of a gauge pressure (Pa, below zero for a vacuum) inside `mesh`.
    ///
    /// # Errors
    /// [`EnclosureError`] for a pressure that is not finite, or a mesh that has a boundary or triangles that face
    /// different ways.
    pub fn new(pressure: Real, mesh: &TriMesh) -> Result<Self, EnclosureError> {
        Self::inside(pressure, mesh, 0..mesh.triangle_count())
    }

    /// The same inside the piece of the mesh that consists of these triangles.
    ///
    /// # Errors
    /// As [`Pressure::new`].
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn inside(
        pressure: Real,
        mesh: &TriMesh,
        triangles: impl IntoIterator<Item = usize>,
    ) -> Result<Self, EnclosureError> {
        finite("pressure (Pa)", pressure)?;
        let surface = ClosedSurface::of(mesh, triangles)?;
        Ok(Self { pressure, surface })
    }

    /// V (m³) with the vertices at `x` (m).
    #[must_use]
    pub fn volume(&self, x: &[Vec3]) -> Real {
        self.surface.volume(x)
    }

    /// `p R/2` (N/m), the tension of a sphere that has as large a surface as the piece with its vertices at `x` (m); 0
    /// for a vacuum.
    #[must_use]
    pub fn tension(&self, x: &[Vec3]) -> Real {
        0.5 * self.pressure.max(0.0) * self.surface.radius(x)
    }

    /// Adds the force (N) on each vertex at `x` (m) to `load`.
    ///
    /// # Panics
    /// If there are fewer vertices than in the mesh.
    pub fn add_load(&self, x: &[Vec3], load: &mut [Vec3]) {
        self.surface.add_gradient(x, self.pressure, load);
    }
}

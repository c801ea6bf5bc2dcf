//! Gas inside a closed mesh, as a load on its vertices.
//!
//! A gas of the gauge pressure p (Pa) does the work p dV on the surface around it. The volume is V = Σ a·(b × c)/6 over
//! its triangles, so the force on a vertex is p ∂V/∂x: of each triangle around it p (b × c)/6 with its other two
//! corners, which sums up to p A n/3. The forces of a closed surface cancel, and have no torque.
//!
//! # Limits
//! - The pressure does not depend on the volume: a pump keeps it. Of a sealed gas it would, and stiffly so.
//! - The force is that at the start of a step.

use crate::math::{Real, Vec3, gather};
use crate::mesh::{MeshError, TriMesh};
use crate::topology::EdgeTable;
use std::fmt;

/// Gas of constant pressure inside a closed piece of a mesh.
///
/// ```
/// use cloth_core::mesh::generate::sphere;
/// use cloth_core::math::Vec3;
/// use cloth_core::pressure::Pressure;
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
    /// Seen from outside counter-clockwise.
    triangles: Vec<[u32; 3]>,
}

impl Pressure {
    /// Gas of a gauge pressure (Pa, below zero for a vacuum) inside `mesh`.
    ///
    /// # Errors
    /// [`PressureError`] for a pressure that is not finite, or a mesh that has a border or triangles that face
    /// different ways.
    pub fn new(pressure: Real, mesh: &TriMesh) -> Result<Self, PressureError> {
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
    ) -> Result<Self, PressureError> {
        if !pressure.is_finite() {
            return Err(PressureError::NotFinite(pressure));
        }
        let triangles = triangles.into_iter().map(|t| mesh.triangles()[t]).collect();
        let piece = mesh.with_triangles(triangles);
        let edges = EdgeTable::build(&piece)?;
        let border = (0..edges.ends().len()).find(|&edge| edges.is_boundary(edge));
        if let Some(edge) = border {
            return Err(PressureError::Open(edges.ends()[edge]));
        }
        let mut gas = Self {
            pressure,
            triangles: piece.triangles().to_vec(),
        };
        let volume = gas.volume(mesh.positions());
        if let Some(ends) = gas.disagreement() {
            return Err(PressureError::Disagree(ends));
        }
        if volume < 0.0 {
            gas.triangles
                .iter_mut()
                .for_each(|corners| corners.reverse());
        }
        Ok(gas)
    }

    /// V (m³) with the vertices at `x` (m).
    #[must_use]
    pub fn volume(&self, x: &[Vec3]) -> Real {
        // About a point of the surface: far from the origin the sum would cancel.
        let middle = self
            .triangles
            .first()
            .map_or(Vec3::zeros(), |t| x[t[0] as usize]);
        let of = |&corners: &[u32; 3]| {
            let [a, b, c] = gather(x, corners).map(|x| x - middle);
            a.dot(&b.cross(&c)) / 6.0
        };
        self.triangles.iter().map(of).sum()
    }

    /// Adds the force (N) on each vertex at `x` (m) to `load`.
    ///
    /// # Panics
    /// If there are fewer vertices than in the mesh.
    pub fn add_load(&self, x: &[Vec3], load: &mut [Vec3]) {
        let sixth = self.pressure / 6.0;
        for &corners in &self.triangles {
            let [a, b, c] = gather(x, corners);
            let third = (b - a).cross(&(c - a)) * sixth;
            for vertex in corners {
                load[vertex as usize] += third;
            }
        }
    }

    /// An edge along which both its triangles run the same way, if there is one.
    fn disagreement(&self) -> Option<[u32; 2]> {
        let along = self.triangles.iter();
        let mut along: Vec<[u32; 2]> = along
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .collect();
        along.sort_unstable();
        along
            .windows(2)
            .find(|pair| pair[0] == pair[1])
            .map(|pair| pair[0])
    }
}

/// Why there can be no gas inside.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PressureError {
    /// The pressure (Pa) is not finite.
    NotFinite(Real),
    /// The surface has a border, along this edge.
    Open([u32; 2]),
    /// The triangles at this edge face different ways.
    Disagree([u32; 2]),
    /// The mesh does not serve.
    Mesh(MeshError),
}

impl fmt::Display for PressureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite(value) => {
                write!(f, "the pressure is {value} Pa, but it has to be finite")
            }
            Self::Open([a, b]) => write!(
                f,
                "the pressure would escape: the surface has a border between vertices {a} and {b}"
            ),
            Self::Disagree([a, b]) => write!(
                f,
                "the pressure has no inside: the triangles between vertices {a} and {b} face different ways"
            ),
            Self::Mesh(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for PressureError {}

impl From<MeshError> for PressureError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

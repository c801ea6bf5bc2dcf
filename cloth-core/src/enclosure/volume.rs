//! A filling that resists a change of its volume, as one energy of the whole piece around it.
//!
//! With the bulk modulus K (Pa) and the rest volume V₀ (m³), a filling at the gauge pressure p₀ when it has the rest
//! volume presses with `p = p₀ − K (V/V₀ − 1)`. That is the energy
//!
//! `E = ½ k (V − V*)²`, with `k = K/V₀` and `V* = V₀ (1 + p₀/K)`,
//!
//! one constraint with the gradient ∂V/∂x on every vertex. Its Hessian is `k ∂V ∂Vᵀ − p ∂²V`. The first part couples
//! all vertices of the piece, and methods take it for what it is, of rank one ([`GlobalRows`]); the second is left to
//! their iterations.
//!
//! # Limits
//! - p is linear in V. A sealed gas of the absolute pressure p_a follows that to first order, with K = p_a if it keeps
//!   its temperature and 1.4 p_a if it keeps its heat (air).
//! - The filling has no mass of its own, and its pressure is the same everywhere.

use super::EnclosureError;
use super::surface::ClosedSurface;
use crate::contact::GlobalRows;
use crate::error::{positive, within};
use crate::math::{Real, Vec3};
use crate::mesh::TriMesh;

/// A filling that resists a change of volume, inside a closed piece of a mesh.
///
/// ```
/// use cloth_core::enclosure::ClosedVolume;
/// use cloth_core::mesh::generate::sphere;
///
/// let ball = sphere(4, 0.1)?; // m
/// // Air of one bar that keeps its temperature, pumped up by 0.2 bar.
/// let air = ClosedVolume::new(1.2e5, &ball)?.pressure(2e4)?; // Pa
/// let x: Vec<_> = ball.positions().iter().map(|x| x * 1.01).collect();
/// let volume = air.volume(&x) / air.volume(ball.positions());
/// assert!((air.gauge_pressure(&x) - (2e4 - 1.2e5 * (volume - 1.0))).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ClosedVolume {
    surface: ClosedSurface,
    /// Its vertices, and of each triangle the places of its corners among them.
    vertices: Vec<u32>,
    places: Vec<[u32; 3]>,
    /// V₀ and V* (m³).
    rest: Real,
    target: Real,
    /// K (Pa).
    modulus: Real,
    /// ∂V/∂x (m²) of the vertices where the substep began, and `Σ w ‖∂V/∂x‖²` (m⁴/kg).
    gradient: Vec<Vec3>,
    inverse_inertia: Real,
    /// λ of the substep (kg/m).
    multiplier: Real,
}

impl ClosedVolume {
    /// A filling with a bulk modulus K (Pa), above 0, inside `mesh` at rest, where it does not press.
    ///
    /// # Errors
    /// [`EnclosureError`] for a modulus out of range, or a mesh that has a boundary, triangles that face different
    /// ways, or no volume.
    pub fn new(modulus: Real, mesh: &TriMesh) -> Result<Self, EnclosureError> {
        Self::inside(modulus, mesh, 0..mesh.triangle_count())
    }

    /// The same inside the piece of the mesh that consists of these triangles.
    ///
    /// # Errors
    /// As [`ClosedVolume::new`].
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn inside(
        modulus: Real,
        mesh: &TriMesh,
        triangles: impl IntoIterator<Item = usize>,
    ) -> Result<Self, EnclosureError> {
        positive("bulk modulus (Pa)", modulus)?;
        let surface = ClosedSurface::of(mesh, triangles)?;
        let rest = surface.volume(mesh.positions());
        if !(rest > 0.0 && (modulus / rest).is_finite()) {
            return Err(EnclosureError::Empty);
        }
        let (vertices, places) = surface.vertices();
        Ok(Self {
            gradient: vec![Vec3::zeros(); vertices.len()],
            surface,
            vertices,
            places,
            rest,
            target: rest,
            modulus,
            inverse_inertia: 0.0,
            multiplier: 0.0,
        })
    }

    /// Lets it press with the gauge pressure p₀ (Pa, 0 unless set) when it has its rest volume.
    ///
    /// # Errors
    /// [`EnclosureError::OutOfRange`] for a pressure that is not finite, or is −K or below: no volume would be left.
    pub fn pressure(mut self, pressure: Real) -> Result<Self, EnclosureError> {
        let is_right = pressure.is_finite() && pressure > -self.modulus;
        let range = "finite and above the negative of the bulk modulus";
        within(is_right, "pressure (Pa)", pressure, range)?;
        self.target = self.rest * (1.0 + pressure / self.modulus);
        Ok(self)
    }

    /// V (m³) with the vertices at `x` (m).
    #[must_use]
    pub fn volume(&self, x: &[Vec3]) -> Real {
        self.surface.volume(x)
    }

    /// V₀ (m³).
    #[must_use]
    pub fn rest_volume(&self) -> Real {
        self.rest
    }

    /// p (Pa) with the vertices at `x` (m).
    #[must_use]
    pub fn gauge_pressure(&self, x: &[Vec3]) -> Real {
        self.stiffness() * (self.target - self.volume(x))
    }

    /// `p R/2` (N/m), the tension of a sphere that has as large a surface as the piece with its vertices at `x` (m); 0
    /// if it does not press outwards.
    #[must_use]
    pub fn tension(&self, x: &[Vec3]) -> Real {
        0.5 * self.gauge_pressure(x).max(0.0) * self.surface.radius(x)
    }

    /// `½ k (V − V*)²` (J) with the vertices at `x` (m).
    #[must_use]
    pub fn energy(&self, x: &[Vec3]) -> Real {
        0.5 * self.stiffness() * (self.volume(x) - self.target).powi(2)
    }

    /// Adds the gradient (N) of the energy at `x` (m) to `out`, and returns the energy (J).
    ///
    /// # Panics
    /// If there are fewer vertices than in the mesh.
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let excess = self.volume(x) - self.target;
        let scale = self.stiffness() * excess;
        self.surface.add_gradient(x, scale, out);
        0.5 * scale * excess
    }

    /// k (N/m⁵).
    fn stiffness(&self) -> Real {
        self.modulus / self.rest
    }

    /// Appends `k ∂V ∂Vᵀ` at `x` (m).
    pub(super) fn linearize(&self, x: &[Vec3], out: &mut GlobalRows) {
        let row = out.push(self.stiffness());
        row.vertices.extend_from_slice(&self.vertices);
        row.gradient.resize(self.vertices.len(), Vec3::zeros());
        self.surface
            .scatter(x, 1.0, &self.places, &mut row.gradient);
    }

    /// Begins a substep from `x` (m).
    ///
    /// The force acts along ∂V where the substep begins, as the forces of an explicit scheme do, and not along ∂V of
    /// where vertices have flown by then. The curvature −p ∂²V of a filling that presses is negative: along one
    /// coordinate, a force `c x` away from rest. A substep of h is then a linear map of position and velocity. Where
    /// the force is that at the start, `v′ = v + h w c x` and `x′ = x + h v′`, the determinant of this is 1, and areas
    /// of (x, v) stay. Where it is that at `x + h v` the determinant is `1 + h² w c`: areas grow, and with them energy,
    /// out of nothing.
    pub(super) fn begin_substep(&mut self, inverse_mass: &[Real], x: &[Vec3]) {
        self.multiplier = 0.0;
        self.gradient.fill(Vec3::zeros());
        self.surface
            .scatter(x, 1.0, &self.places, &mut self.gradient);
        let own = self.vertices.iter().zip(&self.gradient);
        let terms = own.map(|(&v, g)| inverse_mass[v as usize] * g.norm_squared());
        self.inverse_inertia = terms.sum();
    }

    /// Projects `x` (m) onto the constraint with its compliance, in a substep of `h` (s): XPBD (Macklin, Müller,
    /// Chentanez 2016, equation 18).
    pub(super) fn project(&mut self, inverse_mass: &[Real], h: Real, x: &mut [Vec3]) {
        if self.inverse_inertia == 0.0 {
            return;
        }
        let excess = self.volume(x) - self.target;
        let compliance = 1.0 / (self.stiffness() * h * h);
        let change = -(excess + compliance * self.multiplier) / (self.inverse_inertia + compliance);
        self.multiplier += change;
        for (&vertex, gradient) in self.vertices.iter().zip(&self.gradient) {
            x[vertex as usize] += gradient * (inverse_mass[vertex as usize] * change);
        }
    }
}

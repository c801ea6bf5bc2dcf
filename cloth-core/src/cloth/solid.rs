//! A solid, stated once: the same numbers mean the same solid in every method.

use super::{ClothError, Elements};
use crate::energy::{ArapTetrahedron, VolumeTetrahedron};
use crate::error::{not_negative, within};
use crate::math::{Real, Vec3, gather};
use crate::particles::Particles;

/// A homogeneous isotropic solid, cut to tetrahedra: the *fixed corotated* model, see [`ArapTetrahedron`].
///
/// With the Lamé parameters `μ = E/(2(1 + ν))` and `λ = E ν/((1 + ν)(1 − 2ν))` it stores
/// `μ ‖F − R‖² + ½ λ (J − 1)²` per rest volume (J = det F): an [`ArapTetrahedron`] and, unless ν is 0, a
/// [`VolumeTetrahedron`]. To second order in the strain that is the linear elastic solid of Young's modulus E and
/// Poisson's ratio ν, of bulk modulus `E/(3(1 − 2ν))`. For ν = 0 a pull to s times the length answers with exactly
/// `E (s − 1)`, and keeps the width.
///
/// Limits: strains are constant in each tetrahedron, so that what bends is too stiff by O(h²), and the more so the
/// nearer ν is to 1/2, where tetrahedra that all keep their volume hardly have a way to move (*locking*): up to 0.4 a
/// few cells across are enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Mass per volume (kg/m³).
    pub density: Real,
    /// Young's modulus E (Pa).
    pub modulus: Real,
    /// Poisson's ratio ν (dimensionless), at least 0 and below 1/2.
    pub poisson_ratio: Real,
}

/// Some tetrahedra, and what they are made of.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidPiece {
    /// The material.
    pub solid: Solid,
    /// Vertex numbers of its tetrahedra.
    pub tetrahedra: Vec<[u32; 4]>,
}

impl SolidPiece {
    /// Adds a quarter of each tetrahedron's mass to each of its corners, and gives the elements.
    pub(super) fn cut(
        &self,
        positions: &[Vec3],
        mass: &mut [Real],
    ) -> Result<[Elements; 2], ClothError> {
        let Solid {
            density,
            modulus,
            poisson_ratio: nu,
        } = self.solid;
        Particles::check_density(density)?;
        not_negative("Young's modulus (Pa)", modulus)?;
        let range = "at least 0 and below 0.5, of a solid";
        within((0.0..0.5).contains(&nu), "Poisson's ratio", nu, range)?;
        let shear = modulus / (2.0 * (1.0 + nu));
        let lambda = modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let (mut shapes, mut volumes) = (Vec::new(), Vec::new());
        for &corners in &self.tetrahedra {
            let x = gather(positions, corners);
            shapes.push(ArapTetrahedron::new(corners, &x, shear));
            let volume = VolumeTetrahedron::new(corners, &x, lambda);
            for vertex in corners {
                mass[vertex as usize] += density * volume.rest_volume.abs() / 4.0;
            }
            volumes.extend((lambda > 0.0).then_some(volume));
        }
        Ok([Elements::ArapTetrahedra(shapes), Elements::Volumes(volumes)])
    }
}

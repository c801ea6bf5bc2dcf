//! A start nearer to something than the thickness.

use super::Summary;
use crate::scene::Scene;
use cloth_core::math::Real;

impl Summary {
    /// A sentence about a start nearer than the thickness, if contact throws the cloth away from there.
    pub fn start_warning(&self) -> Option<String> {
        self.start_lift.map(|lift| {
            format!(
                "the cloth starts nearer to itself or to a body than the thickness: contact holds {:.3e} J there, \
                 which a method without damping gives back as {lift:.3} m of height; start it farther away, or with \
                 a smaller thickness",
                self.contact_energy_at_start
            )
        })
    }
}

/// How far (m) an energy (J) throws the free vertices up on Earth, if that is farther than the thickness.
pub(super) fn lift(scene: &Scene, energy: Real) -> Option<Real> {
    let (particles, touch) = (&scene.model.particles, scene.touch.as_ref()?);
    let free = (0..particles.len()).filter(|&v| !particles.is_prescribed(v));
    let mass: Real = free.map(|v| particles.mass()[v]).sum();
    Some(energy / (9.81 * mass)).filter(|lift| *lift > touch.thickness)
}

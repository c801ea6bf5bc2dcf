//! Contact as an impulse: what an impact does to a velocity.

use super::{ObstacleError, not_negative, within};
use cloth_core::math::{Real, Vec3};

/// Restitution and Coulomb friction, as a rule for velocities.
///
/// Let u be the velocity of a vertex relative to the surface, with the part uₙ = n·u along the normal and the part uₜ
/// along the surface. Approaching (uₙ < 0), it changes by
///
/// Δuₙ = −(1 + e) uₙ,  Δuₜ = −min(μ Δuₙ / ‖uₜ‖, 1) uₜ:
///
/// the impulse stays in the friction cone, and friction stops but never turns round. With the mass m of the vertex, the
/// impulse on it is m Δu. The obstacle receives −m Δu, but keeps its velocity: its motion is given.
///
/// Seen from the surface the vertex loses ½ m (1 − e²) uₙ², and by friction ½ m (‖uₜ‖² − ‖uₜ + Δuₜ‖²): never less than
/// nothing. In the world a surface that moves with v_p does the work m Δu·v_p besides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactLaw {
    friction: Real,
    restitution: Real,
}

impl ImpactLaw {
    /// Coefficient of friction μ ≥ 0, coefficient of restitution e in 0..=1 (both dimensionless).
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`].
    pub fn new(friction: Real, restitution: Real) -> Result<Self, ObstacleError> {
        let is_fraction = (0.0..=1.0).contains(&restitution);
        let name = "coefficient of restitution";
        Ok(Self {
            friction: not_negative("coefficient of friction", friction)?,
            restitution: within(is_fraction, name, restitution, "between 0 and 1")?,
        })
    }

    /// The same law without rebound.
    #[must_use]
    pub fn inelastic(self) -> Self {
        Self {
            restitution: 0.0,
            ..self
        }
    }

    /// Change of velocity (m/s) of a vertex that moves with `relative` velocity u (m/s) against a surface with unit
    /// normal `normal`.
    #[must_use]
    pub fn velocity_change(&self, relative: Vec3, normal: Vec3) -> Vec3 {
        let along = relative.dot(&normal);
        if along >= 0.0 {
            return Vec3::zeros();
        }
        let push = -(1.0 + self.restitution) * along;
        normal * push - hold(relative - normal * along, self.friction * push)
    }
}

/// A force of friction that is not larger than `most`.
pub(crate) fn hold(wanted: Vec3, most: Real) -> Vec3 {
    let size = wanted.norm();
    if size > most {
        wanted * (most / size)
    } else {
        wanted
    }
}

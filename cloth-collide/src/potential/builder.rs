//! Settings of the contact potential, checked.

use super::last_resort::LastResort;
use super::near::Near;
use super::patches::Patches;
use super::source::PotentialContacts;
use crate::obstacle::{ObstacleContacts, PenaltyLaw};
use cloth_core::math::Real;
use cloth_core::mesh::TriMesh;
use cloth_core::step::BuildError;

/// Settings of [`PotentialContacts`], to begin with [`PotentialContacts::builder`].
#[derive(Clone, Debug)]
pub struct PotentialBuilder<'a> {
    pub(super) mesh: &'a TriMesh,
    pub(super) thickness: Real,
    pub(super) stiffness: Real,
    pub(super) friction: Real,
    pub(super) obstacles: Option<ObstacleContacts>,
    pub(super) self_collision: bool,
}

impl<'a> PotentialBuilder<'a> {
    /// Distance h (m) at which contact begins.
    #[must_use]
    pub fn thickness(mut self, thickness: Real) -> Self {
        self.thickness = thickness;
        self
    }

    /// Stiffness κ (Pa/m): pressure per m that is missing to the thickness.
    #[must_use]
    pub fn stiffness(mut self, stiffness: Real) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Coefficient of friction μ (dimensionless) of cloth on cloth.
    #[must_use]
    pub fn friction(mut self, friction: Real) -> Self {
        self.friction = friction;
        self
    }

    /// What is in the way; its thickness should be that of the contact.
    #[must_use]
    pub fn obstacles(mut self, obstacles: ObstacleContacts) -> Self {
        self.obstacles = Some(obstacles);
        self
    }

    /// Whether the cloth touches itself (it does unless told otherwise). If not, nothing is built for it.
    #[must_use]
    pub fn self_collision(mut self, self_collision: bool) -> Self {
        self.self_collision = self_collision;
        self
    }

    /// Builds the contact source.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`] for a thickness or stiffness that is not positive and finite, or a friction that is negative.
    pub fn build(self) -> Result<PotentialContacts, BuildError> {
        let law = PenaltyLaw::two_stage(self.stiffness, self.thickness).map_err(|_| {
            let is_stiff = self.stiffness > 0.0 && self.stiffness.is_finite();
            let (name, value) = match is_stiff {
                true => ("thickness of contact (m)", self.thickness),
                false => ("stiffness of contact (Pa/m)", self.stiffness),
            };
            BuildError::InvalidSetting {
                name,
                value,
                range: "positive and finite",
            }
        })?;
        // Friction is no part of the law of pressure, and checked apart.
        if !(self.friction >= 0.0 && self.friction.is_finite()) {
            return Err(BuildError::InvalidSetting {
                name: "friction of contact",
                value: self.friction,
                range: "finite and not negative",
            });
        }
        let near = Near::new(self.mesh, law, self.self_collision);
        let patches = self.self_collision;
        let patches = || patches.then(|| Patches::new(self.mesh, &near.piece));
        let patches = [patches(), patches()];
        let last_resort = LastResort::new(self.mesh, self.thickness, self.self_collision);
        Ok(PotentialContacts::new(
            near,
            patches,
            self.obstacles,
            last_resort,
            self.friction,
        ))
    }
}

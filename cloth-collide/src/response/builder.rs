//! Setting up contact.

use super::ClothContacts;
use super::cloth::Cloth;
use crate::obstacle::ObstacleContacts;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::step::BuildError;

/// What the contact of a cloth is made of; see [`ClothContacts::builder`].
#[derive(Debug)]
pub struct ContactsBuilder<'a> {
    mesh: &'a TriMesh,
    thickness: Real,
    friction: Real,
    obstacles: Option<ObstacleContacts>,
    self_collision: bool,
}

impl ClothContacts {
    /// Contact for the cloth `mesh`; several cloths are several pieces of one mesh. Unless set: a thickness of 1 mm, no friction, no obstacles, and contact of the cloth
    /// with itself.
    #[must_use]
    pub fn builder(mesh: &TriMesh) -> ContactsBuilder<'_> {
        ContactsBuilder {
            mesh,
            thickness: 1e-3,
            friction: 0.0,
            obstacles: None,
            self_collision: true,
        }
    }
}

impl ContactsBuilder<'_> {
    /// The distance (m) of cloth from cloth that the response works towards, positive.
    #[must_use]
    pub fn thickness(mut self, thickness: Real) -> Self {
        self.thickness = thickness;
        self
    }

    /// Coefficient of friction (dimensionless) of cloth on cloth. Obstacles have their own.
    #[must_use]
    pub fn friction(mut self, friction: Real) -> Self {
        self.friction = friction;
        self
    }

    /// What the cloth can touch besides itself.
    #[must_use]
    pub fn obstacles(mut self, obstacles: ObstacleContacts) -> Self {
        self.obstacles = Some(obstacles);
        self
    }

    /// Whether the cloth can touch itself. If not, nothing is looked for in it, and nothing is allocated for that.
    #[must_use]
    pub fn self_collision(mut self, on: bool) -> Self {
        self.self_collision = on;
        self
    }

    /// Contact as described.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`] for a thickness that is not positive or a friction that is negative, or for one of them not finite.
    pub fn build(self) -> Result<ClothContacts, BuildError> {
        let settings = [
            (
                "thickness (m)",
                self.thickness,
                self.thickness > 0.0,
                "positive and finite",
            ),
            (
                "friction",
                self.friction,
                self.friction >= 0.0,
                "finite and not negative",
            ),
        ];
        for (name, value, in_range, range) in settings {
            if !(in_range && value.is_finite()) {
                return Err(BuildError::InvalidSetting { name, value, range });
            }
        }
        let cloth = self.self_collision;
        let cloth = cloth.then(|| Cloth::new(self.mesh, self.thickness));
        // With nothing to touch there is nothing to keep.
        let needed = cloth.is_some() || self.obstacles.is_some();
        let count = if needed { self.mesh.vertex_count() } else { 0 };
        Ok(ClothContacts {
            vertex_count: self.mesh.vertex_count(),
            thickness: self.thickness,
            friction: self.friction,
            obstacles: self.obstacles,
            cloth,
            safe: Vec::new(),
            seen: vec![Vec3::zeros(); count],
            moved: vec![false; count],
            rows: Vec::new(),
            hits: Vec::new(),
            entering: Vec::new(),
            zones: super::Zones::default(),
            solved: vec![Vec3::zeros(); count],
            ways: vec![Vec3::zeros(); count],
            hold: super::Hold::default(),
            memory: super::Memory::default(),
            work: crate::obstacle::BodyWork::default(),
            report: super::ContactReport::default(),
        })
    }
}

//! What the cloth of a scene can touch, and how it is kept from going through it.

use crate::error::BenchError;
use crate::settings::{Parameter, Settings, parameter};
use cloth_collide::obstacle::{ImpactLaw, Obstacle, ObstacleContacts};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::ContactSource;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

pub(crate) const CONTACT: Parameter = parameter(
    "contact",
    "potential",
    "how contact acts: potential (an energy that implicit methods and pd minimise along, and constraints in every substep of explicit methods, xpbd and pbd) or none",
);
pub(crate) const SELF: Parameter = parameter(
    "self",
    "yes",
    "whether the cloth can touch itself: yes or no",
);
pub(crate) const NO_SELF: Parameter = Parameter {
    default: "no",
    ..SELF
};
pub(crate) const THICKNESS: Parameter = parameter(
    "thickness",
    "2e-3",
    "distance to keep (m), of cloth from cloth and from obstacles: where contact begins to push",
);
pub(crate) const STIFFNESS: Parameter = parameter(
    "contact_stiffness",
    "1e6",
    "stiffness of contact=potential (Pa/m): pressure per m that is missing to the thickness",
);
pub(crate) const FRICTION: Parameter = parameter(
    "friction",
    "0.3",
    "coefficient of friction, of cloth with cloth and with obstacles",
);

/// What can be set of contact, in a scene that is about it.
pub(crate) const TOUCHING: &[Parameter] = &[CONTACT, SELF, THICKNESS, STIFFNESS, FRICTION];

/// The same where the cloth cannot touch itself unless that is asked for.
pub(crate) const TOUCHING_ALONE: &[Parameter] = &[CONTACT, NO_SELF, THICKNESS, STIFFNESS, FRICTION];

/// Everything that a cloth can touch.
#[derive(Clone, Debug)]
pub struct Touch {
    /// Whether contact is switched on.
    is_on: bool,
    self_collision: bool,
    thickness: Real,
    stiffness: Real,
    friction: Real,
    obstacles: ObstacleContacts,
    /// The same obstacles as surfaces around their own origins, for pictures.
    shapes: Vec<TriMesh>,
}

impl Touch {
    /// As the settings say, with these obstacles and what they look like. `own` is the scene's parameter for cloth against itself.
    pub(super) fn new(
        settings: &Settings,
        own: &Parameter,
        obstacles: Vec<(Obstacle, TriMesh)>,
    ) -> Result<Self, BenchError> {
        let thickness = settings.positive(&THICKNESS)?;
        let stiffness = settings.positive(&STIFFNESS)?;
        let friction = settings.number(&FRICTION)?;
        let law = ImpactLaw::new(friction, 0.0).map_err(BenchError::usage)?;
        let is_on = settings.choice(&CONTACT, &[("potential", true), ("none", false)])?;
        let mut contacts =
            ObstacleContacts::new(thickness, 0.5 * thickness).map_err(BenchError::usage)?;
        let mut shapes = Vec::new();
        for (obstacle, shape) in obstacles {
            contacts = contacts.with(obstacle, law);
            shapes.push(shape);
        }
        let self_collision = settings.choice(own, &[("yes", true), ("no", false)])?;
        // contact=none switches contact off, whatever else is said of it.
        if is_on && !self_collision && shapes.is_empty() {
            for parameter in [&CONTACT, &THICKNESS, &STIFFNESS, &FRICTION] {
                settings.refuse_without(parameter, "anything to touch (self=yes)")?;
            }
        }
        Ok(Self {
            is_on,
            self_collision,
            thickness,
            stiffness,
            friction,
            obstacles: contacts,
            shapes,
        })
    }

    /// Whether there is nothing to touch, or nothing to be done about it.
    pub(super) fn is_idle(&self) -> bool {
        let alone = !self.self_collision && self.obstacles.obstacles().next().is_none();
        alone || !self.is_on
    }

    /// What resolves contact of the cloth `mesh`; nothing where there is nothing to touch.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a mesh or a setting that does not serve.
    pub fn source(&self, mesh: &TriMesh) -> Result<Option<Box<dyn ContactSource>>, BenchError> {
        if self.is_idle() {
            return Ok(None);
        }
        let contacts = PotentialContacts::builder(mesh)
            .thickness(self.thickness)
            .stiffness(self.stiffness)
            .friction(self.friction)
            .obstacles(self.obstacles.clone())
            .self_collision(self.self_collision);
        Ok(Some(Box::new(contacts.build().map_err(BenchError::usage)?)))
    }

    /// The obstacles where they start.
    pub fn obstacles(&self) -> impl Iterator<Item = &Obstacle> + '_ {
        self.obstacles.obstacles()
    }

    /// Surfaces of the obstacles, for pictures: their vertices (m) at a time (s), and their triangles.
    pub(super) fn surfaces(
        &self,
        time: Real,
    ) -> impl Iterator<Item = (Vec<Vec3>, &[[u32; 3]])> + '_ {
        let both = self.obstacles().zip(&self.shapes);
        both.map(move |(obstacle, shape)| {
            let pose = obstacle.motion().pose_at(time);
            let positions = shape.positions().iter().map(|&x| pose.to_world(x));
            (positions.collect(), shape.triangles())
        })
    }
}

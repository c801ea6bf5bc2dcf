//! What the cloth of a scene can touch, and how it is kept from going through it.

use crate::error::BenchError;
use crate::settings::{Parameter, Settings, parameter};
use cloth_collide::ClothContacts;
use cloth_collide::barrier::BarrierContacts;
use cloth_collide::obstacle::{ImpactLaw, Obstacle, ObstacleContacts};
use cloth_core::contact::ContactSource;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

pub(crate) const CONTACT: Parameter = parameter(
    "contact",
    "zones",
    "how contact is resolved: zones (impulses, then impact zones), barrier (of the given thickness, without friction) or none",
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
    "distance to keep (m), of cloth from cloth and from obstacles",
);
pub(crate) const FRICTION: Parameter = parameter(
    "friction",
    "0.3",
    "coefficient of friction, of cloth with cloth and with obstacles",
);

pub(crate) const CONTACT_STEPS: Parameter = parameter(
    "contact_steps",
    "10",
    "parts of a step, after each of which contact is resolved; substeps of a method are shared among them",
);

/// Where contact pulls at the cloth all the time.
pub(crate) const TWIST_STEPS: Parameter = Parameter {
    default: "40",
    ..CONTACT_STEPS
};

/// What can be set of contact, in a scene that is about it.
pub(crate) const TOUCHING: &[Parameter] = &[CONTACT, CONTACT_STEPS, SELF, THICKNESS, FRICTION];

/// The same in a scene where contact pulls at the cloth.
pub(crate) const PULLING: &[Parameter] = &[CONTACT, TWIST_STEPS, SELF, THICKNESS, FRICTION];

/// The same in a scene that is about something else.
pub(crate) const NOT_TOUCHING: &[Parameter] =
    &[CONTACT, CONTACT_STEPS, NO_SELF, THICKNESS, FRICTION];

/// Everything that a cloth can touch.
#[derive(Clone, Debug)]
pub struct Touch {
    response: Response,
    steps: u32,
    self_collision: bool,
    thickness: Real,
    friction: Real,
    obstacles: ObstacleContacts,
    /// The same obstacles as surfaces around their own origins, for pictures.
    shapes: Vec<TriMesh>,
}

/// How contact is resolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Response {
    Zones,
    Barrier,
    None,
}

impl Touch {
    /// As the settings say, with these obstacles and what they look like. `steps` and `own` are the scene's parameters for the parts of a step and for cloth against itself.
    pub(super) fn new(
        settings: &Settings,
        steps: &Parameter,
        own: &Parameter,
        obstacles: Vec<(Obstacle, TriMesh)>,
    ) -> Result<Self, BenchError> {
        let thickness = settings.positive(&THICKNESS)?;
        let friction = settings.number(&FRICTION)?;
        let law = ImpactLaw::new(friction, 0.0).map_err(BenchError::usage)?;
        let mut contacts =
            ObstacleContacts::new(thickness, 0.5 * thickness).map_err(BenchError::usage)?;
        let mut shapes = Vec::new();
        for (obstacle, shape) in obstacles {
            contacts = contacts.with(obstacle, law);
            shapes.push(shape);
        }
        Ok(Self {
            response: settings.choice(
                &CONTACT,
                &[
                    ("zones", Response::Zones),
                    ("barrier", Response::Barrier),
                    ("none", Response::None),
                ],
            )?,
            steps: settings.count(steps, 1)?,
            self_collision: settings.choice(own, &[("yes", true), ("no", false)])?,
            thickness,
            friction,
            obstacles: contacts,
            shapes,
        })
    }

    /// Into how many parts a step is cut, so that contact is resolved after each of them: 1 where there is nothing to touch.
    ///
    /// A vertex that something stops within a part lets its neighbours go on until the end of the part, and no method knows of it before: contact is resolved in the metric of the masses, as if
    /// nothing held the cloth together, and the elements pull back in the next part. So cloth that is pulled around something, or that lands hard, is left with a strain; more parts make it
    /// smaller, more iterations of the method do not.
    #[must_use]
    pub fn parts(&self) -> u32 {
        if self.is_idle() { 1 } else { self.steps }
    }

    /// Whether there is nothing to touch, or nothing to be done about it.
    pub(super) fn is_idle(&self) -> bool {
        let alone = !self.self_collision && self.obstacles.obstacles().next().is_none();
        alone || self.response == Response::None
    }

    /// What resolves contact of the cloth `mesh`; nothing where there is nothing to touch.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a mesh or a setting that does not serve.
    pub fn source(&self, mesh: &TriMesh) -> Result<Option<Box<dyn ContactSource>>, BenchError> {
        if self.is_idle() {
            return Ok(None);
        }
        let obstacles = self.obstacles.clone();
        if self.response == Response::Barrier {
            let contacts = BarrierContacts::builder(mesh)
                .distance(self.thickness)
                .obstacles(obstacles)
                .self_collision(self.self_collision);
            return Ok(Some(Box::new(contacts.build().map_err(BenchError::usage)?)));
        }
        let contacts = ClothContacts::builder(mesh)
            .thickness(self.thickness)
            .friction(self.friction)
            .obstacles(obstacles)
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

//! What the cloth of a scene can touch, and how it is kept from going through it.

use crate::error::BenchError;
use crate::settings::{Parameter, Settings, parameter};
use cloth_collide::ClothContacts;
use cloth_collide::obstacle::{ImpactLaw, Obstacle, ObstacleContacts};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::ContactSource;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::step::Stepper;

pub(crate) const CONTACT: Parameter = parameter(
    "contact",
    "potential",
    "how contact acts: potential (an energy that implicit methods and pd minimise along, and constraints in every substep of explicit methods, xpbd and pbd; with limits of strain, Newton's method and what else knows neither: after the step, as zones), zones (impulses, then impact zones, after the step) or none",
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

pub(crate) const CONTACT_STEPS: Parameter = parameter(
    "contact_steps",
    "10",
    "parts of a step, after each of which contact is resolved; substeps of a method are shared among them",
);

/// Where contact pulls at the cloth all the time.
pub(crate) const TWIST_STEPS: Parameter = Parameter {
    default: "160",
    ..CONTACT_STEPS
};

/// Where cloth falls onto something.
pub(crate) const FALL_STEPS: Parameter = parameter(
    "contact_steps",
    "auto",
    "parts of a step, after each of which contact is resolved, and which share the substeps of a method; auto: 10, or more where the whole fall makes the cloth go further than a twenty-fourth of an edge in one",
);

/// What can be set of contact, in a scene that is about it.
pub(crate) const TOUCHING: &[Parameter] =
    &[CONTACT, CONTACT_STEPS, SELF, THICKNESS, STIFFNESS, FRICTION];

/// The same in a scene where contact pulls at the cloth.
pub(crate) const PULLING: &[Parameter] =
    &[CONTACT, TWIST_STEPS, SELF, THICKNESS, STIFFNESS, FRICTION];

/// The same in a scene where cloth falls down.
pub(crate) const FALLING: &[Parameter] =
    &[CONTACT, FALL_STEPS, SELF, THICKNESS, STIFFNESS, FRICTION];

/// The same where it cannot touch itself unless that is asked for.
pub(crate) const FALLING_ALONE: &[Parameter] =
    &[CONTACT, FALL_STEPS, NO_SELF, THICKNESS, STIFFNESS, FRICTION];

/// The same in a scene that is about something else.
pub(crate) const NOT_TOUCHING: &[Parameter] = &[
    CONTACT,
    CONTACT_STEPS,
    NO_SELF,
    THICKNESS,
    STIFFNESS,
    FRICTION,
];

/// Everything that a cloth can touch.
#[derive(Clone, Debug)]
pub struct Touch {
    response: Response,
    steps: u32,
    /// Whether the settings say how many.
    has_steps: bool,
    self_collision: bool,
    thickness: Real,
    stiffness: Real,
    friction: Real,
    obstacles: ObstacleContacts,
    /// The same obstacles as surfaces around their own origins, for pictures.
    shapes: Vec<TriMesh>,
}

/// How contact is resolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Response {
    Potential,
    Zones,
    None,
}

impl Touch {
    /// As the settings say, with these obstacles and what they look like. `steps` are the parts of a step, and `own` is the scene's parameter for cloth against itself.
    pub(super) fn new(
        settings: &Settings,
        steps: u32,
        own: &Parameter,
        obstacles: Vec<(Obstacle, TriMesh)>,
    ) -> Result<Self, BenchError> {
        let thickness = settings.positive(&THICKNESS)?;
        let stiffness = settings.positive(&STIFFNESS)?;
        let friction = settings.number(&FRICTION)?;
        let law = ImpactLaw::new(friction, 0.0).map_err(BenchError::usage)?;
        let response = settings.choice(
            &CONTACT,
            &[
                ("potential", Response::Potential),
                ("zones", Response::Zones),
                ("none", Response::None),
            ],
        )?;
        let mut contacts =
            ObstacleContacts::new(thickness, 0.5 * thickness).map_err(BenchError::usage)?;
        let mut shapes = Vec::new();
        for (obstacle, shape) in obstacles {
            contacts = contacts.with(obstacle, law);
            shapes.push(shape);
        }
        let self_collision = settings.choice(own, &[("yes", true), ("no", false)])?;
        // contact=none switches contact off, whatever else is said of it.
        if response != Response::None && !self_collision && shapes.is_empty() {
            for parameter in [&CONTACT, &CONTACT_STEPS, &THICKNESS, &STIFFNESS, &FRICTION] {
                settings.refuse_without(parameter, "anything to touch (self=yes)")?;
            }
        }
        if response == Response::Zones {
            settings.refuse_without(&STIFFNESS, "contact=potential")?;
        }
        let given = settings.get(CONTACT_STEPS.name);
        Ok(Self {
            response,
            steps,
            has_steps: given.is_some_and(|steps| steps != FALL_STEPS.default),
            self_collision,
            thickness,
            stiffness,
            friction,
            obstacles: contacts,
            shapes,
        })
    }

    /// Into how many parts a step is cut, so that contact is resolved after each of them: 1 where there is nothing to touch.
    ///
    /// A vertex that something stops within a part lets its neighbours go on until the end of the part, and no method knows of it before: contact is resolved in the metric of the masses, as if
    /// nothing held the cloth together, and the elements pull back in the next part. So cloth that is pulled around something, or that lands hard, is left with a strain; more parts make it
    /// smaller, more iterations of the method do not. Where cloth falls, the default follows from the height.
    #[must_use]
    pub fn parts(&self) -> u32 {
        if self.is_idle() { 1 } else { self.steps }
    }

    /// The same for a method that may feel contact in its own solve: it needs no parts, and has none unless the settings ask for them.
    #[must_use]
    pub fn parts_with(&self, stepper: &dyn Stepper) -> u32 {
        let feels = self.has_potential() && stepper.feels_contact();
        if feels && !self.has_steps {
            1
        } else {
            self.parts()
        }
    }

    /// Whether methods can feel what there is to touch while they solve.
    pub(super) fn has_potential(&self) -> bool {
        self.response == Response::Potential && !self.is_idle()
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
        if self.response == Response::Potential {
            let contacts = PotentialContacts::builder(mesh)
                .thickness(self.thickness)
                .stiffness(self.stiffness)
                .friction(self.friction)
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

/// Parts of a step of `dt` (s) as [`FALL_STEPS`] says, for the cloth `mesh` that may fall by `fall` (m) under `gravity` (m/s²).
pub(super) fn parts_of_fall(
    settings: &Settings,
    mesh: &TriMesh,
    gravity: Vec3,
    fall: Real,
    dt: Real,
) -> Result<u32, BenchError> {
    /// A part of a step takes the cloth no further than the mean edge divided by this. Sheets of 33 vertices a side that are draped on a turning box keep
    /// largest strains of 1 to 6 % then, by the kind of method; with half as many parts 5 to 14 %, with ten 16 to 39 %.
    const PARTS_OF_AN_EDGE: Real = 24.0;
    const FEWEST: Real = 10.0;
    /// More are a slip of the pen, in the height or in gravity.
    const MOST: Real = 1000.0;
    if settings.text(&FALL_STEPS) != FALL_STEPS.default {
        return settings.count(&FALL_STEPS, 1);
    }
    let speed = (2.0 * gravity.norm() * fall.max(0.0)).sqrt();
    let sides = mesh.triangles().iter().flat_map(|&[a, b, c]| {
        let at = |v: u32| mesh.positions()[v as usize];
        [(a, b), (b, c), (c, a)].map(|(a, b)| (at(a) - at(b)).norm())
    });
    let edge = sides.sum::<Real>() / (3 * mesh.triangle_count()) as Real;
    let parts = PARTS_OF_AN_EDGE * speed * dt / edge;
    Ok(parts.ceil().clamp(FEWEST, MOST) as u32)
}

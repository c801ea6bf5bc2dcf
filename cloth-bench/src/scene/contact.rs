//! What the cloth of a scene can touch, and how it is kept from going through it.

use crate::error::BenchError;
use crate::settings::{Parameter, Settings, parameter};
use cloth_collide::obstacle::{AnimatedMesh, ImpactLaw, Obstacle};
use cloth_collide::potential::PotentialContacts;
use cloth_collide::untangle::StepUntangler;
use cloth_collide::{BodyProbe, SeparationProbe};
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

pub(crate) const UNTANGLE: Parameter = parameter(
    "untangle",
    "no",
    "whether the cloth may pass through itself at the start: yes (those pairs are let go, and pulled apart during the run) or no (that is refused)",
);

/// What can be set of contact, in a scene that is about it.
pub(crate) const TOUCHING: &[Parameter] =
    &[CONTACT, SELF, THICKNESS, STIFFNESS, FRICTION, UNTANGLE];

/// The same where the cloth cannot touch itself unless that is asked for.
pub(crate) const TOUCHING_ALONE: &[Parameter] =
    &[CONTACT, NO_SELF, THICKNESS, STIFFNESS, FRICTION, UNTANGLE];

/// Something that a cloth can touch.
pub(super) enum Body {
    /// A rigid one, with its surface in its own frame.
    Rigid {
        obstacle: Obstacle,
        surface: TriMesh,
        /// Whether its signed distance at the vertices of the cloth is all there is to it.
        is_flat: bool,
    },
    /// A surface that changes its shape.
    Animated(TriMesh, AnimatedMesh),
}

/// Splits of an icosahedron's edges so fine that its sphere (m) comes out of no triangle by more than a quarter of the
/// thickness (m).
///
/// Edges are 1.3 R/n at most, and the sphere is e²/6R above the middle of a triangle.
pub(super) fn splits(radius: Real, thickness: Real) -> usize {
    const LEAST: Real = 5.0;
    const MOST: Real = 60.0;
    (1.13 * radius / thickness).sqrt().ceil().clamp(LEAST, MOST) as usize
}

/// A key of `[mesh.contact]` alone.
pub(super) const EXCLUDE: Parameter = parameter(
    "exclude",
    "none",
    "numbers of the [[mesh]] tables, from 0, that this piece passes through freely; with its own number, itself",
);

/// Contact of each vertex, where pieces differ.
#[derive(Clone, Debug)]
pub(super) struct PieceContact {
    /// Thickness (m).
    pub(super) thickness: Vec<Real>,
    /// Coefficient of friction (dimensionless).
    pub(super) friction: Vec<Real>,
    /// Number of the piece, and pairs of pieces that pass through each other freely.
    pub(super) piece: Vec<u32>,
    pub(super) excluded: Vec<[u32; 2]>,
}

/// Everything that a cloth can touch.
#[derive(Clone, Debug)]
pub struct ContactSetup {
    /// Whether contact is switched on.
    is_on: bool,
    self_collision: bool,
    thickness: Real,
    stiffness: Real,
    friction: Real,
    untangles: bool,
    obstacles: Vec<Obstacle>,
    /// The same obstacles as surfaces around their own origins, and whether these are needed for more than pictures.
    shapes: Vec<(TriMesh, bool)>,
    animated: Vec<(TriMesh, AnimatedMesh)>,
    pub(super) pieces: Option<PieceContact>,
}

impl ContactSetup {
    /// As the settings say, with these bodies. `own` is the scene's parameter for cloth against itself.
    pub(super) fn new(
        settings: &Settings,
        own: &Parameter,
        bodies: Vec<Body>,
    ) -> Result<Self, BenchError> {
        let thickness = settings.positive(&THICKNESS)?;
        let stiffness = settings.positive(&STIFFNESS)?;
        let friction = settings.number(&FRICTION)?;
        ImpactLaw::new(friction, 0.0).map_err(BenchError::usage)?;
        let is_on = settings.choice(&CONTACT, &[("potential", true), ("none", false)])?;
        let (mut obstacles, mut shapes, mut animated) = (Vec::new(), Vec::new(), Vec::new());
        for body in bodies {
            match body {
                Body::Rigid {
                    obstacle,
                    surface,
                    is_flat,
                } => {
                    obstacles.push(obstacle);
                    shapes.push((surface, !is_flat));
                }
                Body::Animated(mesh, animation) => animated.push((mesh, animation)),
            }
        }
        let self_collision = settings.choice(own, &[("yes", true), ("no", false)])?;
        if !self_collision {
            settings.refuse_without(&UNTANGLE, "a cloth that can touch itself (self=yes)")?;
        }
        let untangles = settings.choice(&UNTANGLE, &[("yes", true), ("no", false)])?;
        // contact=none switches contact off, whatever else is said of it.
        if is_on && !self_collision && shapes.is_empty() && animated.is_empty() {
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
            untangles,
            obstacles,
            shapes,
            animated,
            pieces: None,
        })
    }

    /// Whether there is nothing to touch, or nothing to be done about it.
    pub(super) fn is_idle(&self) -> bool {
        let has_bodies = !self.shapes.is_empty() || !self.animated.is_empty();
        let alone = !self.self_collision && !has_bodies;
        alone || !self.is_on
    }

    /// Whether a cloth that passes through itself at the start is pulled apart.
    pub(super) fn untangles(&self) -> bool {
        self.untangles
    }

    /// Whether pieces may pass through each other that untangling would pull apart.
    pub(super) fn excludes_and_untangles(&self) -> bool {
        let excludes = |pieces: &PieceContact| !pieces.excluded.is_empty();
        self.untangles && self.pieces.as_ref().is_some_and(excludes)
    }

    /// What resolves contact of the cloth `mesh`, with pairs of vertices that are `sewn` together; nothing where there
    /// is nothing to touch.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a mesh or a setting that does not serve.
    pub fn source(
        &self,
        mesh: &TriMesh,
        sewn: &[[u32; 2]],
    ) -> Result<Option<PotentialContacts>, BenchError> {
        if self.is_idle() {
            return Ok(None);
        }
        let mut contacts = PotentialContacts::builder(mesh)
            .thickness(self.thickness)
            .stiffness(self.stiffness)
            .friction(self.friction)
            .self_collision(self.self_collision)
            .sew(sewn);
        if let Some(pieces) = &self.pieces {
            contacts = contacts
                .thickness_of_vertices(pieces.thickness.clone())
                .friction_of_vertices(pieces.friction.clone())
                .exclude(pieces.piece.clone(), pieces.excluded.clone());
        }
        for obstacle in &self.obstacles {
            contacts = contacts.obstacle(obstacle.clone(), self.friction);
        }
        for (number, (surface, _)) in self.shapes.iter().enumerate().filter(|(_, s)| s.1) {
            contacts = contacts.surface(number, surface.clone());
        }
        for (surface, animation) in &self.animated {
            contacts = contacts.animated(surface.clone(), animation.clone(), self.friction);
        }
        contacts.build().map(Some).map_err(BenchError::usage)
    }

    /// What counts crossings and measures distances of the cloth `mesh`.
    #[must_use]
    pub fn separation_probe(&self, mesh: &TriMesh) -> SeparationProbe {
        let probe = SeparationProbe::new(mesh);
        match &self.pieces {
            Some(pieces) => probe.exclude(pieces.piece.clone(), pieces.excluded.clone()),
            None => probe,
        }
    }

    /// What pulls the cloth `mesh` apart during a run, if that is wanted.
    #[must_use]
    pub fn untangler(&self, mesh: &TriMesh) -> Option<StepUntangler> {
        (self.untangles && !self.is_idle()).then(|| StepUntangler::new(mesh))
    }

    /// The obstacles where they start.
    pub fn obstacles(&self) -> impl Iterator<Item = &Obstacle> + '_ {
        self.obstacles.iter()
    }

    /// Surfaces of the bodies, for pictures: their vertices (m) at a time (s), and their triangles.
    pub(super) fn surfaces(
        &self,
        time: Real,
    ) -> impl Iterator<Item = (Vec<Vec3>, &[[u32; 3]])> + '_ {
        let both = self.obstacles().zip(&self.shapes);
        let rigid = both.map(move |(obstacle, (shape, _))| {
            let pose = obstacle.motion().pose_at(time);
            let positions = shape.positions().iter().map(|&x| pose.to_world(x));
            (positions.collect(), shape.triangles())
        });
        let animated = self.animated.iter().map(move |(shape, animation)| {
            let mut positions = shape.positions().to_vec();
            animation.place(time, &mut positions);
            (positions, shape.triangles())
        });
        rigid.chain(animated)
    }

    /// What counts the triangles of the cloth `mesh` that go through bodies; nothing where no body has an edge.
    ///
    /// # Errors
    /// [`BenchError::Failed`] for more triangles than fit.
    pub fn probe(&self, mesh: &TriMesh) -> Result<Option<BodyProbe>, BenchError> {
        let rigid = self.shapes.iter().filter(|shape| shape.1).map(|s| &s.0);
        let bodies: Vec<&TriMesh> = rigid.chain(self.animated.iter().map(|a| &a.0)).collect();
        if bodies.is_empty() {
            return Ok(None);
        }
        let probe = BodyProbe::new(mesh, &bodies).map_err(BenchError::failed)?;
        Ok(Some(probe))
    }

    /// Counts them where the cloth is at `x` (m) at `time` (s).
    ///
    /// # Errors
    /// [`BenchError::Failed`] for positions that are not finite.
    pub fn count(
        &self,
        probe: &mut BodyProbe,
        x: &[Vec3],
        time: Real,
    ) -> Result<usize, BenchError> {
        let needed = self.shapes.iter().map(|s| s.1);
        let needed = needed.chain(std::iter::repeat(true));
        let places = self
            .surfaces(time)
            .zip(needed)
            .filter(|(_, needed)| *needed);
        let places: Vec<Vec<Vec3>> = places.map(|((x, _), _)| x).collect();
        let bodies = places.iter().map(Vec::as_slice);
        probe.count(x, bodies).map_err(BenchError::failed)
    }
}

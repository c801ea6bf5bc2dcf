//! What the cloth of a scene can touch, and how it is kept from going through it.

mod surfaces;

pub use surfaces::BodySurface;

use crate::bounds::bounds;
use crate::error::BenchError;
use crate::settings::{Auto, Choice, Or, Range::*, Settings, Table};
use cloth_collide::obstacle::{AnimatedMesh, Obstacle, RigidBody, RigidMotion};
use cloth_collide::potential::PotentialContacts;
use cloth_collide::{BroadPhaseKind, SeparationProbe};
use cloth_core::energy::Seam;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

crate::settings! {
    /// Of the surface of cloth.
    pub(crate) struct Surface {
        thickness: Or<Auto, Real> = "auto" "m" in Above(0.0),
            "distance to keep, of cloth from cloth and from obstacles: where contact begins to push; auto: 2e-3, or \
             half the mean edge of the mesh where that is less, or a two-hundredth of it where that is more";
        friction: Real = 0.3 in AtLeast(0.0), "coefficient of friction, of cloth with cloth and with obstacles";
    }
    /// Of contact.
    pub(crate) struct Contact {
        contact: Acts = "potential",
            "how contact acts: potential (an energy that implicit methods and pd minimise along, and constraints in \
             every substep of explicit methods, xpbd and pbd) or none";
        collides as "self": bool = "no", "whether the cloth can touch itself: yes or no";
        contact_stiffness: Or<Auto, Real> = "auto" "Pa/m" in Between(0.0, STIFFEST),
            "stiffness of contact=potential: pressure per m that is missing to the thickness; auto: 1e6, or where a \
             body that the cloth pushes is heavier, so much that cloth carries it at two thirds of the thickness h: \
             3 p/h, with the pressure p of its weight on the smallest side of the box around it";
        restitution: Option<Real> = "none" in Within(0.0, 1.0),
            "coefficient of restitution: what hits something leaves it with this part of its speed; with explicit \
             methods, pbd, xpbd and xpbd-direct, and 0 with all, since what minimises does not rebound anyway; none: \
             with what contact has stored and the method has not damped";
        untangle: bool = "no",
            "whether the cloth may pass through itself and through bodies at the start: yes (those pairs are let go, \
             and pulled apart during the run) or no (that is refused)";
        pinched: Pinched = "pass",
            "cloth to which bodies leave no feasible path: pass (through one of them, until it is out again) or refuse \
             (the run ends there)";
        broad_phase: BroadPhaseKind = "hierarchy",
            "what finds near triangles: hierarchy (a tree of boxes), spatial-hash or morton-grid; the motion is the \
             same with each, bit for bit";
    }
}

/// The least thickness of cloth, in mean edges.
const THINNEST: Real = 1e-6;
/// The thickness of cloth (m) unless edges are short or long.
const USUAL_THICKNESS: Real = 2e-3;
/// And its bounds, in mean edges.
const LEAST_OF_EDGE: Real = 0.005;
const MOST_OF_EDGE: Real = 0.5;

/// A stiffness of contact (Pa/m) at which a coordinate of 1 m, in double precision, is off by as much (1e-16 m) as a
/// tenth of a Pa, where cloth weighs 2 Pa: from 1e18 on methods that minimise make energy of that.
const STIFFEST: Real = 1e15;
/// The stiffness of contact (Pa/m) unless bodies are heavy.
const USUAL_STIFFNESS: Real = 1e6;

/// The pressure (Pa) of the weight of a body on the smallest side of the box around its surface.
fn pressure(body: &RigidBody, surface: &TriMesh) -> Real {
    let [low, high] = bounds(surface.positions().iter().copied());
    let size = high - low;
    let side = [size.x * size.y, size.y * size.z, size.z * size.x];
    body.mass() * body.gravity().norm() / side.into_iter().fold(Real::INFINITY, Real::min)
}

/// The mean length (m) of the edges of the triangles.
pub(super) fn mean_edge(mesh: &TriMesh) -> Real {
    let x = mesh.positions();
    let length = |[a, b]: [u32; 2]| (x[a as usize] - x[b as usize]).norm();
    let edges = mesh
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    edges.map(length).sum::<Real>() / (3.0 * mesh.triangle_count() as Real)
}

impl Surface {
    /// The thickness (m) of a cloth `mesh`. Where it is more than half an edge, most of what is near a vertex is its
    /// own neighbourhood. Where it is a small fraction of what a fold has for a radius, contact cuts each path short: a
    /// sheet of 50 m on a ball of 10 m, with edges of 1.6 m, takes five times as long with 2 mm as with 9.
    pub(super) fn thickness_of(&self, mesh: &TriMesh) -> Real {
        match *self.thickness {
            Or::Word(Auto::Auto) => {
                let edge = mean_edge(mesh);
                USUAL_THICKNESS.clamp(LEAST_OF_EDGE * edge, MOST_OF_EDGE * edge)
            }
            Or::Value(thickness) => thickness,
        }
    }

    /// Refuses a thickness that is lost beside the edges: steps would end where rounding does not let anything come
    /// nearer.
    pub(super) fn check(&self, mesh: &TriMesh) -> Result<(), BenchError> {
        let (thickness, least) = (self.thickness_of(mesh), THINNEST * mean_edge(mesh));
        if thickness < least {
            return Err(self.thickness.refuse(format!(
                "the thickness of contact is {thickness:e} m, but on this mesh it has to be at least {least:.1e} m"
            )));
        }
        Ok(())
    }

    /// What a user should know of it.
    fn note(&self, mesh: &TriMesh) -> Option<String> {
        let (thickness, edge) = (self.thickness_of(mesh), mean_edge(mesh));
        match *self.thickness {
            Or::Word(Auto::Auto) if thickness < USUAL_THICKNESS => Some(format!(
                "the thickness of contact is {thickness:.3e} m, half the mean edge of the cloth, and not \
                 {USUAL_THICKNESS} m: its triangles are too small for that"
            )),
            Or::Word(Auto::Auto) if thickness > USUAL_THICKNESS => Some(format!(
                "the thickness of contact is {thickness:.3e} m, a two-hundredth of the mean edge of the cloth, and not \
                 {USUAL_THICKNESS} m: its triangles are too large for that"
            )),
            Or::Value(_) if thickness > edge => Some(format!(
                "the thickness of contact, {thickness} m, is more than the mean edge of the cloth, {edge:.3e} m: steps \
                 take long, since every part is near many others"
            )),
            _ => None,
        }
    }
}

crate::choices! {
    /// How contact acts.
    #[derive(PartialEq)]
    pub(crate) enum Acts { Potential = "potential", None = "none" }
}

crate::choices! {
    /// What becomes of cloth that bodies pinch.
    #[derive(PartialEq)]
    pub(crate) enum Pinched { Pass = "pass", Refuse = "refuse" }
}

impl Choice for BroadPhaseKind {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("hierarchy", Self::Hierarchy),
        ("spatial-hash", Self::SpatialHash),
        ("morton-grid", Self::MortonGrid),
    ];
}

/// Something that a cloth can touch.
pub(super) enum Body {
    /// A rigid one, with its surface in its own frame.
    Rigid {
        obstacle: Obstacle,
        surface: TriMesh,
        /// Mass and inertia, if the cloth can push it.
        free: Option<Box<RigidBody>>,
        /// As a scene file calls its shape. Of a plane the signed distance at the vertices of the cloth is all there
        /// is.
        kind: &'static str,
        /// Coefficient of friction of its own (dimensionless).
        friction: Option<Real>,
        /// Why it has no inside, if it has none.
        why_hollow: Option<String>,
    },
    /// A surface that changes its shape, and its coefficient of friction.
    Animated(TriMesh, AnimatedMesh, Option<Real>),
}

/// A rigid body, as contact has it.
#[derive(Clone, Debug)]
pub(super) struct RigidSetup {
    /// In the scene, from 0.
    pub(super) number: usize,
    /// As a scene file calls its shape.
    pub(super) kind: &'static str,
    pub(super) obstacle: Obstacle,
    /// Its surface around its own origin.
    surface: TriMesh,
    /// Mass and inertia, if the cloth pushes it.
    free: Option<RigidBody>,
    /// Coefficient of friction (dimensionless).
    friction: Real,
}

impl RigidSetup {
    /// Whether triangles of the cloth touch its own; if not, they are for pictures.
    pub(super) fn has_triangles(&self) -> bool {
        self.kind != "plane"
    }

    /// Whether there is a signed distance from it.
    fn has_inside(&self) -> bool {
        self.obstacle.shape().error_bound() < Real::INFINITY
    }
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
    /// Whether the cloth can touch itself, where contact is switched on.
    pub(crate) self_collision: bool,
    /// Distance to keep (m).
    pub(crate) thickness: Real,
    stiffness: Real,
    friction: Real,
    restitution: Option<Real>,
    untangles: bool,
    pinched_passes: bool,
    broad_phase: BroadPhaseKind,
    pub(super) rigid: Vec<RigidSetup>,
    /// Those of them that are held, and bodies that will be driven otherwise than at the start.
    pub(super) held: Vec<usize>,
    pub(super) driven: Vec<usize>,
    /// Of these on their contact (rad/s); 0 without any.
    highest_frequency: Real,
    /// Surfaces that change their shape, and their coefficients of friction (dimensionless).
    animated: Vec<(TriMesh, AnimatedMesh, Real)>,
    /// Numbers of the rigid bodies, and of the animated surfaces behind them, in the scene, from 0.
    numbers: Vec<usize>,
    /// What a user should know of the bodies.
    notes: Vec<String>,
    /// Whether the common coefficient of friction is that of anything.
    is_common_friction_felt: bool,
    pub(super) pieces: Option<PieceContact>,
}

impl ContactSetup {
    /// Of a cloth `mesh`, as the settings say, with these bodies.
    pub(super) fn new(
        settings: &Settings,
        mesh: &TriMesh,
        bodies: Vec<Body>,
    ) -> Result<Self, BenchError> {
        let (surface, own) = (Surface::read(settings)?, Contact::read(settings)?);
        let (friction, restitution) = (*surface.friction, *own.restitution);
        let is_on = *own.contact == Acts::Potential;
        let (mut rigid, mut animated): (Vec<RigidSetup>, Vec<_>) = Default::default();
        let (mut animated_numbers, mut notes) = (Vec::new(), Vec::new());
        let mut is_common_friction_felt = *own.collides;
        let mut friction_of = |own: Option<Real>| {
            is_common_friction_felt |= own.is_none();
            own.unwrap_or(friction)
        };
        for (number, body) in bodies.into_iter().enumerate() {
            match body {
                Body::Rigid {
                    obstacle,
                    surface,
                    free,
                    kind,
                    friction,
                    why_hollow,
                } => {
                    notes.extend(why_hollow.map(|why| {
                        format!("obstacle {number} has no inside, since {why}: its triangles alone keep the cloth off")
                    }));
                    rigid.push(RigidSetup {
                        number,
                        kind,
                        obstacle,
                        surface,
                        free: free.map(|body| *body),
                        friction: friction_of(friction),
                    });
                }
                Body::Animated(surface, animation, friction) => {
                    animated_numbers.push(number);
                    animated.push((surface, animation, friction_of(friction)));
                }
            }
        }
        let thickness = surface.thickness_of(mesh);
        let free = || {
            let free = rigid.iter().map(|body| (body.free.as_ref(), &body.surface));
            free.filter_map(|(free, surface)| Some((free?, surface)))
        };
        let stiffness = match *own.contact_stiffness {
            Or::Value(stiffness) => stiffness,
            Or::Word(Auto::Auto) => free()
                .map(|(body, surface)| 3.0 * pressure(body, surface) / thickness)
                .filter(|needed| needed.is_finite())
                .fold(USUAL_STIFFNESS, Real::max),
        };
        let highest_frequency = free()
            .map(|(body, surface)| body.highest_frequency(stiffness, surface))
            .fold(0.0, Real::max);
        let self_collision = *own.collides;
        let has_bodies = !rigid.is_empty() || !animated.is_empty();
        // Planes alone have no triangles to be found.
        let has_triangles = !animated.is_empty() || rigid.iter().any(RigidSetup::has_triangles);
        if !self_collision && !has_triangles {
            let what = "triangles to touch (self=yes, or a body that is no plane)";
            own.untangle.refuse_without(what)?;
            if is_on {
                own.broad_phase.refuse_without(what)?;
            }
        }
        if is_on && !has_bodies {
            own.pinched.refuse_without("an obstacle")?;
        }
        if is_on && (self_collision || has_bodies) {
            notes.extend(surface.note(mesh));
        }
        surface.check(mesh)?;
        if is_on && stiffness > USUAL_STIFFNESS && *own.contact_stiffness == Or::Word(Auto::Auto) {
            notes.push(format!(
                "contact_stiffness is {stiffness:.2e} Pa/m, not {USUAL_STIFFNESS:e}, so that cloth carries the heaviest \
                 body before its thickness is used up"
            ));
        }
        // contact=none switches contact off, whatever else is said of it.
        if is_on && !self_collision && !has_bodies {
            let what = "anything to touch (self=yes)";
            own.contact.refuse_without(what)?;
            surface.thickness.refuse_without(what)?;
            own.contact_stiffness.refuse_without(what)?;
            surface.friction.refuse_without(what)?;
            own.restitution.refuse_without(what)?;
        }
        let rigid_numbers = rigid.iter().map(|body| body.number);
        Ok(Self {
            numbers: rigid_numbers.chain(animated_numbers).collect(),
            is_on,
            self_collision,
            thickness,
            stiffness,
            friction,
            restitution,
            untangles: *own.untangle,
            pinched_passes: *own.pinched == Pinched::Pass,
            broad_phase: *own.broad_phase,
            rigid,
            held: Vec::new(),
            driven: Vec::new(),
            highest_frequency,
            animated,
            notes,
            is_common_friction_felt,
            pieces: None,
        })
    }

    /// Refuses a common coefficient of friction that nothing has.
    pub(super) fn check_friction(&self, settings: &Settings) -> Result<(), BenchError> {
        if self.is_idle() || self.is_common_friction_felt || self.pieces.is_some() {
            return Ok(());
        }
        let friction = Surface::read(settings)?.friction;
        friction.refuse_without("a body without friction of its own, or self=yes")
    }

    /// Whether there is nothing to touch, or nothing to be done about it.
    pub(crate) fn is_idle(&self) -> bool {
        let alone = !self.self_collision && self.numbers.is_empty();
        alone || !self.is_on
    }

    /// Whether the cloth can touch itself.
    pub(super) fn touches_itself(&self) -> bool {
        self.self_collision && self.is_on
    }

    /// Whether what hits something leaves it with a given part of its speed, which is not zero.
    pub(crate) fn rebounds(&self) -> bool {
        self.restitution.is_some_and(|part| part > 0.0) && !self.is_idle()
    }

    /// Whether a cloth that is tangled at the start is pulled apart.
    pub(super) fn untangles(&self) -> bool {
        self.untangles && !self.is_idle()
    }

    /// What resolves contact of the cloth `mesh` with this seam, from a time (s) on; nothing where there is nothing to
    /// touch.
    pub fn source(
        &self,
        mesh: &TriMesh,
        seam: &Seam,
        time: Real,
    ) -> Result<Option<PotentialContacts>, BenchError> {
        if self.is_idle() {
            return Ok(None);
        }
        let mut contacts = PotentialContacts::builder(mesh)
            .thickness(self.thickness)
            .stiffness(self.stiffness)
            .friction(self.friction)
            .broad_phase(self.broad_phase)
            .pinched_cloth_passes(self.pinched_passes)
            .self_collision(self.self_collision)
            .begins_at(time)
            .sew(&seam.sewn_pairs(), &seam.sewn_onto_edges());
        if let Some(pieces) = &self.pieces {
            contacts = contacts
                .thickness_of_vertices(pieces.thickness.clone())
                .friction_of_vertices(pieces.friction.clone())
                .exclude(pieces.piece.clone(), pieces.excluded.clone());
        }
        if let Some(restitution) = self.restitution {
            contacts = contacts.restitution(restitution);
        }
        for body in &self.rigid {
            contacts = contacts.obstacle(body.obstacle.clone(), body.friction);
        }
        for (number, body) in self.rigid.iter().enumerate() {
            if body.has_triangles() {
                contacts = contacts.surface(number, body.surface.clone());
            }
        }
        for (number, body) in self.free_bodies() {
            contacts = contacts.free(number, *body);
        }
        for (surface, animation, friction) in &self.animated {
            contacts = contacts.animated(surface.clone(), animation.clone(), *friction);
        }
        let mut contacts = contacts.build().map_err(BenchError::usage)?;
        for &number in &self.held {
            contacts.hold_body(number, true);
        }
        Ok(Some(contacts))
    }

    /// What counts crossings and measures distances of the cloth `mesh`.
    pub fn separation_probe(&self, mesh: &TriMesh) -> SeparationProbe {
        let probe = SeparationProbe::new(mesh);
        match &self.pieces {
            Some(pieces) => probe.exclude(pieces.piece.clone(), pieces.excluded.clone()),
            None => probe,
        }
    }

    /// Whether no body moves, and none can.
    pub fn stands_still(&self) -> bool {
        let mut bodies = self.obstacles();
        let is_pushed = self.free_bodies().next().is_some();
        let none_moves = self.animated.is_empty() && !is_pushed && self.driven.is_empty();
        none_moves && bodies.all(|o| o.motion().is_still())
    }

    /// Whether the cloth can push the obstacle of this number.
    pub fn is_free(&self, number: usize) -> bool {
        self.rigid
            .get(number)
            .is_some_and(|body| body.free.is_some())
    }

    /// The mass and inertia of the obstacles that the cloth can push, by their numbers.
    pub fn free_bodies(&self) -> impl Iterator<Item = (usize, &RigidBody)> + '_ {
        let all = self.rigid.iter().enumerate();
        all.filter_map(|(number, body)| Some((number, body.free.as_ref()?)))
    }

    /// Into how many equal parts a step of `dt` (s) is cut, so that each resolves the frequency of every body that the
    /// cloth can push on its contact: none is longer than 1/Ω, half of what is stable.
    pub(super) fn parts(&self, dt: Real) -> u32 {
        /// More parts are a slip of the pen.
        const MOST: Real = 1e4;
        if self.is_idle() {
            return 1;
        }
        (dt * self.highest_frequency).ceil().clamp(1.0, MOST) as u32
    }

    /// Numbers of the bodies in the scene, from 0: of the obstacles in their order, then of the animated surfaces, as
    /// [`ContactForces`](cloth_collide::potential::ContactForces) has them.
    pub fn body_numbers(&self) -> &[usize] {
        &self.numbers
    }

    /// What a user should know of the bodies, a sentence each.
    pub fn notes(&self) -> impl Iterator<Item = &str> + '_ {
        self.notes.iter().map(String::as_str)
    }

    /// Takes bodies to where they are at `time` (s), with the velocities that they have.
    pub(crate) fn put(
        &mut self,
        motions: impl Iterator<Item = (usize, RigidMotion)>,
        time: Real,
    ) -> Result<(), BenchError> {
        for (number, motion) in motions {
            let Some(body) = self.rigid.get_mut(number) else {
                continue;
            };
            // As if it had always moved like that.
            let pose = motion.pose_at(-time);
            body.obstacle
                .set_motion(RigidMotion { pose, ..motion })
                .map_err(BenchError::failed)?;
        }
        Ok(())
    }

    /// Gives an obstacle other velocities (m/s, rad/s) from `time` (s) on.
    pub(super) fn drive(
        &mut self,
        number: usize,
        [velocity, angular_velocity]: [Vec3; 2],
        time: Real,
    ) -> Result<(), BenchError> {
        let pose = self.rigid[number].obstacle.motion().pose_at(time);
        let motion = RigidMotion {
            pose,
            velocity,
            angular_velocity,
        };
        self.put([(number, motion)].into_iter(), time)
    }

    /// The number in contact of an obstacle of the scene, both from 0; of an animated surface nothing.
    pub(super) fn rigid_body(&self, number: usize) -> Option<usize> {
        self.rigid.iter().position(|body| body.number == number)
    }

    /// A sentence about each body that the cloth can push, and that starts in another one.
    pub(super) fn overlap_warnings(&self) -> impl Iterator<Item = String> + '_ {
        /// Deeper than by rounding, in parts of the size of a body.
        const ROUNDING: Real = 1e-9;
        self.free_bodies().filter_map(|(number, _)| {
            let body = &self.rigid[number];
            let pose = body.obstacle.motion().pose_at(0.0);
            let own = body.surface.positions();
            let size = own.iter().map(|x| x.norm()).fold(0.0, Real::max);
            let others = self.rigid.iter().enumerate();
            let others = others.filter(|(other, body)| *other != number && body.has_inside());
            let depth = |obstacle: &Obstacle| {
                let depths = own.iter().map(|x| -obstacle.signed_distance(pose.to_world(*x), 0.0).value);
                depths.fold(Real::NEG_INFINITY, Real::max)
            };
            let (other, depth) = others
                .map(|(other, body)| (other, depth(&body.obstacle)))
                .reduce(|a, b| if b.1 > a.1 { b } else { a })?;
            (depth > ROUNDING * size).then(|| {
                format!(
                    "{}, which the cloth can push, starts in {}, {depth:.3e} m deep: it cannot fall out of it, so \
                     move it out",
                    self.body_name(number),
                    self.body_name(other)
                )
            })
        })
    }

    /// What messages call the body of a number of contact: of an obstacle, or of an animated surface behind them.
    pub(super) fn body_name(&self, body: usize) -> String {
        let number = self.numbers.get(body).map_or(body, |number| *number);
        let kind = self.rigid.get(body).map_or("animation", |body| body.kind);
        format!("obstacle {number} ({kind})")
    }

    /// The obstacles that the cloth cannot push.
    pub(super) fn standing_obstacles(&self) -> impl Iterator<Item = &Obstacle> + '_ {
        let standing = self.rigid.iter().filter(|body| body.free.is_none());
        standing.map(|body| &body.obstacle)
    }

    /// The obstacles where they start, and those that the cloth pushes on the path that they are on now.
    pub fn obstacles(&self) -> impl Iterator<Item = &Obstacle> + '_ {
        self.rigid.iter().map(|body| &body.obstacle)
    }
}

//! Settings of the contact potential, checked.

use super::bodies::Body;
use super::excluded::Excluded;
use super::free::FreeBody;
use super::near::{Near, Own, Side};
use super::patches::Patches;
use super::rebound::Rebounds;
use super::sewn::Sewn;
use super::source::Contacts;
use super::surfaces::{PotentialContacts, SurfaceMotion, Surfaces};
use crate::broad_phase::BroadPhaseKind;
use crate::obstacle::{AnimatedMesh, Obstacle, PenaltyLaw, RigidBody};
use cloth_core::error::{OutOfRange, not_negative, positive};
use cloth_core::math::Real;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::join;
use cloth_core::step::BuildError;

/// Settings of [`PotentialContacts`], to begin with [`PotentialContacts::builder`].
///
/// | setting | default | too small | too large |
/// |---|---|---|---|
/// | thickness h (m) | 1 mm; 0 is refused | more iterations: a path is tested 10 h at a time | cloth presses cloth harder than κ says |
/// | stiffness κ (Pa/m) | 10⁶ | a load p > κ h/2 presses into the barrier, to d = κ h²/(4 p) | a worse condition: more iterations |
/// | friction μ (dimensionless) | 0 | slides on slopes above arctan μ | sticks on slopes below |
/// | restitution e (dimensionless) | none: the law is elastic | no rebound at 0 | no loss at 1 |
/// | length ε (m) up to which friction goes back to where it began to stick; a spring for methods that minimise, no compliance in sweeps | h/100, fixed | a stiffer spring, μ λ/ε: more iterations | that spring gives way by ε F/(μ λ), visibly |
/// | fraction of its distance that a pair keeps on a path (dimensionless) | 1/5, in substeps of constraints 1/10, fixed | k paths leave (1/5)ᵏ of it, and a stiffness up as 1/d² | shorter paths, more of them |
///
/// None of them depends on mesh, step, density or bending stiffness. Ten times κ is a tenth of the compression ρ g/κ,
/// and ten times the stiffness of contact beside inertia, κ Δt²/ρ, which an iteration meets as a condition: 1400 by
/// default at 0.2 kg/m² and 1/60 s. Ten times h is a gap ten times as wide, and more pressure than κ says once h is a
/// tenth of an edge ([limits](super#limits)). With a tenth of h, a path is tested for 1 mm at a time instead of 10 mm.
#[derive(Clone, Debug)]
#[must_use]
pub struct PotentialBuilder<'a> {
    mesh: &'a TriMesh,
    thickness: Real,
    stiffness: Real,
    restitution: Option<Real>,
    obstacles: Vec<Body>,
    surfaces: Vec<(TriMesh, SurfaceMotion)>,
    free: Vec<(usize, RigidBody)>,
    /// At which the first step begins (s).
    time: Real,
    own: Own,
    /// See [`PotentialBuilder::sew`].
    sewn: (Vec<[u32; 2]>, Vec<[u32; 3]>),
}

impl<'a> PotentialBuilder<'a> {
    pub(super) fn new(mesh: &'a TriMesh) -> Self {
        Self {
            mesh,
            thickness: 1e-3,
            stiffness: 1e6,
            restitution: None,
            obstacles: Vec::new(),
            surfaces: Vec::new(),
            free: Vec::new(),
            time: 0.0,
            own: Own {
                self_collision: true,
                ..Own::default()
            },
            sewn: Default::default(),
        }
    }

    /// Distance h (m) at which contact begins, between a vertex and whatever is near it; edges push below h/2. Two
    /// primitives of one connected component push from no farther than they are apart at rest, so h may be larger than
    /// an edge; what shares a vertex is no pair (the chapter has why). Up to a tenth of an edge κ means what it says to
    /// 1.3 times (the limits of the [chapter](super)). A small h costs iterations: methods that minimise move by at
    /// most 10 h between two searches for pairs. Cloth rests on cloth a little less than h apart, not 2 h. For
    /// another one later, build anew.
    pub fn thickness(mut self, thickness: Real) -> Self {
        self.thickness = thickness;
        self
    }

    /// The same for each vertex of the cloth apart (m), where pieces are not equally thick: it keeps this distance from
    /// bodies, and two pieces keep half the sum of theirs, those of one vertex of each. The length below which friction
    /// is a spring is a hundredth of the largest. Replaces [`thickness`](Self::thickness).
    pub fn thickness_of_vertices(mut self, thickness: Vec<Real>) -> Self {
        self.own.thicknesses = thickness;
        self
    }

    /// Coefficients of friction μ (dimensionless) of each vertex of the cloth apart, where pieces are not equally
    /// rough. Two that touch have the geometric mean of their coefficients, those of one vertex of each; a vertex and a
    /// body too. Replaces [`friction`](Self::friction).
    pub fn friction_of_vertices(mut self, friction: Vec<Real>) -> Self {
        self.own.frictions = friction;
        self
    }

    /// Parts of the cloth that pass through each other freely: pairs of regions, and the region of each vertex. A pair
    /// of a region with itself is one that does not touch itself. Bodies keep out all.
    pub fn exclude(mut self, region: Vec<u32>, pairs: Vec<[u32; 2]>) -> Self {
        self.own.excluded = Excluded::new(region, pairs);
        self
    }

    /// Pairs of vertices that are sewn together, and vertices that are sewn onto an edge, each with the ends of that.
    /// Two parts of the cloth that have vertices of one pair, directly or through others, are neighbours, as if they
    /// shared a vertex: they are not kept apart. So are a part with a vertex and one with an end of the edge that it is
    /// sewn onto.
    pub fn sew(mut self, pairs: &[[u32; 2]], onto_edges: &[[u32; 3]]) -> Self {
        self.sewn = (pairs.to_vec(), onto_edges.to_vec());
        self
    }

    /// Edges push from the thickness on, as vertices do, and vertices with all of their area: where everything is to be
    /// that far apart, at any cost.
    pub fn full_thickness(mut self) -> Self {
        self.own.full_thickness = true;
        self
    }

    /// What finds the triangles that are near each other. All kinds find the same, at different cost.
    pub fn broad_phase(mut self, kind: BroadPhaseKind) -> Self {
        self.own.broad_phase = kind;
        self
    }

    /// Stiffness κ (Pa/m): pressure per m that is missing to the thickness. The weight ρ g of what lies on the cloth
    /// should leave it in the quadratic part of the law, ρ g/κ < h/2; beyond what that asks for, more stiffness costs
    /// iterations. At 0.2 kg/m² the default of 10⁶ is pressed together by 2 µm.
    pub fn stiffness(mut self, stiffness: Real) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Coefficient of friction μ (dimensionless) of cloth on cloth.
    pub fn friction(mut self, friction: Real) -> Self {
        self.own.friction = friction;
        self
    }

    /// Coefficient of restitution e (dimensionless, 0 to 1) of all contacts: what approaches something with a speed u
    /// leaves it with e u. Of methods that project positions alone; no body can be free beside it. Unless set,
    /// contact gives back what it has stored, less what the method damps. Where g Δt² of a substep is more than (1 + e)
    /// h/1000, what lies still rebounds in each, and its gap is that of 1/(1 + e) of the weight.
    pub fn restitution(mut self, restitution: Real) -> Self {
        self.restitution = Some(restitution);
        self
    }

    /// Adds a rigid body that is in the way, with a coefficient of `friction` μ (dimensionless).
    pub fn obstacle(mut self, obstacle: Obstacle, friction: Real) -> Self {
        self.obstacles.push((obstacle, friction));
        self
    }

    /// What obstacle `number` (in the order in which they are added, from 0) looks like in its own frame (m): no
    /// triangle of the cloth cuts those of `mesh`, which may be open and pass through itself. It should lie on the
    /// surface of the shape or inside, since the signed distance keeps vertices on its own.
    pub fn surface(mut self, number: usize, mesh: TriMesh) -> Self {
        self.surfaces.push((mesh, SurfaceMotion::Obstacle(number)));
        self
    }

    /// Obstacle `number` (in the order of [`obstacle`](Self::obstacle), from 0) is pushed by the cloth and pulled by
    /// gravity; it starts with the velocities of its motion. Other bodies stop it only at the vertices of its
    /// [`surface`](Self::surface), or of theirs if they are free: without either it passes through them.
    pub fn free(mut self, number: usize, body: RigidBody) -> Self {
        self.free.push((number, body));
        self
    }

    /// A body that has triangles alone, those of `mesh` where `animation` moves its vertices; with a coefficient of
    /// `friction` μ (dimensionless). Its time begins with the first step.
    pub fn animated(mut self, mesh: TriMesh, animation: AnimatedMesh, friction: Real) -> Self {
        let motion = SurfaceMotion::Own(animation, friction);
        self.surfaces.push((mesh, motion));
        self
    }

    /// The first step begins at this time (s): bodies are where their motion has taken them by then.
    pub fn begins_at(mut self, time: Real) -> Self {
        self.time = time;
        self
    }

    /// Whether cloth to which bodies leave no feasible path passes through one of them until it is out again; see
    /// [pinched cloth](super#pinched-cloth). Unless told so, such a step is
    /// [`ContactError::Infeasible`](cloth_core::contact::ContactError::Infeasible).
    pub fn pinched_cloth_passes(mut self, passes: bool) -> Self {
        self.own.pinched_passes = passes;
        self
    }

    /// Whether the cloth touches itself (it does unless told otherwise). If not, nothing is built for it.
    pub fn self_collision(mut self, self_collision: bool) -> Self {
        self.own.self_collision = self_collision;
        self
    }

    /// Builds the contact source.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for a thickness or stiffness that is not positive and finite, a friction that is
    /// negative or not finite, a restitution outside 0 to 1, a time that is not finite, thicknesses, frictions or
    /// regions of vertices that are not as many as these, the surface of an obstacle with an unknown number, a free one
    /// with an unknown number or one that is free already, an animation of another number of vertices than its mesh, a
    /// sewn vertex beyond those of the cloth, or vertices beyond 2³² together. [`BuildError::SettingsConflict`] for
    /// restitution beside a free body.
    pub fn build(mut self) -> Result<PotentialContacts, BuildError> {
        self.check_own()?;
        let (pairs, onto_edges) = &self.sewn;
        self.own.sewn = Sewn::new(pairs, onto_edges, self.mesh.vertex_count());
        let most = self.own.thicknesses.iter().copied().reduce(Real::max);
        let thickness = most.unwrap_or(self.thickness);
        let law = PenaltyLaw {
            stiffness: positive("stiffness of contact (Pa/m)", self.stiffness)?,
            range: positive("thickness of contact (m)", thickness)?,
        };
        if let Some(e) = self.restitution {
            if !(0.0..=1.0).contains(&e) {
                return Err(invalid("coefficient of restitution", e, "from 0 to 1"));
            }
            if !self.free.is_empty() {
                let (one, needs) = ("restitution", "bodies that the cloth does not push");
                return Err(BuildError::SettingsConflict { one, needs });
            }
        }
        // Friction is no part of the law of pressure, and checked apart.
        not_negative("friction of contact", self.own.friction)?;
        for (_, friction) in &self.obstacles {
            not_negative("friction of a body", *friction)?;
        }
        let begins = "time at which contact begins (s)";
        if !self.time.is_finite() {
            return Err(invalid(begins, self.time, "finite"));
        }
        for (obstacle, _) in self.obstacles.iter_mut().filter(|_| self.time != 0.0) {
            let moved = obstacle.advance(self.time);
            moved.map_err(|_| invalid(begins, self.time, "one to which bodies come"))?;
        }
        let sides = self.sides()?;
        let free = self.free_bodies()?;
        let joined = if self.surfaces.is_empty() {
            None
        } else {
            let surfaces = self.surfaces.iter().map(|(mesh, _)| mesh);
            let all: Vec<TriMesh> = std::iter::once(self.mesh)
                .chain(surfaces)
                .cloned()
                .collect();
            let count = all.iter().map(|mesh| mesh.vertex_count() as Real).sum();
            let name = "number of vertices of the cloth and the surfaces of bodies";
            Some(join(&all).map_err(|_| invalid(name, count, "below 2³²"))?)
        };
        let has_pairs = self.own.self_collision || joined.is_some();
        let mesh = joined.as_ref().unwrap_or(self.mesh);
        let near = Near::new(mesh, law, sides, self.own);
        let patches = || has_pairs.then(|| Patches::new(mesh, &near));
        let (for_rows, for_paths) = (patches(), patches());
        let mut contacts = Contacts::new(near, self.obstacles);
        contacts.last_resort.mesh = has_pairs.then(|| mesh.clone());
        contacts.constraints.patches = for_rows;
        contacts.pairs.patches = for_paths;
        contacts.free.list = free;
        contacts.constraints.rebounds = self.restitution.map(|coefficient| Rebounds {
            coefficient,
            list: Vec::new(),
        });
        contacts.constraints.bodies.measures_approach = self.restitution.is_some();
        let surfaces = Surfaces::new(self.mesh.vertex_count(), self.surfaces, self.time);
        let mut contacts = PotentialContacts { contacts, surfaces };
        contacts.record_forces(false);
        Ok(contacts)
    }

    /// Checks what vertices have of their own.
    fn check_own(&self) -> Result<(), BuildError> {
        let (own, count) = (&self.own, self.mesh.vertex_count());
        for (name, length) in [
            ("number of thicknesses of vertices", own.thicknesses.len()),
            (
                "number of coefficients of friction of vertices",
                own.frictions.len(),
            ),
            ("number of regions of vertices", own.excluded.region_count()),
        ] {
            if length != 0 && length != count {
                return Err(invalid(name, length as Real, "the number of vertices"));
            }
        }
        let (pairs, onto_edges) = &self.sewn;
        let sewn = pairs.iter().flatten().chain(onto_edges.iter().flatten());
        if let Some(&last) = sewn.max().filter(|last| **last as usize >= count) {
            let (name, range) = ("number of a sewn vertex", "below the number of vertices");
            return Err(invalid(name, last.into(), range));
        }
        for &value in &own.thicknesses {
            positive("thickness of a vertex (m)", value)?;
        }
        for &value in &own.frictions {
            not_negative("friction of a vertex", value)?;
        }
        Ok(())
    }

    fn body(&self, name: &'static str, number: usize) -> Result<&Body, BuildError> {
        let range = "below the number of obstacles";
        let body = self.obstacles.get(number);
        body.ok_or_else(|| invalid(name, number as Real, range))
    }

    fn free_bodies(&self) -> Result<Vec<FreeBody>, BuildError> {
        let name = "number of a free obstacle";
        let found = self.free.iter().enumerate().map(|(k, &(number, body))| {
            let (obstacle, _) = self.body(name, number)?;
            if self.free[..k].iter().any(|(other, _)| *other == number) {
                return Err(invalid(
                    name,
                    number as Real,
                    "one that is not free already",
                ));
            }
            let is_own = |motion: &SurfaceMotion| matches!(motion, SurfaceMotion::Obstacle(of) if *of == number);
            let surfaces = self.surfaces.iter().filter(|(_, motion)| is_own(motion));
            let vertices = surfaces.flat_map(|(mesh, _)| mesh.positions().iter().copied());
            Ok(FreeBody::new(number, body, obstacle, vertices.collect()))
        });
        found.collect()
    }

    /// What each vertex of the surfaces knows of its body.
    fn sides(&self) -> Result<Vec<Side>, BuildError> {
        let mut sides = Vec::new();
        let mut animated = self.obstacles.len()..;
        for (mesh, motion) in &self.surfaces {
            let (error_bound, friction, body) = match motion {
                SurfaceMotion::Obstacle(number) => {
                    let name = "number of the obstacle with a surface";
                    let (body, friction) = self.body(name, *number)?;
                    (body.shape().error_bound(), *friction, Some(*number))
                }
                SurfaceMotion::Own(animation, friction) => {
                    let count = animation.vertex_count();
                    if count != mesh.vertex_count() {
                        let name = "number of vertices of an animation";
                        return Err(invalid(name, count as Real, "that of its mesh"));
                    }
                    let friction = not_negative("friction of a body", *friction)?;
                    (Real::INFINITY, friction, animated.next())
                }
            };
            let side = Side {
                error_bound,
                friction,
                body: body.unwrap_or_default(),
            };
            sides.extend(std::iter::repeat_n(side, mesh.vertex_count()));
        }
        Ok(sides)
    }
}

fn invalid(name: &'static str, value: Real, range: &'static str) -> BuildError {
    OutOfRange { name, value, range }.into()
}

//! The contact of a cloth with itself, and with bodies whose surfaces are triangles: prescribed vertices, numbered
//! after those of the cloth, that are treated like these. The [chapter](super#bodies) has why they are needed.

use super::bodies::Body;
use super::builder::PotentialBuilder;
use super::clock::Clock;
use super::constraints::FEASIBLE_START_SWEEPS;
use super::forces::{ContactForces, Ledger};
use super::handed::Handed;
use super::near::Near;
use super::report::ConstraintReport;
use super::sewn::Sewn;
use super::shared::Shared;
use super::source::Contacts;
use crate::obstacle::{AnimatedMesh, Pose};
use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactRow, ContactSource, ContactStep,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

/// Size (s) of a step in which no body comes far, and no law of contact is stiff.
const NO_TIME: Real = 1e-12;

/// Contact of a cloth with itself and with obstacles, as a potential that methods take into their own solve; see the
/// [chapter](super).
///
/// # What is guaranteed
///
/// After a step, no two triangles of the cloth meet beyond the vertices and edges that they share, at its end and at no
/// time on the paths there, nor do triangles of the cloth and of the [surfaces](PotentialBuilder::surface) of bodies:
/// every pair that could come near has passed the conservative [`ContinuousTest`](crate::ContinuousTest), or a plane
/// that keeps it apart at both ends.
///
/// Vertices of the surface that are not prescribed stay out of obstacles. One that starts inside is led out: slowly by
/// the constraints (it may sink by h/100 in a substep), in the first step by the potential.
///
/// What prescribed vertices or moving obstacles make impossible is [`ContactError::Infeasible`], or lets pinched cloth
/// pass if it may. The start of a step must be free of crossings; it is if the last step ended there, and if anything
/// else has moved the cloth since, all near pairs of triangles are tested exactly, and crossing ones are
/// [`ContactError::IntersectingStart`]. Nothing is guaranteed of
///
/// - pairs that the builder was told to exclude, or that are sewn together;
/// - the cloth with itself without self-collision;
/// - pairs that cross at the start and are excluded until they are apart, as a
///   [`StepUntangler`](crate::untangle::StepUntangler) does;
/// - cloth that crosses a body at the start, or is pinched, before that body alone;
/// - prescribed vertices of the cloth, which may be inside of bodies, and the triangles around them before a body that
///   they cross at the start of a step ([`PotentialContacts::prescribed_inside`]).
///
/// The path is that of the substep, or, of a method that minimises, the polyline of its start and accepted iterates.
/// The straight line from the start of the step to its end is not tested. Convergence and the thickness are not
/// guaranteed: of pairs of triangles only d > 0.
///
/// # Example
///
/// A sheet falls on a ball: implicit Euler without elasticity, each vertex by its own stiffness.
///
/// ```
/// use cloth_collide::obstacle::{Obstacle, Pose, RigidMotion, Sphere};
/// use cloth_collide::potential::PotentialContacts;
/// use cloth_core::contact::{ContactPotential, ContactStep};
/// use cloth_core::math::Vec3;
/// use cloth_core::mesh::generate::{Diagonals, grid};
///
/// let sheet = grid(5, 5, 0.1, 0.1, Diagonals::Alternating)?; // its middle is vertex 12
/// let (mass, dt, h) = (1e-3, 0.01, 2e-3); // kg a vertex, s, m
/// let below = RigidMotion::still(Pose::at(Vec3::new(0.05, 0.05, -0.11)));
/// let ball = Obstacle::moving(Sphere::new(0.1)?, below)?;
/// let mut contacts = PotentialContacts::builder(&sheet).thickness(h).obstacle(ball, 0.0).build()?;
///
/// let (mut x, mut v) = (sheet.positions().to_vec(), vec![Vec3::zeros(); 25]);
/// let inertia = mass / (dt * dt);
/// for _ in 0..20 {
///     let from = x.clone();
///     let step = ContactStep { from: &from, inverse_mass: &[1.0 / mass; 25], dt };
///     let fly = |k: usize| from[k] + (v[k] - Vec3::z() * (9.81 * dt)) * dt;
///     let free: Vec<Vec3> = (0..25).map(fly).collect();
///     x.clone_from(&free);
///     contacts.begin(&step, &mut x)?; // takes back what is not safe
///     for _ in 0..50 {
///         let mut gradient: Vec<Vec3> = (0..25).map(|k| (x[k] - free[k]) * inertia).collect();
///         let (mut rows, mut stiffness) = (Vec::new(), [inertia; 25]);
///         contacts.add_gradient(&x, &mut gradient);
///         contacts.linearize(&x, &mut rows);
///         for row in &rows {
///             let own = |k: usize| row.stiffness * row.weights[k].abs();
///             (0..4).for_each(|k| stiffness[row.vertices[k] as usize] += own(k));
///         }
///         let to: Vec<Vec3> = (0..25).map(|k| x[k] - gradient[k] / stiffness[k]).collect();
///         let safe = contacts.limit(&x, &to)?;
///         x.iter_mut().zip(&to).for_each(|(x, to)| *x += (to - *x) * safe);
///     }
///     v = (0..25).map(|k| (x[k] - from[k]) / dt).collect();
///     contacts.end(&x, &mut v);
/// }
/// // The middle rests on the top: κ A (h − d) = m g, with a third of the area of the triangles around it.
/// let around = sheet.triangles().iter().zip(sheet.areas()).filter(|(t, _)| t.contains(&12));
/// let area = around.map(|(_, area)| area / 3.0).sum::<f64>();
/// assert!((x[12].z + 0.01 - h + mass * 9.81 / (1e6 * area)).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # To come back to a state
///
/// Contact has a state of its own: where bodies are, how far friction is stretched, what is known to be free of
/// crossings. A cloth that is put back alone would meet bodies elsewhere: with moving ones, a state of another time is
/// refused ([`ContactError::WrongTime`]). A clone is a snapshot: restored together with the state, it repeats the same
/// steps bit for bit. [`take_back`](Self::take_back) undoes the last step; [`begins_at`](PotentialBuilder::begins_at)
/// is for a later time. A method may have a memory too ([`Stepper::step`](cloth_core::step::Stepper::step)).
#[derive(Clone, Debug)]
pub struct PotentialContacts {
    pub(super) contacts: Contacts,
    pub(super) surfaces: Surfaces,
}

/// The surface of a body.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub(super) mesh: TriMesh,
    pub(super) motion: SurfaceMotion,
    /// What has taken the place of its animation.
    pub(super) handed: Option<Handed>,
    /// Where it is at both ends, if it is that of an obstacle and has been put there.
    placed: Option<[Pose; 2]>,
}

/// What moves it.
#[derive(Clone, Debug)]
pub(super) enum SurfaceMotion {
    /// The obstacle of this number.
    Obstacle(usize),
    /// Its own shapes, with a coefficient of friction.
    Own(AnimatedMesh, Real),
}

/// The surfaces, and buffers for the vertices of everything.
#[derive(Clone, Debug)]
pub(super) struct Surfaces {
    /// Number of vertices of the cloth.
    cloth: usize,
    pub(super) list: Vec<Surface>,
    /// Of what moves by itself (s): now, and at the start of the step.
    pub(super) time: Real,
    pub(super) begun: Real,
    pub(super) clock: Clock,
    /// 0 for all vertices of bodies (1/kg).
    inverse_mass: Vec<Real>,
    /// Places (m) at the start and at the end of the path at hand.
    from: Vec<Vec3>,
    to: Vec<Vec3>,
    fractions: Vec<Real>,
    /// The same place with its gradient (N), for methods that take `&self`.
    shared: Shared,
}

impl Surfaces {
    /// `time` is that (s) at which the first step begins.
    pub(super) fn new(cloth: usize, list: Vec<(TriMesh, SurfaceMotion)>, time: Real) -> Self {
        let own = list.iter().map(|(mesh, _)| mesh.vertex_count());
        let count = cloth + own.sum::<usize>();
        let buffer = || vec![Vec3::zeros(); count];
        let nowhere = |(mesh, motion)| Surface {
            mesh,
            motion,
            handed: None,
            placed: None,
        };
        Self {
            cloth,
            list: list.into_iter().map(nowhere).collect(),
            time,
            begun: time,
            clock: Clock::default(),
            inverse_mass: vec![0.0; count],
            from: buffer(),
            to: buffer(),
            fractions: vec![1.0; count],
            shared: Shared::new([buffer(), buffer()]),
        }
    }

    /// Puts bodies at both ends (m) of a (sub)step of `dt` (s), which obstacles begin as `bodies` are. In between their
    /// vertices go straight: with an angular velocity ω one at a distance r from the axis is up to r (1 − cos(ω dt/2))
    /// inside of the arc on which its body goes. Gives whether all of them are there already, and stay.
    fn place(&mut self, bodies: &[Body], dt: Real) -> bool {
        let mut all_rest = true;
        let (mut from, mut to) = (&mut self.from[self.cloth..], &mut self.to[self.cloth..]);
        for Surface {
            mesh,
            motion,
            handed,
            placed,
        } in &mut self.list
        {
            let count = mesh.vertex_count();
            let (own_from, rest_from) = from.split_at_mut(count);
            let (own_to, rest_to) = to.split_at_mut(count);
            (from, to) = (rest_from, rest_to);
            match motion {
                SurfaceMotion::Obstacle(number) => {
                    let motion = bodies[*number].0.motion();
                    let poses = [0.0, dt].map(|time| motion.pose_at(time));
                    // What stands still is there already.
                    if *placed == Some(poses) && poses[0] == poses[1] {
                        continue;
                    }
                    all_rest = false;
                    *placed = Some(poses);
                    for (out, pose) in [own_from, own_to].into_iter().zip(poses) {
                        let places = out.iter_mut().zip(mesh.positions());
                        places.for_each(|(x, local)| *x = pose.to_world(*local));
                    }
                }
                SurfaceMotion::Own(animation, _) => {
                    all_rest = false;
                    let ends = [(self.time, own_from), (self.time + dt, own_to)];
                    ends.into_iter().for_each(|(time, out)| match handed {
                        Some(handed) => handed.place(time, out),
                        None => animation.interpolate(time, out),
                    });
                }
            }
        }
        all_rest
    }

    /// The cloth begins a (sub)step from `step.from` to `to` (m).
    fn put(&mut self, step: &ContactStep<'_>, to: &[Vec3]) {
        self.inverse_mass[..self.cloth].copy_from_slice(step.inverse_mass);
        self.from[..self.cloth].copy_from_slice(step.from);
        self.to[..self.cloth].copy_from_slice(to);
    }

    /// From now on bodies are where they end.
    fn stay(&mut self) {
        let bodies = self.cloth..;
        self.from[bodies.clone()].copy_from_slice(&self.to[bodies.clone()]);
        let [place, gradient] = &mut *self.shared.lock();
        place[bodies.clone()].copy_from_slice(&self.to[bodies.clone()]);
        // What is added up there in the step is of no use.
        gradient[bodies].fill(Vec3::zeros());
    }

    /// The step (from, 1/kg, Δt) of everything, and its end.
    fn all(&mut self, dt: Real) -> (ContactStep<'_>, &mut Vec<Vec3>) {
        let step = ContactStep {
            from: &self.from,
            inverse_mass: &self.inverse_mass,
            dt,
        };
        (step, &mut self.to)
    }

    /// The same with the cloth at `x` (m).
    fn with(&mut self, dt: Real, x: &[Vec3]) -> (ContactStep<'_>, &mut Vec<Vec3>) {
        self.to[..x.len()].copy_from_slice(x);
        self.all(dt)
    }

    /// The same of a path of the cloth (m).
    fn path(&mut self, from: &[Vec3], to: &[Vec3]) -> (&[Vec3], &mut [Vec3]) {
        self.from[..from.len()].copy_from_slice(from);
        self.to[..to.len()].copy_from_slice(to);
        (&self.from, &mut self.to)
    }

    /// Where everything is, with the cloth at `x` (m).
    fn at(&mut self, x: &[Vec3]) -> &[Vec3] {
        self.to[..x.len()].copy_from_slice(x);
        &self.to
    }

    /// Takes the cloth to where it ends (m).
    fn take(&self, x: &mut [Vec3]) {
        x.copy_from_slice(&self.to[..x.len()]);
    }
}

impl PotentialContacts {
    /// Contact of the cloth `mesh` with itself: from 1 mm on, with 1e6 Pa/m and without friction.
    pub fn builder(mesh: &TriMesh) -> PotentialBuilder<'_> {
        PotentialBuilder::new(mesh)
    }

    /// What the last step took, of a method that projects positions.
    #[must_use]
    pub fn constraint_report(&self) -> ConstraintReport {
        self.contacts.constraints.report
    }

    /// Whether forces are recorded from the next step on; nothing is spent on them otherwise. They always are where
    /// bodies are free.
    pub fn record_forces(&mut self, are_wanted: bool) {
        let contacts = &mut self.contacts;
        let all = contacts.near.vertex_area.len();
        let obstacles = contacts.bodies.len();
        let bodies = contacts.near.bodies().map(|body| body + 1);
        let bodies = bodies.fold(obstacles, usize::max);
        let cloth = contacts.near.cloth;
        let are_needed = !contacts.free.list.is_empty();
        contacts.ledger = (are_wanted || are_needed).then(|| Ledger::new(all, cloth, bodies));
    }

    /// The forces of the last step, if they are recorded.
    #[must_use]
    pub fn forces(&self) -> Option<&ContactForces> {
        let ledger = self.contacts.ledger.as_ref();
        ledger.map(|ledger| &ledger.forces)
    }

    /// From the next step on these vertices are sewn together, and no others; see
    /// [`PotentialBuilder::sew`](super::PotentialBuilder::sew). What names a vertex beyond those of the cloth is left
    /// out.
    pub fn sew(&mut self, pairs: &[[u32; 2]], onto_edges: &[[u32; 3]]) {
        self.contacts.near.own.sewn = Sewn::new(pairs, onto_edges, self.surfaces.cloth);
        self.contacts.is_anew = true;
    }

    /// What the parts of the cloth, and of the surfaces of bodies, stand for.
    pub(crate) fn near(&self) -> &Near {
        &self.contacts.near
    }

    /// The cloth, followed by the surfaces of bodies; none if nothing of it can cross.
    pub(crate) fn mesh(&self) -> Option<&TriMesh> {
        self.contacts.last_resort.mesh.as_ref()
    }

    /// Writes where the vertices of bodies are when the next step begins (m).
    pub(crate) fn place_bodies(&mut self, out: &mut [Vec3]) {
        self.close();
        self.surfaces.place(&self.contacts.bodies, 0.0);
        out.copy_from_slice(&self.surfaces.from[self.surfaces.cloth..]);
    }

    /// Whether a vertex of the cloth at `x` (m) is inside of a body with an inside and a surface.
    pub(crate) fn contain(&self, vertex: u32, x: Vec3) -> bool {
        let mut bodies = self.surfaces.list.iter().filter_map(|s| match s.motion {
            SurfaceMotion::Obstacle(number) => Some(&self.contacts.bodies[number].0),
            SurfaceMotion::Own(..) => None,
        });
        let is_own = (vertex as usize) < self.surfaces.cloth;
        is_own && bodies.any(|body| body.signed_distance(x, 0.0).value <= 0.0)
    }

    /// Whether something gives way where there was no feasible path: a free body halts, or cloth passes through a body.
    fn gives_way(&mut self, error: &ContactError) -> bool {
        if let ContactError::Infeasible { vertex, .. } = error {
            let place = self.surfaces.from[*vertex as usize];
            if self.contacts.halt_near(place) || self.contacts.let_pass(&self.surfaces.from) {
                return true;
            }
        }
        // The step is not taken.
        for free in &mut self.contacts.free.list {
            free.is_halted = free.is_held;
        }
        false
    }

    /// The prescribed vertices with a triangle that crosses a body, and passes through it therefore: pairs of a vertex
    /// and the number of the body. Obstacles have the first numbers, animated surfaces the next.
    #[must_use]
    pub fn prescribed_inside(&self) -> &[[u32; 2]] {
        self.contacts.near.prescribed_inside.pairs()
    }

    /// Puts everything at the ends of a (sub)step in which the cloth goes to `to` (m).
    fn place(
        &mut self,
        step: &ContactStep<'_>,
        to: &[Vec3],
        [begins, begins_to_move]: [bool; 2],
    ) -> Result<(), ContactError> {
        step.check(self.surfaces.cloth, to, to)?;
        if begins {
            self.close();
            let surfaces = &mut self.surfaces;
            surfaces.clock.advance(surfaces.time - surfaces.begun);
            surfaces.begun = surfaces.time;
        }
        if begins_to_move {
            self.contacts.start_free_bodies(step, to);
        }
        self.contacts.near.bodies_rest = self.surfaces.place(&self.contacts.bodies, step.dt);
        self.surfaces.put(step, to);
        Ok(())
    }
}

impl ContactSource for PotentialContacts {
    fn potential(&mut self) -> &mut dyn ContactPotential {
        self
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        self
    }

    fn keep_free(
        &mut self,
        from: &[Vec3],
        inverse_mass: &[Real],
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        let step = ContactStep {
            from,
            inverse_mass,
            dt: NO_TIME,
        };
        step.check(self.surfaces.cloth, x, x)?;
        self.close();
        let surfaces = &mut self.surfaces;
        self.contacts.near.bodies_rest = surfaces.place(&self.contacts.bodies, 0.0);
        surfaces.put(&step, x);
        let (all, to) = surfaces.all(step.dt);
        self.contacts.keep_free(&all, to)?;
        self.surfaces.take(x);
        Ok(())
    }

    fn work(&self) -> Real {
        self.contacts.work
    }

    fn potential_energy(&self) -> Real {
        self.contacts.energy
    }

    fn take_back(&mut self) {
        self.take_back();
    }

    fn can_touch(&self) -> bool {
        let Contacts { near, bodies, .. } = &self.contacts;
        near.own.self_collision || !bodies.is_empty() || !self.surfaces.list.is_empty()
    }

    fn truncated_count(&self) -> usize {
        self.contacts.truncated
    }

    fn check_time(&self, time: Real, dt: Real) -> Result<(), ContactError> {
        self.check_clock(time, dt)
    }
}

impl ContactPotential for PotentialContacts {
    fn begin(&mut self, step: &ContactStep<'_>, start: &mut [Vec3]) -> Result<(), ContactError> {
        let mut is_first = true;
        loop {
            self.place(step, start, [true, true])?;
            if std::mem::take(&mut is_first) {
                self.contacts.unpinch(&self.surfaces.from)?;
            }
            let (all, to) = self.surfaces.all(step.dt);
            match self.contacts.begin(&all, to) {
                Err(error) if self.gives_way(&error) => {}
                begun => break begun?,
            }
        }
        self.surfaces.take(start);
        self.surfaces.clock.begin();
        self.surfaces.time += step.dt;
        self.surfaces.stay();
        Ok(())
    }

    fn limit(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<Real, ContactError> {
        cloth_core::contact::same_length(self.surfaces.cloth, [from.len(), to.len()])?;
        let (from, to) = self.surfaces.path(from, to);
        self.contacts.limit(from, to)
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        let surfaces = &mut self.surfaces;
        cloth_core::contact::same_length(surfaces.cloth, [from.len(), to.len(), fractions.len()])?;
        surfaces.path(from, to);
        self.contacts
            .limit_each(&surfaces.from, &mut surfaces.to, &mut surfaces.fractions)?;
        surfaces.take(to);
        fractions.copy_from_slice(&surfaces.fractions[..fractions.len()]);
        Ok(())
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        assert_eq!([x.len(), out.len()], [self.surfaces.cloth; 2], "vertices");
        if self.contacts.is_clear_of_surfaces() {
            return self.contacts.add_gradient(x, out);
        }
        let [place, gradient] = &mut *self.surfaces.shared.at(x);
        gradient[..x.len()].copy_from_slice(out);
        let energy = self.contacts.add_gradient(place, gradient);
        out.copy_from_slice(&gradient[..x.len()]);
        energy
    }

    fn linearize(&self, x: &[Vec3], out: &mut Vec<ContactRow>) {
        if self.contacts.is_clear_of_surfaces() {
            return self.contacts.linearize(x, out);
        }
        let first = out.len();
        self.contacts.linearize(&self.surfaces.shared.at(x)[0], out);
        // Vertices of bodies do not move, and have no part.
        for row in &mut out[first..] {
            let own = row.vertices.into_iter().min().unwrap_or_default();
            for (vertex, weight) in row.vertices.iter_mut().zip(&mut row.weights) {
                if *vertex as usize >= x.len() {
                    (*vertex, *weight) = (own, 0.0);
                }
            }
        }
    }

    fn linearization_errors(&self, x: &[Vec3], to: &[Vec3], out: &mut Vec<Real>) {
        let [from, end] = &mut *self.surfaces.shared.at(x);
        end.clone_from(from);
        end[..x.len()].copy_from_slice(to);
        self.contacts.linearization_errors(from, end, out);
    }

    fn update_multipliers(&mut self, x: &[Vec3], direction: &[Vec3]) {
        let Self { contacts, surfaces } = self;
        let [place, motion] = &mut *surfaces.shared.at(x);
        motion.fill(Vec3::zeros());
        motion[..x.len()].copy_from_slice(direction);
        contacts.update_multipliers(place, motion);
    }

    fn has_free_bodies(&self) -> bool {
        self.contacts.has_free_bodies()
    }

    fn end(&mut self, x: &[Vec3], v: &mut [Vec3]) {
        self.contacts.end(self.surfaces.at(x), v);
    }
}

impl ContactConstraints for PotentialContacts {
    fn begin_step(&mut self, step: &ContactStep<'_>) -> Result<(), ContactError> {
        self.place(step, step.from, [true, false])?;
        self.contacts.unpinch(&self.surfaces.from)?;
        let (all, _) = self.surfaces.all(step.dt);
        self.contacts.begin_step(&all)?;
        self.surfaces.clock.begin();
        Ok(())
    }

    fn begin_substep(
        &mut self,
        step: &ContactStep<'_>,
        predicted: &[Vec3],
    ) -> Result<(), ContactError> {
        self.place(step, predicted, [false, true])?;
        let (all, to) = self.surfaces.all(step.dt);
        self.contacts.begin_substep(&all, to)
    }

    fn sweep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) {
        let (all, to) = self.surfaces.with(step.dt, x);
        self.contacts.sweep(&all, to);
        self.surfaces.take(x);
    }

    fn end_substep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        loop {
            let (all, to) = self.surfaces.with(step.dt, x);
            match self.contacts.end_substep(&all, to) {
                Err(error) if self.gives_way(&error) => {
                    self.begin_substep(step, x)?;
                    for _ in 0..FEASIBLE_START_SWEEPS {
                        ContactConstraints::sweep(self, step, x);
                    }
                }
                ended => break ended?,
            }
        }
        self.surfaces.take(x);
        self.surfaces.time += step.dt;
        Ok(())
    }

    fn change_velocities(&mut self, velocities: &mut [Vec3]) {
        self.contacts.change_velocities(velocities);
    }

    fn given(&mut self, x: &[Vec3]) -> Real {
        self.contacts.given(self.surfaces.at(x))
    }

    fn end_step(&mut self, x: &[Vec3]) {
        self.contacts.end_step(self.surfaces.at(x));
    }
}

//! Contact as unilateral constraints: the view for methods that project positions.
//!
//! A substep of Δt goes from x₀. Each pair of primitives that can touch in it is a constraint n·Σ c_k x_k ≥ d₀, with
//! the nearest points frozen at x₀ (or at an earlier substep, while the patches have hardly moved against each other:
//! then cloth at rest has the same constraints in each), and what pushes is the law of the potential there: with
//! stiffness k = A ψ″ and the range d₀ = d − ψ′/ψ″ where the tangent of the force ends, so that λ (kg m) over Δt² is
//! the force k (d₀ − d) (N). XPBD's projection (Macklin et al. 2016, equation 18) with the compliance α̃ = 1/(k Δt²)
//! and λ ≥ 0 is
//!
//! Δλ = max(−λ, −(C + α̃ λ)/(Σ c_k²/m_k + α̃)), C = n·Σ c_k x_k − d₀.
//!
//! Friction holds the point where it was, with ‖f‖ ≤ μ λ; a point that sticks goes back to where it began to stick,
//! however many substeps ago. For a body the distance is evaluated anew in each sweep ([`bodies`](super::bodies)).
//!
//! The [chapter](super#for-methods-that-project-positions) has what happens at the end of a substep.

use super::bodies::{Bodies, Body, Substep};
use super::culled_substeps::CulledSubsteps;
use super::forces::Ledger;
use super::near::Near;
use super::pair_constraint::{PairConstraint, Role};
use super::patches::{Lists, NearPair, Patches};
use super::rebound::Rebounds;
use super::report::ConstraintReport;
use super::source::Contacts;
use crate::bounds::longest;
use crate::pair::ends;
use cloth_core::contact::{ContactConstraints, ContactError, ContactStep};
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::method::parallel::join;

/// Margin of detection for motion beyond the predicted one (in thicknesses).
pub(super) const DETECTION_MARGIN: Real = 0.05;
/// The fraction of its distance, or of its range where that is less, that a pair keeps in a substep.
pub(super) const KEPT: Real = 0.1;
/// Distances (in ranges) below which the law is that of this distance; and what a pair that is nearer comes back to at
/// most when it has to.
pub(super) const LEAST: Real = 0.05;
/// Rounds of sweeps without compliance, and sweeps in each.
const REPAIRS: u32 = 3;
const REPAIR_SWEEPS: u32 = 5;
/// Rounds in which paths are halved, and rounds in all before zones take over.
const HALVINGS: u32 = 3;
const ROUNDS: u32 = 12;

/// Sweeps that find the feasible start of a minimisation.
pub(super) const FEASIBLE_START_SWEEPS: u32 = 10;
/// The longest path (in thicknesses, relative to the mean motion) of a substep on the way there, and most substeps.
const PART: Real = 10.0;
const MOST_PARTS: Real = 100.0;

/// What the constraints know.
#[derive(Clone, Debug, Default)]
pub(super) struct Constraints {
    pub(super) patches: Option<Patches>,
    pub(super) bodies: Bodies,
    /// Of this substep, and of the one before.
    lists: Lists<PairConstraint>,
    last: Lists<PairConstraint>,
    culled: CulledSubsteps,
    /// Whether the last step was taken with these constraints.
    pub(super) took_last: bool,
    /// Whether the last substep found the feasible start of a minimisation (`Contacts::find_feasible_start`): the next
    /// one that does brings the patches from its end to its own start, instead of forgetting them.
    has_found_start: bool,
    /// Where the substeps to the feasible start begin, and where they go (m).
    start_buffers: (Vec<Vec3>, Vec<Vec3>),
    /// Where the sweeps have ended (m), and the fraction of the path there that each vertex goes.
    proposed: Vec<Vec3>,
    fractions: Vec<Real>,
    /// Velocities (m/s) of the substep, if zones have ended it.
    velocities: Vec<Vec3>,
    by_zones: bool,
    work: Real,
    /// Of a scene with a coefficient of restitution.
    pub(super) rebounds: Option<Rebounds>,
    pub(super) report: ConstraintReport,
}

impl Constraints {
    /// Forgets everything about earlier steps: the cloth starts at `from` (m), before `bodies` bodies.
    pub(super) fn start_anew(&mut self, near: &Near, from: &[Vec3], bodies: usize) {
        self.culled.end();
        self.bodies.forget(near.cloth, bodies);
        if let Some(patches) = &mut self.patches {
            patches.forget(from, &near.is_resting);
        }
    }

    /// Begins without constraints, and remembers what there was.
    fn clear(&mut self) {
        std::mem::swap(&mut self.lists, &mut self.last);
        self.lists.clear();
    }

    fn iter(&self) -> impl Iterator<Item = &PairConstraint> {
        self.lists.iter()
    }

    /// Those that have pushed.
    pub(super) fn touching(&self) -> impl Iterator<Item = &PairConstraint> {
        self.iter().filter(|contact| contact.state.lambda > 0.0)
    }

    /// Work (J) of what is prescribed, on its path to `x` (m), against the forces λ n c_k/Δt² of the constraints.
    fn work_of_prescribed(&self, step: &ContactStep<'_>, x: &[Vec3]) -> Real {
        let mut sum = 0.0;
        if !step.inverse_mass.contains(&0.0) {
            return 0.0;
        }
        for contact in self.touching() {
            let push = contact.normal * contact.state.lambda + contact.state.friction;
            for (v, weight) in ends(contact.pair.vertices, contact.weights) {
                if step.inverse_mass[v] == 0.0 {
                    sum -= push.dot(&(x[v] - step.from[v])) * weight;
                }
            }
        }
        sum / (step.dt * step.dt)
    }
}

impl ContactConstraints for Contacts {
    fn begin_step(&mut self, step: &ContactStep<'_>) -> Result<(), ContactError> {
        let goes_on = self.check_start(step)?;
        self.remember_bodies();
        self.free.remember();
        self.is_open = true;
        self.ledger.iter_mut().for_each(Ledger::begin);
        let constraints = &mut self.constraints;
        constraints.report = ConstraintReport::default();
        constraints.work = 0.0;
        constraints.by_zones = false;
        constraints.has_found_start = false;
        if !(goes_on && constraints.took_last) {
            constraints.start_anew(&self.near, step.from, self.before.len());
        }
        Ok(())
    }

    fn begin_substep(
        &mut self,
        step: &ContactStep<'_>,
        predicted: &[Vec3],
    ) -> Result<(), ContactError> {
        if self.near.starts_moving(step.from, predicted) {
            self.constraints
                .start_anew(&self.near, step.from, self.before.len());
        }
        let may_move = self.near.may_move(predicted.len());
        if self.constraints.culled.holds(predicted, may_move) {
            self.constraints.culled.is_on = true;
            return Ok(());
        }
        self.near.check_range(predicted)?;
        let constraints = &mut self.constraints;
        if let (true, Some(patches)) = (constraints.culled.end(), &mut constraints.patches) {
            patches.skip(step.from);
        }
        constraints.clear();
        constraints.by_zones = false;
        self.find(step, predicted, true);
        let substep = Substep::of_cloth(&self.near, &self.bodies, step);
        self.constraints.bodies.begin(&substep, predicted);
        let bodies = self.constraints.bodies.len();
        let pushes = |contact: &&PairConstraint| contact.role == Role::Pushes;
        self.constraints.report.queries += self.constraints.iter().count() as u32;
        self.constraints.report.constraints +=
            (self.constraints.iter().filter(pushes).count() + bodies) as u32;
        Ok(())
    }

    fn sweep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) {
        if self.constraints.culled.is_on {
            return;
        }
        for contact in self.constraints.lists.iter_mut() {
            if contact.role == Role::Pushes {
                contact.project(step.inverse_mass, x);
            }
        }
        let substep = Substep::of_cloth(&self.near, &self.bodies, step);
        self.constraints.bodies.sweep(&substep, x);
    }

    fn end_substep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        if self.constraints.culled.is_on {
            if self
                .constraints
                .culled
                .holds(x, self.near.may_move(x.len()))
            {
                self.constraints.report.culled_substeps += 1;
                self.ledger
                    .iter_mut()
                    .for_each(|ledger| ledger.pass(step.dt));
                return Ok(());
            }
            self.begin_substep(step, x)?;
            ContactConstraints::sweep(self, step, x);
        }
        if let Some(vertex) = x.iter().position(|x| !is_finite(x)) {
            return Err(ContactError::NonFinite { vertex });
        }
        let mut round = 0;
        loop {
            match self.violations(step, x) {
                Some(0) => {
                    self.end_by_constraints(step, x);
                    return Ok(());
                }
                Some(violated) if round < ROUNDS => self.constraints.report.violated += violated,
                _ => return self.end_by_zones(step, x),
            }
            if round < REPAIRS {
                for contact in self.constraints.lists.iter_mut() {
                    if contact.is_violated {
                        contact.harden(x);
                    }
                }
                let substep = Substep::of_cloth(&self.near, &self.bodies, step);
                self.constraints.bodies.harden(&substep, x);
                for _ in 0..REPAIR_SWEEPS {
                    ContactConstraints::sweep(self, step, x);
                }
            } else {
                self.shorten(step, x, round == REPAIRS, round < REPAIRS + HALVINGS);
            }
            round += 1;
        }
    }

    fn change_velocities(&mut self, velocities: &mut [Vec3]) {
        let constraints = &mut self.constraints;
        if constraints.by_zones {
            let own = velocities.len();
            velocities.copy_from_slice(&constraints.velocities[..own]);
        } else if let Some(rebounds) = &mut constraints.rebounds {
            constraints.work += rebounds.act(velocities, self.ledger.as_mut());
            rebounds.list.clear();
        }
    }

    fn given(&mut self, x: &[Vec3]) -> Real {
        self.constraints.work + self.energy - self.stored_in_constraints(x)
    }

    fn end_step(&mut self, x: &[Vec3]) {
        self.is_open = false;
        self.work = self.constraints.work;
        self.truncated = self.constraints.report.shortened as usize;
        self.energy = self.stored_in_constraints(x);
        if let Some(ledger) = &mut self.ledger {
            ledger.end(&self.near, &self.bodies, x);
        }
        self.constraints.took_last = true;
        x.clone_into(&mut self.safe);
        if let Some(patches) = &mut self.constraints.patches {
            self.constraints.report.searches = std::mem::take(&mut patches.searches);
            self.constraints.report.detections = std::mem::take(&mut patches.detections);
        }
    }
}

impl Contacts {
    /// Energy (J) of the constraints of the last substep, with the cloth at `x` (m).
    fn stored_in_constraints(&mut self, x: &[Vec3]) -> Real {
        let (constraints, near) = (&mut self.constraints, &self.near);
        let energy = constraints.bodies.energy(&self.bodies, near, x);
        let touching = constraints.touching();
        energy
            + touching
                .map(|contact| contact.energy(x, near))
                .sum::<Real>()
    }

    /// Constraints for the pairs that a path to `to` (m) can bring into contact, if it is not too long for that.
    /// Returns whether it was not.
    fn find(&mut self, step: &ContactStep<'_>, to: &[Vec3], begins: bool) -> bool {
        let reach = self.reach();
        let Self {
            near, constraints, ..
        } = self;
        let (Some(patches), last) = (&mut constraints.patches, &constraints.last) else {
            return true;
        };
        let visit = |list: &mut Vec<PairConstraint>,
                     pair: &mut NearPair,
                     place: Option<[u32; 2]>,
                     travel| {
            let last = place.map(|place| last.at(place));
            PairConstraint::add(list, pair, last, near, step, (to, travel, reach)) - pair.range
        };
        patches.detect_for_substep(near, [step.from, to], begins, &mut constraints.lists, visit)
    }

    /// How many pairs do not keep their distances on the path to `x` (m); nothing if the path is too long to say.
    fn violations(&mut self, step: &ContactStep<'_>, x: &[Vec3]) -> Option<u32> {
        if !self.find(step, x, false) {
            return None;
        }
        let near = &self.near;
        let test = |contact: &mut PairConstraint| contact.test(near, step, x);
        let (first, later) = self.constraints.lists.split();
        let count =
            test_all(first, x.len(), &test) + test_all(std::slice::from_mut(later), x.len(), &test);
        let substep = Substep::of_cloth(&self.near, &self.bodies, step);
        Some(count + self.constraints.bodies.violations(&substep, x))
    }

    /// Shortens the paths of vertices of violated pairs.
    fn shorten(&mut self, step: &ContactStep<'_>, x: &mut [Vec3], begins: bool, halves: bool) {
        let constraints = &mut self.constraints;
        if begins {
            x.clone_into(&mut constraints.proposed);
            constraints.fractions.clear();
            constraints.fractions.resize(x.len(), 1.0);
        }
        let pairs = constraints
            .lists
            .iter()
            .filter(|contact| contact.is_violated);
        let vertices = pairs.flat_map(|contact| contact.pair.vertices);
        let fractions = &mut constraints.fractions;
        let mut shorten = |v: u32| {
            let v = v as usize;
            if step.inverse_mass[v] > 0.0 && fractions[v] > 0.0 {
                fractions[v] = if halves { -0.5 * fractions[v] } else { -0.0 };
            }
        };
        vertices.for_each(&mut shorten);
        constraints.bodies.violated().for_each(&mut shorten);
        for (v, fraction) in fractions.iter_mut().enumerate() {
            // Negative until here, so that a vertex of several pairs is shortened once.
            if fraction.is_sign_negative() {
                constraints.report.shortened += 1;
                *fraction = -*fraction;
                let from = step.from[v];
                x[v] = from + (constraints.proposed[v] - from) * *fraction;
            }
        }
    }

    /// Enters the impulses of the constraints in a substep that ends at `x` (m).
    fn record_impulses(&mut self, step: &ContactStep<'_>, x: &[Vec3]) {
        self.collect_impulses(step, x);
        let Some(ledger) = &mut self.ledger else {
            return;
        };
        ledger.pass(step.dt);
        ledger.add_stops(&self.free, &self.stops, 1.0);
        let constraints = &self.constraints;
        for contact in constraints.touching() {
            let impulses = [
                contact.normal * contact.state.lambda,
                contact.state.friction,
            ]
            .map(|push| push / step.dt);
            ledger.add_pair(contact.pair.vertices, contact.weights, impulses);
        }
        let substep = Substep::of_cloth(&self.near, &self.bodies, step);
        constraints.bodies.record(&substep, x, ledger);
    }

    /// The substep ends at `x` (m), and what it has done is remembered.
    fn end_by_constraints(&mut self, step: &ContactStep<'_>, x: &[Vec3]) {
        self.record_impulses(step, x);
        let reach = self.reach();
        let (constraints, bodies, near) = (&mut self.constraints, &self.bodies[..], &self.near);
        if let Some(patches) = &mut constraints.patches {
            patches.accept();
        }
        let substep = Substep::of_cloth(near, bodies, step);
        constraints.work += constraints.bodies.end(&substep, reach, x);
        constraints.work += constraints.work_of_prescribed(step, x);
        if let Some(rebounds) = &mut constraints.rebounds {
            let touching = constraints
                .lists
                .iter()
                .filter(|contact| contact.state.lambda > 0.0);
            rebounds.find(touching, near, step, x);
            constraints
                .bodies
                .rebounds(&substep, rebounds.least(near), x, &mut rebounds.list);
        }
        if constraints.lists.is_empty() && constraints.bodies.len() == 0 {
            let patches = constraints.patches.as_ref();
            let relative = patches.map_or(Some([Real::INFINITY; 2]), Patches::margins);
            let whole = constraints.bodies.margin(&substep, x);
            // A body that nothing holds may start to move in the next substep.
            let is_alone = self.free.list.is_empty();
            if let (Some(relative), Some(whole), true) = (relative, whole, is_alone) {
                constraints.culled.begin(x, relative, whole);
            }
        }
        self.advance_bodies(step.dt);
    }

    /// Moves the bodies on by `dt` (s).
    fn advance_bodies(&mut self, dt: Real) {
        self.push_free(dt);
        for (body, _) in &mut self.bodies {
            if !body.motion().is_still() {
                let moved = body.advance(dt);
                debug_assert!(moved.is_ok(), "a finite motion");
            }
        }
    }

    /// Moves the start `x` (m) of an iteration to a feasible one, around what prescribed vertices and bodies do in the
    /// step: substeps of the constraints on the way to `x`, none of them long.
    pub(super) fn find_feasible_start(
        &mut self,
        step: &ContactStep<'_>,
        goes_on: bool,
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        let constraints = &mut self.constraints;
        let has_found_start = std::mem::take(&mut constraints.has_found_start);
        match &mut constraints.patches {
            Some(patches) if goes_on && has_found_start => patches.skip(step.from),
            _ => constraints.start_anew(&self.near, step.from, self.before.len()),
        }
        let parts = longest([step.from, x]) / (PART * self.near.law.range());
        let parts = parts.ceil().clamp(1.0, MOST_PARTS) as u32;
        let (mut from, mut goal) = std::mem::take(&mut self.constraints.start_buffers);
        step.from.clone_into(&mut from);
        x.clone_into(&mut goal);
        self.free.finds_feasible_start = true;
        let mut found = Ok(());
        for left in (1..=parts).rev() {
            if left > 1 {
                let part = 1.0 / Real::from(left);
                let ends = x.iter_mut().zip(&from).zip(&goal);
                ends.for_each(|((x, from), goal)| *x = from + (goal - from) * part);
            } else {
                x.copy_from_slice(&goal);
            }
            let dt = step.dt / Real::from(parts);
            found = self.move_to_feasible(
                &ContactStep {
                    from: &from,
                    dt,
                    ..*step
                },
                x,
            );
            if found.is_err() {
                break;
            }
            from.copy_from_slice(x);
        }
        self.free.finds_feasible_start = false;
        self.constraints.start_buffers = (from, goal);
        self.constraints.has_found_start = found.is_ok();
        found
    }

    fn move_to_feasible(
        &mut self,
        step: &ContactStep<'_>,
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.begin_substep(step, x)?;
        self.constraints.bodies.move_out();
        for _ in 0..FEASIBLE_START_SWEEPS {
            ContactConstraints::sweep(self, step, x);
        }
        self.end_substep(step, x)
    }

    /// The substep is taken out of the hands of the constraints: impact zones bring it to an end.
    fn end_by_zones(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        self.record_impulses(step, x);
        let constraints = &mut self.constraints;
        constraints.report.zones += 1;
        constraints.velocities.clear();
        let displacements = step.from.iter().zip(&*x);
        constraints
            .velocities
            .extend(displacements.map(|(from, x)| (x - from) / step.dt));
        // What was proposed has been given up.
        constraints.proposed.clone_from(&constraints.velocities);
        let bodies = &self.bodies[..];
        let substep = Substep {
            near: &self.near,
            bodies,
            step: *step,
        };
        let truncated = self
            .last_resort
            .resolve(&substep, x, &mut constraints.velocities)?;
        constraints.report.shortened += truncated as u32;
        let changes = constraints.velocities.iter().zip(&constraints.proposed);
        let changes = changes.map(|(after, before)| after - before);
        let mut work = 0.0;
        for (v, (change, w)) in changes.zip(step.inverse_mass).enumerate() {
            if *w > 0.0 && change != Vec3::zeros() {
                work += work_of_nearest(bodies, change, x[v], step.dt) / w;
                self.ledger
                    .iter_mut()
                    .for_each(|ledger| ledger.add(v, change / *w));
            }
        }
        constraints.work += work;
        constraints.by_zones = true;
        constraints.clear();
        constraints.start_anew(&self.near, x, self.before.len());
        self.advance_bodies(step.dt);
        Ok(())
    }
}

/// Tests all constraints, on several threads if the cloth has enough `vertices`; returns how many are violated.
fn test_all(
    lists: &mut [Vec<PairConstraint>],
    vertices: usize,
    test: &(impl Fn(&mut PairConstraint) + Sync),
) -> u32 {
    if lists.len() > 1 {
        let (some, others) = lists.split_at_mut(lists.len() / 2);
        let (a, b) = join(
            vertices,
            || test_all(some, vertices, test),
            || test_all(others, vertices, test),
        );
        return a + b;
    }
    let constraints = lists.iter_mut().flatten();
    constraints
        .map(|contact| {
            test(contact);
            u32::from(contact.is_violated)
        })
        .sum()
}

/// Work (J/kg) of what contact has changed of the velocity (m/s) of a vertex at `x` (m): times that of the nearest body
/// there, at the end of a substep of `dt` (s). Impulses of cloth on cloth come in pairs at one place, which cancel in
/// the velocity field of a rigid body.
fn work_of_nearest(bodies: &[Body], push: Vec3, x: Vec3, dt: Real) -> Real {
    let distance = |body: &&Body| body.0.signed_distance(x, dt).value;
    let nearest = bodies
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(0.0, |(body, _)| push.dot(&body.motion().velocity_at(x, dt)))
}

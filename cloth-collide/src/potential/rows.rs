//! Contact as unilateral constraints: the view for methods that project positions.
//!
//! A substep of Δt goes from x₀. Each pair of pieces that can touch in it is a row n·Σ wᵢ xᵢ ≥ d̂, with the nearest
//! points frozen at x₀ (or at an earlier substep, while the patches have hardly moved against each other: then cloth at
//! rest has the same rows in each), and what pushes is the law of the potential there: with stiffness k = A ψ″ and the
//! range d̂ = d − ψ′/ψ″ where the tangent of the force ends, so that λ (kg m) over Δt² is the force k (d̂ − d) (N).
//! XPBD's projection (Macklin et al. 2016, equation 18) with the compliance α̃ = 1/(k Δt²) and λ ≥ 0 is
//!
//! Δλ = max(−λ, −(C + α̃ λ)/(Σ wᵢ²/mᵢ + α̃)), C = n·Σ wᵢ xᵢ − d̂.
//!
//! Friction holds the point where it was, with ‖f‖ ≤ μ λ; a point that sticks goes back to where it began to stick,
//! however many substeps ago. For a body the distance is evaluated anew in each sweep ([`bodies`](super::bodies)).
//!
//! What happens at the end of a substep says the [chapter](super#for-methods-that-project-positions).

use super::bodies::{Bodies, Body, Substep};
use super::forces::Ledger;
use super::near::Near;
use super::patches::{NearPair, Patches};
use super::quiet::Quiet;
use super::rebound::Rebounds;
use super::report::ConstraintReport;
use super::row::{Role, Row};
use super::source::Contacts;
use crate::pair::ends;
use cloth_core::contact::{ContactConstraints, ContactError, ContactStep};
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::method::parallel::join;

/// Allowance for motion beyond the predicted one in detection (in thicknesses).
pub(super) const SLACK: Real = 0.05;
/// The part of its distance, or of its range where that is less, that a pair keeps in a substep.
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

/// Sweeps that lead the start of a minimisation.
pub(super) const LEADING_SWEEPS: u32 = 10;

/// What the constraints know.
#[derive(Debug, Default)]
pub(super) struct Rows {
    pub(super) patches: Option<Patches>,
    pub(super) bodies: Bodies,
    /// Of this substep, and of the one before.
    rows: Vec<Vec<Row>>,
    last: Vec<Vec<Row>>,
    quiet: Quiet,
    /// Whether the last step was taken with these rows.
    pub(super) took_last: bool,
    /// Whether the last substep led the start of a minimisation (`Contacts::lead`): the next one that does brings the
    /// patches from its end to its own start, instead of forgetting them.
    has_led: bool,
    /// Where the sweeps have ended (m), and the part of the path there that each vertex goes.
    proposed: Vec<Vec3>,
    shares: Vec<Real>,
    /// Velocities (m/s) of the substep, if zones have ended it.
    velocities: Vec<Vec3>,
    by_zones: bool,
    work: Real,
    /// Of a scene with a coefficient of restitution.
    pub(super) rebounds: Option<Rebounds>,
    pub(super) report: ConstraintReport,
}

impl Rows {
    /// Forgets everything about earlier steps: the cloth starts at `from` (m), before so many bodies.
    pub(super) fn start_anew(&mut self, near: &Near, from: &[Vec3], bodies: usize) {
        self.quiet.end();
        self.bodies.forget(near.cloth, bodies);
        if let Some(patches) = &mut self.patches {
            patches.forget(from, &near.is_resting);
        }
    }

    /// Begins without rows, and remembers what there was.
    fn clear(&mut self) {
        std::mem::swap(&mut self.rows, &mut self.last);
        self.rows.iter_mut().for_each(Vec::clear);
    }

    fn iter(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().flatten()
    }

    /// Those that have pushed.
    pub(super) fn touching(&self) -> impl Iterator<Item = &Row> {
        self.iter().filter(|row| row.state.lambda > 0.0)
    }

    /// Work (J) of what is prescribed, on its path to `x` (m), against the forces λ n wᵢ/Δt² of the rows.
    fn work_of_prescribed(&self, step: &ContactStep<'_>, x: &[Vec3]) -> Real {
        let mut sum = 0.0;
        if !step.inverse_mass.contains(&0.0) {
            return 0.0;
        }
        for row in self.touching() {
            let push = row.normal * row.state.lambda + row.state.friction;
            for (v, weight) in ends(row.pair.vertices, row.weights) {
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
        let rows = &mut self.rows;
        rows.report = ConstraintReport::default();
        rows.work = 0.0;
        rows.by_zones = false;
        rows.has_led = false;
        if !(goes_on && rows.took_last) {
            rows.start_anew(&self.near, step.from, self.before.len());
        }
        Ok(())
    }

    fn begin_substep(
        &mut self,
        step: &ContactStep<'_>,
        predicted: &[Vec3],
    ) -> Result<(), ContactError> {
        if self.near.sets_out(step.from, predicted) {
            self.rows
                .start_anew(&self.near, step.from, self.before.len());
        }
        if self.rows.quiet.holds(predicted) {
            self.rows.quiet.is_on = true;
            return Ok(());
        }
        if let Some(vertex) = predicted.iter().position(|x| !is_finite(x)) {
            return Err(ContactError::NonFinite { vertex });
        }
        let rows = &mut self.rows;
        if let (true, Some(patches)) = (rows.quiet.end(), &mut rows.patches) {
            patches.skip(step.from);
        }
        rows.clear();
        rows.by_zones = false;
        self.find(step, predicted, true);
        let substep = Substep::of_cloth(&self.near, &self.bodies, step);
        self.rows.bodies.begin(&substep, predicted);
        let bodies = self.rows.bodies.len();
        let pushes = |row: &&Row| row.role == Role::Pushes;
        self.rows.report.queries += self.rows.iter().count() as u32;
        self.rows.report.constraints += (self.rows.iter().filter(pushes).count() + bodies) as u32;
        Ok(())
    }

    fn sweep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) {
        if self.rows.quiet.is_on {
            return;
        }
        for row in self.rows.rows.iter_mut().flatten() {
            if row.role == Role::Pushes {
                row.project(step.inverse_mass, x);
            }
        }
        let substep = Substep::of_cloth(&self.near, &self.bodies, step);
        self.rows.bodies.sweep(&substep, x);
    }

    fn end_substep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        if self.rows.quiet.is_on {
            if self.rows.quiet.holds(x) {
                self.rows.report.culled_substeps += 1;
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
                    self.end_by_rows(step, x);
                    return Ok(());
                }
                Some(violated) if round < ROUNDS => self.rows.report.violated += violated,
                _ => return self.end_by_zones(step, x),
            }
            if round < REPAIRS {
                for row in self.rows.rows.iter_mut().flatten() {
                    if row.is_violated {
                        row.harden(x);
                    }
                }
                let substep = Substep::of_cloth(&self.near, &self.bodies, step);
                self.rows.bodies.harden(&substep, x);
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
        let rows = &mut self.rows;
        if rows.by_zones {
            let own = velocities.len();
            velocities.copy_from_slice(&rows.velocities[..own]);
        } else if let Some(rebounds) = &mut rows.rebounds {
            rows.work += rebounds.act(velocities, self.ledger.as_mut());
            rebounds.list.clear();
        }
    }

    fn given(&mut self, x: &[Vec3]) -> Real {
        self.rows.work + self.energy - self.stored_in_rows(x)
    }

    fn end_step(&mut self, x: &[Vec3]) {
        self.is_open = false;
        self.work = self.rows.work;
        self.held = self.rows.report.shortened as usize;
        self.energy = self.stored_in_rows(x);
        if let Some(ledger) = &mut self.ledger {
            ledger.end(&self.near, &self.bodies, x);
        }
        self.rows.took_last = true;
        x.clone_into(&mut self.safe);
        if let Some(patches) = &mut self.rows.patches {
            self.rows.report.searches = std::mem::take(&mut patches.searches);
            self.rows.report.detections = std::mem::take(&mut patches.detections);
        }
    }
}

impl Contacts {
    /// Energy (J) of the rows of the last substep, with the cloth at `x` (m).
    fn stored_in_rows(&mut self, x: &[Vec3]) -> Real {
        let (rows, near) = (&mut self.rows, &self.near);
        let energy = rows.bodies.energy(&self.bodies, near, x);
        let touching = rows.touching();
        energy + touching.map(|row| row.energy(x, near)).sum::<Real>()
    }

    /// Rows for the pairs that a path to `to` (m) can bring into contact, if it is not too long for that. Returns
    /// whether it was not.
    fn find(&mut self, step: &ContactStep<'_>, to: &[Vec3], begins: bool) -> bool {
        let reach = self.reach();
        let Self { near, rows, .. } = self;
        let (Some(patches), last) = (&mut rows.patches, &rows.last) else {
            return true;
        };
        let visit = |rows: &mut Vec<Row>, pair: &mut NearPair, place: Option<[u32; 2]>, travel| {
            let last = place.map(|[list, index]| &last[list as usize][index as usize]);
            Row::add(rows, pair, last, near, step, (to, travel, reach)) - pair.range
        };
        patches.detect_for_substep(near, [step.from, to], begins, &mut rows.rows, visit)
    }

    /// How many pairs do not keep their distances on the path to `x` (m); nothing if the path is too long to say.
    fn violations(&mut self, step: &ContactStep<'_>, x: &[Vec3]) -> Option<u32> {
        if !self.find(step, x, false) {
            return None;
        }
        let near = &self.near;
        let count = test_all(&mut self.rows.rows, x.len(), &|row| row.test(near, step, x));
        let substep = Substep::of_cloth(&self.near, &self.bodies, step);
        Some(count + self.rows.bodies.violations(&substep, x))
    }

    /// Shortens the paths of vertices of violated pairs.
    fn shorten(&mut self, step: &ContactStep<'_>, x: &mut [Vec3], begins: bool, halves: bool) {
        let rows = &mut self.rows;
        if begins {
            x.clone_into(&mut rows.proposed);
            rows.shares.clear();
            rows.shares.resize(x.len(), 1.0);
        }
        let pairs = rows.rows.iter().flatten().filter(|row| row.is_violated);
        let vertices = pairs.flat_map(|row| row.pair.vertices);
        let shares = &mut rows.shares;
        let mut shorten = |v: u32| {
            let v = v as usize;
            if step.inverse_mass[v] > 0.0 && shares[v] > 0.0 {
                shares[v] = if halves { -0.5 * shares[v] } else { -0.0 };
            }
        };
        vertices.for_each(&mut shorten);
        rows.bodies.violated().for_each(&mut shorten);
        for (v, share) in shares.iter_mut().enumerate() {
            // Negative until here, so that a vertex of several pairs is shortened once.
            if share.is_sign_negative() {
                rows.report.shortened += 1;
                *share = -*share;
                let from = step.from[v];
                x[v] = from + (rows.proposed[v] - from) * *share;
            }
        }
    }

    /// Enters the impulses of the rows in a substep that ends at `x` (m).
    fn record_impulses(&mut self, step: &ContactStep<'_>, x: &[Vec3]) {
        self.collect_impulses(step, x);
        let Some(ledger) = &mut self.ledger else {
            return;
        };
        ledger.pass(step.dt);
        ledger.add_stops(&self.free, 1.0);
        let rows = &self.rows;
        for row in rows.touching() {
            let impulses =
                [row.normal * row.state.lambda, row.state.friction].map(|push| push / step.dt);
            ledger.add_pair(row.pair.vertices, row.weights, impulses);
        }
        let substep = Substep::of_cloth(&self.near, &self.bodies, step);
        rows.bodies.record(&substep, x, ledger);
    }

    /// The substep ends at `x` (m), and what it has done is remembered.
    fn end_by_rows(&mut self, step: &ContactStep<'_>, x: &[Vec3]) {
        self.record_impulses(step, x);
        let reach = self.reach();
        let (rows, bodies, near) = (&mut self.rows, &self.bodies[..], &self.near);
        if let Some(patches) = &mut rows.patches {
            patches.accept();
        }
        let substep = Substep::of_cloth(near, bodies, step);
        rows.work += rows.bodies.end(&substep, reach, x);
        rows.work += rows.work_of_prescribed(step, x);
        if let Some(rebounds) = &mut rows.rebounds {
            let touching = rows
                .rows
                .iter()
                .flatten()
                .filter(|row| row.state.lambda > 0.0);
            rebounds.find(touching, near, step, x);
            rows.bodies
                .rebounds(&substep, rebounds.least(near), x, &mut rebounds.list);
        }
        if rows.rows.iter().all(Vec::is_empty) && rows.bodies.len() == 0 {
            let patches = rows.patches.as_ref();
            let relative = patches.map_or(Some(Real::INFINITY), Patches::margin);
            let whole = rows.bodies.margin(&substep, x);
            // A body that nothing holds may set out in the next substep.
            let is_alone = self.free.list.is_empty();
            if let (Some(relative), Some(whole), true) = (relative, whole, is_alone) {
                rows.quiet.begin(x, relative, whole);
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

    /// Leads the start `x` (m) of an iteration around what prescribed vertices and bodies do in the step: a substep of
    /// the constraints.
    pub(super) fn lead(
        &mut self,
        step: &ContactStep<'_>,
        goes_on: bool,
        x: &mut [Vec3],
    ) -> Result<(), ContactError> {
        let rows = &mut self.rows;
        let has_led = std::mem::take(&mut rows.has_led);
        match &mut rows.patches {
            Some(patches) if goes_on && has_led => patches.skip(step.from),
            _ => rows.start_anew(&self.near, step.from, self.before.len()),
        }
        self.begin_substep(step, x)?;
        self.rows.bodies.lead_out();
        for _ in 0..LEADING_SWEEPS {
            ContactConstraints::sweep(self, step, x);
        }
        self.free.is_led = true;
        let ended = self.end_substep(step, x);
        self.free.is_led = false;
        ended?;
        self.rows.has_led = true;
        Ok(())
    }

    /// The substep is taken out of the hands of the rows: impact zones bring it to an end.
    fn end_by_zones(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        self.record_impulses(step, x);
        let rows = &mut self.rows;
        rows.report.zones += 1;
        rows.velocities.clear();
        let displacements = step.from.iter().zip(&*x);
        rows.velocities
            .extend(displacements.map(|(from, x)| (x - from) / step.dt));
        // What was proposed has been given up.
        rows.proposed.clone_from(&rows.velocities);
        let bodies = &self.bodies[..];
        let substep = Substep {
            near: &self.near,
            bodies,
            step: *step,
        };
        let held = self
            .last_resort
            .resolve(&substep, x, &mut rows.velocities)?;
        rows.report.shortened += held as u32;
        let changes = rows.velocities.iter().zip(&rows.proposed);
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
        rows.work += work;
        rows.by_zones = true;
        rows.clear();
        rows.start_anew(&self.near, x, self.before.len());
        self.advance_bodies(step.dt);
        Ok(())
    }
}

/// Tests all rows, on several threads for a cloth of so many vertices; returns how many are violated.
fn test_all(lists: &mut [Vec<Row>], vertices: usize, test: &(impl Fn(&mut Row) + Sync)) -> u32 {
    if lists.len() > 1 {
        let (some, others) = lists.split_at_mut(lists.len() / 2);
        let (a, b) = join(
            vertices,
            || test_all(some, vertices, test),
            || test_all(others, vertices, test),
        );
        return a + b;
    }
    let rows = lists.iter_mut().flatten();
    rows.map(|row| {
        test(row);
        u32::from(row.is_violated)
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

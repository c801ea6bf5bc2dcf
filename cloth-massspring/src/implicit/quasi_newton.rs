//! The direction, around a multigrid cycle on a positive definite Hessian: of L-BFGS, or that of a truncated Newton
//! method where contact shortens steps, or where a second derivative jumps and 32 iterations were not enough.
//!
//! *Why.* Pairs of differences tell of the Hessian as it was. With springs that are slack within some range, as many as
//! a cloth has edges come and go in a step, and L-BFGS took 600 iterations, of which most had to be ended by a
//! factorisation; now 50 to 90. Without such jumps Newton's directions take a third of the iterations and more time:
//! eight to fourteen cycles each, for cloth that crumples as for very stiff cloth.
//!
//! *Tried in vain* in contact: back to L-BFGS after three to eight whole steps (a sheet that wraps a ball takes two to
//! three times the iterations, and the same time); conjugate gradients to 0.2, 0.3 or 0.5 of the residual (within a
//! tenth of the time, one scene faster and the next one slower).
//!
//! Stiff springs with slack under compression that land on an edge take some steps thousands of iterations, each cut to
//! a hundredth of its direction. In vain: for springs within their slack the mean stiffness up to where the last
//! direction would have led (no change), all of it (as many linear iterations), a hundredth of it (half of them).

use super::drift::Unconstrained;
use super::line_search::Point;
use super::piecewise::Piecewise;
use super::stage::Stage;
use cloth_core::contact::{ContactPotential, ContactRow};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::contact_hessian::ContactHessian;
use cloth_core::method::family::{Assembly, Energies};
use cloth_core::method::in_contact::{
    FIRST_ITERATIONS, MAX_SHORTENED_STEPS, NEWTON_DIRECTION, REFRESH_INTERVAL, SHORTENED_BELOW,
};
use cloth_core::method::limited_memory::LimitedMemory;
use cloth_core::method::vectors::dot;

/// Pairs that are kept.
const HISTORY: usize = 5;
/// Iterations of L-BFGS where a second derivative jumps ([`Energies::have_jumps`]), before directions are Newton's.
const WITH_JUMPS: u32 = 32;

/// The first inverse Hessian, and the pairs.
#[derive(Debug)]
pub(super) struct QuasiNewton {
    assembly: Assembly,
    hessian: ContactHessian,
    unconstrained: Unconstrained,
    pub(super) piecewise: Piecewise,
    history: LimitedMemory<f32>,
    rows: Vec<ContactRow>,
    work: Vec<Vec3>,
    /// Steps in this minimisation that were shortened.
    shortened_steps: u32,
    /// The last iteration of L-BFGS in a step.
    last_of_pairs: u32,
    /// Iterations in this step, and since the matrix was taken.
    iterations: u32,
    age: u32,
    /// Along the last direction (J).
    slope: Real,
}

impl QuasiNewton {
    pub(super) fn new(energies: &Energies, is_free: Vec<bool>) -> Self {
        let assembly = energies.lumped_assembly();
        let unconstrained = Unconstrained::of_energies(energies, assembly.pattern(), &is_free);
        let count = is_free.len();
        let mut hessian = ContactHessian::new(assembly.pattern(), is_free);
        let mut last_of_pairs = u32::MAX;
        if energies.have_jumps() {
            last_of_pairs = WITH_JUMPS;
            hessian.make_room();
        }
        Self {
            history: LimitedMemory::new(count, HISTORY),
            rows: Vec::new(),
            work: vec![Vec3::zeros(); count],
            shortened_steps: 0,
            last_of_pairs,
            unconstrained,
            piecewise: Piecewise::new(assembly.pattern()),
            hessian,
            assembly,
            iterations: 0,
            age: 0,
            slope: 0.0,
        }
    }

    pub(super) fn begin(&mut self) {
        self.history.clear();
        (self.iterations, self.age, self.shortened_steps) = (0, 0, 0);
        self.hessian.clear_contacts();
    }

    /// Recomputes the matrix at `current` if it is time, in the first iterations with predicted forces. `before` is the
    /// iterate before, or the start of the step (m).
    /// Returns whether it did.
    pub(super) fn refresh(
        &mut self,
        stage: &Stage<'_>,
        current: &Point,
        before: &[Vec3],
        is_start: bool,
    ) -> bool {
        let x = &current.positions[..];
        let is_mixed = self.iterations < FIRST_ITERATIONS;
        if !is_mixed && self.age < REFRESH_INTERVAL && !self.is_newton() {
            return false;
        }
        let to = if is_start { before } else { x };
        let mixed = is_mixed.then_some([before, to]);
        let matrix = self.hessian.matrix_mut();
        stage.lumped_hessian_into(&self.assembly, x, mixed, matrix);
        let rest = stage.potential.particles.rest_positions();
        let contact = stage.contact;
        self.hessian.refresh(contact, x, rest.unwrap_or(before));
        if is_mixed || self.is_newton() {
            self.history.clear();
        }
        self.age = 0;
        true
    }

    /// Whether contacts were active where the matrix was taken last.
    pub(super) fn has_active_contacts(&self) -> bool {
        self.hessian.has_contacts()
    }

    /// Whether the last direction was by a matrix of where it begins.
    pub(super) fn is_fresh(&self) -> bool {
        self.age == 1
    }

    /// The matrix (N/m) that was taken last.
    pub(super) fn matrix(&self) -> &BlockMatrix {
        self.hessian.matrix()
    }

    /// Whether contact shortens the steps so often that directions of L-BFGS lead nowhere.
    fn is_often_shortened(&self) -> bool {
        self.shortened_steps >= MAX_SHORTENED_STEPS
    }

    /// Whether directions are those of a truncated Newton method.
    fn is_newton(&self) -> bool {
        self.is_often_shortened() || self.iterations >= self.last_of_pairs
    }

    /// Writes the direction (m) for a gradient (N) to `out`. Returns the slope along it (J); what has to be added to
    /// minus the slope for the square of the Newton decrement (J), because conjugate gradients ended before the
    /// solution, 0 for L-BFGS; and the number of linear iterations.
    pub(super) fn direction(&mut self, gradient: &[Vec3], out: &mut [Vec3]) -> (Real, Real, u32) {
        let is_newton = self.is_newton();
        self.iterations += 1;
        self.age += 1;
        if is_newton {
            let (left, iterations) = self.hessian.solve(NEWTON_DIRECTION, gradient, out);
            return (dot(gradient, out), left, iterations);
        }
        let hessian = &mut self.hessian;
        let inverse = |r: &[Vec3], z: &mut [Vec3]| hessian.precondition(r, z);
        let (history, work) = (&mut self.history, &mut self.work);
        self.slope = history.direction(gradient, work, out, inverse);
        (self.slope, 0.0, 1)
    }

    /// The second-order correction of a direction (m) from `x` (m) of which `fraction` is to be followed
    /// ([`ContactHessian::correct`]), if the matrix is that of `x`. Returns whether there was anything to correct.
    pub(super) fn correct(
        &mut self,
        contact: &dyn ContactPotential,
        x: &[Vec3],
        fraction: Real,
        direction: &mut [Vec3],
    ) -> bool {
        self.is_fresh() && self.hessian.correct(contact, x, fraction, direction)
    }

    /// Records a step that contact, the trust radius or the line search has shortened to `fraction` of its direction. A
    /// volume that is kept shortens steps by itself, and a better direction does not help there.
    pub(super) fn record_shortening(&mut self, fraction: Real) {
        self.shortened_steps +=
            u32::from(fraction < SHORTENED_BELOW && !self.hessian.has_global_terms());
    }

    /// Keeps the pair (s, y) of L-BFGS, of which s is no time, of a step of `length` along the last direction (m) from
    /// one gradient (N) to another.
    pub(super) fn accumulate(
        &mut self,
        length: Real,
        direction: &[Vec3],
        from: &[Vec3],
        to: &[Vec3],
    ) {
        if self.iterations >= FIRST_ITERATIONS && !self.is_newton() {
            self.history.push(length, self.slope, direction, from, to);
        }
    }

    /// Records a step that is no multiple of its direction: drops the pairs, whose secants it has left.
    pub(super) fn drop_pairs(&mut self) {
        self.history.clear();
        self.shortened_steps += u32::from(!self.hessian.has_global_terms());
    }

    /// Restores the momentum of unconstrained components at an evaluated point.
    pub(super) fn restore_momentum(&self, stage: &Stage<'_>, point: &mut Point) {
        self.unconstrained.restore_momentum(stage, point);
    }

    /// The same where components touch each other, but nothing else. Returns whether that is so.
    pub(super) fn restore_momentum_together(
        &mut self,
        stage: &Stage<'_>,
        contact: &dyn ContactPotential,
        point: &mut Point,
    ) -> bool {
        self.rows.clear();
        contact.linearize(&point.positions, &mut self.rows);
        self.rows.iter().all(ContactRow::is_internal)
            && self.unconstrained.restore_momentum_together(stage, point)
    }

    /// Goes back to L-BFGS without pairs, and recomputes the matrix in the next iteration. Returns whether that changes
    /// anything.
    pub(super) fn restart(&mut self) -> bool {
        let changes = self.is_often_shortened() || !self.history.is_empty() || self.age > 1;
        self.history.clear();
        (self.age, self.shortened_steps) = (REFRESH_INTERVAL, 0);
        changes
    }
}

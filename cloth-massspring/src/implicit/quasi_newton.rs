//! The direction, around a multigrid cycle on a positive definite Hessian: of L-BFGS, or in contact that of a truncated
//! Newton method.

use super::drift::Unconstrained;
use super::global_terms::GlobalTerms;
use super::line_search::Point;
use super::stage::Stage;
use super::truncated_newton::{CG_TOLERANCE, MAX_CG_ITERATIONS, Operator};
use cloth_core::contact::{ContactPotential, ContactRow};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::family::{Assembly, Energies};
use cloth_core::method::limited_memory::LimitedMemory;
use cloth_core::method::linear::TruncatedConjugateGradients;
use cloth_core::method::multigrid::Multigrid;
use cloth_core::method::vectors::dot;
use std::sync::Arc;

/// Iterations at the start of a step that take the matrix anew each, with predicted forces.
const PREDICTED_FORCE_ITERATIONS: u32 = 4;
/// Iterations after which the matrix is taken anew.
const REFRESH_INTERVAL: u32 = 8;
/// Fraction of a direction below which a step in contact counts as shortened, and the number of such steps after which
/// directions are those of the truncated Newton method.
const SHORTENED_BELOW: Real = 0.25;
const MAX_SHORTENED_STEPS: u32 = 5;
/// Largest stiffness of a contact, over the largest diagonal block of the cloth: beyond, a cycle in single precision
/// would not stay positive definite.
const MAX_CONTACT_STIFFNESS_RATIO: Real = 1e4;
/// Pairs that are kept.
const HISTORY: usize = 5;

/// The first inverse Hessian, and the pairs.
#[derive(Debug)]
pub(super) struct QuasiNewton {
    assembly: Assembly,
    matrix: BlockMatrix,
    is_free: Vec<bool>,
    unconstrained: Unconstrained,
    multigrid: Option<Multigrid>,
    history: LimitedMemory<f32>,
    /// Contacts, and those at the last matrix between vertices.
    rows: Vec<ContactRow>,
    contact_pairs: Vec<ContactRow>,
    /// The latter, none stiffer than a cycle can take.
    for_cycle: Vec<ContactRow>,
    global: GlobalTerms,
    truncated_newton: TruncatedConjugateGradients,
    work: Vec<Vec3>,
    /// Steps in this minimisation that were shortened.
    shortened_steps: u32,
    /// Iterations in this step, and since the matrix was taken.
    iterations: u32,
    age: u32,
    /// Along the last direction (J).
    slope: Real,
}

impl QuasiNewton {
    pub(super) fn new(energies: &Energies, is_free: Vec<bool>) -> Self {
        let assembly = energies.lumped_assembly();
        Self {
            matrix: BlockMatrix::zeros(Arc::clone(assembly.pattern())),
            history: LimitedMemory::new(is_free.len(), HISTORY),
            rows: Vec::new(),
            contact_pairs: Vec::new(),
            for_cycle: Vec::new(),
            global: GlobalTerms::default(),
            truncated_newton: TruncatedConjugateGradients::default(),
            work: vec![Vec3::zeros(); is_free.len()],
            multigrid: None,
            shortened_steps: 0,
            unconstrained: Unconstrained::of_energies(energies, assembly.pattern(), &is_free),
            assembly,
            is_free,
            iterations: 0,
            age: 0,
            slope: 0.0,
        }
    }

    pub(super) fn begin(&mut self) {
        self.history.clear();
        (self.iterations, self.age, self.shortened_steps) = (0, 0, 0);
        self.contact_pairs.clear();
        self.for_cycle.clear();
        self.global.clear();
    }

    /// Takes the matrix anew at `current` if it is time. `before` is the iterate before, or the start of the step (m).
    /// Returns whether it did.
    pub(super) fn refresh(
        &mut self,
        stage: &Stage<'_>,
        current: &Point,
        before: &[Vec3],
        is_start: bool,
    ) -> bool {
        let x = &current.positions[..];
        let is_mixed = self.iterations < PREDICTED_FORCE_ITERATIONS;
        if !is_mixed && self.age < REFRESH_INTERVAL && !self.is_often_shortened() {
            return false;
        }
        let to = if is_start { before } else { x };
        let mixed = is_mixed.then_some([before, to]);
        stage.lumped_hessian_into(&self.assembly, x, mixed, &mut self.matrix);
        if let Some(contact) = stage.contact {
            let stiffest = MAX_CONTACT_STIFFNESS_RATIO * self.largest_diagonal();
            self.add_contact(contact, x);
            self.for_cycle.clone_from(&self.contact_pairs);
            for row in &mut self.for_cycle {
                row.stiffness = row.stiffness.min(stiffest);
            }
        }
        let multigrid = self.multigrid.get_or_insert_with(|| {
            let rest = stage.potential.particles.rest_positions().unwrap_or(before);
            Multigrid::new(&self.matrix, &self.is_free, rest)
        });
        // A matrix that the coarsest level refuses still makes a descent direction of the others.
        let _ = multigrid.refresh_with(&self.matrix, &self.for_cycle);
        if let Some(contact) = stage.contact {
            let prior = |r: &[Vec3], z: &mut [Vec3]| multigrid.apply(r, z);
            self.global.refresh(contact, x, &self.is_free, prior);
        }
        if is_mixed {
            self.history.clear();
        }
        self.age = 0;
        true
    }

    /// The largest norm of a diagonal block of what can move (N/m).
    fn largest_diagonal(&self) -> Real {
        let blocks = self.matrix.blocks();
        let diagonal = |v: usize| blocks[self.matrix.pattern().row(v).end - 1].norm();
        let free = (0..self.is_free.len()).filter(|&v| self.is_free[v]);
        free.map(diagonal).fold(0.0, Real::max)
    }

    /// Takes the second derivative of contact at `x` (m): that of single vertices, held by bodies, into the matrix,
    /// that of pairs beside it.
    fn add_contact(&mut self, contact: &dyn ContactPotential, x: &[Vec3]) {
        self.rows.clear();
        contact.linearize(x, &mut self.rows);
        let pattern = Arc::clone(self.matrix.shared_pattern());
        let blocks = self.matrix.blocks_mut();
        self.contact_pairs.clear();
        for row in &self.rows {
            if row.weights.iter().filter(|w| **w != 0.0).count() > 1 {
                self.contact_pairs.push(*row);
                continue;
            }
            let across = row.normal * row.normal.transpose() * row.stiffness;
            for (&vertex, weight) in row.vertices.iter().zip(row.weights) {
                let diagonal = pattern.row(vertex as usize).end - 1;
                blocks[diagonal] += across * (weight * weight);
            }
        }
    }

    /// Whether contacts were active where the matrix was taken last.
    pub(super) fn has_active_contacts(&self) -> bool {
        !self.rows.is_empty()
    }

    /// The matrix (N/m) that was taken last.
    pub(super) fn matrix(&self) -> &BlockMatrix {
        &self.matrix
    }

    /// Whether contact shortens the steps so often that directions of L-BFGS lead nowhere.
    fn is_often_shortened(&self) -> bool {
        self.shortened_steps >= MAX_SHORTENED_STEPS
    }

    /// Writes the direction (m) for a gradient (N) to `out`. Returns the slope along it (J), by how much the square of
    /// the Newton decrement is more than the slope says (J), and how many linear iterations that took.
    pub(super) fn direction(&mut self, gradient: &[Vec3], out: &mut [Vec3]) -> (Real, Real, u32) {
        self.iterations += 1;
        self.age += 1;
        let is_often_shortened = self.is_often_shortened();
        let (multigrid, global) = (&mut self.multigrid, &self.global);
        let inverse = |r: &[Vec3], z: &mut [Vec3]| {
            if let Some(multigrid) = multigrid {
                multigrid.apply(r, z);
                global.correct(z);
            }
        };
        if is_often_shortened {
            let operator = Operator {
                matrix: &self.matrix,
                contact_pairs: &self.contact_pairs,
                global,
                is_free: &self.is_free,
            };
            let method = &mut self.truncated_newton;
            let end = (CG_TOLERANCE, MAX_CG_ITERATIONS);
            let multiply = |p: &[Vec3], out: &mut [Vec3]| operator.apply(p, out);
            let (left, iterations) = method.solve(end, multiply, inverse, gradient, out);
            return (dot(gradient, out), left, iterations);
        }
        let (history, work) = (&mut self.history, &mut self.work);
        self.slope = history.direction(gradient, work, out, inverse);
        (self.slope, 0.0, 1)
    }

    /// Records a step that contact, the trust radius or the line search has shortened to `fraction` of its direction. A
    /// volume that is kept shortens steps by itself, and a better direction does not help there.
    pub(super) fn record_shortening(&mut self, fraction: Real) {
        self.shortened_steps += u32::from(fraction < SHORTENED_BELOW && self.global.is_empty());
    }

    /// Keeps the pair (s, y) of a step of `length` along the last direction (m) from one gradient (N) to another.
    pub(super) fn accumulate(
        &mut self,
        length: Real,
        direction: &[Vec3],
        from: &[Vec3],
        to: &[Vec3],
    ) {
        if self.iterations >= PREDICTED_FORCE_ITERATIONS && !self.is_often_shortened() {
            self.history.push(length, self.slope, direction, from, to);
        }
    }

    /// Records a step that is no multiple of its direction: drops the pairs, whose secants it has left.
    pub(super) fn drop_pairs(&mut self) {
        self.history.clear();
        self.shortened_steps += u32::from(self.global.is_empty());
    }

    /// Restores the momentum of unconstrained components at an evaluated point.
    pub(super) fn restore_momentum(&self, stage: &Stage<'_>, point: &mut Point) {
        self.unconstrained.restore_momentum(stage, point);
    }

    /// The same where components touch each other, but nothing else.
    pub(super) fn restore_momentum_together(
        &mut self,
        stage: &Stage<'_>,
        contact: &dyn ContactPotential,
        point: &mut Point,
    ) {
        self.rows.clear();
        contact.linearize(&point.positions, &mut self.rows);
        if self.rows.iter().all(ContactRow::is_internal) {
            self.unconstrained.restore_momentum_together(stage, point);
        }
    }

    /// Goes back to L-BFGS without pairs, and takes the matrix anew in the next iteration. Returns whether that changes
    /// anything.
    pub(super) fn restart(&mut self) -> bool {
        let changes = self.is_often_shortened() || !self.history.is_empty() || self.age > 1;
        self.history.clear();
        (self.age, self.shortened_steps) = (REFRESH_INTERVAL, 0);
        changes
    }
}

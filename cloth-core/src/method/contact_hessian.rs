//! A positive definite Hessian with contacts, a multigrid cycle for it, and directions by conjugate gradients around
//! the cycle (truncated Newton methods: Nocedal and Wright 2006, section 7.1).
//!
//! Contacts come and go, and a pair of them couples vertices that the pattern of the matrix does not. So what holds a
//! single vertex is added to its diagonal block, pairs are kept beside the matrix as terms `k J Jᵀ`, and what couples
//! many vertices (a volume) as terms of rank one that an inverse takes by the formula of Sherman and Morrison. So are
//! pairs that are much stiffer than the cloth, as long as they are few: relaxation, which moves one vertex at a time,
//! hardly moves several that are nearly rigid together.
//!
//! One cycle is a good direction where nothing touches. In contact it is not: the residual that it leaves is largest
//! where cloth and contact share the load, and there a small error of the direction runs far into what is near, so that
//! contact cuts the step. A solve to a tenth costs several cycles, but no contact detection, and the directions that
//! come out can be followed farther. What is nearly closed and turns needs more: [`ContactHessian::correct`].

mod global_terms;

use crate::contact::{ContactPotential, ContactRow};
use crate::math::{Real, Vec3};
use crate::method::block_matrix::{BlockMatrix, BlockPattern};
use crate::method::linear::TruncatedConjugateGradients;
use crate::method::multigrid::Multigrid;
use global_terms::GlobalTerms;
use std::sync::Arc;

/// Largest stiffness of a contact, over the largest diagonal block of the cloth: beyond, a cycle in single precision
/// would not stay positive definite.
const MAX_CONTACT_STIFFNESS_RATIO: Real = 1e4;
/// Stiffness of a contact between vertices, over the same, from which on relaxation, which moves a vertex at a time,
/// does not follow it; and how many of these are taken by the formula for terms of rank one, a cycle each.
const STIFF: Real = 10.0;
const MOST_STIFF: usize = 40;

/// The matrix, and what is kept beside it.
#[derive(Debug)]
pub struct ContactHessian {
    matrix: BlockMatrix,
    is_free: Vec<bool>,
    /// All contacts that were taken, those between vertices, and the latter no stiffer than a cycle can take.
    rows: Vec<ContactRow>,
    pairs: Vec<ContactRow>,
    for_cycle: Vec<ContactRow>,
    /// The numbers, among all contacts, of the pairs that are too stiff for a cycle.
    stiff: Vec<usize>,
    /// Where a direction ends (m), and the errors of linearisation there (m).
    end: Vec<Vec3>,
    errors: Vec<Real>,
    global: GlobalTerms,
    multigrid: Option<Multigrid>,
    gradients: TruncatedConjugateGradients,
}

impl ContactHessian {
    /// A matrix of zeros on a pattern; `is_free[v]` says whether vertex v moves.
    #[must_use]
    pub fn new(pattern: &Arc<BlockPattern>, is_free: Vec<bool>) -> Self {
        Self {
            matrix: BlockMatrix::zeros(Arc::clone(pattern)),
            is_free,
            rows: Vec::new(),
            pairs: Vec::new(),
            for_cycle: Vec::new(),
            stiff: Vec::new(),
            end: Vec::new(),
            errors: Vec::new(),
            global: GlobalTerms::default(),
            multigrid: None,
            gradients: TruncatedConjugateGradients::default(),
        }
    }

    /// Makes room for [`solve`](Self::solve), as its first call does otherwise.
    pub fn make_room(&mut self) {
        self.gradients.resize(self.is_free.len());
    }

    /// The matrix (N/m), with the contacts of single vertices since the last [`refresh`](Self::refresh).
    #[must_use]
    pub fn matrix(&self) -> &BlockMatrix {
        &self.matrix
    }

    /// The matrix, to be assembled; [`refresh`](Self::refresh) comes next.
    pub fn matrix_mut(&mut self) -> &mut BlockMatrix {
        &mut self.matrix
    }

    /// Removes the contacts that are kept beside the matrix.
    pub fn clear_contacts(&mut self) {
        self.pairs.clear();
        self.for_cycle.clear();
        self.stiff.clear();
        self.global.clear();
    }

    /// Whether contacts were active where they were taken last.
    #[must_use]
    pub fn has_contacts(&self) -> bool {
        !self.rows.is_empty()
    }

    /// Whether a term couples many vertices.
    #[must_use]
    pub fn has_global_terms(&self) -> bool {
        self.global.has_volumes()
    }

    /// Takes the contacts at x (m) to the matrix as it was assembled, and updates the cycle; `rest` (m) is where
    /// vertices are at rest, for the first time. If the coarsest level is not positive definite as it is, the cycle has
    /// it with a slightly larger diagonal, or, if that is not enough, without a correction from it
    /// ([`Multigrid::refresh`]).
    pub fn refresh(&mut self, contact: Option<&dyn ContactPotential>, x: &[Vec3], rest: &[Vec3]) {
        if let Some(contact) = contact {
            let largest = self.largest_diagonal();
            let stiffest = MAX_CONTACT_STIFFNESS_RATIO * largest;
            self.add_contacts(contact, x);
            let is_stiff = |row: &ContactRow| is_pair(row) && row.stiffness > STIFF * largest;
            let rows = self.rows.iter().enumerate();
            let numbers = rows.filter(|(_, row)| is_stiff(row)).map(|(n, _)| n);
            self.stiff.clear();
            self.stiff.extend(numbers);
            if self.stiff.len() <= MOST_STIFF {
                self.pairs.retain(|row| !is_stiff(row));
            } else {
                self.stiff.clear();
            }
            self.for_cycle.clone_from(&self.pairs);
            for row in &mut self.for_cycle {
                row.stiffness = row.stiffness.min(stiffest);
            }
        }
        let multigrid = self
            .multigrid
            .get_or_insert_with(|| Multigrid::new(&self.matrix, &self.is_free, rest));
        let _ = multigrid.refresh_with(&self.matrix, &self.for_cycle);
        if let Some(contact) = contact {
            let prior = |r: &[Vec3], z: &mut [Vec3]| multigrid.apply(r, z);
            let stiff = self.stiff.iter().map(|&number| &self.rows[number]);
            self.global.refresh(contact, stiff, x, &self.is_free, prior);
        }
    }

    /// The largest norm of a diagonal block of what can move (N/m).
    fn largest_diagonal(&self) -> Real {
        let blocks = self.matrix.blocks();
        let diagonal = |v: usize| blocks[self.matrix.pattern().row(v).end - 1].norm();
        let free = (0..self.is_free.len()).filter(|&v| self.is_free[v]);
        free.map(diagonal).fold(0.0, Real::max)
    }

    fn add_contacts(&mut self, contact: &dyn ContactPotential, x: &[Vec3]) {
        self.rows.clear();
        contact.linearize(x, &mut self.rows);
        let pattern = Arc::clone(self.matrix.shared_pattern());
        let blocks = self.matrix.blocks_mut();
        self.pairs.clear();
        for row in &self.rows {
            if is_pair(row) {
                self.pairs.push(*row);
                continue;
            }
            let across = row.normal * row.normal.transpose() * row.stiffness;
            for (&vertex, weight) in row.vertices.iter().zip(row.weights) {
                let diagonal = pattern.row(vertex as usize).end - 1;
                blocks[diagonal] += across * (weight * weight);
            }
        }
    }

    /// Adds the second-order correction of stiff pairs (R. Fletcher 1982; Nocedal and Wright 2006, section 15.6) to a
    /// direction `p` (m) from `x` (m), where the contacts were taken, of which `fraction` is to be followed: a pair
    /// that would end there nearer by e than its linearised motion has it is opened by e, with the least that the
    /// matrix asks for. Two edges that slide over each other by s and turn come nearer by the order of s², and if they
    /// are nearly closed contact would cut the path to the first of it, again in each iteration. On the corrected path
    /// the distance is `d + t J·p + t (1 − t) e`, to the second order. Returns whether there was anything to correct.
    pub fn correct(
        &mut self,
        contact: &dyn ContactPotential,
        x: &[Vec3],
        fraction: Real,
        p: &mut [Vec3],
    ) -> bool {
        if self.stiff.is_empty() {
            return false;
        }
        self.end.clear();
        let ends = x.iter().zip(&*p).map(|(x, p)| x + p * fraction);
        self.end.extend(ends);
        self.errors.clear();
        contact.linearization_errors(x, &self.end, &mut self.errors);
        // A source need not know all, nor any.
        self.errors.resize(self.rows.len(), 0.0);
        // In place: numbers grow, so none is overwritten before it is read.
        for (to, &from) in self.stiff.iter().enumerate() {
            self.errors[to] = (-self.errors[from]).max(0.0);
        }
        self.errors.truncate(self.stiff.len());
        if self.errors.iter().all(|error| *error == 0.0) {
            return false;
        }
        self.global.open(&self.errors, 1.0 / fraction, p);
        true
    }

    /// Writes nearly `H⁻¹ r` (m) to `z` for r (N), by one cycle; nothing before the first [`refresh`](Self::refresh).
    pub fn precondition(&mut self, r: &[Vec3], z: &mut [Vec3]) {
        if let Some(multigrid) = &mut self.multigrid {
            multigrid.apply(r, z);
            self.global.correct(z);
        }
    }

    /// Writes `−H⁻¹ g` (m) for a gradient g (N), nearly, to `out`, by conjugate gradients around the cycle:
    /// [`TruncatedConjugateGradients::solve`] has the tolerance, the most iterations, and what is returned.
    pub fn solve(&mut self, end: (Real, u32), gradient: &[Vec3], out: &mut [Vec3]) -> (Real, u32) {
        let (matrix, pairs, global) = (&self.matrix, &self.pairs, &self.global);
        let (is_free, multigrid) = (&self.is_free, &mut self.multigrid);
        let multiply = |p: &[Vec3], out: &mut [Vec3]| {
            matrix.multiply(p, out);
            for row in pairs {
                row.add_product(p, out);
            }
            global.add_product(p, out);
            for (out, is_free) in out.iter_mut().zip(is_free) {
                if !is_free {
                    *out = Vec3::zeros();
                }
            }
        };
        let inverse = |r: &[Vec3], z: &mut [Vec3]| {
            if let Some(multigrid) = multigrid {
                multigrid.apply(r, z);
                global.correct(z);
            }
        };
        self.gradients.solve(end, multiply, inverse, gradient, out)
    }
}

/// Whether a contact is one between vertices.
fn is_pair(row: &ContactRow) -> bool {
    row.weights.iter().filter(|w| **w != 0.0).count() > 1
}

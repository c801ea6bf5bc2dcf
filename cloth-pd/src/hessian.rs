//! The Hessian of the objective, and a multigrid cycle for it, for directions in contact.
//!
//! Cloth that is pressed onto something moves out of its own plane, where the constant matrix is as stiff as along the
//! springs, thousands of times too stiff. What an iteration with that matrix leaves of such a motion looks small in the
//! metric of the matrix, and pairs of differences hardly correct it: every contact that comes or goes makes them wrong.
//! By L-BFGS around A a towel without friction stuck to its rail, and cloth at rest pressed with 15 % less than its
//! weight.
//!
//! So with active contacts the first inverse Hessian is that of `H + Σ k J Jᵀ`, nearly: a multigrid cycle
//! ([`ContactHessian`](cloth_core::method::contact_hessian::ContactHessian)). `H = M/Δt² + Σ w Sᵀ |I − ∂p/∂z| S` is the
//! Hessian at the iterate, of all elements, those too that A leaves out, and with the drag of the air; | | takes the
//! absolute values of eigenvalues (`local.rs`). With k ≥ 0 the sum is positive definite. A has no part in it.
//!
//! *Why absolute values.* Where an element is compressed its energy falls when it turns, with an eigenvalue below zero.
//! With zero in its place only inertia resists such a motion: the direction goes many times as far as G falls, and
//! however long a step is taken of it, everything else in it is as short. G then falls into the next minimum, with more
//! and smaller folds than there are between it and a lower one. A sheet of 33 × 33 vertices that wraps a ball fell 3 %
//! less far than by converged implicit Euler with zeros, 1 % with absolute values (mean of 8 to 16 places).
//!
//! *Bending.* The pattern of H has the pairs of vertices that springs, triangles and tetrahedra couple. A quadratic
//! hinge couples its wing tips i and j too. Their entry v is lumped: it is left out, and |v| is added to both diagonal
//! entries. As `2 v dᵢ·dⱼ ≤ |v| (dᵢ² + dⱼ²)`, dᵀHd gets no smaller for any d; where v > 0 and dᵢ = dⱼ it is the same.
//!
//! *Solved to a tenth* of the residual, by conjugate gradients around the cycle, directions are those of a truncated
//! Newton method (Nocedal and Wright 2006, section 7.1). With the constant matrix as the preconditioner, alone or with
//! blocks of the diagonal, that takes 40 to 70 iterations to a fifth of the residual, here 5 to 25 to a tenth. Ending
//! them at the trust radius (Steihaug 1983) loses what slides freely, the last that they find. A nonmonotone line
//! search (Grippo et al. 1986) is slower.

use crate::contact::Contact;
use crate::lattice::{ElementProlongation, PaddedBlock};
use crate::objective::Objective;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::block_matrix::PatternBuilder;
use cloth_core::method::contact_hessian::ContactHessian;
use cloth_core::method::in_contact::NEWTON_DIRECTION;
use cloth_core::method::multigrid::Prolongation;

/// The Hessian H, and a multigrid cycle for it.
#[derive(Debug)]
pub(crate) struct CurrentHessian {
    system: ContactHessian,
    /// S of the elements of each family, by the slots of their blocks.
    operators: Vec<ElementProlongation>,
    /// Entries of the families of constant projection: slot, value (N/m).
    constant: Vec<(u32, Real)>,
    stiffness: Vec<PaddedBlock>,
}

impl CurrentHessian {
    pub(crate) fn new(objective: &Objective) -> Self {
        let count = objective.particles.len();
        let mut pattern = PatternBuilder::new(count);
        let mut is_covered = vec![false; count];
        for family in objective.families.iter().filter(|f| !f.is_constant()) {
            family.for_each_stencil(&mut |vertices| {
                pattern.add_pairs(vertices, |_| true);
                vertices.iter().for_each(|v| is_covered[*v as usize] = true);
            });
        }
        for (i, j, _) in objective.quadratic_entries() {
            if !(is_covered[i] && is_covered[j]) {
                pattern.add_pairs(&[i as u32, j as u32], |[a, b]| a != b);
            }
        }
        let pattern = pattern.build();
        let diagonal = |vertex: usize| (pattern.row(vertex).end - 1) as u32;
        let mut constant = Vec::new();
        for (i, j, value) in objective.quadratic_entries() {
            match pattern.slot(i as u32, j as u32) {
                Some(slot) => constant.push((slot, value)),
                None => constant.extend([(diagonal(i), value.abs()), (diagonal(j), value.abs())]),
            }
        }
        let own: Vec<[(u32, Real); 1]> = (0..count).map(|v| [(v as u32, 1.0)]).collect();
        let vertices = Prolongation::new(own.iter().map(|row| &row[..]), count);
        let families = objective.families.iter();
        let operators = families.map(|family| match family.is_constant() {
            true => ElementProlongation::default(),
            false => family.prolongation(&vertices, &pattern),
        });
        let is_free = objective.particles.inverse_mass().iter();
        Self {
            operators: operators.collect(),
            stiffness: vec![PaddedBlock::default(); pattern.block_count()],
            constant,
            system: ContactHessian::new(&pattern, is_free.map(|w| *w > 0.0).collect()),
        }
    }

    /// Takes H and the second derivative of contact at x (m).
    pub(crate) fn refresh(&mut self, objective: &Objective, contact: &Contact<'_>, x: &[Vec3]) {
        self.stiffness.fill(PaddedBlock::default());
        for (family, operator) in objective.families.iter().zip(&self.operators) {
            family.add_stiffness(operator, x, &mut self.stiffness);
        }
        let (particles, dt) = (&objective.particles, objective.dt());
        let matrix = self.system.matrix_mut();
        matrix.set_diagonal(particles.mass(), 1.0 / dt / dt);
        let pattern = std::sync::Arc::clone(matrix.shared_pattern());
        let blocks = matrix.blocks_mut();
        for (block, stiffness) in blocks.iter_mut().zip(&self.stiffness) {
            *block += stiffness.block();
        }
        for (slot, value) in &self.constant {
            blocks[*slot as usize] += Mat3::from_diagonal_element(*value);
        }
        let mut add = |vertex: usize, own: Mat3| blocks[pattern.row(vertex).end - 1] += own;
        for attachment in &objective.attachments {
            let own = Mat3::from_diagonal_element(attachment.stiffness);
            add(attachment.vertex as usize, own);
        }
        for (vertex, (drag, _)) in objective.drag.iter().enumerate() {
            add(vertex, drag / dt);
        }
        let rest = particles.rest_positions().unwrap_or(x);
        self.system.refresh(contact.as_deref(), x, rest);
    }

    /// Writes nearly `H⁻¹ r` (m) to `z` for r (N), by one cycle.
    pub(crate) fn precondition(&mut self, r: &[Vec3], z: &mut [Vec3]) {
        self.system.precondition(r, z);
    }

    /// Writes `−H⁻¹ g` (m) to `out` for a gradient g (N), to a tenth of the residual. Returns what that leaves out of
    /// `gᵀ H⁻¹ g` (J), nearly, and the number of iterations of conjugate gradients.
    pub(crate) fn solve(&mut self, gradient: &[Vec3], out: &mut [Vec3]) -> (Real, u32) {
        self.system.solve(NEWTON_DIRECTION, gradient, out)
    }

    /// The second-order correction of the direction (m) that was found last, at x (m), or of what is left of it
    /// ([`ContactHessian::correct`]).
    pub(crate) fn correct(&mut self, contact: &Contact<'_>, x: &[Vec3], direction: &mut [Vec3]) {
        if let Some(contact) = contact.as_deref() {
            self.system.correct(contact, x, 1.0, direction);
        }
    }
}

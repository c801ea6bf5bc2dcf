//! A positive definite Hessian with contacts, a multigrid cycle for it, and directions by conjugate gradients around
//! the cycle (truncated Newton methods: Nocedal and Wright 2006, section 7.1).
//!
//! Contacts come and go, and a pair of them couples vertices that the pattern of the matrix does not. So what holds a
//! single vertex is added to its diagonal block, pairs are kept beside the matrix as terms `k J Jᵀ`, and what couples
//! many vertices (a volume) as terms of rank one that an inverse takes by the formula of Sherman and Morrison.
//!
//! One cycle is a good direction where nothing touches. In contact it is not: the residual that it leaves is largest
//! where cloth and contact share the load, and there a small error of the direction runs far into what is near, so that
//! contact cuts the step. A solve to a tenth costs several cycles, but no contact detection, and the directions that
//! come out can be followed farther.

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

/// The matrix, and what is kept beside it.
#[derive(Debug)]
pub struct ContactHessian {
    matrix: BlockMatrix,
    is_free: Vec<bool>,
    /// All contacts that were taken, those between vertices, and the latter no stiffer than a cycle can take.
    rows: Vec<ContactRow>,
    pairs: Vec<ContactRow>,
    for_cycle: Vec<ContactRow>,
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
            global: GlobalTerms::default(),
            multigrid: None,
            gradients: TruncatedConjugateGradients::default(),
        }
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
        !self.global.is_empty()
    }

    /// Takes the contacts at x (m) to the matrix as it was assembled, and updates the cycle; `rest` (m) is where
    /// vertices are at rest, for the first time. If the coarsest level is not positive definite as it is, the cycle has
    /// it with a slightly larger diagonal, or, if that is not enough, without a correction from it
    /// ([`Multigrid::refresh`]).
    pub fn refresh(&mut self, contact: Option<&dyn ContactPotential>, x: &[Vec3], rest: &[Vec3]) {
        if let Some(contact) = contact {
            let stiffest = MAX_CONTACT_STIFFNESS_RATIO * self.largest_diagonal();
            self.add_contacts(contact, x);
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
            self.global.refresh(contact, x, &self.is_free, prior);
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
            if row.weights.iter().filter(|w| **w != 0.0).count() > 1 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::{Cloth, Membrane};
    use crate::contact::{ContactError, ContactStep, GlobalRows};
    use crate::energy::Spring;
    use crate::math::Mat3;
    use crate::mesh::generate::{Diagonals, grid};
    use crate::method::block_matrix::PatternBuilder;

    /// One vertex on a floor, a vertex before a triangle far away, and a term on all vertices.
    #[derive(Debug)]
    struct Contacts([ContactRow; 2]);

    impl ContactPotential for Contacts {
        fn begin(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
            Ok(())
        }

        fn limit(&mut self, _: &[Vec3], _: &[Vec3]) -> Result<Real, ContactError> {
            Ok(1.0)
        }

        fn limit_each(
            &mut self,
            _: &[Vec3],
            _: &mut [Vec3],
            _: &mut [Real],
        ) -> Result<(), ContactError> {
            Ok(())
        }

        fn add_gradient(&self, _: &[Vec3], _: &mut [Vec3]) -> Real {
            0.0
        }

        fn linearize(&self, _: &[Vec3], out: &mut Vec<ContactRow>) {
            out.extend(self.0);
        }

        fn linearize_globally(&self, x: &[Vec3], out: &mut GlobalRows) {
            let row = out.push(3.0);
            row.vertices.extend(0..x.len() as u32);
            row.gradient.extend(x.iter().map(|x| x * 0.1 + Vec3::z()));
        }

        fn end(&mut self, _: &[Vec3], _: &[Vec3]) {}
    }

    /// `H p = −g` with all terms, multiplied out by their definition: the residual is what was asked for.
    #[test]
    fn the_direction_solves_the_hessian_with_contacts() {
        let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let cloth = Cloth {
            areal_density: 0.2,
            membrane: Membrane::SpringStiffness(1e3),
            bending_rigidity: 0.0,
        };
        let springs: Vec<Spring> = cloth.on(&mesh).unwrap().springs;
        let x = mesh.positions();
        let stiffness = |s: &Spring| {
            let n = (x[s.vertices[0] as usize] - x[s.vertices[1] as usize]).normalize();
            n * n.transpose() * s.stiffness
        };
        let own = Mat3::from_diagonal_element(2.0);
        let contacts = Contacts([
            ContactRow {
                vertices: [40, 0, 0, 0],
                weights: [1.0, 0.0, 0.0, 0.0],
                normal: Vec3::z(),
                stiffness: 1e4,
            },
            ContactRow {
                vertices: [250, 60, 61, 77],
                weights: [1.0, -0.2, -0.3, -0.5],
                normal: Vec3::new(0.6, 0.0, 0.8),
                stiffness: 1e5,
            },
        ]);
        let mut pattern = PatternBuilder::new(x.len());
        pattern.add(&springs);
        let pattern = pattern.build();
        let is_free: Vec<bool> = (0..x.len()).map(|v| v != 0).collect();
        let mut hessian = ContactHessian::new(&pattern, is_free.clone());
        let blocks = hessian.matrix_mut().blocks_mut();
        for spring in &springs {
            let [a, b] = spring.vertices;
            let k = stiffness(spring);
            blocks[pattern.slot(a, b).unwrap() as usize] -= k;
            for v in [a, b] {
                blocks[pattern.row(v as usize).end - 1] += k;
            }
        }
        for v in 0..x.len() {
            blocks[pattern.row(v).end - 1] += own;
        }
        hessian.refresh(Some(&contacts), x, x);
        assert!(hessian.has_contacts() && hessian.has_global_terms());
        let mut gradient: Vec<Vec3> = (0..x.len())
            .map(|v| Vec3::from_fn(|axis, _| ((3 * v + axis) as Real * 1.7).sin()))
            .collect();
        gradient[0] = Vec3::zeros();
        let mut p = vec![Vec3::zeros(); x.len()];
        let (_, iterations) = hessian.solve((1e-10, 200), &gradient, &mut p);
        assert!(iterations < 60, "{iterations}");
        assert_eq!(p[0], Vec3::zeros());

        let mut residual = gradient.clone();
        for (r, p) in residual.iter_mut().zip(&p) {
            *r += own * p;
        }
        for spring in &springs {
            let [a, b] = spring.vertices.map(|v| v as usize);
            let force = stiffness(spring) * (p[a] - p[b]);
            residual[a] += force;
            residual[b] -= force;
        }
        for row in &contacts.0 {
            row.add_product(&p, &mut residual);
        }
        let along = |x: &Vec3| x * 0.1 + Vec3::z();
        let moved: Real = x.iter().zip(&p).skip(1).map(|(x, p)| along(x).dot(p)).sum();
        for (r, x) in residual.iter_mut().zip(x) {
            *r += along(x) * (3.0 * moved);
        }
        residual[0] = Vec3::zeros();
        let left = residual.iter().map(Vec3::norm).fold(0.0, Real::max);
        assert!(left < 1e-7, "{left:e} N");
    }
}

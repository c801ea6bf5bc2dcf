//! The truncated Newton direction: conjugate gradients, around the multigrid cycle, on the matrix that the cycle is for
//! (S. G. Nash, "A survey of truncated-Newton methods", J. Comput. Appl. Math. 124, 2000,
//! <https://doi.org/10.1016/S0377-0427(00)00426-X>).
//!
//! One cycle is a good direction where nothing touches. In contact it is not: the residual that it leaves is largest
//! where cloth and contact share the load, and there a small error of the direction runs far into what is near, so that
//! contact cuts the step. A solve to a tenth costs several cycles, but no contact detection, and the directions that
//! come out can be followed farther.

use super::global_terms::GlobalTerms;
use cloth_core::contact::ContactRow;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::vectors::{add, dot};

/// Residual, in the norm of the cycle and relative to the first, at which conjugate gradients end.
const CG_TOLERANCE: Real = 0.1;
/// Most iterations of conjugate gradients.
const MAX_CG_ITERATIONS: u32 = 30;

/// `H p`, positive definite: a matrix and what is kept beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Operator<'a> {
    pub(super) matrix: &'a BlockMatrix,
    pub(super) contact_pairs: &'a [ContactRow],
    pub(super) global: &'a GlobalTerms,
    pub(super) is_free: &'a [bool],
}

impl Operator<'_> {
    fn apply(&self, p: &[Vec3], out: &mut [Vec3]) {
        self.matrix.multiply(p, out);
        for row in self.contact_pairs {
            row.add_product(p, out);
        }
        self.global.add_product(p, out);
        for (out, is_free) in out.iter_mut().zip(self.is_free) {
            if !is_free {
                *out = Vec3::zeros();
            }
        }
    }
}

/// The working memory.
#[derive(Debug, Default)]
pub(super) struct TruncatedNewton {
    residual: Vec<Vec3>,
    solved: Vec<Vec3>,
    direction: Vec<Vec3>,
    product: Vec<Vec3>,
}

impl TruncatedNewton {
    /// Writes `p = −H⁻¹ g` (m), nearly, to `out` for a gradient g (N), with `inverse` near H⁻¹. Returns `rᵀ H⁻¹ r` (J)
    /// of the residual r that is left, nearly, and the number of iterations: `gᵀ H⁻¹ g = −gᵀ p + rᵀ H⁻¹ r`.
    pub(super) fn solve(
        &mut self,
        operator: Operator<'_>,
        mut inverse: impl FnMut(&[Vec3], &mut [Vec3]),
        gradient: &[Vec3],
        out: &mut [Vec3],
    ) -> (Real, u32) {
        let lists = [
            &mut self.residual,
            &mut self.solved,
            &mut self.direction,
            &mut self.product,
        ];
        for list in lists {
            list.resize(gradient.len(), Vec3::zeros());
        }
        let pairs = self.residual.iter_mut().zip(gradient);
        pairs.for_each(|(r, g)| *r = -g);
        inverse(&self.residual, &mut self.solved);
        self.direction.copy_from_slice(&self.solved);
        out.fill(Vec3::zeros());
        let first = dot(&self.residual, &self.solved);
        let mut size = first;
        for iteration in 1..=MAX_CG_ITERATIONS {
            operator.apply(&self.direction, &mut self.product);
            let length = size / dot(&self.direction, &self.product);
            if !(length.is_finite() && length > 0.0) {
                // A gradient of zero, or a matrix that rounding has made indefinite.
                return (size, iteration);
            }
            add(out, length, &self.direction);
            add(&mut self.residual, -length, &self.product);
            inverse(&self.residual, &mut self.solved);
            let next = dot(&self.residual, &self.solved);
            if next <= CG_TOLERANCE * CG_TOLERANCE * first {
                return (next, iteration);
            }
            let ratio = next / size;
            size = next;
            for (p, z) in self.direction.iter_mut().zip(&self.solved) {
                *p = z + *p * ratio;
            }
        }
        (size, MAX_CG_ITERATIONS)
    }
}

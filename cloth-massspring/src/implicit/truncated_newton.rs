//! The truncated Newton direction: [conjugate gradients](cloth_core::method::linear::TruncatedConjugateGradients),
//! around the multigrid cycle, on the matrix that the cycle is for.
//!
//! One cycle is a good direction where nothing touches. In contact it is not: the residual that it leaves is largest
//! where cloth and contact share the load, and there a small error of the direction runs far into what is near, so that
//! contact cuts the step. A solve to a tenth costs several cycles, but no contact detection, and the directions that
//! come out can be followed farther.

use super::global_terms::GlobalTerms;
use cloth_core::contact::ContactRow;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;

/// Residual, in the norm of the cycle and relative to the first, at which conjugate gradients end.
pub(super) const CG_TOLERANCE: Real = 0.1;
/// Most iterations of conjugate gradients.
pub(super) const MAX_CG_ITERATIONS: u32 = 30;

/// `H p`, positive definite: a matrix and what is kept beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Operator<'a> {
    pub(super) matrix: &'a BlockMatrix,
    pub(super) contact_pairs: &'a [ContactRow],
    pub(super) global: &'a GlobalTerms,
    pub(super) is_free: &'a [bool],
}

impl Operator<'_> {
    pub(super) fn apply(&self, p: &[Vec3], out: &mut [Vec3]) {
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

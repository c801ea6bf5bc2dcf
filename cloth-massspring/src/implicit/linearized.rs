//! The function of a stage with its elastic part linearised at one place, for a step that does so once and still has to
//! feel contact.
//!
//! The cloth takes part as the quadratic function `gᵀp + ½ pᵀH p` of its displacement p; contact is not linearised,
//! since what the cloth meets during the step need not touch it where it starts.

use super::line_search::Point;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::vectors::dot;
use std::sync::{Mutex, PoisonError};

/// `g`, `H` and the place that they were taken at.
#[derive(Debug)]
pub(super) struct Linearized<'a> {
    /// Positions (m) and gradient (N).
    at: &'a Point,
    /// H (N/m).
    matrix: &'a BlockMatrix,
    /// Buffer for p (m).
    displacement: Mutex<Vec<Vec3>>,
}

impl<'a> Linearized<'a> {
    /// At an evaluated point, with the matrix (N/m) there. `displacement` is a buffer of one vector per vertex.
    pub(super) fn new(at: &'a Point, matrix: &'a BlockMatrix, displacement: Vec<Vec3>) -> Self {
        Self {
            at,
            matrix,
            displacement: Mutex::new(displacement),
        }
    }

    /// Gives the buffer back.
    pub(super) fn into_buffer(self) -> Vec<Vec3> {
        self.displacement
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// Positions (m) where the cloth is linearised.
    pub(super) fn place(&self) -> &[Vec3] {
        &self.at.positions
    }

    /// The function (J), zero at the place; writes its gradient (N) to `out`.
    pub(super) fn gradient_into(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let mut displacement = self
            .displacement
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        for ((displacement, x), at) in displacement.iter_mut().zip(x).zip(&self.at.positions) {
            *displacement = x - at;
        }
        self.matrix.multiply(&displacement, out);
        let quadratic = 0.5 * dot(&displacement, out);
        for (out, gradient) in out.iter_mut().zip(&self.at.gradient) {
            *out += gradient;
        }
        quadratic + dot(&displacement, &self.at.gradient)
    }
}

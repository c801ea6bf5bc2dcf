//! The inverted diagonal blocks: what the iterative solvers know of a matrix besides its products.

use super::solver::LinearError;
use crate::math::{Mat3, Vec3};
use crate::method::block_matrix::BlockMatrix;

/// `D⁻¹` over the free vertices, zero at the prescribed ones.
#[derive(Debug)]
pub(super) struct InverseDiagonal {
    blocks: Vec<Mat3>,
    prescribed: Vec<u32>,
}

impl InverseDiagonal {
    /// The identity over the free vertices.
    pub(super) fn identity(is_free: &[bool]) -> Self {
        let block = |free: &bool| {
            if *free {
                Mat3::identity()
            } else {
                Mat3::zeros()
            }
        };
        let prescribed = (0u32..).zip(is_free).filter(|(_, free)| !**free);
        Self {
            blocks: is_free.iter().map(block).collect(),
            prescribed: prescribed.map(|(vertex, _)| vertex).collect(),
        }
    }

    /// Inverts the diagonal blocks of a matrix. A block that is not positive definite shows that the matrix is not.
    pub(super) fn invert(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError> {
        let pattern = matrix.pattern();
        let mut prescribed = self.prescribed.iter().peekable();
        for (row, inverse) in self.blocks.iter_mut().enumerate() {
            if prescribed
                .next_if(|&&vertex| vertex as usize == row)
                .is_some()
            {
                continue;
            }
            let block = &matrix.blocks()[pattern.row(row).end - 1];
            *inverse = inverted(block).ok_or(LinearError::NotPositiveDefinite)?;
        }
        Ok(())
    }

    /// One block per vertex.
    pub(super) fn blocks(&self) -> &[Mat3] {
        &self.blocks
    }

    /// Sets entries of prescribed vertices to zero.
    pub(super) fn clear_prescribed(&self, values: &mut [Vec3]) {
        for &vertex in &self.prescribed {
            values[vertex as usize] = Vec3::zeros();
        }
    }

    /// Copies `b` where vertices are free, zero elsewhere.
    pub(super) fn copy_free(&self, b: &[Vec3], out: &mut [Vec3]) {
        out.copy_from_slice(b);
        self.clear_prescribed(out);
    }
}

/// The inverse of a symmetric positive definite block.
fn inverted(block: &Mat3) -> Option<Mat3> {
    let minor = block[(0, 0)] * block[(1, 1)] - block[(1, 0)] * block[(1, 0)];
    let leading = [block[(0, 0)], minor, block.determinant()];
    if !leading.iter().all(|minor| *minor > 0.0) {
        return None;
    }
    block
        .try_inverse()
        .filter(|inverse| inverse.iter().all(|v| v.is_finite()))
}

//! The linear map from a triangle at rest to the present one, shared by the membrane elements.

use crate::math::{Real, Vec3};

/// F (3 × 2, dimensionless) as a function of the corners: `F = Σ xᵢ bᵢᵀ`.
///
/// F takes the edges at rest to those of now: `F D_m = [x₁ − x₀, x₂ − x₀]`. The columns of `D_m` (2 × 2, m) are the
/// same two edges at rest, in a frame of the rest triangle. So `b₁` and `b₂` are the rows of `D_m⁻¹`, and
/// `b₀ = −b₁ − b₂`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TriangleMap {
    /// `bᵢ` (1/m), in a frame of the rest triangle whose first axis runs along `x₀ x₁`; they sum to zero.
    pub(super) gradients: [[Real; 2]; 3],
    /// Rest area A (m²).
    pub(super) area: Real,
}

impl TriangleMap {
    pub(super) fn new(rest: &[Vec3; 3]) -> Self {
        let [along, side] = [rest[1] - rest[0], rest[2] - rest[0]];
        let twice_area = along.cross(&side).norm();
        let width = along.norm();
        let (foot, height) = (along.dot(&side) / width, twice_area / width);
        // The rows of the inverse of D_m = [[width, foot], [0, height]].
        let first = [1.0 / width, -foot / twice_area];
        let second = [0.0, 1.0 / height];
        Self {
            gradients: [
                [-first[0] - second[0], -first[1] - second[1]],
                first,
                second,
            ],
            area: 0.5 * twice_area,
        }
    }

    /// The two columns of F, by differences to one vertex.
    #[inline]
    pub(super) fn columns(&self, x: &[Vec3; 3]) -> [Vec3; 2] {
        let [d, e] = [x[1] - x[0], x[2] - x[0]];
        let [_, b, c] = &self.gradients;
        [d * b[0] + e * c[0], d * b[1] + e * c[1]]
    }

    /// From a derivative by the columns of F to one by the corners.
    #[inline]
    pub(super) fn back(&self, by_columns: [Vec3; 2]) -> [Vec3; 3] {
        self.gradients
            .map(|b| by_columns[0] * b[0] + by_columns[1] * b[1])
    }
}

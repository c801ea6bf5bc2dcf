//! Rows in the forms that a sweep visits fastest. Nobody else needs them.

use super::Row;
use crate::math::{Real, Vec3};

/// One row whose gradient is a unit vector at every vertex, not yet divided by its length: `∂C/∂xᵢ = direction[i] / length`.
///
/// The direction of a spring is a difference of positions over its length. A sweep that divides by the length waits for a root, then for a
/// division, then for the division that gives Δλ. With the difference itself the last one takes in the other: `Δλ/l = −C/((w̃ + α̃) l)`, and
/// `w̃ = Σ wᵢ` needs no gradient at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitRow<const N: usize> {
    /// `C(x)`, zero at rest (m).
    pub value: Real,
    /// `l ∂C/∂xᵢ` (m), one per vertex of the element.
    pub direction: [Vec3; N],
    /// `l` (m), above zero: the length of every `direction`.
    pub length: Real,
    /// `k` with the energy `½ k C²` (J).
    pub stiffness: Real,
}

impl<const N: usize> UnitRow<N> {
    /// The row.
    #[inline]
    #[must_use]
    pub fn row(&self) -> Row<N> {
        Row {
            value: self.value,
            gradient: self.direction.map(|direction| direction / self.length),
            stiffness: self.stiffness,
        }
    }
}

/// Three rows that are the coordinates of one vector: `C = Σ qᵢ xᵢ − target`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VectorRow<const N: usize> {
    /// q, one per vertex of the element.
    pub coefficients: [Real; N],
    /// What `Σ qᵢ xᵢ` is at rest.
    pub target: Vec3,
    /// `k` with the energy `½ k ‖C‖²` (J).
    pub stiffness: Real,
}

impl<const N: usize> VectorRow<N> {
    /// `C` at `x` (m).
    #[inline(always)]
    #[must_use]
    pub fn value(&self, x: &[Vec3; N]) -> Vec3 {
        let mut sum = -self.target;
        for i in 0..N {
            sum += x[i] * self.coefficients[i];
        }
        sum
    }

    /// The three rows at `x` (m).
    #[inline]
    #[must_use]
    pub fn rows(&self, x: &[Vec3; N]) -> [Row<N>; 3] {
        let value = self.value(x);
        let mut rows = [Row {
            value: 0.0,
            gradient: [Vec3::zeros(); N],
            stiffness: self.stiffness,
        }; 3];
        // Loops, because `map` and `from_fn` to arrays of this size are calls that copy.
        for axis in 0..3 {
            rows[axis].value = value[axis];
            for i in 0..N {
                rows[axis].gradient[i][axis] = self.coefficients[i];
            }
        }
        rows
    }
}

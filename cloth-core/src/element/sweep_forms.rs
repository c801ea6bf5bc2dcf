//! Rows in the forms that a sweep visits fastest. Nobody else needs them.

use super::Row;
use crate::math::{Real, Vec3};

/// One row whose gradient is a unit vector at every vertex, not yet divided by its length:
/// `∂C/∂xᵢ = direction[i] / length`.
///
/// So a sweep divides once: `Δλ/l = −C/((w̃ + α̃) l)`, and `w̃ = Σ wᵢ` needs no gradient at all.
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

/// One row that is free within a range: `C = φ − clamp(φ)`, with φ and its gradient not cut off there.
///
/// [`Row`] has neither value nor gradient inside the range, so a method that accumulates multipliers could not reduce
/// one there that an earlier visit made. The multiplier of such a row solves `C + α̃λ = 0`, with `C = φ − clamp(φ)`:
/// for one row alone, φ going along with λ by w̃, that is `φ − clamp(φ − w̃λ) + α̃λ = 0`, where `φ − w̃λ` is what φ
/// would be without the row. So λ pulls or is zero at the upper end, pushes or is zero at the lower one, and is zero
/// between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadZoneRow<const N: usize> {
    /// `φ(x)`, in the unit that the element documents.
    pub value: Real,
    /// `∂φ/∂xᵢ`, one per vertex of the element (unit of φ per m).
    pub gradient: [Vec3; N],
    /// Least and greatest φ at which nothing acts; equal ends make it a row like any other. An end may be infinite.
    pub range: [Real; 2],
    /// `k` with the energy `½ k C²` (J).
    pub stiffness: Real,
}

impl<const N: usize> DeadZoneRow<N> {
    /// The row of the energy: C, with a gradient that vanishes where the row is free.
    #[inline]
    #[must_use]
    pub fn row(&self) -> Row<N> {
        let [low, high] = self.range;
        let value = self.value - self.nearest(self.value);
        let is_free = value == 0.0 && low < high;
        Row {
            value,
            gradient: if is_free {
                [Vec3::zeros(); N]
            } else {
                self.gradient
            },
            stiffness: self.stiffness,
        }
    }

    /// `φ − clamp(φ − w̃λ)` (unit of φ), how far the row is from the end of its range at which it acts, for the
    /// generalised inverse mass w̃ (unit of φ² per kg m²) and the multiplier λ (kg m² per unit of φ); `None` where it
    /// is free.
    #[inline]
    #[must_use]
    pub fn acting_value(&self, weight: Real, multiplier: Real) -> Option<Real> {
        let without = self.value - weight * multiplier;
        let nearest = self.nearest(without);
        let is_free = nearest == without && self.range[0] < self.range[1];
        (!is_free).then_some(self.value - nearest)
    }

    #[inline]
    fn nearest(&self, value: Real) -> Real {
        value.min(self.range[1]).max(self.range[0])
    }
}

/// The rows of an element in a form that is faster to sweep than any number of [`Row`]s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RowForm<const N: usize> {
    /// No such form.
    General,
    /// One row whose gradient is a unit vector at every vertex: twice as fast.
    Unit(UnitRow<N>),
    /// Three linear rows that are the coordinates of one vector.
    Vector(VectorRow<N>),
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

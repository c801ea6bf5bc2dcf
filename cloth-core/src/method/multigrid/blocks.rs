//! Vectors and blocks of the preconditioner: single precision, four lanes of which three count.

use crate::math::{Mat3, Vec3};

/// Three numbers and a zero.
pub(super) type Lanes = [f32; 4];

/// A 3 × 3 block by columns.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub(super) struct Block([Lanes; 3]);

impl Block {
    pub(super) const ZERO: Self = Self([[0.0; 4]; 3]);

    pub(super) fn from(block: &Mat3) -> Self {
        let column = |c: usize| [0, 1, 2].map(|r| block[(r, c)] as f32);
        let pad = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        Self([pad(column(0)), pad(column(1)), pad(column(2))])
    }

    pub(super) fn to_double(self) -> Mat3 {
        Mat3::from_fn(|r, c| f64::from(self.0[c][r]))
    }

    /// `self += weight · other`.
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self, weight: f32) {
        for column in 0..3 {
            for lane in 0..4 {
                self.0[column][lane] += other.0[column][lane] * weight;
            }
        }
    }

    #[inline(always)]
    pub(super) fn transposed(&self) -> Self {
        let c = &self.0;
        Self([
            [c[0][0], c[1][0], c[2][0], 0.0],
            [c[0][1], c[1][1], c[2][1], 0.0],
            [c[0][2], c[1][2], c[2][2], 0.0],
        ])
    }

    /// Block times vector.
    #[inline(always)]
    pub(super) fn times(&self, x: &Lanes) -> Lanes {
        let mut out = [0.0; 4];
        for lane in 0..4 {
            out[lane] = self.0[0][lane] * x[0] + self.0[1][lane] * x[1] + self.0[2][lane] * x[2];
        }
        out
    }

    /// Whether it equals its transpose but for rounding.
    #[inline(always)]
    pub(super) fn is_symmetric(&self) -> bool {
        let [a, b, c] = &self.0;
        let apart = (a[1] - b[0]).abs() + (a[2] - c[0]).abs() + (b[2] - c[1]).abs();
        apart <= 1e-6 * (a[0].abs() + b[1].abs() + c[2].abs())
    }

    /// Transposed block times vector; by columns, as [`Block::times`], where the block is `SYMMETRIC`.
    #[inline(always)]
    pub(super) fn transposed_times<const SYMMETRIC: bool>(&self, x: &Lanes) -> Lanes {
        if SYMMETRIC {
            return self.times(x);
        }
        let mut products = [[0.0; 4]; 3];
        for column in 0..3 {
            for lane in 0..4 {
                products[column][lane] = self.0[column][lane] * x[lane];
            }
        }
        let sum = |column: usize| {
            let p = &products[column];
            p[0] + p[1] + p[2]
        };
        [sum(0), sum(1), sum(2), 0.0]
    }
}

/// `a − b`.
#[inline(always)]
pub(super) fn minus(a: Lanes, b: Lanes) -> Lanes {
    let mut out = a;
    for lane in 0..4 {
        out[lane] -= b[lane];
    }
    out
}

/// `a + weight · b`.
#[inline(always)]
pub(super) fn plus(a: Lanes, weight: f32, b: &Lanes) -> Lanes {
    let mut out = a;
    for lane in 0..4 {
        out[lane] += weight * b[lane];
    }
    out
}

#[inline(always)]
pub(super) fn lanes(v: &Vec3) -> Lanes {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}

#[inline(always)]
pub(super) fn vector(v: &Lanes) -> Vec3 {
    Vec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]))
}

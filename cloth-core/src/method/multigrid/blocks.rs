//! Vectors and blocks of the preconditioner: single precision, four lanes of which three count.

use crate::math::{Mat3, Vec3};
use wide::{f32x4, f64x4};

/// Three numbers and a zero. A register of four: loops over arrays become one of two lanes and single numbers, since
/// the fourth lane is asked for by nobody.
pub(super) type Lanes = f32x4;

/// A 3 × 3 block by columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Block([Lanes; 3]);

impl Block {
    pub(super) const ZERO: Self = Self([Lanes::ZERO; 3]);

    pub(super) fn from(block: &Mat3) -> Self {
        Self([0, 1, 2].map(|c| lanes(&block.column(c).into_owned())))
    }

    pub(super) fn to_double(self) -> Mat3 {
        let columns = self.0.map(|column| vector(&column));
        Mat3::from_columns(&columns)
    }

    /// `self += weight · other`.
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self, weight: f32) {
        for (column, other) in self.0.iter_mut().zip(&other.0) {
            *column += *other * Lanes::splat(weight);
        }
    }

    #[inline(always)]
    pub(super) fn transposed(&self) -> Self {
        let [a, b, c] = self.0;
        let [a, b, c, _] = Lanes::transpose([a, b, c, Lanes::ZERO]);
        Self([a, b, c])
    }

    /// Block times vector.
    #[inline(always)]
    pub(super) fn times(&self, x: &Lanes) -> Lanes {
        let [a, b, c, _] = x.to_array().map(Lanes::splat);
        self.0[0] * a + self.0[1] * b + self.0[2] * c
    }

    /// Whether it equals its transpose but for rounding.
    #[inline(always)]
    pub(super) fn is_symmetric(&self) -> bool {
        let [a, b, c] = self.0.map(Lanes::to_array);
        let apart = (a[1] - b[0]).abs() + (a[2] - c[0]).abs() + (b[2] - c[1]).abs();
        apart <= 1e-6 * (a[0].abs() + b[1].abs() + c[2].abs())
    }

    /// Transposed block times vector; by columns, as [`Block::times`], where the block is `SYMMETRIC`.
    #[inline(always)]
    pub(super) fn transposed_times<const SYMMETRIC: bool>(&self, x: &Lanes) -> Lanes {
        if SYMMETRIC {
            return self.times(x);
        }
        let products = self.0.map(|column| column * *x);
        let [a, b, c, _] = Lanes::transpose([products[0], products[1], products[2], Lanes::ZERO]);
        a + b + c
    }
}

/// What rounding leaves of a diagonal block that is a sum of others, over its norm.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// The inverse of a diagonal block, in double precision: what is soft in some direction and stiff in another, as a sheet
/// at an angle to the axes, has an inverse that single precision rounds by more than its part in the stiff direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inverse([f64x4; 3]);

impl Inverse {
    pub(super) const ZERO: Self = Self([f64x4::ZERO; 3]);

    /// Of a block. Where single precision has lost what is soft, the diagonal is larger by its rounding.
    pub(super) fn of(block: &Mat3) -> Self {
        let size = block.norm();
        let is_known = |inverse: &Mat3| inverse.norm() * size * ROUNDING < 1.0;
        let inverse = block
            .try_inverse()
            .filter(is_known)
            .or_else(|| (block + Mat3::from_diagonal_element(size * ROUNDING)).try_inverse());
        let inverse = inverse.unwrap_or_else(Mat3::zeros);
        Self(
            [0, 1, 2].map(|c| f64x4::new([inverse[(0, c)], inverse[(1, c)], inverse[(2, c)], 0.0])),
        )
    }

    /// Inverse times vector.
    #[inline(always)]
    pub(super) fn times(&self, x: &Lanes) -> Lanes {
        let [a, b, c, _] = x.to_array().map(|x| f64x4::splat(f64::from(x)));
        let product = self.0[0] * a + self.0[1] * b + self.0[2] * c;
        Lanes::new(product.to_array().map(|x| x as f32))
    }
}

/// `a + weight · b`.
#[inline(always)]
pub(super) fn plus(a: Lanes, weight: f32, b: &Lanes) -> Lanes {
    a + Lanes::splat(weight) * *b
}

#[inline(always)]
pub(super) fn lanes(v: &Vec3) -> Lanes {
    Lanes::new([v.x as f32, v.y as f32, v.z as f32, 0.0])
}

#[inline(always)]
pub(super) fn vector(v: &Lanes) -> Vec3 {
    let [x, y, z, _] = v.to_array();
    Vec3::new(f64::from(x), f64::from(y), f64::from(z))
}

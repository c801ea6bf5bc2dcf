//! Two kinds of number to calculate with: `f64`, and double-double numbers, unevaluated sums of two `f64`, for what is
//! nearer than `f64` can tell.

use cloth_core::math::{Real, Vec3};
use std::ops::{Add, Mul, Sub};

/// A number that rounds, by a known amount.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// Allowance for a product of a direction and a corner, in units of the size of both (dimensionless): the proof is
    /// in `reach`.
    const ROUNDING: Real;
    /// The sum of two numbers, the second of which is smaller than the last digit of the first, or zero.
    fn new(high: Real, low: Real) -> Self;
    /// The nearest `f64`.
    fn value(self) -> Real;
    /// The number times a power of two. Exact.
    fn times_power(self, power: Real) -> Self;
}

impl Number for Real {
    const ROUNDING: Real = 8.0 * Real::EPSILON;
    fn new(high: Real, _low: Real) -> Self {
        high
    }
    fn value(self) -> Real {
        self
    }
    fn times_power(self, power: Real) -> Self {
        self * power
    }
}

/// A number of 106 bits as the sum of two `f64`, the second of which holds what does not fit into the first. One
/// operation is off by at most 8 u², u = 2⁻⁵³ (Joldes, Muller and Popescu 2017 show less).
#[derive(Clone, Copy, Debug)]
pub(super) struct Double {
    high: Real,
    low: Real,
}

impl Number for Double {
    // 16 roundings, as of an `f64` (`reach`), of 4 ε² = 16 u² each: twice what one can be.
    const ROUNDING: Real = 16.0 * Real::EPSILON * Real::EPSILON * 4.0;
    fn new(high: Real, low: Real) -> Self {
        Self { high, low }
    }
    fn value(self) -> Real {
        self.high
    }
    fn times_power(self, power: Real) -> Self {
        Self {
            high: self.high * power,
            low: self.low * power,
        }
    }
}

impl Double {
    /// The largest `f64` that is not above.
    pub(super) fn rounded_down(self) -> Real {
        if self.low < 0.0 {
            self.high.next_down()
        } else {
            self.high
        }
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = exact_sum(self.high, other.high);
        let (middle, lowest) = exact_sum(self.low, other.low);
        let (high, low) = quick_exact_sum(high, low + middle);
        let (high, low) = quick_exact_sum(high, low + lowest);
        Self { high, low }
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self {
            high: -other.high,
            low: -other.low,
        }
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (high, low) = exact_product(self.high, other.high);
        let crossed = self.high * other.low + self.low * other.high;
        let (high, low) = quick_exact_sum(high, low + crossed);
        Self { high, low }
    }
}

/// a + b as a rounded sum and its error (Knuth).
pub(super) fn exact_sum(a: Real, b: Real) -> (Real, Real) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The same, if |a| ≥ |b| or a = 0 (Dekker).
fn quick_exact_sum(a: Real, b: Real) -> (Real, Real) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a b as a rounded product and its error (Dekker). Without the fused operation, which many builds do not have.
fn exact_product(a: Real, b: Real) -> (Real, Real) {
    let halves = |x: Real| {
        let shifted = 134_217_729.0 * x; // 2²⁷ + 1
        let upper = shifted - (shifted - x);
        (upper, x - upper)
    };
    let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
    let product = a * b;
    (
        product,
        a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2),
    )
}

/// Three numbers: a point or a direction.
pub(super) type Triple<S> = [S; 3];

pub(super) fn minus<S: Number>(a: &Triple<S>, b: &Triple<S>) -> Triple<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn plus<S: Number>(a: &Triple<S>, b: &Triple<S>) -> Triple<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn dot<S: Number>(a: &Triple<S>, b: &Triple<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<S: Number>(a: &Triple<S>, b: &Triple<S>) -> Triple<S> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(super) fn times_power<S: Number>(a: &Triple<S>, power: Real) -> Triple<S> {
    a.map(|x| x.times_power(power))
}

/// The nearest `f64` of each.
pub(super) fn value<S: Number>(a: &Triple<S>) -> Vec3 {
    a.map(S::value).into()
}

/// A power of two that brings `x` into 1..2, if `x` is neither subnormal nor above 1e300; a subnormal number to at
/// least 2⁻⁵².
pub(super) fn power_for(x: Real) -> Real {
    // The exponent of an f64 stands in bits 52 to 62, with 1023 added to it.
    let exponent = x.to_bits() >> 52;
    Real::from_bits((2046 - exponent.max(1)) << 52)
}

#[cfg(test)]
#[path = "../../tests/unit/ccd_number.rs"]
mod tests;

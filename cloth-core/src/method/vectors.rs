//! Sums over whole vectors with three numbers per vertex, four vertices at a time.

use crate::math::{Real, Vec3};
use crate::method::chunked::map_reduce;

/// Vertices that are added up beside each other, so that no addition waits for the one before.
const ABREAST: usize = 4;

/// `Σ aᵢ·bᵢ`.
#[must_use]
pub fn dot(a: &[Vec3], b: &[Vec3]) -> Real {
    let sum = map_reduce(
        (a, b),
        #[inline(always)]
        |_, (a, b)| [dot_of_chunk(a, b)],
    );
    sum[0]
}

/// `y += factor · x`.
pub fn add(y: &mut [Vec3], factor: Real, x: &[Vec3]) {
    map_reduce(
        (y, x),
        #[inline(always)]
        |_, (y, x): (&mut [Vec3], &[Vec3])| {
            for (y, x) in y.iter_mut().zip(x) {
                *y += x * factor;
            }
            []
        },
    );
}

/// `Σ aᵢ·bᵢ` of a chunk.
#[inline(always)]
#[must_use]
pub fn dot_of_chunk(a: &[Vec3], b: &[Vec3]) -> Real {
    let mut sums = [[0.0; 3]; ABREAST];
    let ((a, a_last), (b, b_last)) = (a.as_chunks(), b.as_chunks());
    for (a, b) in a.iter().zip(b) {
        add_products(&mut sums, a, b);
    }
    total(sums) + rest(a_last, b_last)
}

#[inline(always)]
fn add_products(sums: &mut [[Real; 3]; ABREAST], a: &[Vec3; ABREAST], b: &[Vec3; ABREAST]) {
    for lane in 0..ABREAST {
        for axis in 0..3 {
            sums[lane][axis] += a[lane][axis] * b[lane][axis];
        }
    }
}

#[inline(always)]
fn total(sums: [[Real; 3]; ABREAST]) -> Real {
    sums.iter().flatten().sum()
}

#[inline(always)]
fn rest(a: &[Vec3], b: &[Vec3]) -> Real {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

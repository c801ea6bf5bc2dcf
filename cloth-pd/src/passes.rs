//! Passes over vectors that have an entry per vertex, a part of the cloth at a time, on several threads where that pays.
//!
//! The parts and the order in which their sums are added do not depend on the number of threads, so neither do the results.

use crate::pieces::{PIECE, together};
use cloth_core::math::Real;
use cloth_core::wide::wide;

/// Vectors of one length that can be cut at the same place.
pub(crate) trait Cut: Send + Sized {
    fn len(&self) -> usize;
    fn cut(self, at: usize) -> (Self, Self);
}

impl<T: Sync> Cut for &[T] {
    #[inline(always)]
    fn len(&self) -> usize {
        <[T]>::len(self)
    }
    #[inline(always)]
    fn cut(self, at: usize) -> (Self, Self) {
        self.split_at(at)
    }
}

impl<T: Send> Cut for &mut [T] {
    #[inline(always)]
    fn len(&self) -> usize {
        <[T]>::len(self)
    }
    #[inline(always)]
    fn cut(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

impl<A: Cut, B: Cut> Cut for (A, B) {
    #[inline(always)]
    fn len(&self) -> usize {
        self.0.len()
    }
    #[inline(always)]
    fn cut(self, at: usize) -> (Self, Self) {
        let (a, b) = (self.0.cut(at), self.1.cut(at));
        ((a.0, b.0), (a.1, b.1))
    }
}

/// Hands `vectors` to `work` part by part, with the number of the first vertex, and adds up what it returns.
#[inline]
pub(crate) fn visit<V: Cut, const M: usize>(
    vectors: V,
    work: impl Fn(usize, V) -> [Real; M] + Sync,
) -> [Real; M] {
    visit_from(0, vectors, &work)
}

fn visit_from<V: Cut, const M: usize>(
    start: usize,
    vectors: V,
    work: &(impl Fn(usize, V) -> [Real; M] + Sync),
) -> [Real; M] {
    let count = vectors.len();
    if count <= PIECE {
        return wide(
            #[inline(always)]
            || work(start, vectors),
        );
    }
    let middle = (count / 2).next_multiple_of(PIECE);
    let (first, second) = vectors.cut(middle);
    let (a, b) = together(
        count,
        || visit_from(start, first, work),
        || visit_from(start + middle, second, work),
    );
    std::array::from_fn(|i| a[i] + b[i])
}

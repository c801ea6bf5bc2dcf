//! Chunked map–reduce over vectors that have an entry per vertex, on several threads where that pays.
//!
//! The chunks and the order in which their sums are added do not depend on the number of threads, so neither do the
//! results.

use crate::math::Real;
use crate::method::parallel::join;
use crate::method::parallel::wide;

/// Vertices of a chunk.
pub const CHUNK: usize = 2_048;

/// Vectors of one length that can be cut at the same place.
pub trait Cut: Send + Sized {
    /// Entries.
    fn len(&self) -> usize;
    /// Whether there is none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The entries before `at`, and the others.
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

/// Hands `vectors` to `work` chunk by chunk, with the number of the first vertex, and adds up what it returns.
#[inline]
pub fn map_reduce<V: Cut, const M: usize>(
    vectors: V,
    work: impl Fn(usize, V) -> [Real; M] + Sync,
) -> [Real; M] {
    reduce_from(0, vectors, &work)
}

fn reduce_from<V: Cut, const M: usize>(
    start: usize,
    vectors: V,
    work: &(impl Fn(usize, V) -> [Real; M] + Sync),
) -> [Real; M] {
    let count = vectors.len();
    if count <= CHUNK {
        return wide(
            #[inline(always)]
            || work(start, vectors),
        );
    }
    let middle = (count / 2).next_multiple_of(CHUNK);
    let (first, second) = vectors.cut(middle);
    let (a, b) = join(
        count,
        || reduce_from(start, first, work),
        || reduce_from(start + middle, second, work),
    );
    std::array::from_fn(|i| a[i] + b[i])
}

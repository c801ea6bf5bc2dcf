//! The cloth cut into pieces of neighbouring vertices, so that sums over elements come out the same on any number of threads.

use cloth_core::math::Real;

/// Vertices of a piece. Twice as many make half as many elements that are visited twice, and half as many pieces.
pub(crate) const PIECE: usize = 2_048;

/// The piece of a vertex.
#[inline]
pub(crate) fn of(vertex: u32) -> usize {
    vertex as usize / PIECE
}

/// The elements of a family, by pieces of the cloth: vertices with neighbouring numbers.
///
/// Each piece visits the elements that touch it, in the order in which one thread would come to them, and adds to its own vertices only; an element on
/// the border of two pieces is visited by both. So no two threads write to the same place, and every vertex adds up the
/// same numbers in the same order on any number of threads. A number per element is added up by the piece of its first vertex.
#[derive(Debug, Default)]
pub(crate) struct Pieces {
    /// One number per piece.
    pub(crate) values: Vec<Real>,
    /// Elements of piece `p`: `elements[offsets[p]..offsets[p + 1]]`, ascending. Made when several threads first meet the family.
    #[cfg(feature = "parallel")]
    offsets: Vec<usize>,
    #[cfg(feature = "parallel")]
    elements: Vec<u32>,
}

impl Pieces {
    pub(crate) fn new(vertex_count: usize) -> Self {
        let mut pieces = Self::default();
        pieces.values.resize(vertex_count.div_ceil(PIECE), 0.0);
        pieces
    }

    /// Forgets which elements there are.
    pub(crate) fn forget(&mut self) {
        #[cfg(feature = "parallel")]
        self.offsets.clear();
    }
}

#[cfg(feature = "parallel")]
pub(crate) use threads::{pays, together};

/// Does two things that have nothing to do with each other, one after the other.
#[cfg(not(feature = "parallel"))]
pub(crate) fn together<A, B>(
    _: usize,
    first: impl FnOnce() -> A,
    second: impl FnOnce() -> B,
) -> (A, B) {
    (first(), second())
}

#[cfg(feature = "parallel")]
mod threads {
    use super::{PIECE, Pieces, of};
    use crate::local::share;
    use crate::pulls::{BLOCK, Pulls};
    use cloth_core::element::{Element, Projective};
    use cloth_core::math::{Real, Vec3};
    use cloth_core::wide::wide;
    use rayon::prelude::*;

    /// Smaller families are visited on one thread: an element costs about five nanoseconds, so these take less than a sixth of
    /// a millisecond, and a second thread that has to be woken first saves nothing of it.
    const SMALLEST_PARALLEL_FAMILY: usize = 32_768;

    /// Passes over fewer vertices than this take less than it costs to wake a second thread a few times in an iteration.
    const SMALLEST_PARALLEL_CLOTH: usize = 8_192;

    /// Whether several threads are there, and enough for them to do.
    pub(crate) fn pays(element_count: usize) -> bool {
        element_count >= SMALLEST_PARALLEL_FAMILY && rayon::current_num_threads() > 1
    }

    /// Does two things that have nothing to do with each other, at the same time if there are several threads and the cloth has enough vertices.
    pub(crate) fn together<A: Send, B: Send>(
        vertex_count: usize,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        if vertex_count >= SMALLEST_PARALLEL_CLOTH && rayon::current_num_threads() > 1 {
            rayon::join(first, second)
        } else {
            (first(), second())
        }
    }

    impl Pieces {
        /// Adds `Σ w Gᵀ(G x − p)` to `out`, and returns `½ Σ w ‖G x − p‖²`.
        pub(crate) fn sum<const N: usize, const K: usize, E: Projective<N, K>>(
            &mut self,
            elements: &[E],
            are_spheres: bool,
            x: &[Vec3],
            out: &mut [Vec3],
        ) -> Real {
            if self.offsets.is_empty() {
                self.list(elements);
            }
            let numbers = &self.elements;
            let ranges = self.offsets.par_windows(2);
            let pieces = ranges.zip(out.par_chunks_mut(PIECE)).zip(&mut self.values);
            pieces
                .enumerate()
                .for_each(|(piece, ((range, out), total))| {
                    let own = &numbers[range[0]..range[1]];
                    *total = wide(
                        #[inline(always)]
                        || sum_piece(piece, own, elements, are_spheres, x, out),
                    );
                });
            self.values.iter().sum()
        }

        fn list<const N: usize, E: Element<N>>(&mut self, elements: &[E]) {
            let mut lists = vec![Vec::new(); self.values.len()];
            for (index, element) in elements.iter().enumerate() {
                for vertex in element.vertices() {
                    let list: &mut Vec<u32> = &mut lists[of(vertex)];
                    if list.last() != Some(&(index as u32)) {
                        list.push(index as u32);
                    }
                }
            }
            self.offsets = vec![0];
            self.elements.clear();
            for list in lists {
                self.elements.extend(list);
                self.offsets.push(self.elements.len());
            }
        }
    }

    /// Adds what the elements with the numbers `own` pull at the vertices of a piece, and returns the energy of those that it counts.
    #[inline(always)]
    fn sum_piece<const N: usize, const K: usize, E: Projective<N, K>>(
        piece: usize,
        own: &[u32],
        elements: &[E],
        are_spheres: bool,
        x: &[Vec3],
        out: &mut [Vec3],
    ) -> Real {
        let start = piece * PIECE;
        let (mut total, mut pulls) = (0.0, Pulls::default());
        for block in own.chunks(BLOCK) {
            let block = block.iter().map(|&element| &elements[element as usize]);
            pulls.find(block.clone(), are_spheres, x);
            for (element, (pull, energy)) in block.zip(pulls.each()) {
                let (vertices, operator) = (element.vertices(), element.operator());
                for i in 0..N {
                    // Wraps to a large number for a vertex before the piece, and finds nothing.
                    if let Some(out) = out.get_mut((vertices[i] as usize).wrapping_sub(start)) {
                        *out += share(&operator, pull, i);
                    }
                }
                if of(vertices[0]) == piece {
                    total += energy;
                }
            }
        }
        total
    }
}

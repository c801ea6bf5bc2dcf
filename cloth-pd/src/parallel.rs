//! The local step on several threads.

use crate::local::share;
use cloth_core::element::Projective;
use cloth_core::math::Vec3;
use rayon::prelude::*;

/// Smaller families are visited on one thread: an element costs about five nanoseconds, so these take less than a sixth of
/// a millisecond, and a second thread that has to be woken first saves nothing of it.
const SMALLEST_PARALLEL_FAMILY: usize = 32_768;

/// Vertices of a piece. Twice as many make half as many elements that are visited twice, and half as many pieces.
const PIECE: usize = 2_048;

/// Whether several threads are there, and enough for them to do.
pub(crate) fn pays(element_count: usize) -> bool {
    element_count >= SMALLEST_PARALLEL_FAMILY && rayon::current_num_threads() > 1
}

/// The elements of a family, by pieces of the cloth: vertices with neighbouring numbers.
///
/// Each piece visits the elements that touch it, in the order in which one thread would come to them, and adds to its own vertices only; an element on
/// the border of two pieces is visited by both. So no two threads write to the same place, and every vertex adds up the
/// same numbers in the same order on any number of threads. Made when several threads first meet the family.
#[derive(Debug, Default)]
pub(crate) struct Pieces {
    /// Elements of piece `p`: `elements[offsets[p]..offsets[p + 1]]`, ascending.
    offsets: Vec<usize>,
    elements: Vec<u32>,
}

impl Pieces {
    /// Adds `Σ Gᵀ goal(element)` to `out`.
    pub(crate) fn sum<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: &[E],
        out: &mut [Vec3],
        goal: impl Fn(&E) -> [Vec3; K] + Sync,
    ) {
        if self.offsets.is_empty() {
            *self = Self::of(elements, out.len());
        }
        let pieces = self.offsets.par_windows(2).zip(out.par_chunks_mut(PIECE));
        pieces.enumerate().for_each(|(piece, (range, out))| {
            let start = piece * PIECE;
            for &element in &self.elements[range[0]..range[1]] {
                let element = &elements[element as usize];
                let (goal, operator) = (goal(element), element.operator());
                let vertices = element.vertices();
                for i in 0..N {
                    // Wraps to a large number for a vertex before the piece, and finds nothing.
                    if let Some(out) = out.get_mut((vertices[i] as usize).wrapping_sub(start)) {
                        *out += share(&operator, &goal, i);
                    }
                }
            }
        });
    }

    fn of<const N: usize, E: cloth_core::element::Element<N>>(
        elements: &[E],
        vertex_count: usize,
    ) -> Self {
        let mut lists = vec![Vec::new(); vertex_count.div_ceil(PIECE)];
        for (index, element) in elements.iter().enumerate() {
            for vertex in element.vertices() {
                let list: &mut Vec<u32> = &mut lists[vertex as usize / PIECE];
                if list.last() != Some(&(index as u32)) {
                    list.push(index as u32);
                }
            }
        }
        let mut pieces = Self {
            offsets: vec![0],
            elements: Vec::new(),
        };
        for list in lists {
            pieces.elements.extend(list);
            pieces.offsets.push(pieces.elements.len());
        }
        pieces
    }
}

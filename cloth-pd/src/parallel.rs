//! The local step on several threads.

use crate::local::share;
use cloth_core::element::Projective;
use cloth_core::math::Vec3;
use rayon::prelude::*;

/// Fewer elements than this are visited on one thread.
const SMALLEST_PARALLEL_FAMILY: usize = 16_384;

/// Elements and vertices are handed to the threads in pieces of this many.
const PIECE: usize = 2_048;

/// Whether several threads are there, and enough for them to do.
pub(crate) fn pays(element_count: usize) -> bool {
    element_count >= SMALLEST_PARALLEL_FAMILY && rayon::current_num_threads() > 1
}

/// Sums over elements vertex by vertex instead of element by element.
///
/// Each vertex adds up its elements in the order in which one thread would come to them, so the bits are the same on any number of
/// threads. Made when several threads first meet the family.
#[derive(Debug)]
pub(crate) struct Gather<const N: usize, const K: usize> {
    /// `w p` of each element.
    goals: Vec<[Vec3; K]>,
    /// Elements of vertex `v`: `corners[offsets[v]..offsets[v + 1]]`, in ascending order.
    offsets: Vec<u32>,
    /// `N · element + corner`.
    corners: Vec<u32>,
}

impl<const N: usize, const K: usize> Default for Gather<N, K> {
    fn default() -> Self {
        Self {
            goals: Vec::new(),
            offsets: Vec::new(),
            corners: Vec::new(),
        }
    }
}

impl<const N: usize, const K: usize> Gather<N, K> {
    /// Adds `Σ Gᵀ goal(element)` to `out`.
    pub(crate) fn sum<E: Projective<N, K>>(
        &mut self,
        elements: &[E],
        out: &mut [Vec3],
        goal: impl Fn(&E) -> [Vec3; K] + Sync,
    ) {
        if self.offsets.is_empty() {
            self.prepare(elements, out.len());
        }
        self.goals
            .par_chunks_mut(PIECE)
            .zip(elements.par_chunks(PIECE))
            .for_each(|(goals, elements)| {
                for (slot, element) in goals.iter_mut().zip(elements) {
                    *slot = goal(element);
                }
            });
        let (goals, offsets, corners) = (&self.goals, &self.offsets, &self.corners);
        let pieces = out.par_chunks_mut(PIECE).enumerate();
        pieces.for_each(|(piece, out)| {
            for (vertex, out) in (piece * PIECE..).zip(out) {
                let range = offsets[vertex] as usize..offsets[vertex + 1] as usize;
                for &corner in &corners[range] {
                    let (element, corner) = (corner as usize / N, corner as usize % N);
                    *out += share(&elements[element].operator(), &goals[element], corner);
                }
            }
        });
    }

    fn prepare<E: Projective<N, K>>(&mut self, elements: &[E], vertex_count: usize) {
        self.goals = vec![[Vec3::zeros(); K]; elements.len()];
        self.offsets = vec![0; vertex_count + 1];
        for vertex in elements.iter().flat_map(E::vertices) {
            self.offsets[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            self.offsets[vertex + 1] += self.offsets[vertex];
        }
        let mut next = self.offsets.clone();
        self.corners = vec![0; N * elements.len()];
        let vertices = elements.iter().flat_map(E::vertices);
        for (corner, vertex) in vertices.enumerate() {
            let place = &mut next[vertex as usize];
            self.corners[*place as usize] = corner as u32;
            *place += 1;
        }
    }
}

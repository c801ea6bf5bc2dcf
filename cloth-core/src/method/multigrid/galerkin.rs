//! The coarse operator PᵀAP, through lists made once.

use super::blocks::Block;
use super::prolongation::Prolongation;
use crate::math::Real;
use crate::method::block_matrix::{BlockPattern, PatternBuilder};
use crate::method::chunked::map_reduce;
use std::sync::Arc;

/// For every block of the coarse matrix the fine blocks that it is the weighted sum of.
#[derive(Debug)]
pub(super) struct Galerkin {
    /// Where the list of each coarse block begins; one more at the end.
    starts: Vec<u32>,
    /// Where in it the blocks begin that go in transposed.
    turns: Vec<u32>,
    /// Places of fine blocks and their weights.
    terms: Vec<(u32, f32)>,
}

impl Galerkin {
    /// The pattern of the coarse matrix, and the lists. `fine` and the coarse pattern hold lower halves.
    pub(super) fn new(
        fine: &BlockPattern,
        prolongation: &Prolongation,
    ) -> (Arc<BlockPattern>, Self) {
        let mut builder = PatternBuilder::new(prolongation.coarse_count());
        for row in 0..fine.row_count() {
            for slot in fine.row(row) {
                let column = fine.columns()[slot] as usize;
                for &(a, _) in prolongation.of_fine(row) {
                    for &(b, _) in prolongation.of_fine(column) {
                        if a != b {
                            builder.add_pairs(&[a, b], |_| true);
                        }
                    }
                }
            }
        }
        let coarse = builder.build();
        let mut terms: Vec<(u32, bool, u32, f32)> = Vec::new();
        for row in 0..fine.row_count() {
            for slot in fine.row(row) {
                let column = fine.columns()[slot] as usize;
                for &(a, in_row) in prolongation.of_fine(row) {
                    for &(b, in_column) in prolongation.of_fine(column) {
                        let weight = (in_row * in_column) as f32;
                        let target = coarse.slot(a, b).expect("a pair of the pattern");
                        // The block stands for (row, column) and, transposed, for (column, row); kept is the lower
                        // half.
                        if a >= b {
                            terms.push((target, false, slot as u32, weight));
                        }
                        if column != row && b >= a {
                            terms.push((target, true, slot as u32, weight));
                        }
                    }
                }
            }
        }
        terms.sort_unstable_by_key(|term| (term.0, term.1, term.2));
        let start = |slot: usize, turned: bool| {
            terms.partition_point(|term| (term.0 as usize, term.1) < (slot, turned)) as u32
        };
        let lists = Self {
            starts: (0..=coarse.block_count())
                .map(|slot| start(slot, false))
                .collect(),
            turns: (0..coarse.block_count())
                .map(|slot| start(slot, true))
                .collect(),
            terms: terms.iter().map(|term| (term.2, term.3)).collect(),
        };
        (coarse, lists)
    }

    /// Fills `coarse` from `fine`.
    pub(super) fn apply(&self, fine: &[Block], coarse: &mut [Block]) {
        map_reduce(
            coarse,
            #[inline(always)]
            |start, coarse: &mut [Block]| {
                for (slot, out) in (start..).zip(coarse) {
                    let [begin, turn, end] =
                        [self.starts[slot], self.turns[slot], self.starts[slot + 1]]
                            .map(|i| i as usize);
                    let mut sum = Block::ZERO;
                    for &(from, weight) in &self.terms[turn..end] {
                        sum.add(&fine[from as usize], weight);
                    }
                    sum = sum.transposed();
                    for &(from, weight) in &self.terms[begin..turn] {
                        sum.add(&fine[from as usize], weight);
                    }
                    *out = sum;
                }
                []
            },
        );
    }
}

/// Couplings of the coarse vertices (any unit) from those of the fine ones, as the coarse operator of a Laplacian has
/// them.
pub(super) fn coarse_strengths(
    fine: &BlockPattern,
    strengths: &[Real],
    prolongation: &Prolongation,
    coarse: &BlockPattern,
) -> Vec<Real> {
    let mut out = vec![0.0; coarse.block_count()];
    for row in 0..fine.row_count() {
        for slot in fine.row(row) {
            let column = fine.columns()[slot] as usize;
            for &(a, in_row) in prolongation.of_fine(row) {
                for &(b, in_column) in prolongation.of_fine(column) {
                    if a != b && row != column {
                        let target = coarse.slot(a, b).expect("a pair of the pattern");
                        out[target as usize] += strengths[slot] * in_row * in_column;
                    }
                }
            }
        }
    }
    out
}

//! What can touch between two patches.

use super::detect::PatchQuery;
use super::measure::{Places, RelativePose};
use super::{NearPair, QUERIES};
use cloth_core::math::Real;
use cloth_core::method::parallel::{join, wide};

/// Two patches, or one with itself, and what can touch between them.
#[derive(Clone, Debug, Default)]
pub(super) struct PatchPair {
    pub(super) patches: [u32; 2],
    /// The second patch as seen from the first, and sum of the spreads (m), when the pairs were found.
    pub(super) pose: RelativePose,
    pub(super) spread: Real,
    /// Relative motion (m) for which the pairs are complete.
    pub(super) budget: Real,
    /// In the order of their excess gap.
    pub(super) pairs: Vec<NearPair>,
    /// The travel (m) from which on each may touch: apart from the pairs, because most of them are only asked for this.
    pub(super) active_from: Vec<Real>,
    /// Scratch: those of an earlier list that have a constraint.
    pub(super) known: Vec<NearPair>,
    /// How many of them had an excess gap of less than `next` (m).
    pub(super) first: usize,
    pub(super) next: Real,
    /// Sum of the changes (m) since then, until the start of the substep.
    pub(super) travel: Real,
}

impl PatchPair {
    /// The same lists for two other patches, of which nothing is known.
    pub(super) fn of(mut self, patches: [u32; 2]) -> Self {
        self.pairs.clear();
        Self {
            patches,
            budget: Real::NEG_INFINITY,
            ..self
        }
    }

    /// The bound on what the two have moved relative to each other (m) since their pairs were found.
    #[inline]
    pub(super) fn moved(&self, now: &Places) -> Real {
        let change = self.pose.change(&now.pose(self.patches));
        change + now.spread(self.patches) - self.spread
    }

    /// Asks `excess` for the excess gap (m) of the pairs that may touch in the motion at hand. Returns how far the two
    /// can move until another pair may touch (m).
    pub(super) fn ask(
        &mut self,
        query: &PatchQuery,
        mut excess: impl FnMut(&mut NearPair) -> Option<Real>,
    ) -> Real {
        let until = self.travel + query.once;
        if query.moved() > self.next {
            let more = self.pairs[self.first..].iter();
            self.first += more.take_while(|pair| pair.excess < query.moved()).count();
            let next = self.pairs.get(self.first);
            self.next = next.map_or(self.budget, |pair| pair.excess);
        }
        let active_from = &mut self.active_from[..self.first];
        for (active_from, pair) in active_from.iter_mut().zip(&mut self.pairs) {
            if *active_from < until
                && let Some(excess) = excess(pair)
            {
                *active_from = self.travel + excess;
            }
        }
        let least = wide(|| smallest(active_from)) - self.travel;
        least.min(self.next.min(self.budget) - query.now)
    }
}

/// What is done with the pairs that may touch in a substep; see
/// [`Patches::detect_for_substep`](super::Patches::detect_for_substep).
#[derive(Debug)]
pub(super) struct Visits<'a, F> {
    pub(super) substep: u32,
    /// Of the whole cloth.
    pub(super) vertices: usize,
    pub(super) visit: &'a F,
}

impl<F> Visits<'_, F> {
    /// Fills the lists, each from as many queries, on several threads. The first of the pairs of patches and of the
    /// lists have these numbers.
    pub(super) fn ask_all<T: Send>(
        &self,
        queries: &mut [PatchQuery],
        (pairs, first): (&mut [PatchPair], usize),
        (lists, list): (&mut [Vec<T>], u32),
    ) where
        F: Fn(&mut Vec<T>, &mut NearPair, Option<[u32; 2]>, Real) -> Real + Sync,
    {
        if let [only] = lists {
            for query in queries {
                let pair = &mut pairs[query.number as usize - first];
                self.ask(query, pair, (only, list));
            }
            return;
        }
        let middle = lists.len() / 2;
        let (queries, other_queries) = queries.split_at_mut((middle * QUERIES).min(queries.len()));
        let Some(next) = other_queries.first().map(|query| query.number as usize) else {
            return;
        };
        let (pairs, other_pairs) = pairs.split_at_mut(next - first);
        let (lists, other_lists) = lists.split_at_mut(middle);
        join(
            self.vertices,
            || self.ask_all(queries, (pairs, first), (lists, list)),
            || {
                self.ask_all(
                    other_queries,
                    (other_pairs, next),
                    (other_lists, list + middle as u32),
                )
            },
        );
    }

    fn ask<T>(
        &self,
        query: &mut PatchQuery,
        between: &mut PatchPair,
        (constraints, list): (&mut Vec<T>, u32),
    ) where
        F: Fn(&mut Vec<T>, &mut NearPair, Option<[u32; 2]>, Real) -> Real,
    {
        let travel = between.travel;
        query.left = between.ask(query, |pair| {
            let seen = std::mem::replace(&mut pair.seen, self.substep);
            // Once in a substep.
            (seen != self.substep).then(|| {
                let last = (seen > 0 && seen + 1 == self.substep).then_some(pair.constraint);
                let index = constraints.len() as u32;
                let excess = (self.visit)(constraints, pair, last, travel);
                pair.constraint = [list, index];
                excess
            })
        });
    }
}

/// The smallest of some numbers; ∞ of none.
#[inline(always)]
fn smallest(numbers: &[Real]) -> Real {
    const LANES: usize = 8;
    let mut least = [Real::INFINITY; LANES];
    let (chunks, rest) = numbers.as_chunks::<LANES>();
    for chunk in chunks {
        for (least, number) in least.iter_mut().zip(chunk) {
            *least = if *number < *least { *number } else { *least };
        }
    }
    least
        .iter()
        .chain(rest)
        .copied()
        .fold(Real::INFINITY, Real::min)
}

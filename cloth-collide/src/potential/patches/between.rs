//! What can touch between two patches.

use super::detect::Look;
use super::motions::{Motions, Pose};
use super::{LOOKS, NearPair};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::parallel::{join, wide};

/// Two patches, or one with itself, and what can touch between them.
#[derive(Debug, Default)]
pub(super) struct PatchPair {
    pub(super) patches: [u32; 2],
    /// The second patch as seen from the first, and sum of the spreads (m), when the pairs were found.
    pub(super) pose: Pose,
    pub(super) spread: Real,
    /// Relative motion (m) for which the pairs are complete.
    pub(super) budget: Real,
    /// In the order of what they lacked to contact.
    pub(super) pairs: Vec<NearPair>,
    /// The travel (m) until which each lacks something: apart from the pairs, because most of them are only asked for
    /// this.
    pub(super) wakes: Vec<Real>,
    /// Room to work in: those of an earlier list that have a row.
    pub(super) known: Vec<NearPair>,
    /// How many of them lacked less than `next` (m).
    pub(super) first: usize,
    pub(super) next: Real,
    /// Bound on the relative motion (m), added up until the start of the substep that it was last brought up to;
    /// difference of the centres and sum of the paths (m) there.
    pub(super) travel: Real,
    pub(super) last_apart: Vec3,
    pub(super) last_path: Real,
    /// Relative motion and travel (m) that were looked at, and in which substep.
    pub(super) looked: [Real; 2],
    pub(super) looked_in: u32,
}

impl PatchPair {
    /// The same lists for two other patches, of which nothing is known.
    pub(super) fn of(mut self, patches: [u32; 2]) -> Self {
        self.pairs.clear();
        Self {
            patches,
            budget: Real::NEG_INFINITY,
            looked: [-1.0; 2],
            looked_in: 0,
            ..self
        }
    }

    /// The bound on what the two have moved relative to each other (m) since their pairs were found.
    #[inline]
    pub(super) fn moved(&self, now: &Motions) -> Real {
        let change = self.pose.change(&now.pose(self.patches));
        change + now.spread(self.patches) - self.spread
    }

    /// Asks `lack` what (m) the pairs lack to contact that may touch in the motion that is looked
    /// at. Returns how far the two can move until another pair may touch (m).
    pub(super) fn wake(
        &mut self,
        look: &Look,
        mut lack: impl FnMut(&mut NearPair) -> Option<Real>,
    ) -> Real {
        let until = self.travel + look.once;
        if look.moved > self.next {
            let more = self.pairs[self.first..].iter();
            self.first += more.take_while(|pair| pair.room < look.moved).count();
            let next = self.pairs.get(self.first);
            self.next = next.map_or(self.budget, |pair| pair.room);
        }
        let wakes = &mut self.wakes[..self.first];
        for (wake, pair) in wakes.iter_mut().zip(&mut self.pairs) {
            if *wake < until
                && let Some(lack) = lack(pair)
            {
                *wake = self.travel + lack;
            }
        }
        let wake = wide(|| smallest(wakes)) - self.travel;
        wake.min(self.next.min(self.budget) - look.now)
    }
}

/// What is done with the pairs that may touch in a substep; see [`Patches::look`](super::Patches::look).
#[derive(Debug)]
pub(super) struct Visits<'a, F> {
    pub(super) substep: u32,
    /// Of the whole cloth.
    pub(super) vertices: usize,
    pub(super) visit: &'a F,
}

impl<F> Visits<'_, F> {
    /// Fills the lists, each from as many looks, on several threads. The first of the looks, of the pairs of patches
    /// and of the lists have these numbers.
    pub(super) fn wake_all<T: Send>(
        &self,
        looks: &mut [Look],
        (pairs, first): (&mut [PatchPair], usize),
        (lists, list): (&mut [Vec<T>], u32),
    ) where
        F: Fn(&mut Vec<T>, &mut NearPair, Option<[u32; 2]>, Real) -> Real + Sync,
    {
        if let [only] = lists {
            for look in looks {
                let pair = &mut pairs[look.number as usize - first];
                self.wake(look, pair, (only, list));
            }
            return;
        }
        let middle = lists.len() / 2;
        let (looks, other_looks) = looks.split_at_mut((middle * LOOKS).min(looks.len()));
        let Some(next) = other_looks.first().map(|look| look.number as usize) else {
            return;
        };
        let (pairs, other_pairs) = pairs.split_at_mut(next - first);
        let (lists, other_lists) = lists.split_at_mut(middle);
        join(
            self.vertices,
            || self.wake_all(looks, (pairs, first), (lists, list)),
            || {
                self.wake_all(
                    other_looks,
                    (other_pairs, next),
                    (other_lists, list + middle as u32),
                )
            },
        );
    }

    fn wake<T>(&self, look: &mut Look, between: &mut PatchPair, (rows, list): (&mut Vec<T>, u32))
    where
        F: Fn(&mut Vec<T>, &mut NearPair, Option<[u32; 2]>, Real) -> Real,
    {
        let travel = between.travel;
        between.looked = [look.moved, travel + look.once];
        between.looked_in = self.substep;
        look.left = between.wake(look, |pair| {
            let seen = std::mem::replace(&mut pair.seen, self.substep);
            // Once in a substep.
            (seen != self.substep).then(|| {
                let last = (seen > 0 && seen + 1 == self.substep).then_some(pair.row);
                let index = rows.len() as u32;
                let lack = (self.visit)(rows, pair, last, travel);
                pair.row = [list, index];
                lack
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

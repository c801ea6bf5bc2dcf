//! What can touch between two patches.

use super::detect::Look;
use super::motions::{Motions, Pose};
use super::{Memory, NearPair};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::parallel::wide;

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
    /// What is remembered of the few that have been looked at.
    pub(super) memories: Vec<Memory>,
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
        self.memories.clear();
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

    /// Asks `lack` what (m) the pairs lack to contact, with their numbers, that may touch in the motion that is looked
    /// at. Returns how far the two can move until another pair may touch (m).
    pub(super) fn wake(
        &mut self,
        look: &Look,
        mut lack: impl FnMut(u32, &mut NearPair, &mut Vec<Memory>) -> Option<Real>,
    ) -> Real {
        let until = self.travel + look.once;
        if look.moved > self.next {
            let more = self.pairs[self.first..].iter();
            self.first += more.take_while(|pair| pair.room < look.moved).count();
            let next = self.pairs.get(self.first);
            self.next = next.map_or(self.budget, |pair| pair.room);
        }
        let wakes = &mut self.wakes[..self.first];
        for (index, wake) in wakes.iter_mut().enumerate() {
            if *wake < until
                && let Some(lack) = lack(index as u32, &mut self.pairs[index], &mut self.memories)
            {
                *wake = self.travel + lack;
            }
        }
        let wake = wide(|| smallest(wakes)) - self.travel;
        wake.min(self.next.min(self.budget) - look.now)
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

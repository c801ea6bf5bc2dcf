//! What can touch between two patches.

use super::NearPair;
use cloth_core::math::{Real, Vec3};
use cloth_core::parallel::wide;

/// Two patches, or one with itself, and what can touch between them.
#[derive(Debug, Default)]
pub(super) struct PatchPair {
    pub(super) patches: [u32; 2],
    /// Difference of the centres (m), and sum of the spreads (m), when the pairs were found.
    pub(super) apart: Vec3,
    pub(super) spread: Real,
    /// Relative motion (m) for which the pairs are complete.
    pub(super) budget: Real,
    /// In the order of what they lacked to contact.
    pub(super) pairs: Vec<NearPair>,
    /// What that was (m), and the travel (m) until which each lacks something: apart from the pairs, because most of them are only asked for these.
    pub(super) rooms: Vec<Real>,
    pub(super) wakes: Vec<Real>,
    /// How many of them lacked less than `next` (m).
    pub(super) first: usize,
    pub(super) next: Real,
    /// Bound on the relative motion (m), added up until the start of the substep that it was last brought up to; difference of the centres and sum of the paths (m)
    /// there.
    pub(super) travel: Real,
    pub(super) last_apart: Vec3,
    pub(super) last_path: Real,
    /// Relative motion and travel (m) that were looked at, and in which substep.
    pub(super) looked: [Real; 2],
    pub(super) looked_in: u32,
}

impl PatchPair {
    /// The same lists for two other patches, of which nothing is known.
    pub(super) fn of(self, patches: [u32; 2]) -> Self {
        Self {
            patches,
            budget: -1.0,
            looked: [-1.0; 2],
            looked_in: 0,
            ..self
        }
    }

    /// Asks `lack` what (m) the pairs lack to contact, with their numbers, that may touch where the two have moved by `moved` against each other, and until their travel is
    /// `until`. Returns how far the two can move, having moved by `now`, until another pair may touch (all in m).
    pub(super) fn wake(
        &mut self,
        [now, moved, until]: [Real; 3],
        mut lack: impl FnMut(u32, &mut NearPair) -> Option<Real>,
    ) -> Real {
        if moved > self.next {
            let more = self.rooms[self.first..].iter();
            self.first += more.take_while(|room| **room < moved).count();
            self.next = *self.rooms.get(self.first).unwrap_or(&self.budget);
        }
        let wakes = &mut self.wakes[..self.first];
        for (index, wake) in wakes.iter_mut().enumerate() {
            if *wake < until
                && let Some(lack) = lack(index as u32, &mut self.pairs[index])
            {
                *wake = self.travel + lack;
            }
        }
        let wake = wide(|| smallest(wakes)) - self.travel;
        wake.min(self.next.min(self.budget) - now)
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

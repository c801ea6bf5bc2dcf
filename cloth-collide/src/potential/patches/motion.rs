//! Pairs for paths that a minimisation may take, with room around them.

use super::detect::Look;
use super::measure::{Allowed, TURN};
use super::{NearPair, Patches, REACH};
use crate::potential::near::Near;
use cloth_core::math::{Real, Vec3};

/// A motion so many times as large as this would still be harmless to two patches: it need not be known better.
const EASILY: Real = 10.0;

impl Patches {
    /// Looks at the path from `x` to `to` (m), and at everything within `room` (m) of it: makes sure that the pairs are
    /// complete, and hands `visit` those that may touch there, with how much nearer they can come to each other than
    /// they are at `x` (m); it returns what they lack to contact there (m), at most.
    ///
    /// [`Patches::holds`] tells for which other places the choice is good.
    pub(in crate::potential) fn choose(
        &mut self,
        near: &Near,
        [x, to]: [&[Vec3]; 2],
        room: Real,
        mut visit: impl FnMut(&NearPair, Real) -> Real,
    ) {
        if self.is_known {
            // From where pairs were chosen last.
            self.measure(x, true);
            self.travel();
            self.accept();
        } else {
            self.place(x);
        }
        self.measure(to, true);
        if !self.is_known || self.has_strayed(room) {
            let displacement = self.longest_stray() + room;
            self.reach = (2.0 * displacement).max(REACH * self.edge);
            self.search(near, x);
        }
        let range = near.law.range();
        let mut looks = std::mem::take(&mut self.looks);
        looks.clear();
        self.allowed.clear();
        for k in 0..self.pairs.len() {
            let (patches, left) = (self.ids[k], self.quiet[k] - self.pairs[k].travel);
            let straight = Allowed::all(Some(TURN), left, range);
            if straight.holds(self.roughly(patches), room) {
                self.allowed.push(straight);
                continue;
            }
            let mut allowed = self.allow(patches, room);
            let nearer = allowed.nearer(range);
            if nearer <= left {
                allowed = allowed.extended(left, range);
            } else {
                let now = self.moved(k, nearer);
                looks.push(Look::new(k, [now, now + nearer, nearer]));
            }
            self.allowed.push(allowed);
        }
        self.find(near, x, &mut looks);
        for look in &looks {
            let k = look.number as usize;
            let pair = &mut self.pairs[k];
            let left = pair.wake(look, |one| Some(visit(one, look.once)));
            self.quiet[k] = pair.travel + left;
            // Nothing has been chosen of these two.
            if look.once <= left {
                self.allowed[k] = self.allowed[k].extended(left, range);
            }
        }
        self.looks = looks;
    }

    /// Adds the motion that was looked at to the travels of all pairs of patches.
    fn travel(&mut self) {
        for k in 0..self.pairs.len() {
            let (patches, left) = (self.ids[k], self.quiet[k] - self.pairs[k].travel);
            let roughly = self.roughly(patches);
            self.pairs[k].travel += match EASILY * roughly <= left {
                true => roughly,
                false => self.change(patches).min(roughly),
            };
        }
    }

    /// Whether what was chosen last holds at `x` (m), which was chosen for paths from the `x` of the choice on.
    pub(in crate::potential) fn holds(&mut self, x: &[Vec3]) -> bool {
        self.measure(x, true);
        let mut pairs = self.ids.iter().zip(&self.allowed);
        pairs.all(|(patches, allowed)| self.is_allowed(*patches, allowed)) && !self.has_strayed(0.0)
    }
}

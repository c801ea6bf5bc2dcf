//! Pairs for paths that a minimisation may take, with room around them.

use super::detect::Look;
use super::{NearPair, Patches, REACH};
use crate::potential::near::Near;
use cloth_core::math::{Real, Vec3};

impl Patches {
    /// Looks at the path from `x` to `to` (m), and at everything within `room` (m) of it: makes sure that the pairs are
    /// complete, and hands `visit` those that may touch there, with how much nearer they can come to each other than
    /// they are at `x` (m); it returns what they lack to contact there (m), at most. `place` is the `x` of the choice
    /// before.
    ///
    /// [`Patches::holds`] tells for which other places the choice is good.
    pub(in crate::potential) fn choose(
        &mut self,
        near: &Near,
        place: &[Vec3],
        [x, to]: [&[Vec3]; 2],
        room: Real,
        mut visit: impl FnMut(&NearPair, Real) -> Real,
    ) {
        if self.is_known {
            // From where pairs were chosen last.
            self.measure(place, x);
            self.accept();
        }
        self.place(x);
        self.measure(x, to);
        let strayed = [&self.then, &self.now].map(|end| Self::stray(&self.searched, end));
        let strayed = strayed[0].max(strayed[1]);
        if !self.is_known || strayed + room > self.reach {
            let displacement = Self::stray(&self.now, &self.then) + room;
            self.reach = (2.0 * displacement).max(REACH * self.edge);
            self.search(near, x);
        }
        self.allowed.clear();
        let mut looks = std::mem::take(&mut self.looks);
        looks.clear();
        for k in 0..self.pairs.len() {
            if self.then.clock(self.ids[k]) + 2.0 * room > self.quiet[k] {
                self.bring_up(k);
                let pair = &self.pairs[k];
                let (now, nearer) = (self.now.bound(pair), self.once(pair) + 2.0 * room);
                self.allowed.push((k as u32, nearer));
                looks.push(Look::new(k, [now, now + nearer, nearer]));
            }
        }
        self.find(near, x, &mut looks);
        for look in &looks {
            let k = look.number as usize;
            let left = self.pairs[k].wake(look, |_, one, _| Some(visit(one, look.once)));
            self.quiet[k] = self.now.clock(self.ids[k]) + left;
        }
        self.looks = looks;
        let mut allowed = std::mem::take(&mut self.stray_allowed);
        allowed.clear();
        allowed.extend(self.strays().map(|stray| stray + room));
        self.stray_allowed = allowed;
    }

    /// How far (m) each patch goes in the motion that is looked at, besides what all do together.
    fn strays(&self) -> impl Iterator<Item = Real> {
        let (from, to) = (&self.now, &self.then);
        let shift = to.mean - from.mean;
        let centres = from.centres.iter().zip(&to.centres);
        let both = centres.zip(&self.displacements);
        both.map(move |((a, b), besides)| (b - a - shift).norm() + besides)
    }

    /// Whether what was chosen last holds at `x` (m), which was chosen for paths from `place` (m) on.
    pub(in crate::potential) fn holds(&mut self, place: &[Vec3], x: &[Vec3]) -> bool {
        self.measure(place, x);
        let mut strays = self.strays().zip(&self.stray_allowed);
        let mut allowed = self.allowed.iter();
        strays.all(|(stray, allowed)| stray <= *allowed)
            && allowed.all(|&(k, allowed)| self.once(&self.pairs[k as usize]) <= allowed)
    }
}

//! Pairs for paths that a minimisation may take, with a margin around them.

use super::detect::PatchQuery;
use super::measure::{change_for, nearer_by};
use super::{NearPair, Patches};
use crate::potential::near::Near;
use cloth_core::math::{Real, Vec3};

impl Patches {
    /// Makes sure that the pairs are complete for the path from `x` to `to` (m) and everything within `margin` (m) of
    /// it, and hands `visit` those that may touch there, with how much nearer they can come to each other than they are
    /// at `x` (m); it returns their excess gap there (m), at least.
    ///
    /// [`Patches::holds`] tells for which other places the choice is good.
    pub(in crate::potential) fn choose(
        &mut self,
        near: &Near,
        [x, to]: [&[Vec3]; 2],
        margin: Real,
        mut visit: impl FnMut(&NearPair, Real) -> Real,
    ) {
        if self.is_known {
            // From where pairs were chosen last.
            self.measure(x, true);
            self.accept();
        } else {
            self.place(x);
        }
        self.measure(to, true);
        if !self.is_known || self.has_strayed(near, x, margin) {
            self.search(near, x, margin);
        }
        let range = near.law.range();
        let mut queries = std::mem::take(&mut self.queries);
        queries.clear();
        for k in 0..self.pairs.len() {
            let harmless = change_for(self.left[k], range);
            let change = self.change(k, harmless - 2.0 * margin) + 2.0 * margin;
            self.allowed[k] = change.max(harmless);
            if change > harmless {
                let once = nearer_by(change, range);
                let moved = self.moved(k, once);
                queries.push(PatchQuery::new(k, moved, once));
            }
        }
        self.find(near, x, &mut queries);
        for query in &queries {
            let k = query.number as usize;
            self.left[k] = self.pairs[k].ask(query, |one| Some(visit(one, query.once)));
            self.allowed[k] = self.allowed[k].max(change_for(self.left[k], range));
        }
        self.queries = queries;
    }

    /// Whether what was chosen last holds at `x` (m), which was chosen for paths from the `x` of the choice on.
    pub(in crate::potential) fn holds(&mut self, x: &[Vec3]) -> bool {
        self.measure(x, true);
        let mut pairs = self.allowed.iter().enumerate();
        pairs.all(|(k, allowed)| self.change(k, *allowed) <= *allowed) && !self.goes_too_far(0.0)
    }
}

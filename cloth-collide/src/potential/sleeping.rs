//! Pairs that sleep until the motion may have brought them into contact.

use cloth_core::math::Real;

/// Pairs that were found where each lacked some distance (m) to contact.
#[derive(Debug)]
pub(super) struct Sleeping<P> {
    /// What each lacked (m), apart from the pairs, because that is all that is asked of most of them.
    lacks: Vec<Real>,
    pub(super) pairs: Vec<P>,
    /// The first so many are awake, and the least that another one lacks (m).
    pub(super) awake: usize,
    next: Real,
}

impl<P> Default for Sleeping<P> {
    fn default() -> Self {
        Self {
            lacks: Vec::new(),
            pairs: Vec::new(),
            awake: 0,
            next: Real::INFINITY,
        }
    }
}

impl<P> Sleeping<P> {
    pub(super) fn clear(&mut self) {
        self.lacks.clear();
        self.pairs.clear();
        (self.awake, self.next) = (0, Real::INFINITY);
    }

    /// Adds a pair that lacks so much (m) and sleeps.
    pub(super) fn push(&mut self, lack: Real, pair: P) {
        self.lacks.push(lack);
        self.pairs.push(pair);
        self.next = self.next.min(lack);
    }

    /// Any two pieces have come nearer by at most `nearer` (m) since they were found. Who is awake stays so.
    pub(super) fn wake(&mut self, nearer: Real) {
        if self.next > nearer {
            return;
        }
        self.next = Real::INFINITY;
        for k in self.awake..self.lacks.len() {
            if self.lacks[k] <= nearer {
                self.lacks.swap(k, self.awake);
                self.pairs.swap(k, self.awake);
                self.awake += 1;
            } else {
                self.next = self.next.min(self.lacks[k]);
            }
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &P> {
        self.pairs[..self.awake].iter()
    }
}

#[cfg(test)]
#[path = "../../tests/unit/potential_sleeping.rs"]
mod tests;

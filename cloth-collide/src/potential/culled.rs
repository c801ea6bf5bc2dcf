//! Pairs that are culled until the motion may have brought them into contact.

use cloth_core::math::Real;

/// Pairs with the excess gap (m) at which they were found.
#[derive(Clone, Debug)]
pub(super) struct CulledPairs<P> {
    /// Excess gap of each (m), apart from the pairs, because that is all that is asked of most of them.
    excess: Vec<Real>,
    pub(super) pairs: Vec<P>,
    /// How many are active, the first ones; and the least excess gap of another one (m).
    pub(super) active: usize,
    next: Real,
}

impl<P> Default for CulledPairs<P> {
    fn default() -> Self {
        Self {
            excess: Vec::new(),
            pairs: Vec::new(),
            active: 0,
            next: Real::INFINITY,
        }
    }
}

impl<P> CulledPairs<P> {
    pub(super) fn clear(&mut self) {
        self.excess.clear();
        self.pairs.clear();
        (self.active, self.next) = (0, Real::INFINITY);
    }

    /// Adds a culled pair.
    pub(super) fn push(&mut self, excess_gap: Real, pair: P) {
        self.excess.push(excess_gap);
        self.pairs.push(pair);
        self.next = self.next.min(excess_gap);
    }

    /// Any two primitives have come nearer by at most `nearer` (m) since they were found. What is active stays so.
    pub(super) fn activate(&mut self, nearer: Real) {
        if self.next > nearer {
            return;
        }
        self.next = Real::INFINITY;
        for k in self.active..self.excess.len() {
            if self.excess[k] <= nearer {
                self.excess.swap(k, self.active);
                self.pairs.swap(k, self.active);
                self.active += 1;
            } else {
                self.next = self.next.min(self.excess[k]);
            }
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &P> {
        self.pairs[..self.active].iter()
    }
}

#[cfg(test)]
#[path = "../../tests/unit/potential_culled.rs"]
mod tests;

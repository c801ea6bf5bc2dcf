//! Pairs in the order of what they lack to contact, so that those which lack more than the motion since then are left
//! alone.

use cloth_core::math::Real;

/// Pairs that were found where each lacked some distance (m) to contact.
#[derive(Debug)]
pub(super) struct Ranked<P> {
    all: Vec<(Real, P)>,
    /// How many of them the motion may have brought into contact.
    awake: usize,
}

impl<P> Default for Ranked<P> {
    fn default() -> Self {
        let (all, awake) = (Vec::new(), 0);
        Self { all, awake }
    }
}

impl<P> Ranked<P> {
    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.awake = 0;
    }

    /// Adds a pair that lacks so much (m); none of them is awake until [`Ranked::wake`].
    pub(super) fn push(&mut self, lack: Real, pair: P) {
        self.all.push((lack, pair));
    }

    /// All have been added. Those that lack the same stay in their order.
    pub(super) fn sort(&mut self) {
        self.all.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// Any two pieces have come nearer by at most `nearer` (m) since they were found.
    pub(super) fn wake(&mut self, nearer: Real) {
        self.awake = self.all.partition_point(|(lack, _)| *lack <= nearer);
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// How many can be in contact.
    pub(super) fn awake(&self) -> usize {
        self.awake
    }

    /// Those that can be in contact.
    pub(super) fn iter(&self) -> impl Iterator<Item = &P> {
        self.all[..self.awake].iter().map(|(_, pair)| pair)
    }
}

#[cfg(test)]
#[path = "../../tests/unit/potential_ranked.rs"]
mod tests;

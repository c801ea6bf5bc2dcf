//! Pairs in rising order.

/// Sorts pairs in time linear in their number, and keeps its memory. A general sort takes longer than finding the
/// pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct PairSorter {
    /// Where the pairs with each first number go.
    places: Vec<u32>,
    sorted: Vec<[u32; 2]>,
}

impl PairSorter {
    /// Sorts `pairs`, whose first numbers are below `count`: into buckets by the first number, then each bucket, of a
    /// few, by the second.
    pub(super) fn sort(&mut self, pairs: &mut [[u32; 2]], count: usize) {
        self.places.clear();
        self.places.resize(count + 1, 0);
        for pair in &*pairs {
            self.places[pair[0] as usize + 1] += 1;
        }
        for i in 1..self.places.len() {
            self.places[i] += self.places[i - 1];
        }
        self.sorted.clear();
        self.sorted.resize(pairs.len(), [0; 2]);
        for pair in &*pairs {
            let place = &mut self.places[pair[0] as usize];
            self.sorted[*place as usize] = *pair;
            *place += 1;
        }
        for same in self.sorted.chunk_by_mut(|a, b| a[0] == b[0]) {
            same.sort_unstable();
        }
        pairs.copy_from_slice(&self.sorted);
    }
}

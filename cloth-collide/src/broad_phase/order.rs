//! Sorting in time linear in the number of things.

/// Sorts things into buckets by counting, and keeps its memory. A general sort takes longer than finding the pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct BucketSorter<T> {
    /// Where the things of each bucket go.
    places: Vec<u32>,
    pub(super) sorted: Vec<T>,
}

impl<T: Copy + Default> BucketSorter<T> {
    /// Copies `all` to `sorted`, bucket after bucket of `count`, each in the order in which they came.
    pub(super) fn sort(&mut self, all: &[T], count: usize, bucket: impl Fn(&T) -> usize) {
        self.places.clear();
        self.places.resize(count + 1, 0);
        for one in all {
            self.places[bucket(one) + 1] += 1;
        }
        for i in 1..self.places.len() {
            self.places[i] += self.places[i - 1];
        }
        self.sorted.clear();
        self.sorted.resize(all.len(), T::default());
        for one in all {
            let place = &mut self.places[bucket(one)];
            self.sorted[*place as usize] = *one;
            *place += 1;
        }
    }
}

pub(super) type PairSorter = BucketSorter<[u32; 2]>;

impl PairSorter {
    /// Sorts `pairs`, whose first numbers are below `count`: into buckets by the first number, then each bucket, of a
    /// few, by the second.
    pub(super) fn sort_pairs(&mut self, pairs: &mut [[u32; 2]], count: usize) {
        self.sort(pairs, count, |pair| pair[0] as usize);
        for same in self.sorted.chunk_by_mut(|a, b| a[0] == b[0]) {
            same.sort_unstable();
        }
        pairs.copy_from_slice(&self.sorted);
    }
}

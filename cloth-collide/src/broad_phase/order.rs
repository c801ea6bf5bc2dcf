//! Pairs in rising order.

/// Sorts pairs whose first numbers are below `count`: into buckets by the first number, then each bucket, of a few, by the second. `buckets` and `scratch` are
/// overwritten, and keep their memory.
pub(super) fn sort_pairs(
    pairs: &mut Vec<[u32; 2]>,
    count: usize,
    buckets: &mut Vec<u32>,
    scratch: &mut Vec<[u32; 2]>,
) {
    buckets.clear();
    buckets.resize(count + 1, 0);
    for pair in &*pairs {
        buckets[pair[0] as usize + 1] += 1;
    }
    for i in 1..buckets.len() {
        buckets[i] += buckets[i - 1];
    }
    scratch.clear();
    scratch.resize(pairs.len(), [0; 2]);
    for pair in &*pairs {
        let next = &mut buckets[pair[0] as usize];
        scratch[*next as usize] = *pair;
        *next += 1;
    }
    for same in scratch.chunk_by_mut(|a, b| a[0] == b[0]) {
        same.sort_unstable();
    }
    // Not swapped: the lists share `scratch`, and would hand their memory around.
    pairs.copy_from_slice(scratch);
}

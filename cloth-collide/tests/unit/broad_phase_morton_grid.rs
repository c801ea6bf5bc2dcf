use super::*;

#[test]
fn bits_take_turns() {
    for cell in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [5, 3, 6], [0x1F_FFFF; 3]] {
        let bit = |k: usize, i: u32| u64::from(cell[k] >> i & 1) << (3 * i + k as u32);
        let expected = (0..21).flat_map(|i| (0..3).map(move |k| (k, i)));
        assert_eq!(morton(cell), expected.map(|(k, i)| bit(k, i)).sum::<u64>());
    }
}

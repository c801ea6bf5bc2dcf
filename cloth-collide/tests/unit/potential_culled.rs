use super::*;

#[test]
fn what_lacks_more_than_the_motion_sleeps() {
    let mut pairs = CulledPairs::default();
    for (excess_gap, pair) in [(0.3, 'c'), (-0.1, 'a'), (0.2, 'b'), (0.3, 'd'), (0.1, 'e')] {
        pairs.push(excess_gap, pair);
    }
    let steps = [
        (-0.2, ""),
        (0.0, "a"),
        (0.2, "abe"),
        (0.1, "abe"),
        (0.25, "abe"),
        (1.0, "abcde"),
    ];
    for (nearer, expected) in steps {
        pairs.activate(nearer);
        let mut active: Vec<char> = pairs.iter().copied().collect();
        active.sort_unstable();
        assert_eq!(active.iter().collect::<String>(), expected, "{nearer}");
    }
}

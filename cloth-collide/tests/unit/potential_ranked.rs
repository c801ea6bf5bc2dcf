use super::*;

#[test]
fn what_lacks_more_than_the_motion_sleeps() {
    let mut pairs = Ranked::default();
    for (lack, pair) in [(0.3, 'c'), (-0.1, 'a'), (0.2, 'b'), (0.3, 'd')] {
        pairs.push(lack, pair);
    }
    pairs.sort();
    for (nearer, expected) in [(0.0, "a"), (0.2, "ab"), (0.25, "ab"), (1.0, "abcd")] {
        pairs.wake(nearer);
        assert_eq!(pairs.iter().collect::<String>(), expected, "{nearer}");
    }
}

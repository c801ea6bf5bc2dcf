use super::*;

#[test]
fn what_lacks_more_than_the_motion_sleeps() {
    let mut pairs = Sleeping::default();
    for (lack, pair) in [(0.3, 'c'), (-0.1, 'a'), (0.2, 'b'), (0.3, 'd'), (0.1, 'e')] {
        pairs.push(lack, pair);
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
        pairs.wake(nearer);
        let mut awake: Vec<char> = pairs.iter().copied().collect();
        awake.sort_unstable();
        assert_eq!(awake.iter().collect::<String>(), expected, "{nearer}");
    }
}

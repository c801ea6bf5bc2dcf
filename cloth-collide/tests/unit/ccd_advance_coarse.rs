use super::*;
use crate::ccd::number::{Double, Number};
use cloth_core::random::SplitMix64;

/// Not even by the last bit.
#[test]
fn part_of_an_interval_is_never_rounded_up() {
    let mut random = SplitMix64::new(5);
    for _ in 0..100_000 {
        let mut draw = || 0.5 * random.symmetric() + 0.5;
        let (a, b, reach) = (draw(), draw(), draw());
        let (from, to) = (a.min(b), a.max(b));
        let exact = |x: Real| Double::new(x, 0.0);
        let certain = exact(from) + (exact(to) - exact(from)) * exact(reach);
        let found = part_of([from, to], reach);
        assert!((certain - exact(found)).value() >= 0.0 || found == from);
        assert!(found >= from && certain.value() - found <= 2e-15);
    }
    assert_eq!(part_of([0.25, 0.75], 1.0), 0.75);
}

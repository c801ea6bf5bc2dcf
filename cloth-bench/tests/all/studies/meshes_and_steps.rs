//! Ranges in words.

use cloth_bench::studies::meshes_and_steps::range;

#[test]
fn a_range_is_least_to_largest() {
    assert_eq!(range([2.0, 1.0, 3.0].into_iter()), "1 to 3");
    assert_eq!(range(std::iter::empty()), "nothing known");
}

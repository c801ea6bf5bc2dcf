//! How far the sheet falls.

mod order;

use cloth_bench::studies::independence::fall;

/// Independent converged codes agree on 0.487 m to 0.50 m.
#[test]
fn the_sheet_falls_as_far_as_it_should() {
    let fallen = fall("bdf2", 17, 240).unwrap();
    assert!((0.487..0.50).contains(&fallen.fall.0), "{fallen:?}");
}

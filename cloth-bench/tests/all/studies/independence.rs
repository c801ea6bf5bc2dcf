//! How far the sheet falls.

mod order;

use cloth_bench::studies::independence::fall;

/// Independent converged codes agree on 0.487 m to 0.50 m.
#[test]
fn the_sheet_falls_as_far_as_it_should() {
    let fallen = fall("bdf2", 17, 240).unwrap();
    assert!((0.487..0.50).contains(&fallen.fall.0), "{fallen:?}");
}

/// Substeps chosen for the mesh show the same cloth on each; 20 on each do not.
#[test]
fn the_default_of_xpbd_is_chosen_for_the_mesh() {
    let ratio = |name: &str| {
        let [coarse, fine] = [9, 33].map(|n| fall(name, n, 60).unwrap().fall.0);
        fine / coarse
    };
    let [chosen, published] = ["xpbd", "xpbd, 20 substeps"].map(ratio);
    assert!((chosen - 1.0).abs() < 0.02, "{chosen}");
    assert!((published - 1.0).abs() > 0.02, "{published}");
}

//! What the pictures of folds say.

use cloth_bench::studies::locking::fold::Axis;
use cloth_bench::studies::locking::picture::{STIFFNESS, flat_mesh, judged};
use cloth_bench::studies::locking::sheet::{Kind, Sheet, square};

#[test]
fn a_sheet_is_judged_by_both_corners_and_by_what_it_bends_besides() {
    let words = |angles, bending| judged(angles, 90.0, bending).0;
    assert_eq!(words([91.0, 89.0], 1.2), "folds: its corners hang 90° down");
    assert_eq!(words([60.0, 66.0], 0.8), "bends: its corners hang 63° down");
    assert_eq!(
        words([20.0, 30.0], 0.3),
        "locked: its corners hang 25° down"
    );
    // One flap lies on top of the sheet: 111° in the mean say nothing.
    assert_eq!(
        words([170.0, 52.0], 1.1),
        "crumples: corners at 52° and 170°"
    );
    assert_eq!(
        words([85.0, 89.0], 9.0),
        "crumples: its corners hang 87° down"
    );
}

/// The flat sheet shows what holds it: no diagonals in a sheet of quads, fewer lines where a part is free, small
/// triangles on midpoints.
#[test]
fn the_flat_sheet_shows_the_lengths_that_are_held() {
    let held = |kind| {
        let [modulus, rigidity] = STIFFNESS;
        let mesh = square("one-way", 4).unwrap();
        let sheet = Sheet::new(mesh, kind, modulus, rigidity).unwrap();
        let svg = flat_mesh(&sheet, Axis::Across, [0.0, 0.0]).unwrap();
        let paths: Vec<usize> = svg
            .split("<path")
            .map(|path| path.matches('M').count())
            .collect();
        paths[1..].to_vec()
    };
    // 40 sides of cells and 16 diagonals; one line for the fold.
    assert_eq!(held(Kind::Springs), [56, 56, 1]);
    assert_eq!(held(Kind::Quads), [56, 40, 1]);
    assert_eq!(held(Kind::Stvk), [56, 56, 1]);
    assert_eq!(held(Kind::Midpoints), [56, 96, 1]);
}

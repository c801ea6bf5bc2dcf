//! How far cloth can fall, which substeps are chosen by.

use crate::scene_text::scene;

/// A sheet of 1 m, 0.2 m above a floor: it can fall on it, and no farther, unless something may lift it.
#[test]
fn a_floor_ends_falls_of_cloth_that_nothing_lifts() {
    let sheet = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\ntranslate = [0, 0, 0.2]\n";
    let floor = "[[obstacle]]\nshape = \"plane\"\n";
    for (name, more, expected) in [
        ("nothing", String::new(), 1.0),
        ("floor", floor.into(), 0.2),
        // The border at y = 1 m is nearest to a slope.
        (
            "slope",
            format!("{floor}rotate = [0.1, 0, 0]\n"),
            1.0 + 0.2 * 0.1_f64.cos() - 0.1_f64.sin(),
        ),
        ("lift", format!("{floor}velocity = [0, 0, 0.1]\n"), 1.2),
        (
            "hand",
            format!("{floor}[[pins]]\nvertices = [0]\nmove = [0, 0, 0.1]\n"),
            1.2,
        ),
        (
            "event",
            format!("{floor}[[event]]\ndo = \"grab\"\ntime = 1\nvertices = [0]\n"),
            1.2,
        ),
    ] {
        let fall = scene(&format!("fall-{name}"), &format!("{sheet}{more}")).fall();
        assert!((fall - expected).abs() < 1e-12, "{name}: {fall} m");
    }
}

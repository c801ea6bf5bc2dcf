//! Stiffness as it is shown.

use cloth_bench::method::Method;
use cloth_bench::studies::stiffness::{hang, published};

/// How many times as stiff as it should be a rope hangs.
fn shown(name: &str, links: u32, rate: u32) -> f64 {
    hang(&published(Method::find(name).unwrap()), links, rate)
        .unwrap()
        .shown
        .unwrap()
        .0
}

/// Neither the step nor the number of links has to do with the stiffness of a step that is solved.
#[test]
fn a_step_that_is_solved_shows_the_stiffness_that_was_asked_for() {
    // Where a step ends at a tolerance, the chain does not come quite to rest.
    for (name, most) in [
        ("symplectic-euler", 1e-6),
        ("implicit-euler", 2e-3),
        ("linear-implicit", 1e-7),
        ("bdf2", 2e-3),
        ("xpbd-direct", 1e-7),
        ("pd", 1e-7),
    ] {
        for (links, rate) in [(20, 60), (5, 60), (40, 60), (20, 15), (20, 240)] {
            let off = (shown(name, links, rate) - 1.0).abs();
            println!("{name} {links} {rate} {off:e}");
            assert!(off < most, "{name}, {links} links, 1/{rate} s: {off:e}");
        }
    }
}

/// Twenty substeps of one sweep leave a rope the softer the more links it has.
#[test]
fn sweeps_that_are_cut_short_show_a_softer_rope_on_finer_meshes() {
    let of_links = [5, 20, 40].map(|links| shown("xpbd", links, 60));
    println!("{of_links:?}");
    assert!(of_links.is_sorted_by(|a, b| a > b), "{of_links:?}");
}

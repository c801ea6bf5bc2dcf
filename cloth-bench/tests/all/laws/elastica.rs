//! The exact solution of the heavy elastica.

use cloth_bench::laws::elastica::{Profile, exact};
use cloth_core::math::Real;

fn ratio(gamma: Real) -> Real {
    let Profile { span, drop } = exact(gamma);
    drop / span
}

#[test]
fn the_curve_passes_through_the_published_points() {
    for (gamma, published) in [(1.0, 0.124_562), (10.0, 1.066_802), (100.0, 5.888_105)] {
        let error = (ratio(gamma) - published).abs();
        assert!(error < 5.1e-7, "{gamma}: {}", ratio(gamma));
    }
}

#[test]
fn a_light_strip_sags_by_an_eighth_of_gamma_and_a_heavy_one_hangs_down() {
    assert!((ratio(1e-4) / 1e-4 - 0.125).abs() < 1e-8);
    let span = exact(1e6).span;
    assert!((span / (2.0 / 1e6_f64).sqrt() - 1.0).abs() < 2e-3, "{span}");
}

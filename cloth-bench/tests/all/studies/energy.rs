//! What runs keep of energy and momentum.

use cloth_bench::method::{self, Method};
use cloth_bench::settings::Settings;
use cloth_bench::studies::energy::{exact, follow, free, oscillator};
use cloth_core::math::Vec3;

#[test]
fn the_oscillator_keeps_what_the_closed_form_says() {
    let scene = oscillator().unwrap();
    for name in ["implicit-euler", "xpbd", "pd", "implicit-midpoint"] {
        let kept = follow(&scene, name, None, 60).unwrap();
        let method = Method::find(name).unwrap();
        let substeps = method.substeps(&scene, &Settings::default(), 1.0 / 60.0);
        let expected = exact(method, substeps.unwrap(), 60).unwrap();
        let error = (kept.left(0.0) / expected - 1.0).abs();
        assert!(error < 1e-6, "{name}: {error:e}");
    }
}

/// Central forces keep linear momentum in every method, and angular momentum in a symplectic one; implicit Euler
/// loses some of it.
#[test]
fn momenta_are_kept_by_those_that_should() {
    let scene = free(5).unwrap();
    let kept = |name: &str| follow(&scene, name, None, 60).unwrap();
    for name in ["symplectic-euler", "implicit-euler", "xpbd", "pd"] {
        // To the tolerance, so to rounding where that is asked for.
        let tolerance = (name == "implicit-euler").then_some(1e-12);
        let [drift, _] = follow(&scene, name, tolerance, 60).unwrap().drift();
        // XPBD divides positions of some metres by twelve thousand substeps of 0.8 ms, and rounds each time.
        let rounding = if name == "xpbd" { 1e-10 } else { 1e-11 };
        assert!(drift < rounding, "{name}: {drift:e}");
    }
    let turned = |name: &str| kept(name).drift()[1];
    assert!(turned("symplectic-euler") < 1e-11);
    let exactly = follow(&scene, "implicit-midpoint", Some(1e-12), 60).unwrap();
    assert!(exactly.drift()[1] < 1e-9);
    assert!(turned("implicit-euler") > 1e-3);
}

/// A known impulse: gravity gives a free sheet M g t, which is all that its momentum changes by, in every method.
#[test]
fn gravity_changes_momentum_by_its_impulse_and_nothing_else_does() {
    let mut scene = free(5).unwrap();
    scene.gravity = -9.81 * Vec3::z();
    for method in method::all().filter(|method| !method.is_never_stable()) {
        let [drift, _] = follow(&scene, method.name, None, 60).unwrap().drift();
        // It falls for 490 m, of which XPBD divides the rounding by substeps of 0.8 ms.
        let rounding = if method.name == "xpbd" { 2e-9 } else { 1e-10 };
        assert!(drift < rounding, "{}: {drift:e}", method.name);
    }
}

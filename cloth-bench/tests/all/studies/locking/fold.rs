//! The exact fold.

use cloth_bench::studies::locking::fold::{Axis, DENSITY, Fold, GRAVITY};
use cloth_core::math::Vec3;

/// Bent little, cos θ = 1: `θ′ = c u²` with `c = ρ g/(6 D)`, the rest integrated by hand.
#[test]
fn a_stiff_flap_sags_as_linear_theory_says() {
    let fold = Fold::exact(Axis::Across, 0.05, 100.0);
    let h = std::f64::consts::FRAC_1_SQRT_2 - 0.05;
    // θ = c (h³ − u³)/3, so the corner drops by c h⁴/4; both flaps store ∫ 2 D u θ′² du.
    let c = DENSITY * GRAVITY / 600.0;
    let curvature = fold.mean_curvature(100.0);
    assert!((curvature / (c * h * h / 3.0_f64.sqrt()) - 1.0).abs() < 1e-5);
    let [_, drop] = fold.curve[fold.curve.len() - 1];
    assert!((drop / (0.25 * c * h.powi(4)) - 1.0).abs() < 1e-5);
    let energy = 100.0 * 2.0 * c * c * h.powi(6) / 6.0;
    assert!((fold.bending_energy / energy - 1.0).abs() < 1e-5);
}

#[test]
fn the_map_keeps_lengths() {
    let fold = Fold::exact(Axis::Along, 0.05, 0.02);
    let [along, away] = Axis::Along.directions();
    for s in [-0.6, -0.2, 0.01, 0.3, 0.65] {
        let p = Vec3::new(0.5, 0.5, 0.0) + away * s + along * 0.02;
        let (a, b) = (fold.place(&p), fold.place(&(p + (away - along) * 1e-3)));
        assert!(
            ((a - b).norm() / (2.0_f64.sqrt() * 1e-3) - 1.0).abs() < 1e-4,
            "{s}"
        );
    }
}

//! The barrier that a law compares with.

use cloth_bench::laws::contact::LogBarrier;
use cloth_core::check::{gradient_error, hessian_error};
use cloth_core::element::Energy;
use cloth_core::math::Vec3;

#[test]
fn a_barrier_presses_as_its_closed_form_says_and_is_its_integral() {
    use std::f64::consts::{E, LN_2};
    let (stiffness, range) = (300.0, 0.02);
    let barrier = LogBarrier { stiffness, range };
    for i in 1..66 {
        let z = 0.0003 * f64::from(i);
        let x = [Vec3::z() * z];
        assert!(gradient_error(&barrier, &x, 0.1 * z) < 1e-7, "{z}");
        assert!(hessian_error(&barrier, &x, 0.1 * z) < 1e-6, "{z}");
    }
    for (part, pressed) in [(0.5, 0.5 + LN_2), (1.0 / E, E - 1.0 / E)] {
        let [slope, _] = barrier.derivatives(part * range);
        let expected = -stiffness * range * pressed;
        assert!((slope / expected - 1.0).abs() < 1e-14, "{part}");
    }
    assert_eq!(barrier.derivatives(range), [0.0; 2]);
    assert_eq!(barrier.value(&[Vec3::zeros()]), f64::INFINITY);
}

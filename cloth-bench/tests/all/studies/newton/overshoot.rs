//! One step of a spring, against closed forms.

use cloth_bench::studies::newton::overshoot::{METHODS, across, along};
use cloth_bench::studies::variants::Variant;
use cloth_core::math::Real;

#[test]
fn one_step_overshoots_by_what_the_closed_forms_say() {
    for z in [0.3, 1.5, 30.0] {
        for turn in [0.1, 2.0] {
            let tangent = Real::hypot(1.0, turn) - 1.0;
            let implicit = 1.0 / (1.0 + z * z);
            for variant in Variant::list(METHODS) {
                let expected = match variant.label.as_str() {
                    "symplectic-euler" => [1.0 - z * z, tangent],
                    "linear-implicit" => [implicit, tangent],
                    "xpbd, 20 substeps" => continue,
                    _ => [implicit, tangent * implicit],
                };
                let errors = [
                    along(&variant, z).unwrap() - expected[0],
                    across(&variant, z, turn).unwrap() - expected[1],
                ];
                let largest = errors.into_iter().map(Real::abs).fold(0.0, Real::max);
                assert!(
                    largest < 1e-12,
                    "{}, {z}, {turn}: {errors:?}",
                    variant.label
                );
            }
        }
    }
}

//! Bias of the order of constraints.

use cloth_bench::studies::Scope;
use cloth_bench::studies::independence::order::{cases, sheet, swing};

#[test]
fn sweeps_in_an_order_are_lopsided_until_they_converge_jacobi_never() {
    let scene = sheet(Scope::Quick).unwrap();
    for (variant, iterations) in cases(Scope::Quick) {
        let found = swing(&scene, &variant, iterations).unwrap().asymmetry.0;
        let expected = match (variant.label.as_str(), iterations) {
            ("pbd, colours" | "xpbd, colours", 1) => 0.12851,
            ("pbd, colours", 16) => 0.013353,
            ("pbd, sequential" | "xpbd, sequential", 1) => 0.070266,
            ("pbd, sequential", 16) => 0.012903,
            ("pbd, Jacobi" | "xpbd, Jacobi", _) | ("xpbd-direct", 4 | 16) => 0.0,
            _ => continue,
        };
        let error = (found - expected).abs();
        let most = 1e-4 * expected + 1e-12;
        assert!(error < most, "{}, {iterations}: {found:e}", variant.label);
    }
}

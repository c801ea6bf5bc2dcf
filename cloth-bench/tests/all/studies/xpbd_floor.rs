//! What converged sweeps of XPBD leave of a step.

use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::studies::xpbd_floor::floor;

/// Where every constraint says its multiplier, the balance of momentum that these leave is the gradient of G, found
/// here without them; the direct solver leaves none.
#[test]
fn all_that_converged_sweeps_leave_is_momentum() {
    for stiffness in [200.0, 1e4] {
        let settings = format!("n=10 link=0.1 mass=0.1 tip_mass=0.1 stiffness={stiffness}");
        let chain = scene::build("chain", None, &Settings::of(&settings)).unwrap();
        let found = floor(&chain, 1.0 / 60.0).unwrap();
        assert!(found.gradient > 1e-4, "{found:?}");
        assert!(
            (found.momentum / found.gradient - 1.0).abs() < 1e-6,
            "{found:?}"
        );
        assert!(found.direct_momentum < 1e-9, "{found:?}");
    }
}

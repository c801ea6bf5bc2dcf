//! What converged sweeps of XPBD leave of a step.

use cloth_bench::studies::xpbd_floor::{chain, floor, sweep};
use cloth_bench::yardstick::StepProblem;

/// Where every constraint says its multiplier, the balance of momentum that these leave is the gradient of G, found
/// here without them; the direct solver leaves none.
#[test]
fn all_that_converged_sweeps_leave_is_momentum() {
    for stiffness in [200.0, 1e4] {
        let found = floor(&chain(stiffness).unwrap(), 1.0 / 60.0).unwrap();
        assert!(found.gradient > 1e-4, "{found:?}");
        assert!(
            (found.momentum / found.gradient - 1.0).abs() < 1e-6,
            "{found:?}"
        );
        assert!(found.direct_momentum < 1e-9, "{found:?}");
    }
}

/// One sweep leaves the equation of the constraints; what they leave in the end is that of the momentum. In between,
/// C + α̃λ falls at least as fast as that of a straight chain of as many springs (the chapter of `XpbdConfig`), to
/// rounding.
#[test]
fn sweeps_solve_the_constraints_and_leave_the_momentum() {
    let dt = 1.0 / 60.0;
    let chain = chain(1e4).unwrap();
    let problem = StepProblem::after(&chain, 18, dt).unwrap();
    let after = |sweeps| sweep(&problem, &chain, dt, sweeps).unwrap();
    let [one, some, more, all] = [1, 10, 100, 1000].map(after);
    assert!(one.momentum < 3e-4 * one.gradient, "{one:?}");
    let rate = (more.residual / some.residual).powf(1.0 / 90.0);
    // ρ of the 10 springs, held by one end.
    let eta = 2.0 * 1e4 * dt * dt / 0.1;
    let straight = (std::f64::consts::PI / 20.0).cos().powi(2) / (1.0 + 1.0 / eta).powi(2);
    assert!((0.97 * straight..straight).contains(&rate), "{rate}");
    assert!(all.residual < 1e-15, "{all:?}");
    assert!((all.momentum / all.gradient - 1.0).abs() < 1e-6, "{all:?}");
}

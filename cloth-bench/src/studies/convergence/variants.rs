//! What the study of convergence compares.

use crate::studies::prelude::*;

/// Methods that iterate on one step, with the most iterations; of your own those with a parameter of that name.
pub fn iterated(scope: Scope) -> Vec<Variant> {
    let [sweeps, accelerated, direct] = scope.pick([500, 200, 30], [2000, 500, 60]);
    let mut variants = Variant::list(&format!(
        "implicit-euler: tolerance=0 iterations={accelerated}
        implicit-euler, Newton: tolerance=0 linear=cholesky iterations=60
        pd: iterations={sweeps}
        xpbd: substeps=1 iterations={sweeps}
        xpbd-direct: tolerance=0 iterations={direct}
        pbd, from the material: substeps=1 iterations={sweeps}
        pbd, rigid: substeps=1 projection=1 iterations={sweeps}
        pd, plain: acceleration=none iterations={accelerated}
        pd, Chebyshev: acceleration=chebyshev iterations={accelerated}
        pd, Chebyshev, ρ given: acceleration=chebyshev spectral_radius=0.9995 iterations={accelerated}
        pd, no coarse grid: coarse=0 iterations={accelerated}
        xpbd, Chebyshev: substeps=1 chebyshev=auto iterations={accelerated}
        pbd, Chebyshev: substeps=1 chebyshev=auto projection=1 iterations={accelerated}
        pbd, coarse levels: substeps=1 projection=1 hierarchy=10 iterations={accelerated}"
    ));
    let iterations = |mut own: Variant| {
        own.settings = own.settings.with("iterations", sweeps);
        own
    };
    variants.extend(Variant::of_own().into_iter().map(iterations));
    variants
}

/// Methods that cut the step, and into how many parts.
pub fn cut(scope: Scope) -> Vec<(&'static str, u32)> {
    let parts = |method| (0..scope.pick(6, 9)).map(move |i| (method, 1 << i));
    parts("xpbd").chain(parts("pbd")).collect()
}

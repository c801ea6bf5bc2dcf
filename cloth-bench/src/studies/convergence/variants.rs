//! What the study of convergence compares.

use crate::settings::Settings;
use crate::studies::Scope;

/// Methods that iterate on one step: label, method, setting, and the most iterations.
pub(super) fn iterated(scope: Scope) -> [(&'static str, &'static str, Settings, u32); 13] {
    let [sweeps, accelerated] = scope.pick([500, 200], [2000, 500]);
    let one_substep = Settings::default().with("substeps", 1);
    let pd = |acceleration: &str| Settings::default().with("acceleration", acceleration);
    let chebyshev = one_substep.clone().with("chebyshev", "auto");
    [
        (
            "implicit-euler",
            "implicit-euler",
            Settings::default().with("tolerance", 0),
            accelerated,
        ),
        (
            "implicit-euler, Newton",
            "implicit-euler",
            Settings::default()
                .with("tolerance", 0)
                .with("linear", "cholesky"),
            60,
        ),
        ("pd", "pd", Settings::default(), sweeps),
        ("xpbd", "xpbd", one_substep.clone(), sweeps),
        ("pbd, from the material", "pbd", one_substep.clone(), sweeps),
        (
            "pbd, rigid",
            "pbd",
            one_substep.clone().with("projection", 1),
            sweeps,
        ),
        ("pd, plain", "pd", pd("none"), accelerated),
        ("pd, Chebyshev", "pd", pd("chebyshev"), accelerated),
        (
            "pd, Chebyshev, ρ given",
            "pd",
            pd("chebyshev").with("spectral_radius", 0.9995),
            accelerated,
        ),
        (
            "pd, no coarse grid",
            "pd",
            Settings::default().with("coarse", 0),
            accelerated,
        ),
        ("xpbd, Chebyshev", "xpbd", chebyshev.clone(), accelerated),
        (
            "pbd, Chebyshev",
            "pbd",
            chebyshev.with("projection", 1),
            accelerated,
        ),
        (
            "pbd, coarse levels",
            "pbd",
            one_substep.with("projection", 1).with("hierarchy", "10"),
            accelerated,
        ),
    ]
}

/// Methods that cut the step, and into how many parts.
pub(super) fn cut(scope: Scope) -> [(&'static str, Vec<u32>); 2] {
    let most = scope.pick(6, 9);
    [
        ("xpbd", (0..most).map(|i| 1 << i).collect()),
        ("pbd", (0..most).map(|i| 1 << i).collect()),
    ]
}

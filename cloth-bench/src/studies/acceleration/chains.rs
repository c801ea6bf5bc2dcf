//! Sweeps over a straight chain of rigid links, whose rates have closed forms.

use crate::laws::Law;
use crate::studies::prelude::*;

const SOLVERS: [&str; 4] = ["jacobi", "gauss-seidel", "sor", "chebyshev"];

const LINKS: [&[u32]; 2] = [&[5, 20, 80], &[5, 10, 20, 40, 80, 160]];

/// Sweeps that divide the slowest error by ten, given the factor by which one shrinks it.
fn per_decade(factor: Real) -> Real {
    -1.0 / factor.log10()
}

/// Draws the measurements and the closed forms through them.
pub(super) fn run(study: &mut StudyRun<'_>) {
    let law = Law::find("chain-rate").expect("a law of this program");
    let links = study.scope.of(LINKS).iter().copied();
    let found = study.grid(
        iproduct!(SOLVERS, links),
        |(solver, links)| format!("chain of {links} rigid links by {solver}"),
        |(solver, links)| {
            let settings = Settings::of(&format!("solver={solver} links={links}"));
            let evaluation = law.evaluate(&settings)?;
            Ok([evaluation.measured, evaluation.expected])
        },
    );
    let curves_of = |which: usize, ending: &str| {
        curves(&found, |((solver, links), rate)| {
            let point = (Real::from(*links), per_decade(rate[which]));
            (format!("{solver}{ending}"), point)
        })
    };
    let title = "Sweeps to a tenth of the slowest error of a chain of rigid links";
    let plot = Plot::new(title, Axis::log("links"), Axis::log("sweeps (dimensionless)"))
        .points(curves_of(0, ""))
        .exact_curves(curves_of(1, ", exact"))
        .note("Dashed: from the spectral radii cos a, cos² a, (1 − sin a)/(1 + sin a) and cos a/(1 + sin a), a = π/2N.");
    study.plot("acceleration-chains", &plot);
}

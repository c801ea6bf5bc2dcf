//! Sweeps over a straight chain of rigid links, whose rates have closed forms.

use crate::laws::Law;
use crate::studies::prelude::*;

const SOLVERS: [&str; 4] = ["jacobi", "gauss-seidel", "sor", "chebyshev"];

fn links(scope: Scope) -> &'static [u32] {
    scope.pick(&[5, 20, 80], &[5, 10, 20, 40, 80, 160])
}

/// The factor by which a sweep shrinks the slowest error.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Rate {
    measured: Real,
    expected: Real,
}

/// Sweeps that divide the slowest error by ten.
fn per_decade(factor: Real) -> Real {
    -1.0 / factor.log10()
}

/// Draws the measurements and the closed forms through them.
pub(super) fn run(scope: Scope, findings: &mut Findings, cases: &mut Cases<'_>) {
    let (mut measured, mut exact) = (Vec::new(), Vec::new());
    let case = "chains of rigid links";
    let rates: Result<Vec<Vec<Rate>>, BenchError> = cases.case(case, || {
        let law = Law::find("chain-rate")?;
        let rate = |solver: &str, &links: &u32| {
            let settings = Settings::default().with("solver", solver);
            let evaluation = law.evaluate(&settings.with("links", links))?;
            Ok::<_, BenchError>(Rate {
                measured: evaluation.measured,
                expected: evaluation.expected,
            })
        };
        let of_solver = |solver| links(scope).iter().map(|n| rate(solver, n)).collect();
        SOLVERS.into_iter().map(of_solver).collect()
    });
    let Some(rates) = findings.unless_failed(case, rates) else {
        return;
    };
    for (solver, rates) in SOLVERS.iter().zip(&rates) {
        let curve = |of: fn(&Rate) -> Real| {
            let rates = links(scope).iter().zip(rates);
            rates
                .map(|(&links, rate)| (Real::from(links), per_decade(of(rate))))
                .collect()
        };
        measured.push(Series::new(solver, curve(|rate| rate.measured)).styled(Style::Points));
        let label = format!("{solver}, exact");
        exact.push(Series::new(&label, curve(|rate| rate.expected)).styled(Style::ExactCurve));
    }
    measured.append(&mut exact);
    findings.plot(
        "acceleration-chains",
        &Plot {
            title: "Sweeps to a tenth of the slowest error of a chain of rigid links".into(),
            x: Axis::log("links"),
            y: Axis::log("sweeps (dimensionless)"),
            series: measured,
            note: "Dashed: from the spectral radii cos a, cos² a, (1 − sin a)/(1 + sin a) and cos a/(1 + sin a), a = π/2N.".into(),
        },
    );
}

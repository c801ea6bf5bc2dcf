//! Is it the same cloth on another mesh and with another step?

use super::{Cases, Findings, Scope, Study};
use crate::error::BenchError;
use crate::journal::Number;
use crate::method::{self, Method};
use crate::report::plot::{Axis, Plot, Series, Style};
use crate::report::table::{Cell, Table, significant};
use crate::run;
use crate::scene;
use crate::settings::Settings;
use cloth_core::math::Real;
use serde::{Deserialize, Serialize};

pub(super) const STUDY: Study = Study {
    name: "independence",
    question: "Does a method show the same cloth at every resolution and every frame rate?",
    about: "A sheet of 1 m × 1 m with the same density, modulus (1e4 N/m) and rigidity (1e-5 N·m) on every mesh, held at two corners, falls from the horizontal for 0.5 s. fall (m) is that of the centre of mass, strain the root mean square over the edges; \
        both beside the converged value: BDF2 on the finest mesh with the shortest step. Independent converged codes agree on a fall of 0.487 m to 0.50 m. Published settings, which is the point: a method whose published setting is a number of iterations shows another cloth on another mesh. \
        A stretchy method falls farther and strains more; one that is numerically heavy falls less. What may surprise: implicit Euler with long steps falls too far, as free fall does in it, by one step more, while its linearised step falls too little; short steps, not more iterations, cure both.",
    cases,
    run,
};

const SECONDS: Real = 0.5;
/// The frame rate at which resolutions are compared, and the mesh on which frame rates are.
const RATE: u32 = 60;

fn methods() -> Vec<&'static str> {
    method::with_own(&[
        "implicit-euler",
        "linear-implicit",
        "implicit-midpoint",
        "bdf2",
        "pbd",
        "xpbd",
        "pd",
    ])
}

/// Vertices a side.
fn sizes(scope: Scope) -> &'static [usize] {
    match scope {
        Scope::Quick => &[9, 17],
        Scope::Full => &[16, 24, 32, 48, 64],
    }
}

/// Steps per second.
fn rates(scope: Scope) -> &'static [u32] {
    match scope {
        Scope::Quick => &[30, 60, 120],
        Scope::Full => &[30, 60, 120, 240],
    }
}

/// Vertices a side and steps per second of the converged value.
fn finest(scope: Scope) -> (usize, u32) {
    match scope {
        Scope::Quick => (17, 240),
        Scope::Full => (64, 480),
    }
}

fn middle(scope: Scope) -> usize {
    sizes(scope)[sizes(scope).len() / 2]
}

/// Every resolution at one rate, then every other rate at one resolution.
fn grid(scope: Scope) -> Vec<(usize, u32)> {
    let by_size = sizes(scope).iter().map(|&n| (n, RATE));
    let others = rates(scope).iter().filter(|&&rate| rate != RATE);
    by_size
        .chain(others.map(|&rate| (middle(scope), rate)))
        .collect()
}

fn cases(scope: Scope) -> u64 {
    (1 + methods().len() * grid(scope).len()) as u64
}

/// Where a sheet is after half a second.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Fallen {
    fall: Number,
    strain: Number,
}

fn fall(name: &str, n: usize, rate: u32) -> Result<Fallen, BenchError> {
    let settings = Settings::default().with("n", n).with("modulus", 1e4);
    let scene = scene::build("hang", None, &settings)?;
    let dt = 1.0 / Real::from(rate);
    let steps = (SECONDS * Real::from(rate)).round() as u32;
    let method = Method::find(name)?;
    let (end, _) = run::from_start(
        &scene,
        method,
        &Settings::default(),
        dt,
        steps,
        |_, _, _| Ok(()),
    )?;
    Ok(Fallen {
        fall: Number(end.center_of_mass_drop),
        strain: Number(end.rms_strain),
    })
}

fn run(scope: Scope, cases: &mut Cases<'_>) -> Result<Findings, BenchError> {
    let mut findings = Findings::default();
    let (n, rate) = finest(scope);
    let converged = cases.case("converged", || fall("bdf2", n, rate));
    // Everything else is relative to it.
    let Some(converged) = findings.unless_failed("converged", converged) else {
        return Ok(findings);
    };
    let mut table = Table::new(&[
        "method",
        "vertices a side",
        "steps per second",
        "fall (m)",
        "fall over converged",
        "strain",
        "strain over converged",
    ]);
    let (mut by_size, mut by_rate, mut strains) = (Vec::new(), Vec::new(), Vec::new());
    let mut told = Vec::new();
    for name in methods() {
        let mut found = Vec::new();
        let grid = grid(scope);
        let case_of = |(n, rate): &(_, _)| format!("{name}, {n} vertices a side, 1/{rate} s");
        let every = cases.side_by_side(&grid, case_of, |&(n, rate)| fall(name, n, rate));
        for (point, fallen) in grid.into_iter().zip(every) {
            let (n, rate) = point;
            let Some(fallen) = findings.unless_failed(&case_of(&point), fallen) else {
                continue;
            };
            table.push([
                Cell::from(name),
                Cell::from(n),
                Cell::from(rate as usize),
                Cell::from(fallen.fall.0),
                Cell::from(fallen.fall.0 / converged.fall.0),
                Cell::from(fallen.strain.0),
                Cell::from(fallen.strain.0 / converged.strain.0),
            ]);
            found.push((n, rate, fallen));
        }
        let at_rate = || found.iter().filter(|(_, rate, _)| *rate == RATE);
        let at_size = || found.iter().filter(|(n, ..)| *n == middle(scope));
        let over = |of: Real| of / converged.fall.0;
        by_size.push(Series::new(
            name,
            at_rate()
                .map(|(n, _, f)| (*n as Real, over(f.fall.0)))
                .collect(),
        ));
        strains.push(Series::new(
            name,
            at_rate()
                .map(|(n, _, f)| (*n as Real, f.strain.0 / converged.strain.0))
                .collect(),
        ));
        let mut points: Vec<(Real, Real)> = at_size()
            .map(|(_, rate, f)| (1.0 / Real::from(*rate), over(f.fall.0)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        by_rate.push(Series::new(name, points));
        let [size, rate] = [
            spread(at_rate().map(|(.., f)| over(f.fall.0))),
            spread(at_size().map(|(.., f)| over(f.fall.0))),
        ];
        let strain = spread(at_rate().map(|(.., f)| f.strain.0 / converged.strain.0));
        told.push(format!(
            "{name} falls {} of the converged way over all resolutions and {} over all steps, at {} times the strain",
            range(size),
            range(rate),
            range(strain)
        ));
    }
    let one = |low: Real, high: Real| {
        Series::new("converged", vec![(low, 1.0), (high, 1.0)]).styled(Style::ExactCurve)
    };
    let ends = |values: &[Real]| {
        let least = values.iter().copied().fold(Real::INFINITY, Real::min);
        one(least, values.iter().copied().fold(0.0, Real::max))
    };
    let all_sizes: Vec<Real> = sizes(scope).iter().map(|&n| n as Real).collect();
    let all_steps: Vec<Real> = rates(scope).iter().map(|&r| 1.0 / Real::from(r)).collect();
    for series in [&mut by_size, &mut strains] {
        series.push(ends(&all_sizes));
    }
    by_rate.push(ends(&all_steps));
    let note = "1 is the converged value.";
    for (name, title, x, y, series) in [
        (
            "independence-size",
            "The fall in 0.5 s, steps of 1/60 s",
            Axis::log("vertices a side (dimensionless)"),
            Axis::linear("fall over converged (dimensionless)"),
            by_size,
        ),
        (
            "independence-step",
            "The fall in 0.5 s on one mesh",
            Axis::log("step (s)"),
            Axis::linear("fall over converged (dimensionless)"),
            by_rate,
        ),
        (
            "independence-strain",
            "The strain after 0.5 s, steps of 1/60 s",
            Axis::log("vertices a side (dimensionless)"),
            Axis::log("strain over converged (dimensionless)"),
            strains,
        ),
    ] {
        findings.plot(
            name,
            &Plot {
                title: title.into(),
                x,
                y,
                series,
                note: note.into(),
            },
        );
    }
    findings.table(
        "independence",
        "The same cloth on every mesh, with every step",
        table,
    );
    findings.section.verdict = Some(format!(
        "Converged, the sheet falls {} m in 0.5 s. {}.",
        significant(converged.fall.0, 4),
        told.join("; ")
    ));
    Ok(findings)
}

/// Least and largest.
fn spread(values: impl Iterator<Item = Real>) -> Option<[Real; 2]> {
    values.fold(None, |range, value| {
        let [least, most] = range.unwrap_or([value; 2]);
        Some([least.min(value), most.max(value)])
    })
}

fn range(values: Option<[Real; 2]>) -> String {
    values.map_or_else(
        || "nothing known".to_owned(),
        |[least, most]| format!("{} to {}", significant(least, 3), significant(most, 3)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent converged codes agree on 0.487 m to 0.50 m.
    #[test]
    fn the_sheet_falls_as_far_as_it_should() {
        let fallen = fall("bdf2", 17, 240).unwrap();
        assert!((0.487..0.50).contains(&fallen.fall.0), "{fallen:?}");
    }

    #[test]
    fn a_spread_is_least_and_largest() {
        assert_eq!(spread([2.0, 1.0, 3.0].into_iter()), Some([1.0, 3.0]));
        assert_eq!(spread(std::iter::empty()), None);
    }
}

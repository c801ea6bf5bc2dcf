//! The same drape on every mesh and with every step, and what its error costs.

use crate::studies::prelude::*;

/// Time of the comparison (s): the sheet has wrapped the upper half of the sphere, and its corners swing.
const SECONDS: Real = 0.4;
/// Steps per second at which resolutions are compared.
const RATE: u32 = 60;

fn methods() -> Vec<&'static str> {
    method::with_own(&[
        "implicit-euler",
        "linear-implicit",
        "bdf2",
        "pbd",
        "xpbd",
        "pd",
    ])
}

/// Vertices a side; rates are compared at the second.
fn sizes(scope: Scope) -> &'static [u32] {
    scope.pick(&[9, 13], &[17, 25, 33, 49])
}

/// Steps per second.
fn rates(scope: Scope) -> &'static [u32] {
    scope.pick(&[30, 60, 120], &[30, 60, 120, 240])
}

/// Vertices a side and steps per second of the converged value.
fn finest(scope: Scope) -> (u32, u32) {
    scope.pick((13, 240), (49, 480))
}

/// Every size at one rate, then every other rate at one size.
fn grid(scope: Scope) -> Vec<(u32, u32)> {
    let by_size = sizes(scope).iter().map(|&n| (n, RATE));
    let others = rates(scope).iter().filter(|&&rate| rate != RATE);
    by_size
        .chain(others.map(|&rate| (sizes(scope)[1], rate)))
        .collect()
}

/// A sheet on a sphere at the end.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Draped {
    /// Fall of the centre of mass (m).
    fall: Number,
    /// Largest strain of an edge.
    stretch: Number,
    /// Energy from nowhere over what was given.
    excess: Number,
    /// Pairs that cross.
    crossings: usize,
    ms: Number,
}

fn drape(name: &str, n: u32, rate: u32) -> Result<Draped, BenchError> {
    let scene = scene::build("drape-sphere", None, &Settings::default().with("n", n))?;
    let steps = (SECONDS * Real::from(rate)).round() as u32;
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let dt = 1.0 / Real::from(rate);
    let (end, _) = run::from_start(&scene, method, &settings, dt, steps, |_, _, _| Ok(()))?;
    Ok(Draped {
        fall: Number(end.center_of_mass_drop),
        stretch: Number(end.max_stretch),
        excess: Number(end.energy_excess / end.energy_given.max(Real::MIN_POSITIVE)),
        crossings: end.intersections.unwrap_or(0) + end.obstacle_intersections.unwrap_or(0),
        ms: Number(end.ms_per_step_median),
    })
}

pub(super) fn run(study: &mut StudyRun<'_>) {
    let scope = study.scope;
    let (finest_n, finest_rate) = finest(scope);
    let at = sizes(scope)[1];
    let mut converged = |n: u32| {
        let case = format!("a converged drape, {n} × {n}");
        let found = study.cases.case(&case, || drape("bdf2", n, finest_rate));
        Some(study.findings.unless_failed(&case, found)?.fall.0)
    };
    let Some(of_size) = converged(finest_n) else {
        return;
    };
    // Rates are compared on one mesh, with what converges there.
    let of_rate = match at == finest_n {
        true => Some(of_size),
        false => converged(at),
    };
    let Some(of_rate) = of_rate else {
        return;
    };
    let mut table = Table::new(&[
        "method",
        "vertices a side",
        "steps per second",
        "fall (m)",
        "fall over converged",
        "largest stretch",
        "excess over given energy",
        "crossing pairs",
        "ms per step",
    ]);
    let (mut by_size, mut by_rate, mut work) = (Vec::new(), Vec::new(), Vec::new());
    let mut told = Vec::new();
    for name in methods() {
        let mut found = Vec::new();
        for (n, rate) in grid(scope) {
            let case = format!("a drape by {name}, {n} vertices a side, 1/{rate} s");
            let Some(draped) = study.case(&case, || drape(name, n, rate)) else {
                continue;
            };
            table.push([
                Cell::from(name),
                Cell::from(n as usize),
                Cell::from(rate as usize),
                Cell::from(draped.fall.0),
                Cell::from(draped.fall.0 / of_size),
                Cell::from(draped.stretch.0),
                Cell::from(draped.excess.0),
                Cell::from(draped.crossings),
                Cell::from(draped.ms.0),
            ]);
            found.push((n, rate, draped));
        }
        let sized = found.iter().filter(|(_, rate, _)| *rate == RATE);
        let sized: Vec<_> = sized
            .map(|(n, _, d)| (Real::from(*n), d.fall.0 / of_size))
            .collect();
        let mut rated: Vec<_> = found.iter().filter(|(n, ..)| *n == at).collect();
        rated.sort_by_key(|(_, rate, _)| *rate);
        let error = |d: &Draped| (d.fall.0 / of_rate - 1.0).abs();
        let time = |rate: u32, d: &Draped| 1e-3 * d.ms.0 * Real::from(rate);
        work.push(Series::new(
            name,
            rated
                .iter()
                .map(|(_, r, d)| (time(*r, d), error(d)))
                .collect(),
        ));
        let rated: Vec<_> = rated
            .iter()
            .map(|(_, rate, d)| (1.0 / Real::from(*rate), d.fall.0 / of_rate))
            .collect();
        let range = |values: &[(Real, Real)]| {
            let of = |f: fn(Real, Real) -> Real| values.iter().map(|v| v.1).reduce(f);
            match (of(Real::min), of(Real::max)) {
                (Some(least), Some(most)) => {
                    format!("{} to {}", significant(least, 3), significant(most, 3))
                }
                _ => "nothing known".to_owned(),
            }
        };
        told.push(format!(
            "{name} {} over all meshes, {} over all steps",
            range(&sized),
            range(&rated)
        ));
        by_size.push(Series::new(name, sized));
        by_rate.push(Series::new(name, rated));
    }
    let one = |low: Real, high: Real| {
        Series::new("converged", vec![(low, 1.0), (high, 1.0)]).styled(Style::ExactCurve)
    };
    if let [first, .., last] = sizes(scope) {
        by_size.push(one(Real::from(*first), Real::from(*last)));
    }
    if let [first, .., last] = rates(scope) {
        by_rate.push(one(1.0 / Real::from(*last), 1.0 / Real::from(*first)));
    }
    for (name, title, x, y, series) in [
        (
            "contact-size",
            "The fall of a sheet on a sphere, steps of 1/60 s",
            Axis::log("vertices a side (dimensionless)"),
            Axis::linear("fall over converged (dimensionless)"),
            by_size,
        ),
        (
            "contact-rate",
            "The same on one mesh",
            Axis::log("step (s)"),
            Axis::linear("fall over converged (dimensionless)"),
            by_rate,
        ),
        (
            "contact-work",
            "What the error of the fall costs, steps of 1/30 s and finer",
            Axis::log("time per simulated second (s)"),
            Axis::log("|fall over converged − 1| (dimensionless)"),
            work,
        ),
    ] {
        study.findings.plot(
            name,
            &Plot {
                title: title.into(),
                x,
                y,
                series,
                note: "Converged is BDF2 with the shortest step.".into(),
            },
        );
    }
    study.findings.table(
        "contact-drape",
        &format!("A sheet of 1 m × 1 m on a sphere of 0.3 m after {SECONDS} s, every method at its default"),
        table,
    );
    study.findings.answer(
        "Is it the same drape on every mesh and at every frame rate?",
        format!(
            "Fall of the centre of mass within {SECONDS} s over the converged one: {}.",
            told.join("; ")
        ),
    );
}

//! Five seconds of the hanging sheet: what too few iterations a step do to its swinging.

use super::super::{Findings, Scope};
use super::{LONG, Pairs, SHORT, with};
use crate::error::BenchError;
use crate::method::Method;
use crate::report::table::{Cell, Table};
use crate::run;
use crate::scene;
use crate::settings::Settings;
use cloth_core::math::Real;
use cloth_core::measure::{Strain, kinetic_energy};
use rayon::prelude::*;

/// Steps, and how many of them at the end are averaged over: a swing and a half.
const STEPS: u32 = 300;
const AVERAGED: u32 = 100;

pub(super) const SETTINGS: [(&str, Pairs); 5] = [
    ("default", &[]),
    SHORT,
    LONG,
    ("24 iterations", &[("iterations", "24")]),
    (
        "36 iterations, 16 cells",
        &[("iterations", "36"), ("coarse", "16")],
    ),
];

pub(super) fn sizes(scope: Scope) -> &'static [u32] {
    match scope {
        Scope::Quick => &[17],
        // Implicit Euler alone would take a minute at 128.
        Scope::Full => &[32, 64],
    }
}

/// Means over the last steps, and the end.
struct Swing {
    kinetic: Real,
    stretch: Real,
    end: run::Summary,
}

pub(super) fn swings(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut table = Table::new(&[
        "n",
        "setting",
        "largest stretch, mean",
        "relative to implicit Euler",
        "largest stretch at the end, relative",
        "kinetic energy, mean (J)",
        "kinetic energy, relative",
        "elastic energy at the end (J)",
    ]);
    for &n in sizes(scope) {
        let simulate = |method: &str, settings: &Settings| -> Result<Swing, BenchError> {
            let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
            let mut solver = Method::find(method)?.build(&scene, settings, scene.dt)?;
            let (mut state, gauges) = (scene.start.clone(), scene.gauges()?);
            let (mut kinetic, mut stretch) = (0.0, 0.0);
            let end = run::run(&scene, &mut *solver, &mut state, scene.dt, STEPS, {
                |step, state, _| {
                    if step > STEPS - AVERAGED {
                        let share = 1.0 / Real::from(AVERAGED);
                        stretch += share * Strain::of(&gauges, &state.positions).max;
                        kinetic +=
                            share * kinetic_energy(&scene.model.particles, &state.velocities);
                    }
                    Ok(())
                }
            })?;
            Ok(Swing {
                kinetic,
                stretch,
                end,
            })
        };
        progress(&format!("projective: five seconds, {n} × {n}"));
        // Side by side, for nothing is timed.
        let exact = || simulate("implicit-euler", &Settings::default());
        let ours = || {
            let every = SETTINGS.par_iter();
            let every = every.map(|(_, pairs)| simulate("pd", &with(pairs)));
            every.collect::<Vec<_>>()
        };
        let (exact, ours) = rayon::join(exact, ours);
        let exact = exact?;
        let mut push = |label: &str, swing: &Swing| {
            table.push([
                Cell::from(n as usize),
                Cell::from(label),
                Cell::from(swing.stretch),
                Cell::from(swing.stretch / exact.stretch - 1.0),
                Cell::from(swing.end.max_stretch / exact.end.max_stretch - 1.0),
                Cell::from(swing.kinetic),
                Cell::from(swing.kinetic / exact.kinetic - 1.0),
                Cell::from(swing.end.elastic_energy),
            ]);
        };
        push("implicit Euler, converged", &exact);
        for ((label, _), outcome) in SETTINGS.into_iter().zip(ours) {
            if let Some(swing) = findings.unless_failed(label, outcome) {
                push(label, &swing);
            }
        }
    }
    findings.table(
        "projective-swing",
        "The hanging sheet after five seconds (300 steps); means over the last 100",
        table,
    );
    Ok(())
}

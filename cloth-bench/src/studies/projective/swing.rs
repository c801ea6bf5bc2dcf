//! Five seconds of the hanging sheet: what too few iterations a step do to its swinging, of projective dynamics and of
//! implicit Euler.

use super::{LONG, SHORT};
use crate::studies::prelude::*;
use cloth_core::measure::{Strain, kinetic_energy};

/// Steps, and how many of them at the end are averaged over: a swing and a half.
const STEPS: u32 = 300;
const AVERAGED: u32 = 100;

/// Label, method and settings. A step of few iterations starts with the velocity as it was: what an extrapolated one
/// gets wrong, they leave.
pub const SETTINGS: [(&str, &str, &str); 10] = [
    ("default", PD, ""),
    (SHORT.0, PD, SHORT.1),
    (LONG.0, PD, LONG.1),
    ("24 iterations", PD, "iterations=24"),
    ("36 iterations, 16 cells", PD, "iterations=36 coarse=16"),
    (
        "implicit Euler, 10 iterations",
        EULER,
        "iterations=10 start=inertial",
    ),
    (
        "implicit Euler, 20 iterations",
        EULER,
        "iterations=20 start=inertial",
    ),
    (
        "implicit Euler, to 1e-1",
        EULER,
        "tolerance=1e-1 start=inertial",
    ),
    ("implicit Euler, to 1e-2", EULER, "tolerance=1e-2"),
    (
        "implicit Euler, 3 Newton iterations of 5 conjugate gradients",
        EULER,
        "linear=newton-multigrid iterations=3 linear_iterations=5 start=inertial",
    ),
];
/// What all are compared with: at its default tolerance the kinetic energy after five seconds is a hundredth too large.
pub const CONVERGED: &str = "tolerance=1e-5";
/// The name of projective dynamics.
pub const PD: &str = "pd";
/// The name of implicit Euler.
pub const EULER: &str = "implicit-euler";

/// Vertices a side. Implicit Euler alone would take a minute at 128.
const SIZES: [&[u32]; 2] = [&[13], &[32, 64]];

/// Means over the last steps, and the end.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Swing {
    kinetic: Real,
    stretch: Real,
    end: run::Summary,
}

impl Swing {
    /// Five seconds of a sheet of `n` vertices a side.
    pub fn of(n: u32, method: &str, settings: &Settings) -> Result<Self, BenchError> {
        let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
        let mut solver = Method::find(method)?.build(&scene, settings, scene.dt)?;
        let (mut state, gauges) = (scene.start.clone(), scene.gauges()?);
        let (mut kinetic, mut stretch) = (0.0, 0.0);
        let end = run::run(&scene, &mut *solver, &mut state, scene.dt, STEPS, {
            |step, state, _| {
                if step > STEPS - AVERAGED {
                    let share = 1.0 / Real::from(AVERAGED);
                    stretch += share * Strain::of(&gauges, &state.positions).max;
                    kinetic += share * kinetic_energy(&scene.model.particles, &state.velocities);
                }
                Ok(())
            }
        })?;
        Ok(Self {
            kinetic,
            stretch,
            end,
        })
    }

    /// How it compares with `reference`.
    pub fn relative_to(&self, reference: &Self) -> Errors {
        Errors {
            kinetic: self.kinetic / reference.kinetic - 1.0,
            stretch: self.stretch / reference.stretch - 1.0,
            ms: self.end.ms_per_step_median,
        }
    }
}

/// Mean kinetic energy and largest stretch relative to those of converged implicit Euler, and the time of a step (ms).
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Of the kinetic energy (dimensionless).
    pub kinetic: Real,
    /// Of the stretch (dimensionless).
    pub stretch: Real,
    /// Time of a step (ms).
    pub ms: Real,
}

impl Errors {
    /// Whether the motion is the right one, as far as seconds of it are to be shown.
    pub fn are_small(&self) -> bool {
        self.kinetic.abs() <= KINETIC && self.stretch.abs() <= STRETCH
    }
}

/// Errors of the kinetic energy and of the stretch up to which a swing counts as the right one.
const KINETIC: Real = 0.15;
const STRETCH: Real = 0.05;

/// What is told of a swing; relative is to converged implicit Euler.
const COLUMNS: [&str; 9] = [
    "n",
    "setting",
    "largest stretch, mean",
    "relative to implicit Euler",
    "largest stretch at the end, relative",
    "kinetic energy, mean (J)",
    "kinetic energy, relative",
    "elastic energy at the end (J)",
    "ms per step",
];

pub(super) fn swings(study: &mut StudyRun<'_>) {
    let converged = ("implicit Euler, converged", EULER, CONVERGED);
    let settings = [converged].into_iter().chain(SETTINGS);
    let found = study.grid(
        iproduct!(study.scope.of(SIZES).iter().copied(), settings),
        |(n, (label, ..))| format!("{label} for five seconds, {n} × {n}"),
        |&(n, (_, method, settings))| Swing::of(n, method, &Settings::of(settings)),
    );
    let columns = [
        "vertices",
        "the faster",
        "implicit Euler, cut short",
        "projective dynamics",
    ];
    let (mut rows, mut judged) = (Vec::new(), Table::new(&columns));
    for of_size in found.chunk_by(|((n, _), _), ((other, _), _)| n == other) {
        let ((n, first), right) = &of_size[0];
        if *first != converged {
            continue; // it failed, which is a remark already
        }
        rows.extend(of_size.iter().map(|((n, (label, ..)), swing)| {
            let errors = swing.relative_to(right);
            let at_end = swing.end.max_stretch / right.end.max_stretch - 1.0;
            let stretch = [swing.stretch, errors.stretch, at_end];
            let energies = [swing.kinetic, errors.kinetic, swing.end.elastic_energy];
            (*n, *label, stretch, energies, errors.ms)
        }));
        let errors = of_size[1..]
            .iter()
            .map(|((_, (label, method, _)), swing)| (*label, *method, swing.relative_to(right)));
        let sheet = Cell::said(format!("{n} × {n}"));
        judged.line(sheet, verdict(&errors.collect_vec()).map(Cell::said));
    }
    study.table(
        "projective-swing",
        "The hanging sheet after five seconds (300 steps); means over the last 100",
        Table::named(&COLUMNS, &rows),
    );
    study.answer(
        "Which swings right in less time, the implicit Euler step cut short or projective dynamics?",
        format!(
            "The fastest of either whose mean kinetic energy is within {} and whose mean stretch is within {} of converged implicit Euler's after five seconds:",
            percent(KINETIC),
            percent(STRETCH)
        ),
        Some(judged),
        "table-projective-swing",
    );
}

/// Which of the two gets a swing right first, and what that takes either.
pub fn verdict(rows: &[(&str, &str, Errors)]) -> [String; 3] {
    let cheapest = |wanted: &str| {
        let good = rows
            .iter()
            .filter(|row| row.1 == wanted && row.2.are_small());
        good.min_by(|a, b| a.2.ms.total_cmp(&b.2.ms))
    };
    let show = |row: Option<&(&str, &str, Errors)>| {
        row.map_or("none".into(), |(label, _, errors)| {
            format!("{label}: {} ms", two(errors.ms))
        })
    };
    let [pd, euler] = [PD, EULER].map(cheapest);
    let is_near = |a: Real, b: Real| a.max(b) < NOISE * a.min(b);
    let better = match (pd, euler) {
        (Some(pd), Some(euler)) if is_near(pd.2.ms, euler.2.ms) => "neither, within the noise",
        (Some(pd), Some(euler)) if euler.2.ms > pd.2.ms => "projective dynamics",
        (Some(_), None) => "projective dynamics",
        (_, Some(_)) => "implicit Euler",
        (None, None) => "neither",
    };
    [better.into(), show(euler), show(pd)]
}

//! A garment that lands on a floor: what is left of the impact as strain, and how much of that is the way between two looks for contact.

use super::super::{Findings, Scope};
use crate::error::BenchError;
use crate::method::Method;
use crate::report::table::{Cell, Table};
use crate::run;
use crate::scene::{self, Scene};
use crate::settings::Settings;
use cloth_core::math::Real;

/// How far it falls (m).
const DEPTH: &str = "0.2";
const STEPS: u32 = 40;

/// Methods with what is set for them, and the parts of a step.
const CASES: [(&str, &str, u32); 5] = [
    ("xpbd", "20", 10),
    ("xpbd", "40", 40),
    ("xpbd", "100", 100),
    ("xpbd", "160", 10),
    ("pd", "", 10),
];

fn chosen(scope: Scope) -> &'static [(&'static str, &'static str, u32)] {
    match scope {
        Scope::Quick => &CASES[..2],
        Scope::Full => &CASES,
    }
}

/// Number of progress reports.
pub(super) fn cases(scope: Scope) -> usize {
    chosen(scope).len()
}

fn settings() -> Settings {
    Settings::default().with("floor", DEPTH).with("self", "yes")
}

fn falling(mesh: &str, parts: u32) -> Result<Scene, BenchError> {
    scene::build("drop", Some(mesh), &settings().with("contact_steps", parts))
}

/// The tube `mesh` above a floor, able to touch itself.
pub(super) fn garment(mesh: &str) -> Result<Scene, BenchError> {
    scene::build("drop", Some(mesh), &settings())
}

/// Adds the table, and says what it shows.
pub(super) fn run(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<String, BenchError> {
    let mesh = match scope {
        Scope::Quick => "tube:12x6",
        Scope::Full => "tube:48x24",
    };
    let mut table = Table::new(&[
        "method",
        "substeps",
        "parts of a step",
        "way of a part at impact (mm)",
        "rms strain",
        "largest stretch",
        "elastic energy (J)",
        "energy of the fall (J)",
    ]);
    let mut strains = Vec::new();
    for &(name, substeps, parts) in chosen(scope) {
        progress(&format!("collision: landing, {name}, {parts} parts"));
        let scene = falling(mesh, parts)?;
        let settings = match substeps {
            "" => Settings::default(),
            count => Settings::default().with("substeps", count),
        };
        let mut stepper = Method::find(name)?.build(&scene, &settings, scene.dt)?;
        let mut state = scene.start.clone();
        let summary = run::run(
            &scene,
            &mut *stepper,
            &mut state,
            scene.dt,
            STEPS,
            |_, _, _| Ok(()),
        )?;
        let depth: Real = DEPTH.parse().map_err(BenchError::failed)?;
        let speed = (2.0 * scene.gravity.norm() * depth).sqrt();
        let mass: Real = scene.model.particles.mass().iter().sum();
        strains.push(summary.rms_strain);
        table.push([
            Cell::from(name),
            Cell::from(substeps),
            Cell::from(parts as usize),
            Cell::from(1e3 * speed * scene.dt / Real::from(parts)),
            Cell::from(summary.rms_strain),
            Cell::from(summary.max_stretch),
            Cell::from(summary.elastic_energy),
            Cell::from(mass * scene.gravity.norm() * depth),
        ]);
    }
    findings.table(
        "collision-landing",
        "What is left of the landing of a tube, by the number of looks for contact in a step",
        table,
    );
    let percent = |k: usize| 100.0 * strains[k];
    Ok(format!(
        "After the landing of a tube XPBD keeps a strain of {:.2} % with {} looks for contact in a step, {:.2} % with {}.",
        percent(0),
        CASES[0].2,
        percent(1),
        CASES[1].2
    ))
}

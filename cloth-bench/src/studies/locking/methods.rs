//! The fold as each method makes it, with as many iterations as it is given.

use super::fold::{self, Axis};
use super::sheet::Kind;
use super::sweeps::RIGIDITY;
use crate::error::BenchError;
use crate::method::{self, Method};
use crate::report::table::{Cell, Table};
use crate::run;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::studies::{Findings, Scope};
use cloth_core::cloth::ClothModel;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::Strain;
use cloth_core::particles::State;
use cloth_core::topology::EdgeTable;

const CELLS: usize = 16;
const PATTERN: &str = "alternating";
const MODULUS: Real = 1e6;
const DT: Real = 1.0 / 60.0;
const MOST_STEPS: u32 = 400;

/// Methods and their iterations; 0: as published.
fn methods(scope: Scope) -> Vec<(&'static str, u32)> {
    let ours: &[(&str, u32)] = match scope {
        Scope::Quick => &[("implicit-euler", 0), ("pbd", 20), ("pbd", 80), ("pd", 0)],
        Scope::Full => &[
            ("implicit-euler", 0),
            ("linear-implicit", 0),
            ("pbd", 5),
            ("pbd", 20),
            ("pbd", 80),
            ("pbd", 320),
            ("pbd", 1280),
            ("xpbd", 0),
            ("pd", 0),
            ("pd", 50),
        ],
    };
    let own = method::with_own(&[]).into_iter().map(|name| (name, 0));
    ours.iter().copied().chain(own).collect()
}

pub(super) fn cases(scope: Scope) -> u64 {
    (methods(scope).len()) as u64
}

pub(super) fn run(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut table = Table::new(&[
        "method",
        "iterations",
        "steps to rest",
        "fold angle over exact",
        "bending reached",
        "rms strain",
        "largest strain",
    ]);
    let stiffness = [MODULUS, RIGIDITY];
    let (sheet, exact, _) = fold::prepared(Axis::Across, PATTERN, CELLS, Kind::Springs, stiffness)?;
    let scene = Scene {
        name: "fold",
        model: ClothModel {
            particles: sheet.particles.clone(),
            springs: Vec::new(),
            hinges: Vec::new(),
            others: sheet.families(),
        },
        start: State::at_rest(sheet.placed(|p| exact.place(p))),
        mesh: Some(sheet.mesh.clone()),
        gravity: Vec3::z() * -fold::GRAVITY,
        dt: DT,
        steps: MOST_STEPS,
        pins: None,
        touch: None,
        air: None,
        order: None,
    };
    let edges = EdgeTable::build(&sheet.mesh).map_err(BenchError::failed)?;
    let gauges = Spring::along(sheet.mesh.positions(), edges.ends(), 0.0);
    for (name, iterations) in methods(scope) {
        progress(&format!("locking: fold by {name}, {iterations} iterations"));
        let settings = match iterations {
            0 => Settings::default(),
            n => Settings::default().with("iterations", n),
        };
        let mut stepper = Method::find(name)?.build(&scene, &settings, DT)?;
        let mut state = scene.start.clone();
        let rest = run::to_rest(&scene, stepper.as_mut(), &mut state, DT, MOST_STEPS, 1e-4);
        let Some(steps) = findings.unless_failed(&format!("fold by {name}"), rest) else {
            continue;
        };
        let strain = Strain::of(&gauges, &state.positions);
        let bending = sheet.bending_energy(&state.positions)? / exact.bending_energy;
        table.push([
            Cell::from(name),
            if iterations == 0 {
                Cell::from("as published")
            } else {
                Cell::from(iterations as usize)
            },
            steps.map_or(Cell::Missing, |steps| Cell::from(steps as usize)),
            Cell::from(exact.angle(&sheet, &state.positions)? / exact.exact_angle()),
            Cell::from(bending),
            Cell::from(strain.rms),
            Cell::from(strain.max),
        ]);
    }
    findings.table("locking-methods", "One fold by every method", table);
    Ok(())
}

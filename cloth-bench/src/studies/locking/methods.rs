//! The fold as each method makes it, with as many iterations as it is given.

use super::fold::{self, Axis};
use super::sheet::Kind;
use super::sweeps::RIGIDITY;
use crate::studies::prelude::*;
use cloth_core::cloth::ClothModel;
use cloth_core::energy::Spring;
use cloth_core::measure::Strain;
use cloth_core::topology::EdgeTable;

const PATTERN: &str = "alternating";
const MODULUS: Real = 1e6;
const DT: Real = 1.0 / 60.0;
const MOST_STEPS: u32 = 400;
/// When nothing is faster than this (m/s), it is at rest.
const STILL: Real = 1e-4;

/// Methods, their iterations (0: as published), and cells a side.
fn list(scope: Scope) -> Vec<(&'static str, u32, usize)> {
    let ours: &[(&str, u32)] = scope.pick(
        &[("implicit-euler", 0), ("pbd", 20), ("pbd", 80), ("pd", 0)],
        &[
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
    );
    let own = method::with_own(&[]).into_iter().map(|name| (name, 0));
    let all = ours.iter().copied().chain(own);
    let mut list: Vec<_> = all.map(|(name, n)| (name, n, 16)).collect();
    if scope == Scope::Full {
        for cells in [32, 64, 128] {
            list.extend(
                [("implicit-euler", 0), ("pbd", 20), ("pd", 0)].map(|(name, n)| (name, n, cells)),
            );
        }
        for cells in [32, 64] {
            list.extend([("pbd", 320), ("xpbd", 0)].map(|(name, n)| (name, n, cells)));
        }
    }
    list
}

/// A solver and a mesh.
#[derive(Clone, Debug, Default, Serialize)]
struct Solver {
    method: &'static str,
    /// Or `as published`.
    iterations: Cell,
    cells: usize,
}

/// What a method made of the fold.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Made {
    /// None: never at rest.
    steps_to_rest: Option<u32>,
    fold_angle_over_exact: Real,
    /// Bending energy over the exact one.
    bending_reached: Real,
    rms_strain: Real,
    largest_strain: Real,
}

fn make(name: &str, iterations: u32, cells: usize) -> Result<Made, BenchError> {
    let stiffness = [MODULUS, RIGIDITY];
    let (sheet, exact, _) = fold::prepared(Axis::Across, PATTERN, cells, Kind::Springs, stiffness)?;
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
        gases: Vec::new(),
        volumes: Vec::new(),
        changes: Vec::new(),
        order: None,
    };
    let settings = match iterations {
        0 => Settings::default(),
        n => Settings::default().with("iterations", n),
    };
    let mut stepper = Method::find(name)?.build(&scene, &settings, DT)?;
    let mut state = scene.start.clone();
    let steps = run::to_rest(&scene, stepper.as_mut(), &mut state, DT, MOST_STEPS, STILL)?;
    let edges = EdgeTable::build(&sheet.mesh)?;
    let gauges = Spring::along(sheet.mesh.positions(), edges.ends(), 0.0);
    let strain = Strain::of(&gauges, &state.positions);
    Ok(Made {
        steps_to_rest: steps,
        fold_angle_over_exact: exact.angle(&sheet, &state.positions)? / exact.exact_angle(),
        bending_reached: sheet.bending_energy(&state.positions)? / exact.bending_energy,
        rms_strain: strain.rms,
        largest_strain: strain.max,
    })
}

/// The angle of the fold over the exact one (dimensionless), by a method at its published setting.
///
/// # Errors
/// [`BenchError::Failed`] with the method's own error, or if the sheet does not come to rest.
pub(in crate::studies) fn fold_angle(name: &str, cells: usize) -> Result<Real, BenchError> {
    let made = make(name, 0, cells)?;
    match made.steps_to_rest {
        Some(_) => Ok(made.fold_angle_over_exact),
        None => Err(BenchError::Failed(format!(
            "the fold is not at rest after {MOST_STEPS} steps"
        ))),
    }
}

pub(super) fn run(study: &mut StudyRun<'_>) {
    let found = study.grid_side_by_side(
        list(study.scope),
        |(name, iterations, cells)| {
            format!("fold by {name}, {iterations} iterations, {cells} cells")
        },
        |&(name, iterations, cells)| make(name, iterations, cells),
    );
    let row = |((method, iterations, cells), made): ((_, u32, _), Made)| {
        let iterations = match iterations {
            0 => Cell::from("as published"),
            n => Cell::from(i64::from(n)),
        };
        (
            Solver {
                method,
                iterations,
                cells,
            },
            made,
        )
    };
    let rows: Vec<(Solver, Made)> = found.into_iter().map(row).collect();
    let table = Table::of(&rows);
    study
        .findings
        .table("locking-methods", "One fold by every method", table);
}

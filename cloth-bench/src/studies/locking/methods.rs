//! The fold as each method makes it, on every pattern, and with as many iterations as it is given.

use super::count::PATTERNS;
use super::fold::{self, Axis};
use super::sheet::Kind;
use super::sweeps::RIGIDITY;
use crate::studies::prelude::*;
use cloth_core::cloth::ClothModel;
use cloth_core::energy::Spring;
use cloth_core::topology::EdgeTable;

const MODULUS: Real = 1e6;
const DT: Real = 1.0 / 60.0;
const MOST_STEPS: u32 = 400;
/// When nothing is faster than this (m/s), it is at rest.
const STILL: Real = 1e-4;

/// A method and a mesh.
#[derive(Clone, Debug)]
pub struct Case {
    /// The method.
    pub variant: Variant,
    /// The pattern of the mesh.
    pub pattern: &'static str,
    cells: usize,
}

/// Cases of methods, one a line, on a pattern.
fn on(pattern: &'static str, cells: usize, lines: &str) -> impl Iterator<Item = Case> {
    let case = move |variant| Case {
        variant,
        pattern,
        cells,
    };
    Variant::list(lines).into_iter().map(case)
}

/// How many iterations decide, and how many cells.
fn by_iterations(scope: Scope) -> Vec<Case> {
    let swept = "pbd, 20 iterations: iterations=20
        pbd, 80 iterations: iterations=80";
    let all = |cells, lines| on("alternating", cells, lines);
    if scope == Scope::Quick {
        return all(16, swept).collect();
    }
    let more = "pbd, 5 iterations: iterations=5
        pbd, 320 iterations: iterations=320
        pbd, 1280 iterations: iterations=1280
        pd, 50 iterations: iterations=50";
    let mut cases: Vec<Case> = all(16, swept).chain(all(16, more)).collect();
    for cells in [32, 64, 128] {
        cases.extend(all(cells, "implicit-euler\npbd\npd"));
    }
    for cells in [32, 64] {
        cases.extend(all(cells, "pbd, 320 iterations: iterations=320\nxpbd"));
    }
    cases
}

/// Every method on every pattern. Those that damp little or nothing of their own get air drag, which changes where
/// nothing moves any more as little as inertia does.
pub fn by_pattern(cells: usize) -> Vec<Case> {
    let name = |method: &Method| match method.name {
        "symplectic-euler" | "implicit-midpoint" | "bdf2" => {
            format!("{}: air_drag=10", method.name)
        }
        name => name.to_owned(),
    };
    let methods = method::all().filter(|method| !method.is_never_stable());
    let lines = methods.map(name).collect::<Vec<_>>().join("\n");
    let of_pattern = |pattern| on(pattern, cells, &lines);
    PATTERNS.into_iter().flat_map(of_pattern).collect()
}

/// A method and a mesh, as columns: its label, the pattern and the cells.
type Solver = (String, &'static str, usize);
const SOLVER: [&str; 3] = ["method", "pattern", "cells"];

/// What a method made of the fold.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Made {
    /// None: never at rest.
    steps_to_rest: Option<u32>,
    fold_angle_over_exact: Real,
    /// Bending energy over the exact one.
    pub bending_reached: Real,
    /// Root mean square of the strains of the edges (dimensionless).
    pub rms_strain: Real,
    largest_strain: Real,
}

/// Makes the fold.
pub fn make(case: &Case) -> Result<Made, BenchError> {
    let (stiffness, Case { pattern, cells, .. }) = ([MODULUS, RIGIDITY], case);
    let (sheet, exact, _) =
        fold::prepared(Axis::Across, pattern, *cells, Kind::Springs, stiffness)?;
    let model = ClothModel {
        particles: sheet.particles.clone(),
        springs: Vec::new(),
        hinges: Vec::new(),
        others: sheet.families(),
    };
    let start = sheet.placed(|p| exact.place(p));
    let gravity = Vec3::z() * -fold::GRAVITY;
    let scene = Scene::new("fold", model, start, Some(sheet.mesh.clone()), gravity);
    let method = Method::find(case.variant.method())?;
    let mut stepper = method.build(&scene, &case.variant.settings, DT)?;
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

/// The angle of the fold over the exact one (dimensionless), by a method as [`by_pattern`] sets it.
pub fn fold_angle(name: &str, cells: usize) -> Result<Real, BenchError> {
    let is_it = |case: &Case| case.variant.method() == name && case.pattern == "alternating";
    let case = by_pattern(cells).into_iter().find(is_it);
    let unknown = || BenchError::Failed(format!("`{name}` makes no fold"));
    let made = make(&case.ok_or_else(unknown)?)?;
    match made.steps_to_rest {
        Some(_) => Ok(made.fold_angle_over_exact),
        None => Err(BenchError::Failed(format!(
            "the fold is not at rest after {MOST_STEPS} steps"
        ))),
    }
}

/// Measures all, and says what every method makes of every pattern.
pub(super) fn run(study: &mut StudyRun<'_>) -> String {
    let mut rows = measured(study, by_pattern(study.scope.pick(6, 16)));
    let told = by_method(&rows, &mut study.findings);
    rows.extend(measured(study, by_iterations(study.scope)));
    let table = Table::named(&SOLVER, &rows);
    study.table("locking-methods", "One fold by every method", table);
    told
}

fn measured(study: &mut StudyRun<'_>, cases: Vec<Case>) -> Vec<(Solver, Made)> {
    let found = study.grid_side_by_side(
        cases,
        |case| {
            let (label, cells) = (&case.variant.label, case.cells);
            format!("fold by {label}, {}, {cells} cells", case.pattern)
        },
        make,
    );
    let row = |(case, made): (Case, Made)| ((case.variant.label, case.pattern, case.cells), made);
    found.into_iter().map(row).collect()
}

/// One line a method, one column a pattern, and the same in words.
fn by_method(rows: &[(Solver, Made)], findings: &mut Findings) -> String {
    let mut table = Table::new(&[&["method"], &PATTERNS[..]].concat());
    let mut told = Vec::new();
    for method in method::all().map(|method| method.name) {
        let at_rest = rows.iter().filter(|(_, made)| made.steps_to_rest.is_some());
        let of_method = at_rest.filter(|((of, ..), _)| of == method);
        let reached = of_method.map(|((_, pattern, _), made)| (*pattern, made.bending_reached));
        let mut reached = reached.collect_vec();
        let of_pattern = |pattern: &str| {
            let one = reached.iter().find(|one| one.0 == pattern);
            Cell::from(one.map(|one| one.1))
        };
        let cells = PATTERNS.map(of_pattern);
        reached.sort_by(|a, b| a.1.total_cmp(&b.1));
        if let [(locked, least), .., (free, most)] = reached[..] {
            let [least, most] = [least, most].map(|share| significant(share, 2));
            told.push(format!("{method} {least} ({locked}) to {most} ({free})"));
            table.line(method, cells);
        }
    }
    findings.table(
        "locking-patterns",
        "Bending reached by every method on every pattern; empty where it did not come to rest",
        table,
    );
    format!(
        "Of the bending of a fold each method reaches, by pattern: {}.",
        told.join(", ")
    )
}

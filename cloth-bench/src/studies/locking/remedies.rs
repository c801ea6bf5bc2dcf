//! The same cone and the same fold with each remedy, and what it breaks.

use super::fold::{self, Axis};
use super::sheet::{KINDS, Kind, Rest, Sheet, square};
use super::sweeps::RIGIDITY;
use super::{cone, count};
use crate::error::BenchError;
use crate::method;
use crate::report::table::{Cell, Table};
use crate::studies::{Findings, Scope};
use cloth_core::dof::{EdgeRank, bent};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::ImplicitConfig;
use std::time::Instant;

/// Y (N/m): a cone of springs is locked by it.
const MODULUS: Real = 1e8;
/// Y (N/m) of the fold, which needs less.
const FOLD_MODULUS: Real = 1e6;

fn patterns(scope: Scope) -> &'static [&'static str] {
    match scope {
        Scope::Quick => &["one-way"],
        Scope::Full => &count::PATTERNS,
    }
}

fn cells(scope: Scope) -> usize {
    match scope {
        Scope::Quick => 16,
        Scope::Full => 32,
    }
}

pub(super) fn cases(scope: Scope) -> u64 {
    (patterns(scope).len() * KINDS.len()) as u64
}

/// What a kind of membrane resists, over what springs do: pulled along x, pushed, sheared, by 2 %.
fn resistances(sheet: &Sheet) -> Result<[Real; 3], BenchError> {
    let strain = 0.02;
    let energy = |a: Real, b: Real| {
        sheet.membrane_energy(&sheet.placed(|p| p + Vec3::x() * (a * p.x + b * p.y)))
    };
    Ok([
        energy(strain, 0.0)?,
        energy(-strain, 0.0)?,
        energy(0.0, strain)?,
    ])
}

/// Shortest time (s) of a step of implicit Euler with one linear solve, from rest under gravity.
fn seconds_a_step(sheet: &Sheet, rest: &Rest) -> Result<Real, BenchError> {
    let config = ImplicitConfig::linearized();
    let mut solver = method::implicit_euler(&sheet.particles, sheet.families(), config)?;
    let mut shortest = Real::INFINITY;
    for _ in 0..7 {
        let mut state = State::at_rest(rest.points.clone());
        let started = Instant::now();
        let input = StepInput::new(1.0 / 60.0).gravity(Vec3::z() * -fold::GRAVITY);
        solver.step(&mut state, input).map_err(BenchError::failed)?;
        shortest = shortest.min(started.elapsed().as_secs_f64());
    }
    Ok(shortest)
}

/// Measures every kind on every pattern.
pub(super) fn run(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut table = Table::new(&[
        "pattern",
        "membrane",
        "coordinates",
        "coordinates − conditions",
        "nullity bent",
        "cone: energy over developable",
        "cone at Y/100",
        "fold angle over exact",
        "fold: bending reached",
        "pull",
        "push",
        "shear",
        "cost per step",
    ]);
    let n = cells(scope);
    for &pattern in patterns(scope) {
        let mut springs: Option<([Real; 3], Real)> = None;
        for (name, kind) in KINDS {
            let case = format!("{name}, {pattern}");
            progress(&format!("locking: {case}"));
            let on_cone = cone::bend(pattern, n, kind, MODULUS, RIGIDITY);
            let on_cone = findings.unless_failed(&format!("cone, {case}"), on_cone);
            let softer = cone::bend(pattern, n, kind, 0.01 * MODULUS, RIGIDITY);
            let softer = findings.unless_failed(&format!("cone, Y/100, {case}"), softer);
            let sheet = Sheet::new(square(pattern, n)?, kind, MODULUS, RIGIDITY)?;
            let conditions = sheet.conditions()?;
            let rank = EdgeRank::of_pairs(&bent(&sheet.points), &conditions)
                .map_err(BenchError::failed)?;
            let resists = resistances(&sheet)?;
            let stiffness = [FOLD_MODULUS, RIGIDITY];
            let folded = fold::fold(Axis::Across, pattern, n, kind, stiffness);
            let folded = findings.unless_failed(&format!("fold, {case}"), folded);
            let seconds = match &folded {
                Some(folded) => Some(seconds_a_step(&folded.sheet, &folded.rest)?),
                None => None,
            };
            if kind == Kind::Springs {
                springs = seconds.map(|seconds| (resists, seconds));
            }
            let over = |k: usize| springs.map(|(of_springs, _)| resists[k] / of_springs[k]);
            let cost = seconds
                .zip(springs)
                .map(|(s, (_, of_springs))| s / of_springs);
            let coordinates = 3 * sheet.points.len();
            table.push([
                Cell::from(pattern),
                Cell::from(name),
                Cell::from(coordinates),
                Cell::from(coordinates as i64 - conditions.len() as i64),
                Cell::from(rank.nullity),
                Cell::from(on_cone.map(|found| found.energy)),
                Cell::from(softer.map(|found| found.energy)),
                Cell::from(
                    folded
                        .as_ref()
                        .map(|found| found.angle / found.exact.exact_angle()),
                ),
                Cell::from(folded.as_ref().map(|found| found.bending)),
                Cell::from(over(0)),
                Cell::from(over(1)),
                Cell::from(over(2)),
                Cell::from(cost),
            ]);
        }
    }
    findings.table(
        "locking-remedies",
        "Every kind of membrane on the cone and in the fold",
        table,
    );
    Ok(())
}

//! The same cone and the same fold with each remedy, and what it breaks.

use super::fold::{self, Axis};
use super::sheet::{KINDS, Kind, Sheet, square};
use super::sweeps::RIGIDITY;
use super::{cone, count};
use crate::studies::interleaved::timed;
use crate::studies::prelude::*;
use cloth_core::dof::{EdgeRank, perturbed};
use cloth_massspring::{ImplicitConfig, ImplicitEuler};

/// Y (N/m): a cone of springs is locked by it.
const MODULUS: Real = 1e8;
/// Y (N/m) of the fold, which needs less.
const FOLD_MODULUS: Real = 1e6;

/// Cells a side of the largest sheet that is bent to a cone with every kind of membrane.
const LARGEST_CONE: usize = 32;

/// Patterns with cells a side.
fn sheets(scope: Scope) -> Vec<(&'static str, usize)> {
    match scope {
        Scope::Quick => vec![("one-way", 12)],
        Scope::Full => {
            let of_size = |n: usize| count::PATTERNS.map(|pattern| (pattern, n));
            let mut all = [16, 32].map(of_size).concat();
            // The most and the least regular of those that lock.
            all.extend([("one-way", 64), ("irregular", 64)]);
            all
        }
    }
}

/// What a kind of membrane makes of a mesh.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Effect {
    coordinates: usize,
    conditions: usize,
    nullity: usize,
    /// Energy on the cone over the developable answer, at [`MODULUS`] and a hundredth of it; of sheets up to
    /// [`LARGEST_CONE`].
    on_cone: Option<[Real; 2]>,
    /// Bending energy of the fold over the exact one, at [`FOLD_MODULUS`] and a hundredth of it.
    bending: [Real; 2],
    /// Angle of the fold over the exact one, at [`FOLD_MODULUS`].
    angle: Real,
    /// Energy when pulled, pushed, sheared and stretched in waves, over that of springs.
    resists: [Real; 4],
}

/// What a kind of membrane resists: pulled along x, pushed, sheared, stretched in waves as long as four cells, all by 2
/// % (J).
fn resistances(sheet: &Sheet, cells: usize) -> Result<[Real; 4], BenchError> {
    let strain = 0.02;
    let wave = 0.5 * std::f64::consts::PI * cells as Real;
    let energy = |shift: &dyn Fn(&Vec3) -> Real| {
        sheet.membrane_energy(&sheet.placed(|p| p + Vec3::x() * shift(p)))
    };
    Ok([
        energy(&|p| strain * p.x)?,
        energy(&|p| -strain * p.x)?,
        energy(&|p| strain * p.y)?,
        energy(&|p| strain / wave * (wave * p.x).sin())?,
    ])
}

/// Shortest time of a step of implicit Euler with one linear solve from the exact fold under gravity, over that of
/// springs, timed interleaved.
fn cost(pattern: &str, cells: usize, kind: Kind) -> Result<Real, BenchError> {
    let config = ImplicitConfig::linearized();
    let prepare = |kind| {
        let stiffness = [FOLD_MODULUS, RIGIDITY];
        let (sheet, exact, _) = fold::prepared(Axis::Across, pattern, cells, kind, stiffness)?;
        let solver = ImplicitEuler::builder(&sheet.particles)
            .elements(sheet.families())
            .config(config)
            .build()?;
        Ok::<_, BenchError>((solver, State::at_rest(sheet.placed(|p| exact.place(p)))))
    };
    let mut both = [prepare(kind)?, prepare(Kind::Springs)?];
    let mut shortest = [Real::INFINITY; 2];
    for _ in 0..7 {
        for ((solver, start), shortest) in both.iter_mut().zip(&mut shortest) {
            let mut state = start.clone();
            let input = StepInput::new(1.0 / 60.0).gravity(Vec3::z() * -fold::GRAVITY);
            *shortest = shortest.min(timed(|| solver.step(&mut state, input))?);
        }
    }
    Ok(shortest[0] / shortest[1])
}

fn measure(pattern: &str, cells: usize, kind: Kind) -> Result<Effect, BenchError> {
    let sheet = |kind| Sheet::new(square(pattern, cells)?, kind, MODULUS, RIGIDITY);
    let [own, springs] = [sheet(kind)?, sheet(Kind::Springs)?];
    let conditions = own.conditions()?;
    let rank = EdgeRank::of_pairs(&perturbed(&own.points), &conditions)?;
    let of_springs = resistances(&springs, cells)?;
    let mut resists = resistances(&own, cells)?;
    let both = resists.iter_mut().zip(of_springs);
    both.for_each(|(own, of_springs)| *own /= of_springs);
    let cone = |modulus| {
        Ok::<_, BenchError>(
            cone::bend(pattern, cells, kind, modulus, RIGIDITY)?
                .1
                .energy,
        )
    };
    let on_cone = match cells <= LARGEST_CONE {
        true => Some([cone(MODULUS)?, cone(0.01 * MODULUS)?]),
        false => None,
    };
    let fold = |modulus| fold::fold(Axis::Across, pattern, cells, kind, [modulus, RIGIDITY]);
    let folded = fold(FOLD_MODULUS)?;
    Ok(Effect {
        coordinates: 3 * own.points.len(),
        conditions: conditions.len(),
        nullity: rank.nullity,
        on_cone,
        bending: [folded.bending, fold(0.01 * FOLD_MODULUS)?.bending],
        angle: folded.angle / folded.exact.exact_angle(),
        resists,
    })
}

/// Measures every kind on every pattern.
pub(super) fn run(study: &mut StudyRun<'_>) {
    let all = iproduct!(sheets(study.scope), KINDS);
    let all = all.map(|((pattern, cells), (name, kind))| (pattern, cells, name, kind));
    let name_of = |&(pattern, cells, name, _): &(_, _, _, _)| {
        format!("remedy, {name}, {pattern}, {cells} cells")
    };
    let found = study.grid_side_by_side(all, name_of, |&(pattern, cells, _, kind)| {
        measure(pattern, cells, kind)
    });
    let (mut folds, mut cones) = (Vec::new(), Vec::new());
    for (remedy, found) in found {
        let (pattern, cells, membrane, kind) = remedy;
        let case = format!("cost of {}", name_of(&remedy));
        let cost_per_step = study.case(&case, || cost(pattern, cells, kind));
        let head = (pattern, cells, membrane);
        let left = found.coordinates as i64 - found.conditions as i64;
        let freedom = (found.coordinates, left, found.nullity);
        folds.push((head, freedom, found.bending, found.angle, cost_per_step));
        let on_cone = [0, 1].map(|k| found.on_cone.map(|energy| energy[k]));
        cones.push((head, on_cone, found.resists));
    }
    let head = ["pattern", "cells", "membrane"];
    let freedom = ["coordinates", "coordinates − conditions", "nullity bent"];
    let reached = ["bending reached", "at Y/100", "fold angle over exact"];
    let cost = ["cost per step"];
    study.table(
        "locking-remedies",
        "Every kind of membrane in the fold: its freedom, what it makes of it, and what it costs",
        Table::named(&[&head[..], &freedom, &reached, &cost].concat(), &folds),
    );
    let on_cone = ["cone: energy over developable", "cone at Y/100"];
    let resists = ["pull", "push", "shear", "waves of 4 cells"];
    study.table(
        "locking-breaks",
        "Every kind of membrane on the cone, and what it breaks: energies over those of the springs",
        Table::named(&[&head[..], &on_cone, &resists].concat(), &cones),
    );
}

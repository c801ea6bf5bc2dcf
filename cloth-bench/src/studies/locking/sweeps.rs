//! Locked or stiff: cone and fold against membrane modulus, resolution and pattern.

use super::cone;
use super::count::PATTERNS;
use super::fold::{self, Axis};
use super::sheet::Kind;
use crate::report::plot;
use crate::studies::prelude::*;

/// D (N·m) of the cone and the fold.
pub(super) const RIGIDITY: Real = 0.02;

/// Moduli Y (N/m).
fn moduli(scope: Scope, cells: usize) -> &'static [Real] {
    match scope {
        Scope::Full if cells <= 64 => &[1e3, 1e4, 1e5, 1e6, 1e7, 1e8],
        _ => &[1e4, 1e6, 1e8],
    }
}

pub(super) fn sizes(scope: Scope) -> &'static [usize] {
    scope.pick(&[8, 12], &[16, 32, 64, 128])
}

/// The modulus (N/m) whose folds are drawn against the edge length.
const SHOWN: Real = 1e6;

fn fold_moduli(scope: Scope, cells: usize) -> &'static [Real] {
    match scope {
        Scope::Quick => &[1e4, SHOWN],
        Scope::Full if cells <= 32 => &[1e3, 1e4, 1e5, 1e6, 1e7, 1e8],
        Scope::Full if cells <= 64 => &[1e4, 1e6, 1e8],
        Scope::Full => &[1e4, 1e6],
    }
}

fn fold_sizes(scope: Scope) -> &'static [usize] {
    scope.pick(&[8, 12], &[16, 32, 64, 128])
}

/// `l* = (702 D R²/Y)^¼` (m): the edge length at which the membrane of a locked bend of radius `radius` (m) was
/// estimated to cost as much as its bending.
pub fn critical_length(radius: Real, modulus: Real, rigidity: Real) -> Real {
    (702.0 * rigidity * radius * radius / modulus).powf(0.25)
}

/// What the cones say about the estimate.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct OnCones {
    /// Least and largest membrane energy with all vertices on the cone over the estimate's `(l/l*)⁴`, for equilateral
    /// triangles, which are nearly alike in all directions, as the estimate assumes.
    pub(super) equilateral: [Real; 2],
    /// The same for all patterns.
    pub(super) placed: [Real; 2],
    /// Largest part of that energy that is left at rest, where l > l*.
    pub(super) left: Real,
    /// The most locked sheet: its pattern, its cells a side, l/l*, and its energy over the developable answer.
    pub(super) worst: (String, usize, Real, Real),
}

/// Least and largest.
fn ends(values: impl Iterator<Item = Real>) -> [Real; 2] {
    values.fold([Real::MAX, 0.0], |[least, most], value| {
        [least.min(value), most.max(value)]
    })
}

/// A cone of a pattern, with so many cells a side and a modulus Y (N/m).
#[derive(Default, Serialize)]
struct ConeRow {
    pattern: &'static str,
    cells: usize,
    #[serde(rename = "Y")]
    modulus: Real,
    #[serde(rename = "l over l*")]
    ratio: Real,
    energy_over_developable: Real,
    membrane_over_developable: Real,
    #[serde(rename = "the same, vertices on the cone")]
    placed: Real,
    iterations: u32,
    last_move: Real,
}

/// The cone for every pattern.
pub(super) fn cones(study: &mut StudyRun<'_>) -> OnCones {
    let scope = study.scope;
    let of_size = |&cells: &usize| moduli(scope, cells).iter().map(move |&y| (cells, y));
    let of_pattern = |pattern| {
        let sheets = sizes(scope).iter().flat_map(of_size);
        sheets.map(move |(cells, modulus)| (pattern, cells, modulus))
    };
    let found = study.grid_side_by_side(
        PATTERNS.into_iter().flat_map(of_pattern),
        |(pattern, cells, y)| format!("cone, {pattern}, {cells} cells, Y = {y:e} N/m"),
        |&(pattern, cells, y)| cone::bend(pattern, cells, Kind::Springs, y, RIGIDITY),
    );
    let row = |((pattern, cells, modulus), cone): ((_, _, Real), cone::OnCone)| ConeRow {
        pattern,
        cells,
        modulus,
        ratio: cone.edge_length / critical_length(cone::radius(), modulus, RIGIDITY),
        energy_over_developable: cone.energy,
        membrane_over_developable: cone.membrane,
        placed: cone.placed,
        iterations: cone.iterations,
        last_move: cone.last_move,
    };
    let rows: Vec<ConeRow> = found.into_iter().map(row).collect();
    let mut sorted: Vec<&ConeRow> = rows.iter().collect();
    sorted.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let let_go = PATTERNS.map(|pattern| {
        let ours = sorted.iter().filter(|row| row.pattern == pattern);
        let points = ours.map(|row| (row.ratio, row.energy_over_developable));
        Series::new(pattern, points.collect())
    });
    let equilateral = || sorted.iter().filter(|row| row.pattern == "equilateral");
    let held = equilateral()
        .map(|row| (row.ratio, 1.0 + row.placed))
        .collect();
    let held = Series::new("equilateral, held on it", held);
    let predicted = (0..=40).map(|i| {
        let ratio = 10.0_f64.powf(-1.0 + 0.045 * Real::from(i));
        (ratio, 1.0 + ratio.powi(4))
    });
    let plot = Plot::new(
        "What a sheet of springs pays for lying on a cone",
        plot::Axis::log("edge length l over l* = (702 D R²/Y)^¼ (dimensionless)"),
        plot::Axis::log("elastic energy over the developable answer (dimensionless)"),
    )
    .points(let_go)
    .points([held])
    .exact("1 + (l/l*)⁴", predicted)
    .note("1 is a sheet that follows the cone without stretching. A sheet is locked, and not only stiff, where the energy goes on rising with Y. The dashed curve is the estimate, which holds for vertices that are held on the cone; let go, they leave it.");
    study.plot("locking-cone", &plot);
    study.table("locking-cone", "Springs on a cone", &rows);
    let constant = |row: &ConeRow| row.placed / row.ratio.powi(4);
    let locked = rows.iter().filter(|row| row.ratio > 1.0);
    let left = locked.map(|row| row.membrane_over_developable / row.placed);
    let energies = |a: &&ConeRow, b: &&ConeRow| {
        a.energy_over_developable
            .total_cmp(&b.energy_over_developable)
    };
    let worst = rows.iter().rev().max_by(energies);
    OnCones {
        equilateral: ends(equilateral().map(|row| constant(row))),
        placed: ends(rows.iter().map(constant)),
        left: left.fold(0.0, Real::max),
        worst: worst.map_or((String::new(), 0, 0.0, 0.0), |row| {
            let energy = row.energy_over_developable;
            (row.pattern.to_owned(), row.cells, row.ratio, energy)
        }),
    }
}

/// What the folds say about the estimate: least and largest edge length over l* at which half of the bending was left,
/// and how many sheets never lost half.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Folds {
    pub(super) halved: [Real; 2],
    pub(super) locked: usize,
    pub(super) free: usize,
}

/// A fold of a pattern about a diagonal, with so many cells a side and a modulus Y (N/m).
#[derive(Default, Serialize)]
struct FoldRow {
    pattern: &'static str,
    held_diagonal: &'static str,
    cells: usize,
    #[serde(rename = "Y")]
    modulus: Real,
    #[serde(rename = "l over l*")]
    ratio: Real,
    #[serde(rename = "rigidity over D")]
    factor: Real,
    fold_angle: Real,
    exact_angle: Real,
    bending_reached: Real,
    membrane_over_bending: Real,
    iterations: u32,
    last_move: Real,
    #[serde(skip)]
    edge_length: Real,
    #[serde(skip)]
    critical_length: Real,
}

/// The diagonal fold for every pattern and both diagonals.
pub(super) fn folds(study: &mut StudyRun<'_>) -> Folds {
    let scope = study.scope;
    let of_size = |&cells: &usize| fold_moduli(scope, cells).iter().map(move |&y| (cells, y));
    let sheets = || fold_sizes(scope).iter().flat_map(of_size);
    let curves_of = [("rising", Axis::Along), ("falling", Axis::Across)];
    let curves_of = curves_of
        .into_iter()
        .flat_map(|axis| PATTERNS.map(|pattern| (pattern, axis)));
    let points = curves_of.clone().flat_map(|(pattern, axis)| {
        sheets().map(move |(cells, modulus)| (pattern, axis, cells, modulus))
    });
    let found = study.grid_side_by_side(
        points,
        |(pattern, (name, _), cells, y)| {
            format!("fold, {pattern}, {name}, {cells} cells, Y = {y:e}")
        },
        |&(pattern, (_, axis), cells, y)| {
            fold::fold(axis, pattern, cells, Kind::Springs, [y, RIGIDITY])?.figures()
        },
    );
    let row = |((pattern, (held_diagonal, _), cells, modulus), folded): (
        (_, (_, Axis), _, _),
        fold::FoldFigures,
    )| {
        let critical_length = critical_length(folded.radius, modulus, folded.factor * RIGIDITY);
        FoldRow {
            pattern,
            held_diagonal,
            cells,
            modulus,
            ratio: folded.edge_length / critical_length,
            factor: folded.factor,
            fold_angle: folded.angle,
            exact_angle: folded.exact_angle,
            bending_reached: folded.bending,
            membrane_over_bending: folded.membrane,
            iterations: folded.iterations,
            last_move: folded.last_move,
            edge_length: folded.edge_length,
            critical_length,
        }
    };
    let rows: Vec<FoldRow> = found.into_iter().map(row).collect();
    let (mut series, mut by_length, mut halved) = (Vec::new(), Vec::new(), Vec::new());
    for (pattern, (name, axis)) in curves_of {
        let ours = || {
            rows.iter()
                .filter(|row| (row.pattern, row.held_diagonal) == (pattern, name))
        };
        for &cells in fold_sizes(scope) {
            let of_size = ours().filter(|row| row.cells == cells);
            let curve: Vec<_> = of_size
                .map(|row| (row.ratio, row.bending_reached))
                .collect();
            halved.push(halved_at(&curve));
        }
        let mut points: Vec<_> = ours().map(|row| (row.ratio, row.bending_reached)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        series.push(Series::new(&format!("{pattern}, {name}"), points));
        if axis == Axis::Across {
            let shown = || ours().filter(|row| row.modulus == SHOWN);
            let reached = shown()
                .map(|row| (row.edge_length, row.bending_reached))
                .collect();
            let critical: Vec<Real> = shown().map(|row| row.critical_length).collect();
            by_length.extend(against_length(pattern, reached, &critical));
        }
    }
    let predicted = (0..=40).map(|i| {
        let ratio = 10.0_f64.powf(-1.0 + 0.045 * Real::from(i));
        (ratio, 1.0 / (1.0 + ratio.powi(4)))
    });
    let reached =
        plot::Axis::linear("bending energy reached, over the developable answer (dimensionless)");
    let plot = Plot::new(
        "How much of a diagonal fold a sheet of springs makes",
        plot::Axis::log("edge length l over l* = (702 D R²/Y)^¼ (dimensionless)"),
        reached.clone(),
    )
    .points(series)
    .exact("1/(1 + (l/l*)⁴)", predicted)
    .note("The sheet hangs under its own weight, held along the named diagonal. The dashed curve is a guess from the estimate: a rigidity of D (1 + (l/l*)⁴) under the same load.");
    study.plot("locking-fold", &plot);
    let length = plot::Axis::log("edge length l (m)");
    let plot = Plot::new("Finer meshes fold", length, reached).with(by_length).note(&format!(
        "Y = {SHOWN:e} N/m, held along the falling diagonal; from right to left the same sheet with finer and finer meshes. Dashed, in the colour of the mesh: 1/(1 + (l/l*)⁴), which is one half at l = l* = (702 D R²/Y)^¼, with the rigidity D that the mesh has about this diagonal and the radius R of its fold. A sheet free to curve across is softer than the developable answer, so 1 can be exceeded."
    ));
    study.plot("locking-length", &plot);
    study.table(
        "locking-fold",
        "Diagonal folds of a sheet of springs",
        &rows,
    );
    let locked = halved.iter().flatten().count();
    Folds {
        halved: ends(halved.iter().flatten().copied()),
        locked,
        free: halved.len() - locked,
    }
}

/// Bending reached at edge lengths (m), and the guess from l* (m), in the mean of those given.
fn against_length(
    pattern: &str,
    mut reached: Vec<(Real, Real)>,
    critical_lengths: &[Real],
) -> [Series; 2] {
    reached.sort_by(|a, b| a.0.total_cmp(&b.0));
    let critical = critical_lengths.iter().sum::<Real>() / critical_lengths.len().max(1) as Real;
    let guess = (0..=40).map(|i| {
        let length = 10.0_f64.powf(-2.0 + 0.03 * Real::from(i));
        (length, 1.0 / (1.0 + (length / critical).powi(4)))
    });
    [
        Series::new(pattern, reached),
        Series::new(&format!("{pattern}, l* {critical:.3} m"), guess.collect())
            .styled(Style::ExactCurve),
    ]
}

/// Where a curve `(l/l*, bending reached)` in ascending order first falls to half of its first value, if it does;
/// between two points by logarithms.
pub fn halved_at(curve: &[(Real, Real)]) -> Option<Real> {
    let half = 0.5 * curve.first()?.1;
    let pair = curve.windows(2).find(|pair| pair[1].1 <= half)?;
    let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
    let part = (y0 / half).ln() / (y0 / y1).ln();
    Some(x0 * (x1 / x0).powf(part))
}

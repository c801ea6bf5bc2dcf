//! Locked or stiff: cone and fold against membrane modulus, resolution and pattern.

use super::cone::{self, OnCone};
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

/// Cells a side.
const SIZES: [&[usize]; 2] = [&[8, 12], &[16, 32, 64, 128]];

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

/// Edge lengths over l* that are drawn, with what is expected there.
fn predicted(of: fn(Real) -> Real) -> impl Iterator<Item = (Real, Real)> {
    let ratios = (0..=40).map(|i| 10.0_f64.powf(-1.0 + 0.045 * Real::from(i)));
    ratios.map(move |ratio| (ratio, of(ratio)))
}

/// The axis of these plots.
fn over_critical() -> plot::Axis {
    plot::Axis::log("edge length l over l* = (702 D R²/Y)^¼ (dimensionless)")
}

/// The cone for every pattern.
pub(super) fn cones(study: &mut StudyRun<'_>) -> OnCones {
    let scope = study.scope;
    let sizes = scope.of(SIZES).iter();
    let of_size = |&cells: &usize| moduli(scope, cells).iter().map(move |&y| (cells, y));
    let points = iproduct!(PATTERNS, sizes.flat_map(of_size));
    let found = study.grid_side_by_side(
        points.map(|(pattern, (cells, modulus))| (pattern, cells, modulus)),
        |(pattern, cells, y)| format!("cone, {pattern}, {cells} cells, Y = {y:e} N/m"),
        |&(pattern, cells, y)| cone::bend(pattern, cells, Kind::Springs, y, RIGIDITY),
    );
    let with_ratio =
        |((pattern, cells, modulus), (length, cone)): ((_, _, Real), (Real, OnCone))| {
            let ratio = length / critical_length(cone::radius(), modulus, RIGIDITY);
            ((pattern, cells, modulus), ratio, cone)
        };
    let rows = found.into_iter().map(with_ratio).collect_vec();
    let sorted = rows
        .iter()
        .sorted_by(|a, b| a.1.total_cmp(&b.1))
        .collect_vec();
    let of_pattern = |pattern| sorted.iter().filter(move |row| row.0.0 == pattern);
    let let_go = PATTERNS.map(|pattern| {
        let points = of_pattern(pattern).map(|(_, ratio, cone)| (*ratio, cone.energy));
        Series::new(pattern, points.collect())
    });
    let held = of_pattern("equilateral").map(|(_, ratio, cone)| (*ratio, 1.0 + cone.placed));
    let held = Series::new("equilateral, held on it", held.collect());
    let energy = plot::Axis::log("elastic energy over the developable answer (dimensionless)");
    let title = "What a sheet of springs pays for lying on a cone";
    let plot = Plot::new(title, over_critical(), energy)
    .points(let_go)
    .points([held])
    .exact("1 + (l/l*)⁴", predicted(|ratio| 1.0 + ratio.powi(4)))
    .note("1 is a sheet that follows the cone without stretching. A sheet is locked, and not only stiff, where the energy goes on rising with Y. The dashed curve is the estimate, which holds for vertices that are held on the cone; let go, they leave it.");
    study.plot("locking-cone", &plot);
    let names = ["pattern", "cells", "Y", "l over l*"];
    study.table(
        "locking-cone",
        "Springs on a cone",
        Table::named(&names, &rows),
    );
    let constant = |(_, ratio, cone): &(_, Real, OnCone)| cone.placed / ratio.powi(4);
    let locked = rows.iter().filter(|(_, ratio, _)| *ratio > 1.0);
    let left = locked.map(|(.., cone)| cone.membrane / cone.placed);
    let worst = rows
        .iter()
        .rev()
        .max_by(|a, b| a.2.energy.total_cmp(&b.2.energy));
    OnCones {
        equilateral: ends(of_pattern("equilateral").map(|row| constant(row))),
        placed: ends(rows.iter().map(constant)),
        left: largest(left),
        worst: worst.map_or_else(Default::default, |((pattern, cells, _), ratio, cone)| {
            ((*pattern).to_owned(), *cells, *ratio, cone.energy)
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

/// Pattern, held diagonal, cells a side, Y (N/m) and l/l* of a fold; what it shows; edge length and l* (m).
type FoldRow = (
    (&'static str, &'static str, usize, Real, Real),
    fold::Shown,
    [Real; 2],
);

/// The diagonal fold for every pattern and both diagonals.
pub(super) fn folds(study: &mut StudyRun<'_>) -> Folds {
    let scope = study.scope;
    let sizes = scope.of(SIZES);
    let of_size = |&cells: &usize| fold_moduli(scope, cells).iter().map(move |&y| (cells, y));
    let folds = iproduct!(
        [("rising", Axis::Along), ("falling", Axis::Across)],
        PATTERNS
    );
    let found = study.grid_side_by_side(
        iproduct!(folds.clone(), sizes.iter().flat_map(of_size)),
        |(((name, _), pattern), (cells, y))| {
            format!("fold, {pattern}, {name}, {cells} cells, Y = {y:e}")
        },
        |&(((_, axis), pattern), (cells, y))| {
            fold::fold(axis, pattern, cells, Kind::Springs, [y, RIGIDITY])?.figures()
        },
    );
    let row = |((((held, _), pattern), (cells, modulus)), folded): (_, fold::Figures)| -> FoldRow {
        let critical = critical_length(folded.radius, modulus, folded.shown.factor * RIGIDITY);
        let at = (pattern, held, cells, modulus, folded.edge_length / critical);
        (at, folded.shown, [folded.edge_length, critical])
    };
    let rows = found.into_iter().map(row).collect_vec();
    let (mut series, mut by_length, mut halved) = (Vec::new(), Vec::new(), Vec::new());
    for ((name, axis), pattern) in folds {
        let ours = || {
            rows.iter()
                .filter(|(at, ..)| (at.0, at.1) == (pattern, name))
        };
        let point = |((.., ratio), shown, _): &FoldRow| (*ratio, shown.bending);
        for &cells in sizes {
            let of_size = ours().filter(|(at, ..)| at.2 == cells);
            halved.push(halved_at(&of_size.map(point).collect_vec()));
        }
        let points = ours().map(point).sorted_by(|a, b| a.0.total_cmp(&b.0));
        series.push(Series::new(&format!("{pattern}, {name}"), points.collect()));
        if axis == Axis::Across {
            let shown = || ours().filter(|(at, ..)| at.3 == SHOWN);
            let reached = shown().map(|(_, shown, [length, _])| (*length, shown.bending));
            let critical = shown().map(|(.., [_, critical])| *critical).collect_vec();
            by_length.extend(against_length(pattern, reached.collect(), &critical));
        }
    }
    let reached =
        plot::Axis::linear("bending energy reached, over the developable answer (dimensionless)");
    let title = "How much of a diagonal fold a sheet of springs makes";
    let plot = Plot::new(title, over_critical(), reached.clone())
    .points(series)
    .exact("1/(1 + (l/l*)⁴)", predicted(|ratio| 1.0 / (1.0 + ratio.powi(4))))
    .note("The sheet hangs under its own weight, held along the named diagonal. The dashed curve is a guess from the estimate: a rigidity of D (1 + (l/l*)⁴) under the same load.");
    study.plot("locking-fold", &plot);
    let length = plot::Axis::log("edge length l (m)");
    let plot = Plot::new("Bending reached against the length of edges", length, reached).with(by_length).note(&format!(
        "Y = {SHOWN:e} N/m, held along the falling diagonal; from right to left the same sheet with finer and finer meshes. Dashed, in the colour of the mesh: 1/(1 + (l/l*)⁴), which is one half at l = l* = (702 D R²/Y)^¼, with the rigidity D that the mesh has about this diagonal and the radius R of its fold. A sheet free to curve across is softer than the developable answer, so 1 can be exceeded."
    ));
    study.plot("locking-length", &plot);
    let rows = rows
        .into_iter()
        .map(|(at, shown, _)| (at, shown))
        .collect_vec();
    let names = ["pattern", "held diagonal", "cells", "Y", "l over l*"];
    let table = Table::named(&names, &rows);
    study.table(
        "locking-fold",
        "Diagonal folds of a sheet of springs",
        table,
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

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
    scope.pick(&[16, 32], &[16, 32, 64, 128])
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
    scope.pick(&[8, 16], &[16, 32, 64, 128])
}

/// `l* = (702 D R²/Y)^¼` (m): the edge length at which the membrane of a locked bend of radius `radius` (m) was
/// estimated to cost as much as its bending.
pub(super) fn critical_length(radius: Real, modulus: Real, rigidity: Real) -> Real {
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

fn widen(range: &mut [Real; 2], value: Real) {
    *range = [range[0].min(value), range[1].max(value)];
}

/// The cone for every pattern.
pub(super) fn cones(study: &mut StudyRun<'_>) -> Result<OnCones, BenchError> {
    let scope = study.scope;
    let mut table = Table::new(&[
        "pattern",
        "cells",
        "Y",
        "l over l*",
        "energy over developable",
        "membrane over developable",
        "the same, vertices on the cone",
        "iterations",
        "last move",
    ]);
    let mut told = OnCones {
        equilateral: [Real::MAX, 0.0],
        placed: [Real::MAX, 0.0],
        left: 0.0,
        worst: (String::new(), 0, 0.0, 0.0),
    };
    let (mut series, mut on_cone) = (Vec::new(), Vec::new());
    for pattern in PATTERNS {
        let mut curve = Vec::new();
        let of_size = |&cells: &usize| moduli(scope, cells).iter().map(move |&y| (cells, y));
        let sheets: Vec<(usize, Real)> = sizes(scope).iter().flat_map(of_size).collect();
        let case_of = |(cells, modulus): &(usize, Real)| {
            format!("cone, {pattern}, {cells} cells, Y = {modulus:e} N/m")
        };
        let every = study
            .cases
            .side_by_side(&sheets, case_of, |&(cells, modulus)| {
                cone::bend(pattern, cells, Kind::Springs, modulus, RIGIDITY)
            });
        for (sheet, found) in sheets.into_iter().zip(every) {
            let (cells, modulus) = sheet;
            let Some(found) = study.findings.unless_failed(&case_of(&sheet), found) else {
                continue;
            };
            let (energy, membrane) = (found.energy, found.membrane);
            let ratio = found.edge_length / critical_length(cone::radius(), modulus, RIGIDITY);
            curve.push((ratio, energy));
            let constant = found.placed / ratio.powi(4);
            widen(&mut told.placed, constant);
            if pattern == "equilateral" {
                on_cone.push((ratio, 1.0 + found.placed));
                widen(&mut told.equilateral, constant);
            }
            if ratio > 1.0 {
                told.left = told.left.max(membrane / found.placed);
            }
            if energy > told.worst.3 {
                told.worst = (pattern.to_owned(), cells, ratio, energy);
            }
            table.push([
                Cell::from(pattern),
                Cell::from(cells),
                Cell::from(modulus),
                Cell::from(ratio),
                Cell::from(energy),
                Cell::from(membrane),
                Cell::from(found.placed),
                Cell::from(found.iterations as usize),
                Cell::from(found.last_move),
            ]);
        }
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        series.push(Series::new(pattern, curve).styled(Style::Points));
    }
    on_cone.sort_by(|a, b| a.0.total_cmp(&b.0));
    series.push(Series::new("equilateral, held on it", on_cone).styled(Style::Points));
    let predicted = (0..=40).map(|i| {
        let ratio = 10.0_f64.powf(-1.0 + 0.045 * Real::from(i));
        (ratio, 1.0 + ratio.powi(4))
    });
    series.push(Series::new("1 + (l/l*)⁴", predicted.collect()).styled(Style::ExactCurve));
    study.findings.plot(
        "locking-cone",
        &Plot {
            title: "What a sheet of springs pays for lying on a cone".into(),
            x: plot::Axis::log("edge length l over l* = (702 D R²/Y)^¼ (dimensionless)"),
            y: plot::Axis::log("elastic energy over the developable answer (dimensionless)"),
            series,
            note: "1 is a sheet that follows the cone without stretching. A sheet is locked, and not only stiff, where the energy goes on rising with Y. The dashed curve is the estimate, which holds for vertices that are held on the cone; let go, they leave it.".into(),
        },
    );
    study
        .findings
        .table("locking-cone", "Springs on a cone", table);
    Ok(told)
}

/// What the folds say about the estimate: least and largest edge length over l* at which half of the bending was left,
/// and how many sheets never lost half.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Folds {
    pub(super) halved: [Real; 2],
    pub(super) locked: usize,
    pub(super) free: usize,
}

/// The diagonal fold for every pattern and both diagonals.
pub(super) fn folds(study: &mut StudyRun<'_>) -> Result<Folds, BenchError> {
    let scope = study.scope;
    let mut told = Folds {
        halved: [Real::MAX, 0.0],
        locked: 0,
        free: 0,
    };
    let mut series = Vec::new();
    let mut by_length = Vec::new();
    let mut table = Table::new(&[
        "pattern",
        "held diagonal",
        "cells",
        "Y",
        "l over l*",
        "rigidity over D",
        "fold angle",
        "exact angle",
        "bending reached",
        "membrane over bending",
        "iterations",
        "last move",
    ]);
    for (name, axis) in [("rising", Axis::Along), ("falling", Axis::Across)] {
        for pattern in PATTERNS {
            let mut points = Vec::new();
            let (mut reached, mut critical_lengths) = (Vec::new(), Vec::new());
            for &cells in fold_sizes(scope) {
                let mut curve: Vec<(Real, Real)> = Vec::new();
                let moduli = fold_moduli(scope, cells);
                let case_of = |modulus: &Real| {
                    format!("fold, {pattern}, {name}, {cells} cells, Y = {modulus:e}")
                };
                let every = study.cases.side_by_side(moduli, case_of, |&modulus| {
                    let stiffness = [modulus, RIGIDITY];
                    fold::fold(axis, pattern, cells, Kind::Springs, stiffness)?.figures()
                });
                for (&modulus, folded) in moduli.iter().zip(every) {
                    let Some(folded) = study.findings.unless_failed(&case_of(&modulus), folded)
                    else {
                        continue;
                    };
                    let critical =
                        critical_length(folded.radius, modulus, folded.factor * RIGIDITY);
                    let ratio = folded.edge_length / critical;
                    curve.push((ratio, folded.bending));
                    if modulus == SHOWN {
                        reached.push((folded.edge_length, folded.bending));
                        critical_lengths.push(critical);
                    }
                    table.push([
                        Cell::from(pattern),
                        Cell::from(name),
                        Cell::from(cells),
                        Cell::from(modulus),
                        Cell::from(ratio),
                        Cell::from(folded.factor),
                        Cell::from(folded.angle),
                        Cell::from(folded.exact_angle),
                        Cell::from(folded.bending),
                        Cell::from(folded.membrane),
                        Cell::from(folded.iterations as usize),
                        Cell::from(folded.last_move),
                    ]);
                }
                match halved_at(&curve) {
                    Some(ratio) => {
                        told.locked += 1;
                        widen(&mut told.halved, ratio);
                    }
                    None => told.free += 1,
                }
                points.extend(curve);
            }
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let label = format!("{pattern}, {name}");
            series.push(Series::new(&label, points).styled(Style::Points));
            if axis == Axis::Across {
                by_length.extend(against_length(pattern, reached, &critical_lengths));
            }
        }
    }
    let predicted = (0..=40).map(|i| {
        let ratio = 10.0_f64.powf(-1.0 + 0.045 * Real::from(i));
        (ratio, 1.0 / (1.0 + ratio.powi(4)))
    });
    series.push(Series::new("1/(1 + (l/l*)⁴)", predicted.collect()).styled(Style::ExactCurve));
    study.findings.plot(
        "locking-fold",
        &Plot {
            title: "How much of a diagonal fold a sheet of springs makes".into(),
            x: plot::Axis::log("edge length l over l* = (702 D R²/Y)^¼ (dimensionless)"),
            y: plot::Axis::linear("bending energy reached, over the developable answer (dimensionless)"),
            series,
            note: "The sheet hangs under its own weight, held along the named diagonal. The dashed curve is a guess from the estimate: a rigidity of D (1 + (l/l*)⁴) under the same load.".into(),
        },
    );
    study.findings.plot(
        "locking-length",
        &Plot {
            title: "Finer meshes fold".into(),
            x: plot::Axis::log("edge length l (m)"),
            y: plot::Axis::linear("bending energy reached, over the developable answer (dimensionless)"),
            series: by_length,
            note: format!(
                "Y = {SHOWN:e} N/m, held along the falling diagonal; from right to left the same sheet with finer and finer meshes. Dashed, in the colour of the mesh: 1/(1 + (l/l*)⁴), which is one half at l = l* = (702 D R²/Y)^¼, with the rigidity D that the mesh has about this diagonal and the radius R of its fold. A sheet free to curve across is softer than the developable answer, so 1 can be exceeded."
            ),
        },
    );
    study.findings.table(
        "locking-fold",
        "Diagonal folds of a sheet of springs",
        table,
    );
    Ok(told)
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
fn halved_at(curve: &[(Real, Real)]) -> Option<Real> {
    let half = 0.5 * curve.first()?.1;
    let pair = curve.windows(2).find(|pair| pair[1].1 <= half)?;
    let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
    let part = (y0 / half).ln() / (y0 / y1).ln();
    Some(x0 * (x1 / x0).powf(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_halved_where_it_crosses_half() {
        let power = |x: Real| (x, 3.0 * x.powi(-2));
        let curve = [power(1.0), power(1.3), power(5.0)];
        assert!((halved_at(&curve).unwrap() - 2.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(halved_at(&curve[..2]), None);
        assert_eq!(halved_at(&[]), None);
    }

    /// The estimate, `Y l⁴/(702 D R²)`, is the membrane over the bending energy of equilateral springs with all
    /// vertices on a cylinder of radius R: an edge at the angle φ to the axis is short by `l² sin⁴φ/(24 R²)`.
    #[test]
    fn the_estimate_is_the_energy_of_springs_on_a_cylinder() {
        use super::super::sheet::Sheet;
        use cloth_core::math::Vec3;
        use cloth_core::mesh::generate::equilateral;
        let (cells, radius, modulus) = (40, 20.0, 1e3);
        let mesh = equilateral(cells + 1, cells + 1, 1.0).unwrap();
        let sheet = Sheet::new(mesh, Kind::Springs, modulus, 1.0).unwrap();
        // The mean of sin⁸φ over three directions is that over all, 35/128, but for a term in cos 6φ.
        let energy = |turn: Real| {
            let axis = Vec3::new(turn.cos(), turn.sin(), 0.0);
            let across = Vec3::new(-axis.y, axis.x, 0.0);
            let rolled = sheet.placed(|p| {
                let s = across.dot(p) / radius;
                axis * axis.dot(p) + across * (radius * s.sin()) + Vec3::z() * (radius * s.cos())
            });
            sheet.membrane_energy(&rolled).unwrap() / sheet.bending_energy(&rolled).unwrap()
        };
        let mean = (0..6)
            .map(|k| energy(std::f64::consts::PI * Real::from(k) / 18.0))
            .sum::<Real>()
            / 6.0;
        let estimate = critical_length(radius, modulus, 1.0).powi(-4);
        let (rim, edges) = (mean / estimate, 3.0 / cells as Real);
        assert!((rim - 1.0).abs() < edges, "{rim}");
    }
}

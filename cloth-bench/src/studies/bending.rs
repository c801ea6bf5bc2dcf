//! How cloth bends: a heavy strip against its exact curve, and what each model amounts to on each pattern.

use crate::laws::elastica::{exact, sag};
use crate::laws::elements::{PATTERNS, Pattern};
use crate::laws::factors::{Case, SURFACES, by_hand, factor};
use crate::laws::models::{MODELS, Model};
use crate::laws::strip::Shape;
use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "bending",
    question: "Does one bending rigidity mean the same cloth in every bending model, and is it the one that was asked for?",
    about: "The strip is clamped at one end and hangs under its own weight, Γ = ρ g L³/D; its drop over span at rest is compared with the exact solution of θ″ + Γ(1 − s) cos θ = 0. \
        Its triangles are three times as high along the strip as wide across it: then the folds are the generators of a cylinder, no edge without a hinge lies across, and Poisson's ratio, \
        which the pattern decides and which is −1/3 for equilateral triangles, makes up 0.15 % at most. The factors are energies per area of vertices on a surface of constant \
        curvature, over ½ k κ² (sphere: ½ k (2κ)²); 3 on a cylinder is what D = 3k means. Settled: on the alternating grid vertices with four and with eight neighbours may stand at different heights, \
        as they do in equilibrium. Expect hinge models of the same D to hang alike; what surprises is the sphere, on which the factor is a third of that on a cylinder.",
    run,
};

/// Γ on which every model is measured.
fn loads(scope: Scope) -> &'static [Real] {
    scope.pick(
        &[0.1, 1.0, 10.0, 100.0, 1000.0],
        &[
            0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0,
        ],
    )
}

fn rows(scope: Scope) -> usize {
    scope.pick(128, 256)
}

/// Rows of the strips that show how the error falls, and their Γ.
const REFINED: [usize; 5] = [16, 32, 64, 128, 256];
const REFINED_LOADS: [Real; 2] = [100.0, 1000.0];
/// One model by the curvature vector and one by the angle: at rest the mesh is flat, and the others are the same.
const REFINED_MODELS: [(&str, Model); 2] = [MODELS[0], MODELS[2]];

/// A strip whose own error, of Poisson's ratio and of the rim, is 0.014 %.
const fn long_triangles(rows: usize) -> Shape {
    Shape {
        cells: rows - 2,
        across: 3,
        elongation: 8.0,
    }
}

const fn strip(rows: usize) -> Shape {
    Shape {
        cells: rows - 2,
        across: 5,
        elongation: 3.0,
    }
}

fn ratio(gamma: Real) -> Real {
    let profile = exact(gamma);
    profile.drop / profile.span
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let worst = elastica(study);
    refinement(study);
    let apart = factors(study);
    let on_curve = worst.is_some_and(|worst| worst < 0.01);
    let alike = if on_curve {
        "Every model lies on the curve of the heavy elastica"
    } else {
        "NOT every model lies on the curve of the heavy elastica"
    };
    let worst = worst.map_or("none was measured at every load".to_owned(), |worst| {
        format!("largest error {:.2} %", 100.0 * worst)
    });
    study.findings.section.verdict = Some(format!(
        "{alike} from Γ = 0.1 to 1000 on a strip of {} × 5 vertices ({worst}), so one rigidity D means one cloth. That holds where bending follows the edges: \
         the measured factors are those of the closed forms to {apart:.0e}, and they differ with pattern, direction and shape, from 1 to 18 for one k of the quadratic model.",
        rows(scope)
    ));
    Ok(())
}

/// A strip at rest.
#[derive(Default, Serialize, Deserialize)]
struct Hanging {
    /// Span W and drop H over the length (dimensionless).
    span: Real,
    drop: Real,
    /// Forces left over the weight (dimensionless).
    residual: Real,
    /// Iterations of Newton's method.
    iterations: u32,
}

impl Hanging {
    fn at_rest(gamma: Real, model: Model, shape: Shape) -> Result<Self, BenchError> {
        let sagged = sag(gamma, model, shape)?;
        Ok(Self {
            span: sagged.profile.span,
            drop: sagged.profile.drop,
            residual: sagged.rest.residual,
            iterations: sagged.rest.iterations,
        })
    }
}

/// H/W against Γ. Returns the largest relative error, or none if a strip did not come to rest.
fn elastica(study: &mut StudyRun<'_>) -> Option<Real> {
    let scope = study.scope;
    let mut table = Table::new(&[
        "model",
        "Γ",
        "H/W exact",
        "H/W measured",
        "relative error",
        "span W/L",
        "drop H/L",
        "forces left over weight",
        "iterations",
    ]);
    let (mut heights, mut errors) = (Vec::new(), Vec::new());
    let mut worst = Some(0.0);
    let loads: Vec<(Real, Real)> = loads(scope).iter().map(|&g| (g, ratio(g))).collect();
    for (name, model) in MODELS {
        let (mut curve, mut error_curve) = (Vec::new(), Vec::new());
        for &(gamma, expected) in &loads {
            let case = format!("{name}, Γ = {gamma}");
            let Some(found) =
                study.case(&case, || Hanging::at_rest(gamma, model, strip(rows(scope))))
            else {
                worst = None;
                continue;
            };
            let measured = found.drop / found.span;
            let error = measured / expected - 1.0;
            worst = worst.map(|worst: Real| worst.max(error.abs()));
            curve.push((gamma, measured));
            error_curve.push((gamma, 100.0 * error));
            table.push([
                Cell::from(name),
                Cell::from(gamma),
                Cell::from(expected),
                Cell::from(measured),
                Cell::from(error),
                Cell::from(found.span),
                Cell::from(found.drop),
                Cell::from(found.residual),
                Cell::from(found.iterations as usize),
            ]);
        }
        heights.push(Series::new(name, curve).styled(Style::Points));
        errors.push(Series::new(name, error_curve));
    }
    let exact_curve = (0..=40)
        .map(|i| 10.0_f64.powf(-1.0 + 0.1 * Real::from(i)))
        .map(|gamma| (gamma, ratio(gamma)))
        .collect();
    heights.push(Series::new("heavy elastica, exact", exact_curve).styled(Style::ExactCurve));
    study.findings.plot(
        "bending-elastica",
        &Plot {
            title: "A strip under its own weight".into(),
            x: Axis::log("Γ = ρ g L³/D (dimensionless)"),
            y: Axis::log("drop over span H/W (dimensionless)"),
            series: heights,
            note: "The dashed curve is the exact solution of θ″ + Γ(1 − s) cos θ = 0.".into(),
        },
    );
    study.findings.plot(
        "bending-elastica-error",
        &Plot {
            title: "Distance of the models from the exact curve".into(),
            x: Axis::log("Γ = ρ g L³/D (dimensionless)"),
            y: Axis::linear("error of H/W (%)"),
            series: errors,
            note: "On the left what is left of Poisson's ratio and the rim, which lacks hinges; on the right the resolution, where a fold θ and 2 sin(θ/2) are no longer the same."
                .into(),
        },
    );
    study.findings.table(
        "bending-elastica",
        "Drop over span of a heavy strip at rest",
        table,
    );
    worst
}

/// The error of H/W against resolution.
fn refinement(study: &mut StudyRun<'_>) {
    let mut table = Table::new(&["model", "Γ", "rows", "relative error of H/W"]);
    let mut series = Vec::new();
    for gamma in REFINED_LOADS {
        let expected = ratio(gamma);
        for (name, model) in REFINED_MODELS {
            let mut curve = Vec::new();
            for rows in REFINED {
                let case = format!("{name}, Γ = {gamma}, {rows} rows");
                let Some(found) = study.case(&case, || {
                    Hanging::at_rest(gamma, model, long_triangles(rows))
                }) else {
                    continue;
                };
                let error = found.drop / found.span / expected - 1.0;
                curve.push((rows as Real, 100.0 * error.abs()));
                table.push([
                    Cell::from(name),
                    Cell::from(gamma),
                    Cell::from(rows),
                    Cell::from(error),
                ]);
            }
            series.push(Series::new(&format!("{name}, Γ = {gamma}"), curve));
        }
    }
    let second = REFINED.map(|rows| (rows as Real, 2.0 * (32.0 / rows as Real).powi(2)));
    series.push(Series::new("second order", second.to_vec()).styled(Style::ExactCurve));
    study.findings.plot(
        "bending-refinement",
        &Plot {
            title: "Error of H/W against resolution".into(),
            x: Axis::log("rows of vertices along the strip (dimensionless)"),
            y: Axis::log("error of H/W (%)").within(0.01, 30.0),
            series,
            note: "Triangles eight times as high as wide, three vertices across: what the strip itself is wrong by, Poisson's ratio and the rim, is 0.014 %.".into(),
        },
    );
    study.findings.data("bending-refinement", table);
}

/// Directions of the curvature (degrees) of the cylinder that are measured, and of the points of the exact curve
/// between them.
fn directions(count: i32) -> impl Iterator<Item = Real> {
    (0..=count).map(move |step| 180.0 * Real::from(step) / Real::from(count))
}

/// What the table shows: surface, direction of its curvature (degrees), and whether the vertices have settled.
fn shown() -> [(usize, Real, bool); 8] {
    let [cylinder, sphere, saddle] = [0, 1, 2];
    [
        (cylinder, 0.0, false),
        (cylinder, 45.0, false),
        (sphere, 0.0, false),
        (saddle, 0.0, false),
        (saddle, 45.0, false),
        (cylinder, 0.0, true),
        (cylinder, 45.0, true),
        (sphere, 0.0, true),
    ]
}

/// A bending model on a pattern, on surface number `surface`.
fn bent(model: Model, pattern: Pattern, (surface, degrees, settled): (usize, Real, bool)) -> Case {
    Case {
        model,
        pattern,
        surface: SURFACES[surface].1,
        angle: degrees.to_radians(),
        settled,
    }
}

/// The factors of every model and pattern, and the factor of a cylinder by direction. Returns the largest relative
/// distance from the closed forms.
fn factors(study: &mut StudyRun<'_>) -> Real {
    let mut table = Table::new(&[
        "model",
        "pattern",
        "cylinder 0°",
        "cylinder 45°",
        "sphere",
        "saddle 0°",
        "saddle 45°",
        "settled: cylinder 0°",
        "settled: cylinder 45°",
        "settled: sphere",
    ]);
    let mut apart: Real = 0.0;
    for (name, model) in MODELS {
        for (pattern_name, pattern) in PATTERNS {
            let case = format!("{name} on {pattern_name}");
            let found: Result<Vec<[Real; 2]>, BenchError> = study.cases.case(&case, || {
                let of = |what| factor(bent(model, pattern, what));
                shown().into_iter().map(of).collect()
            });
            let Some(found) = study.findings.unless_failed(&case, found) else {
                continue;
            };
            let mut line = [const { Cell::Missing }; 10];
            line[0] = Cell::from(name);
            line[1] = Cell::from(pattern_name);
            for (cell, [expected, measured]) in line[2..].iter_mut().zip(found) {
                apart = apart.max((measured / expected - 1.0).abs());
                *cell = Cell::from(measured);
            }
            table.push(line);
        }
    }
    let (mut series, mut curves) = (Vec::new(), Vec::new());
    for (name, pattern) in PATTERNS {
        for settled in [false, true] {
            if settled && name != "alternating" {
                continue;
            }
            let label = if settled {
                format!("{name}, settled")
            } else {
                name.to_owned()
            };
            let at = |degrees| bent(Model::Bergou, pattern, (0, degrees, settled));
            let case = format!("cylinder on {label}");
            let found: Result<Vec<[Real; 2]>, BenchError> = study.cases.case(&case, || {
                directions(24).map(|degrees| factor(at(degrees))).collect()
            });
            let Some(found) = study.findings.unless_failed(&case, found) else {
                continue;
            };
            for [expected, measured] in &found {
                apart = apart.max((measured / expected - 1.0).abs());
            }
            let points = directions(24).zip(found.iter().map(|[_, measured]| *measured));
            series.push(Series::new(&label, points.collect()).styled(Style::Points));
            let exact = directions(72).map(|degrees| (degrees, by_hand(&at(degrees))));
            let exact = Series::new(&format!("{label}, exact"), exact.collect());
            curves.push(exact.styled(Style::ExactCurve));
        }
    }
    series.extend(curves);
    study.findings.plot(
        "bending-direction",
        &Plot {
            title: "Energy of a cylinder, by the direction in which it bends".into(),
            x: Axis::linear("direction of the curvature (degrees)"),
            y: Axis::linear("energy per area over ½ k κ² (dimensionless)"),
            series,
            note: "Quadratic model. Dashed: by hand, hinge by hinge.".into(),
        },
    );
    study.findings.table(
        "bending-factors",
        "Energy per area for coefficient k, over ½ k κ² (sphere: over ½ k (2κ)²)",
        table,
    );
    apart
}

//! How cloth bends: a heavy strip against its exact curve, and what each model amounts to on each pattern.

use crate::laws::elastica::{exact, sag};
use crate::laws::elements::Pattern;
use crate::laws::factors::{Case, Surface, by_hand, factor};
use crate::laws::models::{MODELS, Model};
use crate::laws::strip::Shape;
use crate::settings::Choice;
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
const LOADS: [&[Real]; 2] = [
    &[0.1, 10.0, 1000.0],
    &[
        0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0,
    ],
];
/// Rows of the strips.
const ROWS: [usize; 2] = [128, 256];
/// Rows of the strips that show how the error falls.
const REFINED: [&[usize]; 2] = [&[16, 32, 64, 128], &[16, 32, 64, 128, 256]];

/// Their Γ.
const REFINED_LOADS: [Real; 2] = [100.0, 1000.0];
/// One model by the curvature vector and one by the angle: at rest the mesh is flat, and the others are the same.
const REFINED_MODELS: [&str; 2] = [MODELS[0].0, MODELS[2].0];

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
    let worst = elastica(study);
    refinement(study);
    let apart = factors(study);
    let alike = match worst.is_some_and(|worst| worst < 0.01) {
        true => "Every model lies on the curve of the heavy elastica",
        false => "NOT every model lies on the curve of the heavy elastica",
    };
    let worst = worst.map_or("none was measured at every load".to_owned(), |worst| {
        format!("largest error {:.2} %", 100.0 * worst)
    });
    study.section.verdict = Some(format!(
        "{alike} from Γ = 0.1 to 1000 on a strip of {} × 5 vertices ({worst}), so there one rigidity D bends alike in all models; on other surfaces and patterns it does not.\nIt does where bending follows the edges: \
         the measured factors are those of the closed forms to {apart:.0e}, and they differ with pattern, direction and shape, from 1 to 18 for one k of the quadratic model.",
        study.scope.of(ROWS)
    ));
    Ok(())
}

/// A strip at rest.
#[derive(Default, Serialize, Deserialize)]
struct Hanging {
    #[serde(rename = "H/W exact")]
    exact: Real,
    #[serde(rename = "H/W measured")]
    measured: Real,
    relative_error: Real,
    /// Over the length, as the drop.
    #[serde(rename = "span W/L")]
    span: Real,
    #[serde(rename = "drop H/L")]
    drop: Real,
    forces_left_over_weight: Real,
    /// Of Newton's method.
    iterations: u32,
}

impl Hanging {
    fn at_rest(gamma: Real, model: Model, shape: Shape) -> Result<Self, BenchError> {
        let sagged = sag(gamma, model, shape)?;
        let (span, drop) = (sagged.profile.span, sagged.profile.drop);
        let (exact, measured) = (ratio(gamma), drop / span);
        Ok(Self {
            exact,
            measured,
            relative_error: measured / exact - 1.0,
            span,
            drop,
            forces_left_over_weight: sagged.rest.residual,
            iterations: sagged.rest.iterations,
        })
    }
}

/// H/W against Γ. Returns the largest relative error, or none if a strip did not come to rest.
fn elastica(study: &mut StudyRun<'_>) -> Option<Real> {
    let loads = study.scope.of(LOADS).iter().copied();
    let shape = strip(study.scope.of(ROWS));
    let points = iproduct!(MODELS.map(|(name, _)| name), loads);
    let asked = points.clone().count();
    let strips = study.grid_side_by_side(
        points,
        |(name, gamma)| format!("{name}, Γ = {gamma}"),
        |&(name, gamma)| Hanging::at_rest(gamma, Model::named(name), shape),
    );
    let exact = (0..=40).map(|i| 10.0_f64.powf(-1.0 + 0.1 * Real::from(i)));
    let load = Axis::log("Γ = ρ g L³/D (dimensionless)");
    let height = Axis::log("drop over span H/W (dimensionless)");
    let plot = Plot::new("A strip under its own weight", load.clone(), height)
        .points(curves(&strips, |((name, gamma), s)| {
            (*name, (*gamma, s.measured))
        }))
        .exact(
            "heavy elastica, exact",
            exact.map(|gamma| (gamma, ratio(gamma))),
        )
        .note("The dashed curve is the exact solution of θ″ + Γ(1 − s) cos θ = 0.");
    study.plot("bending-elastica", &plot);
    let errors = curves(&strips, |((name, gamma), s)| {
        (*name, (*gamma, 100.0 * s.relative_error))
    });
    let error = Axis::linear("error of H/W (%)");
    let plot = Plot::new("Distance of the models from the exact curve", load, error).with(errors).note(
        "On the left what is left of Poisson's ratio and the rim, which lacks hinges; on the right the resolution, where a fold θ and 2 sin(θ/2) are no longer the same.",
    );
    study.plot("bending-elastica-error", &plot);
    let table = Table::named(&["model", "Γ"], &strips);
    study.table(
        "bending-elastica",
        "Drop over span of a heavy strip at rest",
        table,
    );
    let errors = strips.iter().map(|(_, strip)| strip.relative_error.abs());
    (strips.len() == asked).then(|| largest(errors))
}

/// The error of H/W against resolution.
fn refinement(study: &mut StudyRun<'_>) {
    let rows = study.scope.of(REFINED).iter().copied();
    let points = iproduct!(REFINED_LOADS, REFINED_MODELS, rows.clone());
    let found = study.grid_side_by_side(
        points.map(|(gamma, name, rows)| (name, gamma, rows)),
        |(name, gamma, rows)| format!("{name}, Γ = {gamma}, {rows} rows"),
        |&(name, gamma, rows)| Hanging::at_rest(gamma, Model::named(name), long_triangles(rows)),
    );
    let strips = found
        .into_iter()
        .map(|(at, strip)| (at, strip.relative_error));
    let strips = strips.collect_vec();
    let second = rows.map(|rows| (rows as Real, 2.0 * (32.0 / rows as Real).powi(2)));
    let plot = Plot::new(
        "Error of H/W against resolution",
        Axis::log("rows of vertices along the strip (dimensionless)"),
        Axis::log("error of H/W (%)").within(0.01, 30.0),
    )
    .with(curves(&strips, |((name, gamma, rows), error)| {
        (format!("{name}, Γ = {gamma}"), (*rows as Real, 100.0 * error.abs()))
    }))
    .exact("second order", second)
    .note("Triangles eight times as high as wide, three vertices across: what the strip itself is wrong by, Poisson's ratio and the rim, is 0.014 %.");
    study.plot("bending-refinement", &plot);
    let names = ["model", "Γ", "rows", "relative error of H/W"];
    study.data("bending-refinement", Table::named(&names, &strips));
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
        surface: Surface::NAMES[surface].1,
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
    let found = study.grid_side_by_side(
        iproduct!(MODELS, Pattern::NAMES),
        |((name, _), (pattern, _))| format!("{name} on {pattern}"),
        |&((_, model), (_, pattern))| {
            let factors = shown().map(|what| factor(bent(model, *pattern, what)));
            factors.into_iter().try_collect::<_, Vec<_>, _>()
        },
    );
    for (((name, _), (pattern, _)), found) in &found {
        let measured = found.iter().map(|[_, measured]| Cell::from(*measured));
        table.line(*name, [Cell::from(*pattern)].into_iter().chain(measured));
    }
    let settling = Pattern::NAMES.iter().flat_map(|&(name, pattern)| {
        let label = format!("{name}, settled");
        let settled = (name == "alternating").then_some((label, pattern, true));
        std::iter::once((name.to_owned(), pattern, false)).chain(settled)
    });
    let at = |pattern, settled, degrees| bent(Model::Bergou, pattern, (0, degrees, settled));
    let by_direction = study.grid_side_by_side(
        settling,
        |(label, ..)| format!("cylinder on {label}"),
        |&(_, pattern, settled)| {
            let factors = directions(24).map(|degrees| factor(at(pattern, settled, degrees)));
            factors.try_collect::<_, Vec<_>, _>()
        },
    );
    let measured = by_direction.iter().map(|((label, ..), found)| {
        let points = directions(24).zip(found.iter().map(|[_, measured]| *measured));
        Series::new(label, points.collect())
    });
    let exact = by_direction.iter().map(|((label, pattern, settled), _)| {
        let by_hand = |degrees| (degrees, by_hand(&at(*pattern, *settled, degrees)));
        let label = format!("{label}, exact");
        Series::new(&label, directions(72).map(by_hand).collect())
    });
    let plot = Plot::new(
        "Energy of a cylinder, by the direction in which it bends",
        Axis::linear("direction of the curvature (degrees)"),
        Axis::linear("energy per area over ½ k κ² (dimensionless)"),
    );
    let plot = plot.points(measured).exact_curves(exact);
    let plot = plot.note("Quadratic model. Dashed: by hand, hinge by hinge.");
    study.plot("bending-direction", &plot);
    study.table(
        "bending-factors",
        "Energy per area for coefficient k, over ½ k κ² (sphere: over ½ k (2κ)²)",
        table,
    );
    let all = found.iter().map(|(_, found)| found);
    let all = all
        .chain(by_direction.iter().map(|(_, found)| found))
        .flatten();
    largest(all.map(|[expected, measured]| (measured / expected - 1.0).abs()))
}

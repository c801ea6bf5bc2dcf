//! The same drape on every mesh and with every step, and what its error costs.

use crate::studies::meshes_and_steps::{MeshesAndSteps, OverConverged, Point};
use crate::studies::prelude::*;

/// Time of the comparison (s): the sheet has wrapped the upper half of the sphere, and its corners swing.
const SECONDS: Real = 0.4;
fn methods() -> Vec<&'static str> {
    method::with_own(&[
        "implicit-euler",
        "linear-implicit",
        "bdf2",
        "pbd",
        "xpbd",
        "pd",
    ])
}

fn meshes_and_steps(scope: Scope) -> MeshesAndSteps {
    let (sizes, rates): (&[u32], &[u32]) = scope.pick(
        (&[7, 9], &[30, 60, 120]),
        (&[17, 25, 33, 49], &[30, 60, 120, 240]),
    );
    let middle = sizes[1];
    MeshesAndSteps {
        sizes,
        rates,
        middle,
    }
}

/// Vertices a side and steps per second of the converged value.
fn finest(scope: Scope) -> (u32, u32) {
    scope.pick((9, 240), (49, 480))
}

/// A sheet on a sphere at the end.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Draped {
    /// Of the centre of mass.
    #[serde(rename = "fall (m)")]
    fall: Number,
    /// None before there is a converged value.
    fall_over_converged: Option<Number>,
    /// Of an edge.
    largest_stretch: Number,
    /// Energy from nowhere.
    excess_over_given_energy: Number,
    crossing_pairs: usize,
    ms_per_step: Number,
}

fn drape(name: &str, n: u32, rate: u32) -> Result<Draped, BenchError> {
    let scene = scene::build("drape-sphere", None, &Settings::default().with("n", n))?;
    let steps = (SECONDS * Real::from(rate)).round() as u32;
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let dt = 1.0 / Real::from(rate);
    let (end, _) = run::from_start(&scene, method, &settings, dt, steps, |_, _, _| Ok(()))?;
    Ok(Draped {
        fall: Number(end.center_of_mass_drop),
        fall_over_converged: None,
        largest_stretch: Number(end.max_stretch),
        excess_over_given_energy: Number(
            end.energy_excess / end.energy_given.max(Real::MIN_POSITIVE),
        ),
        crossing_pairs: end.intersections.unwrap_or(0) + end.obstacle_intersections.unwrap_or(0),
        ms_per_step: Number(end.ms_per_step_median),
    })
}

pub(super) fn run(study: &mut StudyRun<'_>) {
    let grid = meshes_and_steps(study.scope);
    let (finest_n, finest_rate) = finest(study.scope);
    let mut converged = |n: u32| {
        let case = format!("a converged drape, {n} × {n}");
        Some(study.case(&case, || drape("bdf2", n, finest_rate))?.fall.0)
    };
    let Some(of_size) = converged(finest_n) else {
        return;
    };
    // Rates are compared on one mesh, with what converges there.
    let of_step = if grid.middle == finest_n {
        Some(of_size)
    } else {
        converged(grid.middle)
    };
    let Some(of_step) = of_step else { return };
    let mut rows = study.grid(
        grid.points(&methods()),
        |Point {
             method,
             vertices_a_side: n,
             steps_per_second: rate,
         }| { format!("a drape by {method}, {n} vertices a side, 1/{rate} s") },
        |point| drape(point.method, point.vertices_a_side, point.steps_per_second),
    );
    for (_, row) in &mut rows {
        row.fall_over_converged = Some(Number(row.fall.0 / of_size));
    }
    let over =
        |(point, row): &(Point, Draped)| (*point, [row.fall.0 / of_size, row.fall.0 / of_step]);
    let falls: Vec<OverConverged> = rows.iter().map(over).collect();
    let work = curves(grid.by_step(&rows), |(point, row)| {
        let seconds = 1e-3 * row.ms_per_step.0 * Real::from(point.steps_per_second);
        (point.method, (seconds, (row.fall.0 / of_step - 1.0).abs()))
    });
    let fall = Axis::linear("fall over converged (dimensionless)");
    let on_sphere = "The fall of a sheet on a sphere, steps of 1/60 s";
    let cost = Plot::new(
        "What the error of the fall costs, steps of 1/30 s and finer",
        Axis::log("time per simulated second (s)"),
        Axis::log("|fall over converged − 1| (dimensionless)"),
    );
    for (name, plot) in [
        ("size", grid.plot_by_size(on_sphere, fall.clone(), &falls)),
        (
            "rate",
            grid.plot_by_step("The same on one mesh", fall, &falls),
        ),
        ("work", cost.with(work)),
    ] {
        let plot = plot.note("Converged is BDF2 with the shortest step.");
        study.findings.plot(&format!("contact-{name}"), &plot);
    }
    study.findings.table(
        "contact-drape",
        &format!("A sheet of 1 m × 1 m on a sphere of 0.3 m after {SECONDS} s, every method at its default"),
        Table::of(&rows),
    );
    let mut ranges = Table::new(&["method", "over all meshes", "over all steps"]);
    for method in methods() {
        ranges.line(method, grid.ranges(method, &falls).map(Cell::said));
    }
    study.findings.answer(
        "Is it the same drape on every mesh and at every frame rate?",
        format!(
            "The fall of the centre of mass within {SECONDS} s, over that of the converged motion; a sheet that buckles scatters by a few per cent:"
        ),
        Some(ranges),
        "figure-contact-rate",
    );
}

//! The same motion in contact on every mesh and with every step, and what its error costs.

use super::survival::scene_of;
use crate::studies::meshes_and_steps::{MeshesAndSteps, OverConverged, Point};
use crate::studies::prelude::*;
use crate::studies::work_precision::distance;

/// Time of the comparison (s): a sheet has wrapped the upper half of a sphere, and its corners swing; a strip has
/// folded onto itself; sheets lie on each other; a sleeve hangs on an arm.
const SECONDS: Real = 0.4;
const SCENES: [&str; 4] = ["drape-sphere", "fold", "stack", "sleeve"];

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
const FINEST: [(u32, u32); 2] = [(9, 240), (49, 480)];

/// Cloth in contact at the end.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Ended {
    /// Of the centre of mass.
    #[serde(rename = "fall (m)")]
    fall: Number,
    /// None before there is a converged value.
    fall_over_converged: Option<Number>,
    /// ‖x − x_ref‖_M/(√Σm · L), on the mesh that has a converged motion.
    distance_from_converged: Option<Number>,
    /// The same over that of the start: 1 for cloth that does not move.
    distance_over_motion: Option<Number>,
    /// Of an edge.
    largest_stretch: Number,
    /// Energy from nowhere.
    excess_over_given_energy: Number,
    crossing_pairs: usize,
    ms_per_step: Number,
}

/// Cloth at the end of its motion, and its positions (m).
pub fn follow(scene: &Scene, name: &str, rate: u32) -> Result<(Ended, Vec<Vec3>), BenchError> {
    let steps = (SECONDS * Real::from(rate)).round() as u32;
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let dt = 1.0 / Real::from(rate);
    let (end, state) = run::simulate(scene, method, &settings, dt, steps)?;
    let ended = Ended {
        fall: Number(end.center_of_mass_drop),
        fall_over_converged: None,
        distance_from_converged: None,
        distance_over_motion: None,
        largest_stretch: Number(end.max_stretch),
        excess_over_given_energy: Number(
            end.energy_excess / end.energy_given.max(Real::MIN_POSITIVE),
        ),
        crossing_pairs: end.intersections.unwrap_or(0) + end.obstacle_intersections.unwrap_or(0),
        ms_per_step: Number(end.ms_per_step_median),
    };
    Ok((ended, state.positions))
}

pub(super) fn run(study: &mut StudyRun<'_>) {
    let (mut rows, mut all_falls) = (Vec::new(), Vec::new());
    for scene in SCENES {
        let Some((ours, falls)) = of_scene(study, scene) else {
            return;
        };
        rows.extend(ours.into_iter().map(|row| (scene, row)));
        all_falls.push(falls);
    }
    study.table(
        "contact-motion",
        &format!("Cloth in contact after {SECONDS} s, by the methods that people take for it (not explicit ones, midpoint and the direct solver, which take minutes), at their defaults"),
        Table::named(&["scene"], &rows),
    );
    let grid = meshes_and_steps(study.scope);
    let mut ranges = Table::about("method", SCENES.map(str::to_owned));
    for method in methods() {
        let of_scene = |falls: &Vec<OverConverged>| Cell::said(&grid.ranges(method, falls)[1]);
        ranges.line(method, all_falls.iter().map(of_scene));
    }
    study.answer(
        "Is it the same motion in contact at every frame rate?",
        format!(
            "The fall of the centre of mass within {SECONDS} s, over that of the converged motion, over all steps; a sheet that buckles scatters by a few per cent:"
        ),
        Some(ranges),
        "figure-contact-drape-sphere-rate",
    );
    let mut cheapest = Table::about(
        "scene",
        WANTED.map(|wanted| format!("to {}", percent(wanted))),
    );
    for scene in SCENES {
        let points = rows.iter().filter(|(of, _)| *of == scene);
        let points = points.filter_map(|(_, (point, row))| {
            let (method, rate) = (point.method, point.steps_per_second);
            let ms = row.ms_per_step.0 * SECONDS * Real::from(rate);
            Some((
                format!("{method}, 1/{rate} s"),
                row.distance_over_motion?.0,
                ms,
            ))
        });
        let named = points.collect_vec();
        let points = || {
            named
                .iter()
                .map(|(label, error, ms)| (&**label, *error, *ms))
        };
        // Converged is BDF2 with the shortest step: how far the same is off with twice that tells how well it is known.
        let of_bdf2 = rows
            .iter()
            .filter(|(of, (point, _))| (*of, point.method) == (scene, "bdf2"));
        let of_bdf2 = of_bdf2.filter(|(_, (_, row))| row.distance_over_motion.is_some());
        let finest = of_bdf2.max_by_key(|(_, (point, _))| point.steps_per_second);
        let doubt = finest.and_then(|(_, (_, row))| row.distance_over_motion);
        let doubt = doubt.map_or(Real::INFINITY, |doubt| doubt.0);
        let cells = WANTED.map(|wanted| match wanted < doubt {
            true => Cell::said(format!("not decidable, known to {}", percent(doubt))),
            false => fastest_to(wanted, points()),
        });
        cheapest.line(scene, cells);
    }
    study.answer(
        "What does an error of the motion in contact cost?",
        format!(
            "The fastest through {SECONDS} s that ends within a part of the converged motion, ‖x − x_ref‖_M/‖x(0) − x_ref‖_M (cloth that never moves is at 1); not decidable where the converged motion itself is known less well:"
        ),
        Some(cheapest),
        "figure-contact-drape-sphere-distance",
    );
}

/// Distances from the converged motion over that motion (dimensionless) that are asked for.
const WANTED: [Real; 3] = [1e-1, 3e-2, 1e-2];

/// What a scene has shown: its runs, and their falls over the converged one.
type Shown = (Vec<(Point, Ended)>, Vec<OverConverged>);

/// The runs of a scene, with its plots; none if another run has what they are compared with.
fn of_scene(study: &mut StudyRun<'_>, scene: &'static str) -> Option<Shown> {
    let grid = meshes_and_steps(study.scope);
    let (finest_n, finest_rate) = study.scope.of(FINEST);
    let case = |n: u32| format!("a converged {scene}, {n} × {n}");
    let follow_converged = |n| follow(&scene_of(scene, n, "")?, "bdf2", finest_rate);
    // Steps are compared on one mesh, with what converges there.
    let middle = grid.middle;
    let mut converged = LazyCell::new(|| follow_converged(middle));
    let (Number(of_step), Number(moved)) = study.case(&case(middle), || {
        let ((ended, end), sheet) = (converged.get()?, scene_of(scene, middle, "")?);
        let moved = distance(&sheet, &sheet.start.positions, end);
        Ok((ended.fall, Number(moved)))
    })?;
    let of_size = match middle == finest_n {
        true => of_step,
        false => {
            study
                .case(&case(finest_n), || Ok(follow_converged(finest_n)?.0.fall))?
                .0
        }
    };
    let mut rows = study.grid(
        grid.points(&methods()),
        |point| format!("{scene} by {point}"),
        |point| {
            let sheet = scene_of(scene, point.vertices_a_side, "")?;
            let (mut ended, end) = follow(&sheet, point.method, point.steps_per_second)?;
            if point.vertices_a_side == middle {
                let converged = &converged.get()?.1;
                ended.distance_from_converged = Some(Number(distance(&sheet, &end, converged)));
            }
            Ok(ended)
        },
    );
    for (_, row) in &mut rows {
        row.fall_over_converged = Some(Number(row.fall.0 / of_size));
        let distance = row.distance_from_converged;
        row.distance_over_motion = distance.map(|distance| Number(distance.0 / moved));
    }
    let over =
        |(point, row): &(Point, Ended)| (*point, [row.fall.0 / of_size, row.fall.0 / of_step]);
    let falls: Vec<OverConverged> = rows.iter().map(over).collect();
    let seconds = |(point, row): &(Point, Ended)| {
        1e-3 * row.ms_per_step.0 * Real::from(point.steps_per_second)
    };
    let work = curves(grid.by_step(&rows), |row| {
        (
            row.0.method,
            (seconds(row), (row.1.fall.0 / of_step - 1.0).abs()),
        )
    });
    let distances = grid.by_step(&rows).into_iter();
    let distances = distances.filter_map(|row| Some((row, row.1.distance_from_converged?.0)));
    let away = curves(distances, |(row, distance)| {
        (row.0.method, (seconds(row), distance))
    });
    let fall = Axis::linear("fall over converged (dimensionless)");
    let by_size = format!("The fall of {scene}, steps of 1/60 s");
    let by_step = format!("The same of {scene} on one mesh");
    let cost = |of: &str, error: &str| {
        Plot::new(
            format!("What the error of {of} costs, {scene}, steps of 1/30 s and finer"),
            Axis::log("time per simulated second (s)"),
            Axis::log(&format!("{error} (dimensionless)")),
        )
    };
    let off = cost("the fall", "|fall over converged − 1|");
    let distance = cost("the motion", "‖x − x_ref‖_M/(√Σm · L)");
    for (name, plot) in [
        ("size", grid.plot_by_size(&by_size, fall.clone(), &falls)),
        ("rate", grid.plot_by_step(&by_step, fall, &falls)),
        ("work", off.with(work)),
        ("distance", distance.with(away)),
    ] {
        let plot = plot.note("Converged is BDF2 with the shortest step.");
        let name = format!("contact-{scene}-{name}");
        study.plot(&name, &plot);
    }
    Some((rows, falls))
}

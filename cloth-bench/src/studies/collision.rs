//! Scenes with contact, by every kind of method: what it costs, and whether anything crosses; and the
//! continuous queries that it rests on.

mod crumple;
mod queries;

use crate::report::render::{Projection, View};
use crate::run::{SeparationWatch, Watched};
use crate::studies::pictures::{Shot, coordinates, pictures};
use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "collision",
    question: "What does contact cost each method, and does anything pass through anything?",
    about: "Six scenes with four methods at their default settings. Every method feels the same contact potential in its own solve: as an energy, or as constraints in every substep. A cell fails with one crossing pair after any step, with the cloth or a body, and with energy from nowhere: more than the start, gravity, moving pins and bodies gave, by more than a hundredth of the most. After every step \
        crossing pairs of triangles are counted by an exact test that shares no code with the response, and distances are measured: of parts of the cloth that share no vertex, and of vertices from \
        obstacles. Expect no crossing at all, and energy from nowhere with PBD, whose sweeps end early and leave stretch that no force has made; where a step is refused, the remark says why. Expect soft methods to need more contact: their cloth stretches, so more of it lies on itself. \
        A distance of cloth from cloth below the thickness is allowed, one below zero of a vertex from an obstacle is not. Queries: single pairs in motion, whose answer is known exactly because it was chosen first; \
        the conservative method must miss none and may report near ones. The times of a query are the shortest of several calls. \
        Crumpled sheet: an accordion of sixteen layers, 1.1 thicknesses apart on average, of ever finer triangles; what the search for candidates costs, and a step that presses it to nine tenths of its height.",
    run,
};

/// Scenes, with the mesh where it is not the scene's own: a garment is a tube here.
const SCENES: [&str; 6] = [
    "drape-sphere",
    "drape-box",
    "fold",
    "twist",
    "stack",
    "drop",
];

/// A scene of its size, and the number of its steps.
fn scene_of(scope: Scope, name: &str) -> Result<(Scene, u32), BenchError> {
    let (n, steps) = size(scope, name);
    let settings = Settings::default();
    let scene = match (name, scope) {
        ("drop", Scope::Quick) => garment("tube:16x8")?,
        ("drop", Scope::Full) => garment("tube:48x24")?,
        _ => scene::build(name, None, &settings.with("n", n))?,
    };
    let steps = steps.unwrap_or(scene.steps);
    Ok((scene, steps))
}

/// The tube `mesh` above a floor, able to touch itself.
pub(super) fn garment(mesh: &str) -> Result<Scene, BenchError> {
    let settings = Settings::default().with("floor", "0.2").with("self", "yes");
    scene::build("drop", Some(mesh), &settings)
}

fn methods() -> Vec<&'static str> {
    method::with_own(&["implicit-euler", "pbd", "xpbd", "pd"])
}

/// Vertices a side, and the number of steps where it is not the scene's own.
fn size(scope: Scope, scene: &str) -> (u32, Option<u32>) {
    match (scope, scene) {
        (Scope::Quick, "stack") => (5, Some(20)),
        (Scope::Quick, _) => (13, Some(20)),
        (Scope::Full, "stack") => (9, None),
        (Scope::Full, "drop") => (0, Some(60)),
        // With half of that, five vertices across, layers hook into each other, and what the towel ends with is chance.
        (Scope::Full, "twist") => (65, None),
        (Scope::Full, _) => (33, None),
    }
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let told = [
        Some(run_scenes(study)?),
        Some(queries::run(study)),
        crumple::run(study),
    ];
    study.section.verdict = Some(told.into_iter().flatten().join("\n"));
    Ok(())
}

/// What came of a scene with one method.
#[derive(Default, Serialize, Deserialize)]
struct Ran {
    /// None of a run that ended early, for the reason in the remark.
    summary: Option<run::Summary>,
    remark: String,
    seen: Watched,
    /// Steps taken.
    steps: usize,
    /// Time (s) and positions (m) at the end.
    time: Real,
    positions: Vec<[Real; 3]>,
}

fn ran(scene: &Scene, steps: u32, method: &str) -> Result<Ran, BenchError> {
    let method = Method::find(method)?;
    let settings = method.by_default(Settings::default());
    let mut stepper = method.build(scene, &settings, scene.dt)?;
    let mut watch = SeparationWatch::new(scene)?;
    let mut state = scene.start.clone();
    let (dt, look) = (scene.dt, |_: u32, state: &State, _: &_| {
        watch.look(scene, state)
    });
    let outcome = run::run(scene, &mut *stepper, &mut state, dt, steps, look);
    let (summary, remark) = match outcome {
        Ok(summary) => (Some(summary), String::new()),
        Err(error) => (None, error.to_string()),
    };
    Ok(Ran {
        summary,
        remark,
        seen: watch.seen(),
        steps: state.steps as usize,
        time: state.time,
        positions: coordinates(state.positions),
    })
}

/// What a cell says that does not fail.
const PASSES: &str = "passes";

/// A scene with one method; where a run ended early, the remark says why.
#[derive(Default, Serialize)]
struct Row {
    scene: &'static str,
    method: &'static str,
    vertices: usize,
    steps: usize,
    ms_per_step: Option<Real>,
    #[serde(rename = "of it contact (ms)")]
    contact_ms: Option<Real>,
    truncated_steps: Option<u32>,
    steps_with_crossings: u32,
    #[serde(rename = "steps that cross a body")]
    steps_in_bodies: u32,
    #[serde(rename = "smallest distance (m)")]
    min_distance: Option<Real>,
    #[serde(rename = "smallest clearance (m)")]
    min_clearance: Option<Real>,
    largest_stretch: Option<Real>,
    rms_strain: Option<Real>,
    #[serde(rename = "kinetic and elastic energy (J)")]
    energy: Option<Real>,
    #[serde(rename = "energy beyond what was given (J)")]
    energy_excess: Option<Real>,
    #[serde(rename = "most that was given (J)")]
    energy_given: Option<Real>,
    cell: String,
    remark: String,
}

impl Row {
    fn new(scene: &'static str, method: &'static str, ran: &Ran) -> Self {
        let Ran { summary, seen, .. } = ran;
        let gains = |s: &run::Summary| s.energy_warning().is_some();
        let failures = [
            (
                seen.crossed_steps + seen.obstacle_crossed_steps > 0,
                "crosses",
            ),
            (summary.as_ref().is_some_and(gains), "energy from nowhere"),
            (summary.is_none(), "ended early"),
        ];
        let failures = failures.iter().filter(|(fails, _)| *fails);
        let of = |value: fn(&run::Summary) -> Real| summary.as_ref().map(value);
        Self {
            scene,
            method,
            vertices: ran.positions.len(),
            steps: ran.steps,
            ms_per_step: of(|s| s.ms_per_step_median),
            contact_ms: of(|s| s.contact_ms_median),
            truncated_steps: summary.as_ref().map(|s| s.truncated_steps),
            steps_with_crossings: seen.crossed_steps,
            steps_in_bodies: seen.obstacle_crossed_steps,
            min_distance: seen.min_distance,
            min_clearance: seen.min_clearance,
            largest_stretch: of(|s| s.max_stretch),
            rms_strain: of(|s| s.rms_strain),
            energy: of(|s| s.kinetic_energy + s.elastic_energy),
            energy_excess: of(|s| s.energy_excess),
            energy_given: of(|s| s.energy_given),
            cell: match failures.map(|(_, failure)| failure).join(", ") {
                none if none.is_empty() => PASSES.to_owned(),
                failures => failures,
            },
            remark: ran.remark.clone(),
        }
    }
}

/// Adds the table and the pictures; returns what they say in words.
fn run_scenes(study: &mut StudyRun<'_>) -> Result<String, BenchError> {
    let mut rows: Vec<Row> = Vec::new();
    for name in SCENES {
        let (scene, steps) = scene_of(study.scope, name)?;
        let found = study.grid(
            methods(),
            |method| format!("{name}, {method}"),
            |method| ran(&scene, steps, method),
        );
        let found = found
            .into_iter()
            .filter(|(_, ran)| !ran.positions.is_empty());
        let shots = found.filter_map(|(method, ran)| {
            rows.push(Row::new(name, method, &ran));
            Shot::of(format!("{name}, {method}"), &ran.positions, ran.time)
        });
        let shots = shots.collect_vec();
        let view = View {
            width: 330,
            height: 330,
            direction: Vec3::new(-0.5, 0.8, -0.5),
            // A floor is larger than what lies on it, and may reach behind an eye that is near.
            projection: Projection::Orthographic,
            bounds: Some(around(&shots)),
            ..View::default()
        };
        let pictures = pictures(&scene, &shots, &view)?;
        study.section.pictures.extend(pictures);
    }
    study.table("collision", "Scenes with contact", &rows);
    let cells = SCENES.len() * methods().len();
    let failures = rows.iter().filter(|row| row.cell != PASSES).map(|row| {
        let energy = row.energy_excess.zip(row.energy_given);
        let energy = energy.map_or(String::new(), |(excess, given)| {
            format!(", {} J beyond {} J", two(excess), two(given))
        });
        format!("{} on {} ({}{energy})", row.method, row.scene, row.cell)
    });
    let failures = match failures.collect_vec() {
        none if none.is_empty() => String::new(),
        some => format!(" These fail: {}.", some.join("; ")),
    };
    let passed = rows.iter().filter(|row| row.cell == PASSES).count();
    let share = |row: &Row| Some(100.0 * row.contact_ms? / row.ms_per_step?);
    let mut shares = rows.iter().filter_map(share).collect_vec();
    let most = largest(shares.iter().copied());
    Ok(format!(
        "Of {cells} runs {passed} pass: they end, no triangles cross after any step, and the cloth never holds more than it was given by more than a hundredth of the most.{failures} Contact takes {:.0} % of a step in the median run, and at most {most:.0} %.",
        median(&mut shares),
    ))
}

/// A box (m) around all cloths, with some room.
fn around(shots: &[Shot]) -> [Vec3; 2] {
    let [low, high] = bounds(shots.iter().flat_map(|shot| &shot.positions).copied());
    let room = Vec3::repeat(0.05 * (high - low).norm());
    [low - room, high + room]
}

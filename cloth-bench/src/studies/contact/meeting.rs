//! Two sheets that meet in free flight: contact gives one what it takes from the other.

use super::laws::{THICKNESS, methods};
use crate::studies::prelude::*;
use cloth_core::measure::angular_momentum;
use std::path::Path;

/// Two sheets that have met.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Met {
    /// Mean relative velocity along their normal at the end (m/s), below zero if they still near each other.
    #[serde(rename = "velocity of parting (m/s)")]
    pub parting: Number,
    /// Change of the linear momentum over that of one sheet (dimensionless).
    #[serde(rename = "drift of momentum")]
    pub drift: Number,
    /// Change of the angular momentum about the origin over that of one sheet (dimensionless).
    #[serde(rename = "drift of angular momentum")]
    pub spin: Number,
}

/// Two sheets in free flight, each at half of a speed (m/s) towards the other, half a second after they could touch.
pub fn meet(name: &str, speed: Real) -> Result<Met, BenchError> {
    let text = format!(
        "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\n\
        [[mesh]]\ngenerator = \"grid:9x9:crossed\"\nscale = 0.9\ntranslate = [0.05, 0.05, 0.01]\n\
        [contact]\nself = true\nthickness = {THICKNESS:?}\nfriction = 0\n"
    );
    let mut scene =
        scene::file::build_text(Path::new("meeting.toml"), &text, &Settings::default())?;
    let mass = scene.model.particles.mass().to_vec();
    let lower = 81; // vertices
    for (v, x) in scene.start.velocities.iter_mut().enumerate() {
        x.z = if v < lower { 0.5 * speed } else { -0.5 * speed };
    }
    // (kg m/s) of the lower sheet and of the upper one.
    let momentum = |velocities: &[Vec3]| {
        let of = |sheet: std::ops::Range<usize>| -> Vec3 {
            sheet.map(|v| velocities[v] * mass[v]).sum()
        };
        [of(0..lower), of(lower..mass.len())]
    };
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let steps = ((0.5 + 0.01 / speed) / scene.dt).round() as u32;
    let (_, end) = run::simulate(&scene, method, &settings, scene.dt, steps)?;
    let before = momentum(&scene.start.velocities);
    let after = momentum(&end.velocities);
    let weights = [&mass[..lower], &mass[lower..]].map(|mass| mass.iter().sum::<Real>());
    let spin = |state: &State| angular_momentum(&scene.model.particles, state);
    let mut alone = scene.start.clone();
    alone.velocities[lower..].fill(Vec3::zeros());
    let gained = after[0] + after[1] - before[0] - before[1];
    Ok(Met {
        parting: Number(after[1].z / weights[1] - after[0].z / weights[0]),
        drift: Number(gained.norm() / before[0].norm()),
        spin: Number((spin(&end) - spin(&scene.start)).norm() / spin(&alone).norm()),
    })
}

/// Speeds (m/s), in the quick scope and in the full one.
const SPEEDS: [&[Real]; 2] = [&[1.0], &[0.05, 0.1, 0.2, 0.5, 1.0, 2.0]];

/// Two sheets that meet in free flight, by every method.
pub(super) fn run(study: &mut StudyRun<'_>) {
    let speeds = study.scope.of(SPEEDS);
    let rows = study.grid_side_by_side(
        iproduct!(methods(), speeds.iter().copied()),
        |(method, speed)| format!("sheets that meet with {speed} m/s by {method}"),
        |&(method, speed)| meet(method, speed),
    );
    let parting = curves(&rows, |((method, speed), met)| {
        (*method, (*speed, met.parting.0 / speed))
    });
    let plot = Plot::new(
        "How fast two sheets part that have met in free flight",
        Axis::log("relative speed before (m/s)"),
        Axis::linear("relative velocity after, over that (dimensionless)"),
    );
    let bounds = [("elastic", 1.0), ("inelastic", 0.0)].map(|(label, e)| {
        let curve = speeds.iter().map(|&speed| (speed, e));
        Series::new(label, curve.collect())
    });
    study.plot(
        "contact-meeting",
        &plot.points(parting).exact_curves(bounds),
    );
    study.table(
        "contact-meeting",
        "Two sheets that meet in free flight, without friction: what is left of it in their bending may part them",
        Table::named(&["method", "speed (m/s)"], &rows),
    );
}

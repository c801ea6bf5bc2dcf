//! What a file says that is seldom meant: most of it are numbers in other units.

use super::document::Section;
use super::keys::{self, Event, Piece};
use crate::bounds::bounds;
use crate::error::BenchError;
use crate::scene::Scene;
use cloth_core::math::{Real, Vec3};
use std::f64::consts::TAU;

/// Of a rotation (rad) beyond one turn.
pub(super) fn of_rotations(
    meshes: &[Section<'_>],
    obstacles: &[Section<'_>],
) -> Result<Vec<String>, BenchError> {
    let pieces = meshes.iter().map(|section| {
        let rotate = *section.read::<Piece>()?.rotate;
        Ok((section, rotate))
    });
    let bodies = obstacles.iter().map(|section| {
        let rotate = *section.read::<keys::Obstacle>()?.rotate;
        Ok((section, rotate))
    });
    let all: Vec<_> = pieces.chain(bodies).collect::<Result<_, BenchError>>()?;
    let all = all.into_iter();
    let angles = all.filter_map(|(section, rotate)| Some((section, rotate?.norm())));
    let turned = angles.filter(|(_, angle)| *angle > TAU);
    Ok(turned
        .map(|(section, angle)| {
            let place = section.place();
            format!(
                "{place}rotate is by {angle} rad, more than one turn: 90 degrees are 1.5708 rad"
            )
        })
        .collect())
}

/// Where the file has each event, and its time (s).
pub(super) fn event_times(events: &[Section<'_>]) -> Result<Vec<(String, Real)>, BenchError> {
    let time = |section: &Section<'_>| {
        let time = section.read::<Event>()?.time(section)?;
        Ok((section.place(), time))
    };
    events.iter().map(time).collect()
}

/// Of a cloth that is hundreds of times as large as all bodies.
pub(super) fn of_sizes(scene: &Scene) -> Option<String> {
    /// So many times.
    const FAR: Real = 300.0;
    let size = |[low, high]: [Vec3; 2]| (high - low).norm();
    let cloth = size(bounds(scene.start.positions.iter().copied()));
    let bodies = scene.obstacle_surfaces(0.0);
    let sizes = bodies.iter().map(|(x, _)| size(bounds(x.iter().copied())));
    let body = sizes.reduce(Real::max)?;
    (cloth > FAR * body).then(|| {
        format!("the cloth is {cloth:.3} m large, and the largest body {body:.3} m: all lengths are in metres")
    })
}

//! What a file says that is seldom meant: most of it are numbers in other units.

use super::document::Section;
use super::keys::{Event, Force, Hold, Obstacle, Piece, Seam, Way};
use crate::bounds::bounds;
use crate::error::BenchError;
use crate::scene::Scene;
use cloth_core::math::{Real, Vec3};
use std::f64::consts::TAU;

/// Of a rotation (rad) beyond one turn, and of pins that make as many turns as a round number of degrees would be.
pub(super) fn of_rotations(
    [meshes, obstacles, pins, events]: [&[Section<'_>]; 4],
) -> Result<Vec<String>, BenchError> {
    let ways = pins.iter().chain(events).map(|section| {
        let turn = section.read::<Way>()?.turn;
        Ok((section, turn.unwrap_or_default().norm()))
    });
    let ways: Vec<_> = ways.collect::<Result<_, BenchError>>()?;
    let in_degrees = ways
        .into_iter()
        .filter(|(_, angle)| *angle > TAU && angle % 5.0 == 0.0);
    let pieces = meshes.iter().map(|section| {
        let rotate = *section.read::<Piece>()?.rotate;
        Ok((section, rotate))
    });
    let bodies = obstacles.iter().map(|section| {
        let rotate = *section.read::<Obstacle>()?.rotate;
        Ok((section, rotate))
    });
    let all: Vec<_> = pieces.chain(bodies).collect::<Result<_, BenchError>>()?;
    let all = all.into_iter();
    let angles = all.filter_map(|(section, rotate)| Some((section, rotate?.norm())));
    let turned = angles.filter(|(_, angle)| *angle > TAU);
    let rotate = turned.map(|(section, angle)| {
        let place = section.place();
        format!("{place}rotate is by {angle} rad, more than one turn: 90 degrees are 1.5708 rad")
    });
    let turn = in_degrees.map(|(section, angle)| {
        let (place, turns) = (section.place(), angle / TAU);
        format!("{place}turn is by {angle} rad, {turns:.2} turns: 90 degrees are 1.5708 rad")
    });
    Ok(rotate.chain(turn).collect())
}

/// What begins at a time: tables, and the time (s) of one.
type Timed<'a> = (
    &'a [Section<'a>],
    fn(&Section<'_>) -> Result<Real, BenchError>,
);

/// Where the file has what happens on the way, and when (s): events, pins, forces and seams that begin later, and
/// bodies that are released.
pub(super) fn event_times(
    [events, pins, forces, seams, bodies]: [&[Section<'_>]; 5],
) -> Result<Vec<(String, Real)>, BenchError> {
    let all: [Timed<'_>; 5] = [
        (events, |section| section.read::<Event>()?.time(section)),
        (pins, |section| Ok(*section.read::<Hold>()?.from)),
        (forces, |section| Ok(*section.read::<Force>()?.from)),
        (seams, |section| Ok(*section.read::<Seam>()?.from)),
        (bodies, |section| {
            Ok(section.read::<Obstacle>()?.released.unwrap_or_default())
        }),
    ];
    let mut times = Vec::new();
    for (sections, time) in all {
        for section in sections {
            let time = time(section)?;
            if time > 0.0 {
                times.push((section.place(), time));
            }
        }
    }
    Ok(times)
}

/// Of animations with more than a second between two shapes.
pub(super) fn of_intervals(obstacles: &[Section<'_>]) -> Result<Vec<String>, BenchError> {
    /// As long (s).
    const LONG: Real = 1.0;
    let mut hints = Vec::new();
    for section in obstacles {
        let interval = section.read::<Obstacle>()?.interval;
        if let Some(long) = interval.filter(|seconds| *seconds > LONG) {
            hints.push(format!(
                "{}interval is {long} s from one shape to the next: {long} shapes a second are an interval of {:.4}",
                interval.place(),
                1.0 / long
            ));
        }
    }
    Ok(hints)
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

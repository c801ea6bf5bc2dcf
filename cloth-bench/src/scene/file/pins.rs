//! `[[pins]]`: held vertices and their ways.

use super::document::Section;
use super::keys::{BOX, CENTRE, DURATION, MOVE, SELECT, TURN, VERTICES};
use crate::error::BenchError;
use crate::names;
use crate::scene::pins;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::Particles;
use cloth_core::pin::Pins;
use nalgebra::{Rotation3, Unit};

/// The vertices that a table holds, in the caller's numbers.
pub(super) fn chosen(
    section: &Section<'_>,
    positions: &[Vec3],
    up: Vec3,
) -> Result<Vec<usize>, BenchError> {
    let select = section.text(&SELECT)?;
    let numbers = section.counts(&VERTICES)?;
    let corners = section.corners(&BOX)?;
    match (select, numbers, corners) {
        (Some(name), None, None) => {
            let known = ["corners", "highest"];
            if known.contains(&name) {
                return pins::chosen(name, positions, up);
            }
            Err(section.refuse(&SELECT, names::unknown("selection", name, &known)))
        }
        (None, Some(numbers), None) => {
            let beyond = numbers.iter().find(|&&n| n >= positions.len() as u64);
            match beyond {
                None => Ok(numbers.into_iter().map(|n| n as usize).collect()),
                Some(vertex) => {
                    let count = positions.len();
                    let message =
                        format!("there is no vertex {vertex}, only {count}, counted from 0");
                    Err(section.refuse(&VERTICES, message))
                }
            }
        }
        (None, None, Some([a, b])) => {
            let (low, high) = (a.inf(&b), a.sup(&b));
            let inside = |x: &Vec3| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&x[axis]));
            let found: Vec<usize> = (0..positions.len())
                .filter(|&v| inside(&positions[v]))
                .collect();
            if found.is_empty() {
                return Err(section.refuse(&BOX, "there is no vertex in the box"));
            }
            Ok(found)
        }
        _ => Err(section.refuse_table("needs one of the keys select, vertices and box")),
    }
}

/// Holds vertices, and adds their ways if they have any.
pub(super) fn hold(
    section: &Section<'_>,
    vertices: &[usize],
    positions: &[Vec3],
    particles: &mut Particles,
    pins: &mut Pins,
) -> Result<(), BenchError> {
    let duration = section.positive(&DURATION)?.unwrap_or(1.0);
    let shift = section.vector(&MOVE)?;
    let turn = section.vector(&TURN)?;
    let centre = section.vector(&CENTRE)?.unwrap_or_default();
    for key in [&CENTRE, &DURATION] {
        let is_used = turn.is_some() || (key.name == DURATION.name && shift.is_some());
        if section.value(key).is_some() && !is_used {
            let message = format!("{} has no meaning without a turn or a move", key.name);
            return Err(section.refuse(key, message));
        }
    }
    let shift_by = shift.unwrap_or_default();
    let axis = Unit::try_new_and_get(turn.unwrap_or_default(), 0.0);
    for &vertex in vertices {
        let held = particles.prescribe(vertex);
        held.map_err(|error| section.refuse_table(error))?;
        if turn.is_none() && shift.is_none() {
            continue;
        }
        let from_centre = positions[vertex] - centre;
        let path = move |time: Real| {
            let part = (time / duration).clamp(0.0, 1.0);
            let turned = match &axis {
                Some((axis, angle)) => Rotation3::from_axis_angle(axis, part * angle) * from_centre,
                None => from_centre,
            };
            centre + turned + shift_by * part
        };
        pins.follow(particles, vertex, path)
            .map_err(|error| section.refuse_table(error))?;
    }
    Ok(())
}

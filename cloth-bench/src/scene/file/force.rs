//! `[[force]]`: forces on chosen vertices, for some time or for ever.

use super::document::Section;
use super::keys::{FORCE, FORCE_FROM, FORCE_UNTIL};
use crate::error::BenchError;
use crate::scene::{Change, ChangeKind};
use cloth_core::particles::Particles;

/// The force that a table lets act on these vertices; `changes` are those of the pins.
pub(super) fn push(
    section: &Section<'_>,
    vertices: Vec<usize>,
    particles: &Particles,
    changes: &[Change],
) -> Result<Change, BenchError> {
    let force = section.vector(&FORCE)?;
    let force = force.ok_or_else(|| section.refuse_table("needs a force"))?;
    if force.norm() == 0.0 {
        return Err(section.refuse(&FORCE, "force is zero, which does nothing"));
    }
    let from = section.not_negative(&FORCE_FROM)?.unwrap_or(0.0);
    let until = section.not_negative(&FORCE_UNTIL)?;
    if until.is_some_and(|until| until <= from) {
        let message = format!("until has to be later than from, which is {from} s");
        return Err(section.refuse(&FORCE_UNTIL, message));
    }
    let is_released = |vertex: &usize| {
        changes.iter().any(|change| match &change.kind {
            ChangeKind::Release { vertices } => vertices.contains(vertex),
            _ => false,
        })
    };
    let moves = |vertex: &usize| !particles.is_prescribed(*vertex) || is_released(vertex);
    if !vertices.iter().any(moves) {
        return Err(section.refuse_table("has no effect: all of its vertices are held for ever"));
    }
    Ok(Change {
        time: from,
        kind: ChangeKind::Push {
            vertices,
            force,
            until,
        },
    })
}

//! `[[force]]`: forces on chosen vertices, for some time or for ever.

use super::document::Section;
use super::keys::Force;
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
    let own = section.read::<Force>()?;
    let force = own
        .force
        .ok_or_else(|| section.refuse_table("needs a force"))?;
    if force.norm() == 0.0 {
        return Err(own.force.refuse("force is zero, which does nothing"));
    }
    let (from, until) = (*own.from, *own.until);
    if until.is_some_and(|until| until <= from) {
        let message = format!("until has to be later than from, which is {from} s");
        return Err(own.until.refuse(message));
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

//! `[[event]]`: vertices that are grabbed, dragged and released. Tears are beside.

use super::document::Section;
use super::keys::{Deed, Event, Way};
use super::pins;
use crate::error::BenchError;
use crate::scene::{Change, ChangeKind};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::particles::Particles;
use cloth_core::pin::PinMotion;

impl Event {
    /// What is done.
    pub(super) fn deed(&self, section: &Section<'_>) -> Result<Deed, BenchError> {
        let kinds = "needs do = \"grab\", \"drag\", \"release\" or \"tear\"";
        (*self.deed).ok_or_else(|| section.refuse_table(kinds))
    }

    /// When (s).
    pub(super) fn time(&self, section: &Section<'_>) -> Result<Real, BenchError> {
        (*self.time).ok_or_else(|| section.refuse_table("needs a time"))
    }
}

/// The vertices of an event, in the caller's numbers; none of a tear.
pub(super) fn chosen(
    section: &Section<'_>,
    mesh: &TriMesh,
    up: Vec3,
) -> Result<Vec<usize>, BenchError> {
    match section.read::<Event>()?.deed(section)? {
        Deed::Tear => Ok(Vec::new()),
        Deed::Grab | Deed::Drag | Deed::Release => pins::chosen(section, mesh, up),
    }
}

/// Refuses a motion where there is none.
pub(super) fn refuse_motion(section: &Section<'_>, there: &str) -> Result<(), BenchError> {
    let way = section.read::<Way>()?;
    let keys = [way.shift.bare(), way.turn.bare(), way.centre.bare()];
    let mut keys = keys.into_iter().chain([way.duration.bare()]);
    keys.try_for_each(|key| key.refuse_given(there))
}

/// What the events do to these vertices, in the order of their times. Pins hold the prescribed ones for ever, and those
/// of `timed` otherwise; `name` has the caller's number of a vertex.
pub(super) fn changes(
    sections: &[Section<'_>],
    vertices: Vec<Vec<usize>>,
    (particles, timed): (&Particles, &[usize]),
    name: impl Fn(usize) -> usize,
) -> Result<Vec<Change>, BenchError> {
    let mut events = Vec::new();
    for (section, vertices) in sections.iter().zip(vertices) {
        let own = section.read::<Event>()?;
        let (deed, time) = (own.deed(section)?, own.time(section)?);
        if deed != Deed::Tear {
            own.line.refuse_given("but for a tear")?;
            events.push((time, deed, section, vertices));
        }
    }
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut is_held: Vec<bool> = (0..particles.len())
        .map(|v| particles.is_prescribed(v))
        .collect();
    let mut changes = Vec::new();
    for (time, deed, section, vertices) in events {
        for &v in &vertices {
            let wrong = if timed.contains(&v) {
                "is held by [[pins]] for some time or by a spring"
            } else if deed == Deed::Grab && is_held[v] {
                "is held already"
            } else if deed != Deed::Grab && !is_held[v] {
                "is not held"
            } else {
                is_held[v] = deed != Deed::Release;
                continue;
            };
            let message = format!("at {time} s vertex {} {wrong}", name(v));
            return Err(section.refuse_table(message));
        }
        let kind = if deed == Deed::Release {
            refuse_motion(section, "for a release")?;
            ChangeKind::Release { vertices }
        } else {
            let motion = pins::motion(section)?;
            if deed == Deed::Drag && motion.is_none() {
                return Err(section.refuse_table("a drag needs a move or a turn"));
            }
            let motion = motion.unwrap_or(PinMotion::NONE);
            ChangeKind::Hold { vertices, motion }
        };
        changes.push(Change { time, kind });
    }
    Ok(changes)
}

//! `[[event]]`: vertices that are grabbed, dragged and released, and bodies that are driven. Tears are beside.

use super::document::Section;
use super::keys::{Deed, Event, Obstacle, Selection, Way};
use super::pins;
use super::selection::Pieces;
use crate::error::BenchError;
use crate::names;
use crate::scene::{Change, ChangeKind, ContactSetup, HeldMotion};
use cloth_core::math::Real;
use cloth_core::particles::Particles;
use cloth_core::pin::PinMotion;

impl Event {
    /// What is done.
    pub(super) fn deed(&self, section: &Section<'_>) -> Result<Deed, BenchError> {
        let kinds = "needs do = \"grab\", \"drag\", \"release\", \"tear\" or \"drive\"";
        (*self.deed).ok_or_else(|| section.refuse_table(kinds))
    }

    /// When (s).
    pub(super) fn time(&self, section: &Section<'_>) -> Result<Real, BenchError> {
        (*self.time).ok_or_else(|| section.refuse_table("needs a time"))
    }
}

/// The vertices of an event, in the caller's numbers; none of a tear or of a body.
pub(super) fn chosen(section: &Section<'_>, pieces: &Pieces<'_>) -> Result<Vec<usize>, BenchError> {
    match section.read::<Event>()?.deed(section)? {
        Deed::Tear | Deed::Drive => Ok(Vec::new()),
        Deed::Grab | Deed::Drag | Deed::Release => pieces.chosen(section),
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
/// of `timed` otherwise; of the former a body takes the `carried` ones along, each with its number. `name` has the
/// caller's number of a vertex.
pub(super) fn changes(
    sections: &[Section<'_>],
    vertices: Vec<Vec<usize>>,
    (particles, timed, carried): (&Particles, &[usize], &[(usize, usize)]),
    name: impl Fn(usize) -> usize,
) -> Result<Vec<Change>, BenchError> {
    let mut events = Vec::new();
    for (section, vertices) in sections.iter().zip(vertices) {
        let own = section.read::<Event>()?;
        let (deed, time) = (own.deed(section)?, own.time(section)?);
        if deed != Deed::Tear {
            own.line.refuse_given("but for a tear")?;
        }
        if deed != Deed::Drive {
            let velocities = [own.velocity.bare(), own.angular_velocity.bare()];
            own.obstacle.refuse_given("but for a drive")?;
            for key in velocities {
                key.refuse_given("but for a drive")?;
            }
        }
        if !matches!(deed, Deed::Tear | Deed::Drive) {
            events.push((time, deed, section, vertices));
        }
    }
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut is_held: Vec<bool> = (0..particles.len())
        .map(|v| particles.is_prescribed(v))
        .collect();
    let mut body_of: Vec<Option<usize>> = vec![None; particles.len()];
    for &(vertex, body) in carried {
        body_of[vertex] = Some(body);
    }
    let mut changes = Vec::new();
    for (time, deed, section, vertices) in events {
        for &v in &vertices {
            let wrong = if timed.contains(&v) {
                "is held by [[pins]] for some time or by a spring".into()
            } else if deed == Deed::Grab && is_held[v] {
                "is held already".into()
            } else if deed != Deed::Grab && !is_held[v] {
                "is not held".into()
            } else if let (Deed::Drag, Some(body)) = (deed, body_of[v]) {
                format!(
                    "goes with obstacle {body}, and a drag would take it off: release and grab it instead"
                )
            } else {
                body_of[v] = body_of[v].filter(|_| deed != Deed::Release);
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
            let motion = HeldMotion::Own(motion.unwrap_or(PinMotion::NONE));
            ChangeKind::Hold { vertices, motion }
        };
        changes.push(Change { time, kind });
    }
    Ok(changes)
}

/// What happens to the bodies of contact: those that events drive, and those that are held until they are released.
pub(super) fn of_bodies(
    events: &[Section<'_>],
    obstacles: &[Section<'_>],
    touch: &mut ContactSetup,
) -> Result<Vec<Change>, BenchError> {
    let mut changes = Vec::new();
    for section in events {
        let own = section.read::<Event>()?;
        if own.deed(section)? != Deed::Drive {
            continue;
        }
        refuse_motion(section, "for a drive")?;
        let chosen = section.read::<Selection>()?;
        for key in [
            chosen.mesh.bare(),
            chosen.select.bare(),
            chosen.vertices.bare(),
            chosen.corners.bare(),
        ] {
            key.refuse_given("for a drive")?;
        }
        let number = *own.obstacle;
        let number = number.ok_or_else(|| section.refuse_table("a drive needs an obstacle"))?;
        let wrong = |why: String| Err(own.obstacle.refuse(why));
        if number as usize >= obstacles.len() {
            return wrong(names::beyond("obstacle", number, obstacles.len()));
        }
        let number = number as usize;
        let body = match touch.rigid_body(number) {
            None => return wrong(format!("the files of obstacle {number} say how it moves")),
            Some(body) if touch.is_free(body) => {
                return wrong(format!(
                    "obstacle {number} has a mass, and moves as it is pushed"
                ));
            }
            Some(body) => body,
        };
        let velocities = [&own.velocity, &own.angular_velocity].map(|v| v.unwrap_or_default());
        touch.driven.push(body);
        let kind = ChangeKind::Drive { body, velocities };
        let time = own.time(section)?;
        changes.push(Change { time, kind });
    }
    for (number, section) in obstacles.iter().enumerate() {
        let own = section.read::<Obstacle>()?;
        let Some(time) = *own.released else {
            continue;
        };
        let Some(body) = touch.rigid_body(number).filter(|&body| touch.is_free(body)) else {
            own.released.refuse_without("a mass or a density")?;
            continue;
        };
        for key in [own.velocity.bare(), own.angular_velocity.bare()] {
            key.refuse_given("with released: it starts from rest")?;
        }
        touch.held.push(body);
        let kind = ChangeKind::LetGo { body };
        changes.push(Change { time, kind });
    }
    Ok(changes)
}

//! `[[pins]]`: held vertices and their ways.

use super::document::Section;
use super::event;
use super::keys::{self, Way};
use crate::error::BenchError;
use crate::names;
use crate::scene::{Change, ChangeKind, ContactSetup, HeldMotion};
use cloth_core::cloth::{ClothModel, Elements};
use cloth_core::energy::SoftPin;
use cloth_core::math::{Real, Vec3};
use cloth_core::pin::{PinMotion, Pins};

/// Vertices that are held for some time.
pub(super) struct Hold {
    pub(super) vertices: Vec<usize>,
    motion: Option<HeldMotion>,
    /// Of the spring of each (N/m); infinite if it is held.
    stiffness: Real,
    from: Real,
    until: Option<Real>,
}

/// How a table says that its vertices move, if they do.
pub(super) fn motion(section: &Section<'_>) -> Result<Option<PinMotion>, BenchError> {
    let own = section.read::<Way>()?;
    let (shift, turn) = (*own.shift, *own.turn);
    if turn.is_none() {
        own.centre.refuse_without("a turn or a move")?;
    }
    if turn.is_none() && shift.is_none() {
        own.duration.refuse_without("a turn or a move")?;
        return Ok(None);
    }
    Ok(Some(PinMotion {
        shift: shift.unwrap_or_default(),
        turn: turn.unwrap_or_default(),
        centre: own.centre.unwrap_or_default(),
        duration: *own.duration,
    }))
}

/// What a table says of these vertices.
pub(super) fn hold(section: &Section<'_>, vertices: Vec<usize>) -> Result<Hold, BenchError> {
    let own = section.read::<keys::Hold>()?;
    let (from, until) = (*own.from, *own.until);
    if until.is_some_and(|until| until <= from) {
        let message = format!("until has to be later than from, which is {from} s");
        return Err(own.until.refuse(message));
    }
    let motion = match *own.obstacle {
        None => motion(section)?.map(HeldMotion::Own),
        Some(number) => {
            event::refuse_motion(section, "with an obstacle: it says how they move")?;
            own.stiffness
                .refuse_given("with an obstacle, which takes along what is held")?;
            Some(HeldMotion::With(number as usize))
        }
    };
    Ok(Hold {
        vertices,
        motion,
        stiffness: own.stiffness.number(),
        from,
        until,
    })
}

/// Refuses vertices that two tables hold at the same time, unless both do so for ever, without a spring and with the
/// same motion. `name` has the caller's number of a vertex.
pub(super) fn refuse_overlap(
    sections: &[Section<'_>],
    holds: &[Hold],
    name: impl Fn(usize) -> usize,
) -> Result<(), BenchError> {
    for (later, (section, hold)) in sections.iter().zip(holds).enumerate() {
        let end = |hold: &Hold| hold.until.unwrap_or(Real::INFINITY);
        for (before, other) in sections.iter().zip(holds).take(later) {
            let meet = hold.from < end(other) && other.from < end(hold);
            let agree = !hold.is_timed() && !other.is_timed() && hold.motion == other.motion;
            if !meet || agree {
                continue;
            }
            let both = hold.vertices.iter().find(|v| other.vertices.contains(v));
            if let Some(vertex) = both {
                let (vertex, place) = (name(*vertex), before.place());
                let place = place.trim_end_matches(": ");
                let message = format!("vertex {vertex} is held at the same time by {place}");
                return Err(section.refuse_table(message));
            }
        }
    }
    Ok(())
}

impl Hold {
    /// Whether it is anything but holding for ever.
    pub(super) fn is_timed(&self) -> bool {
        self.from > 0.0 || self.until.is_some() || self.stiffness.is_finite()
    }

    /// Refuses a body that is not there, or that moves as it is pushed.
    pub(super) fn check(
        &self,
        section: &Section<'_>,
        touch: &ContactSetup,
    ) -> Result<(), BenchError> {
        let Some(HeldMotion::With(number)) = self.motion else {
            return Ok(());
        };
        let own = section.read::<keys::Hold>()?.obstacle;
        let count = touch.body_numbers().len();
        if number >= count {
            return Err(own.refuse(names::beyond("obstacle", number as u32, count)));
        }
        match touch.rigid_body(number).filter(|&body| touch.is_free(body)) {
            Some(_) => Err(own.refuse(format!(
                "obstacle {number} has a mass, and moves as it is pushed: it cannot take vertices along"
            ))),
            None => Ok(()),
        }
    }

    /// Holds the vertices from the start on, or later; and releases them, if they are not held for ever. Those that
    /// go with a body from the start on are told, with its number.
    pub(super) fn apply(
        self,
        section: &Section<'_>,
        positions: &[Vec3],
        model: &mut ClothModel,
        pins: &mut Pins,
        changes: &mut Vec<Change>,
    ) -> Result<Option<(Vec<usize>, usize)>, BenchError> {
        let Self {
            vertices,
            motion: given,
            stiffness,
            from,
            until,
        } = self;
        let own = match given {
            Some(HeldMotion::Own(motion)) => motion,
            _ => PinMotion::NONE,
        };
        let is_soft = stiffness.is_finite();
        if let Some(time) = until {
            let vertices = vertices.clone();
            let kind = match is_soft {
                true => ChangeKind::Untie { vertices },
                false => ChangeKind::Release { vertices },
            };
            changes.push(Change { time, kind });
        }
        if from > 0.0 {
            let kind = match is_soft {
                true => ChangeKind::Tie {
                    vertices,
                    stiffness,
                    motion: own,
                },
                false => ChangeKind::Hold {
                    vertices,
                    motion: given.unwrap_or(HeldMotion::Own(own)),
                },
            };
            changes.push(Change { time: from, kind });
        } else if is_soft {
            let tie = |&v: &usize| SoftPin::new(v as u32, stiffness, positions[v], own, 0.0);
            let ties = vertices.iter().map(tie).collect();
            model.fasten([Elements::SoftPins(ties)]);
        } else {
            for &vertex in &vertices {
                let (particles, start) = (&mut model.particles, positions[vertex]);
                let path = move |time| own.position(start, 0.0, time);
                let held = match given {
                    Some(HeldMotion::Own(_)) => pins.add_path(particles, vertex, path),
                    _ => particles.prescribe(vertex),
                };
                held.map_err(|error| section.refuse_table(error))?;
            }
            if let Some(HeldMotion::With(body)) = given {
                return Ok(Some((vertices, body)));
            }
        }
        Ok(None)
    }
}

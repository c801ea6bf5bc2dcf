//! Which time of the state the bodies belong to: they go on by themselves, and a state that somebody has put back does
//! not take them along.

use super::surfaces::PotentialContacts;
use cloth_core::contact::ContactError;
use cloth_core::math::Real;
use std::sync::atomic::{AtomicU64, Ordering};

/// How far a step may begin from where the last one ended, as a fraction of its size: times are sums of steps, which
/// whoever runs a method adds up in another order.
const SLACK: Real = 1e-3;

/// The times (s) of the state at which steps begin.
#[derive(Debug)]
pub(super) struct Clock {
    /// The one that a step is about to begin at, as bits; of no number if nobody has said so.
    asked: AtomicU64,
    /// The one that belongs to `Surfaces::begun`; none before the first step.
    begun: Option<Real>,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            asked: AtomicU64::new(Real::NAN.to_bits()),
            begun: None,
        }
    }
}

impl Clone for Clock {
    fn clone(&self) -> Self {
        Self {
            asked: AtomicU64::new(self.asked.load(Ordering::Relaxed)),
            begun: self.begun,
        }
    }
}

impl Clock {
    /// Another step is to begin `elapsed` (s) after the last one.
    pub(super) fn advance(&mut self, elapsed: Real) {
        self.begun = self.begun.map(|time| time + elapsed);
    }

    /// It has begun, where somebody has said.
    pub(super) fn begin(&mut self) {
        let asked = Real::from_bits(*self.asked.get_mut());
        if asked.is_finite() {
            self.begun = Some(asked);
        }
        *self.asked.get_mut() = Real::NAN.to_bits();
    }
}

impl PotentialContacts {
    /// Takes the last step back: the next one begins where that has begun, with bodies as they were there, and of a
    /// method that minimises friction too. The positions of the cloth are the caller's.
    pub fn take_back(&mut self) {
        if !std::mem::replace(&mut self.contacts.is_open, true) {
            self.contacts.tangential.take_back();
        }
    }

    /// The next step begins at this time (s) of the state, with everything that moves where it is now: for whoever sets
    /// the clock of the state anew, and means the bodies to stay.
    pub fn continue_at(&mut self, time: Real) {
        self.close();
        self.surfaces.begun = self.surfaces.time;
        self.surfaces.clock.begun = time.is_finite().then_some(time);
    }

    /// Takes back a step that has not ended: the next one begins where that has begun.
    pub(super) fn close(&mut self) {
        if self.contacts.take_back() {
            self.surfaces.time = self.surfaces.begun;
        }
    }

    /// Whether a body moves, or may.
    fn has_moving_bodies(&self) -> bool {
        let mut obstacles = self.contacts.bodies.iter();
        obstacles.any(|(body, _)| !body.motion().is_still()) || self.surfaces.animated(0).is_some()
    }

    /// See [`ContactSource::check_time`](cloth_core::contact::ContactSource::check_time).
    pub(super) fn check_clock(&self, time: Real, dt: Real) -> Result<(), ContactError> {
        let surfaces = &self.surfaces;
        // Of a step that has not ended nothing counts.
        let elapsed = match self.contacts.is_open {
            true => 0.0,
            false => surfaces.time - surfaces.begun,
        };
        let expected = surfaces.clock.begun.map(|begun| begun + elapsed);
        let is_far = |expected: &Real| {
            (time - expected).abs() > SLACK * dt + 8.0 * Real::EPSILON * time.abs()
        };
        if let Some(expected) = expected.filter(is_far)
            && self.has_moving_bodies()
        {
            return Err(ContactError::WrongTime { time, expected });
        }
        let asked = &surfaces.clock.asked;
        asked.store(time.to_bits(), Ordering::Relaxed);
        Ok(())
    }
}

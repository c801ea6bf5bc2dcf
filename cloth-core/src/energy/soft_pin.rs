//! A vertex tied to a point that moves.

use super::Attachment;
use crate::element::{Constraint, Element, Projective, Row, RowForm};
use crate::error::OutOfRange;
use crate::math::{Real, Vec3};
use crate::pin::PinMotion;

/// An [`Attachment`] whose point moves: `E = ½ k ‖x − p(t)‖²` (J).
///
/// A force F on the vertex takes it F/k away from the point. Methods tell the time by [`Element::set_time`]; the matrix
/// of projective dynamics has k in it and not p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftPin {
    vertex: u32,
    stiffness: Real,
    start: Vec3,
    motion: PinMotion,
    since: Real,
    /// p (m) at the time that was set last.
    target: Vec3,
}

impl SoftPin {
    /// A pin of `stiffness` k (N/m) whose point is at `start` (m) until the time `since` (s), and moves from then on.
    #[must_use]
    pub fn new(vertex: u32, stiffness: Real, start: Vec3, motion: PinMotion, since: Real) -> Self {
        Self {
            vertex,
            stiffness,
            start,
            motion,
            since,
            target: start,
        }
    }

    /// The vertex.
    #[must_use]
    pub fn vertex(&self) -> u32 {
        self.vertex
    }

    /// Stiffness k (N/m).
    #[must_use]
    pub fn stiffness(&self) -> Real {
        self.stiffness
    }

    /// How its point moves.
    #[must_use]
    pub fn motion(&self) -> &PinMotion {
        &self.motion
    }

    /// Its point p (m) at a time (s).
    #[must_use]
    pub fn target_at(&self, time: Real) -> Vec3 {
        self.motion.position(self.start, self.since, time)
    }

    #[inline(always)]
    fn attachment(&self) -> Attachment {
        Attachment {
            vertex: self.vertex,
            target: self.target,
            stiffness: self.stiffness,
        }
    }
}

impl Element<1> for SoftPin {
    const CHANGES_WITH_TIME: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 1] {
        [self.vertex]
    }

    fn set_time(&mut self, time: Real) {
        self.target = self.target_at(time);
    }

    fn check(&self) -> Result<(), OutOfRange> {
        self.attachment().check()
    }
}

impl Constraint<1> for SoftPin {
    type Rows = [Row<1>; 3];

    const ROWS_ARE_LINEAR: bool = true;

    #[inline]
    fn rows(&self, x: &[Vec3; 1]) -> [Row<1>; 3] {
        self.attachment().rows(x)
    }

    #[inline(always)]
    fn row_form(&self, x: &[Vec3; 1]) -> RowForm<1> {
        self.attachment().row_form(x)
    }
}

impl Projective<1, 1> for SoftPin {
    const PROJECTION_IS_CONSTANT: bool = true;

    #[inline]
    fn operator(&self) -> [[Real; 1]; 1] {
        self.attachment().operator()
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, z: [Vec3; 1]) -> [Vec3; 1] {
        self.attachment().project(z)
    }
}

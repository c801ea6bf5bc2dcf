//! A shape whose origin is elsewhere.

use super::{Distance, SignedDistance};
use crate::bounds::Bounds;
use cloth_core::math::{Real, Vec3};

/// A shape that is `shift` (m) away from where it describes itself: for a body whose centre of mass, the origin of its
/// frame, is not the middle of its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shifted<S> {
    /// The shape.
    pub shape: S,
    /// How far it is moved (m).
    pub shift: Vec3,
}

impl<S: SignedDistance> SignedDistance for Shifted<S> {
    fn signed_distance(&self, point: Vec3) -> Distance {
        self.shape.signed_distance(point - self.shift)
    }

    fn each_part(&self, point: Vec3, range: Real, visit: &mut dyn FnMut(Distance, Real)) {
        self.shape.each_part(point - self.shift, range, visit);
    }

    fn lipschitz(&self) -> Real {
        self.shape.lipschitz()
    }

    fn is_convex(&self) -> bool {
        self.shape.is_convex()
    }

    fn error_bound(&self) -> Real {
        self.shape.error_bound()
    }

    fn bounds(&self) -> Option<Bounds> {
        let moved = |box_: Bounds| Bounds {
            lower: box_.lower + self.shift,
            upper: box_.upper + self.shift,
        };
        self.shape.bounds().map(moved)
    }
}

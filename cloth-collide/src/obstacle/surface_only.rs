//! A body without an inside.

use super::{Distance, SignedDistance};
use crate::bounds::Bounds;
use cloth_core::math::{Real, Vec3};

/// A rigid body that is nothing but the triangles of its
/// [surface](crate::potential::PotentialBuilder::surface), which may be open or pass through itself: no signed distance
/// tells inside from outside. It keeps the cloth on the side where it is.
///
/// φ is the largest number everywhere, and may be off by any amount.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceOnly;

impl SignedDistance for SurfaceOnly {
    fn signed_distance(&self, _: Vec3) -> Distance {
        Distance::exact(Real::MAX, Vec3::z())
    }

    fn error_bound(&self) -> Real {
        Real::INFINITY
    }

    fn bounds(&self) -> Option<Bounds> {
        None
    }
}

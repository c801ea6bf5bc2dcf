//! Obstacles as signed distance, and what they do to the vertices of a cloth.
//!
//! # The idea
//!
//! An obstacle is a function φ(x): how far the point x is from its surface, negative inside. Its gradient is the
//! outward normal n. With it, contact of a vertex is one inequality,
//!
//! φ(x) ≥ h, with the thickness h of the cloth,
//!
//! whatever the shape. Only vertices are kept out by it; what is between them feels the triangles of a body's surface,
//! which [`potential`](crate::potential) takes beside it.
//!
//! A shape is described at rest around its own origin ([`SignedDistance`]), and placed by a rigid motion
//! ([`Obstacle`]). The point is taken into the frame of the shape, the normal back out of it, so nothing of a shape is
//! ever computed again because it moved.
//!
//! # Equation → code
//!
//! | equation | code |
//! |---|---|
//! | φ = n·x | [`HalfSpace`] |
//! | φ = ‖x‖ − r | [`Sphere`] |
//! | φ = ‖max(\|x\| − b, 0)‖ outside, the largest of \|xᵢ\| − bᵢ inside | [`Cuboid`] |
//! | φ = ‖x − s‖ − r, s the nearest point of a segment | [`Capsule`] |
//! | φ = ±min over triangles, the sign from angle-weighted normals | [`ClosedMesh`] |
//! | Σ ψ(d) over triangles − edges + vertices, in place of ψ(φ) | [`SignedDistance::each_part`] |
//! | φ = Σ wᵢ φᵢ over the 27 nodes around, a quadratic B-spline | [`SampledDistance`] |
//! | triangles alone, no φ | [`SurfaceOnly`] |
//! | φ(x) = φ₀(x − a) | [`Shifted`] |
//! | x = (1 − s) xₖ + s xₖ₊₁ between two shapes | [`AnimatedMesh`] |
//! | x = Σ wᵢ xᵢ + F d of a point that goes along | [`Attachment`] |
//! | x = p + R y, v(x) = v + ω × (x − p) | [`RigidMotion`] |
//! | v = P/m + g Δt, ω = J⁻¹ L, P ← P + m g Δt + ∫f dt, L ← L + ∫τ dt | [`RigidBody`] |
//! | E = ½ k (h − φ)², a barrier below h/2 | [`PenaltyLaw`] |
//! | φ(x(t)) = h for the first time | [`first_contact`] |
//!
//! # Limits
//!
//! - φ of a shape is the distance to its surface, so from deep inside a thin one the nearest way out may be the far
//!   side. What keeps vertices on their side is [`first_contact`].
//! - Meshes and samples are not taken to be convex: a path that grazes them may end early, and says so.
//!
//! # References
//!
//! - J. A. Bærentzen and H. Aanæs, Signed distance computation using the angle weighted pseudonormal, *IEEE
//!   Transactions on Visualization and Computer Graphics* 11(3), 2005. DOI 10.1109/TVCG.2005.49

mod animated;
mod attachment;
mod capsule;
mod closed_mesh;
mod cuboid;
mod error;
mod half_space;
mod motion;
mod penalty;
mod placed;
mod rigid_body;
mod sampled;
mod shifted;
mod sphere;
mod surface_only;
mod sweep;

pub use animated::AnimatedMesh;
pub use attachment::Attachment;
pub use capsule::Capsule;
pub use closed_mesh::ClosedMesh;
pub use cuboid::Cuboid;
pub use error::ObstacleError;
pub use half_space::HalfSpace;
pub use motion::{Pose, RigidMotion};
pub use penalty::PenaltyLaw;
pub use placed::Obstacle;
pub use rigid_body::RigidBody;
pub use sampled::SampledDistance;
pub use shifted::Shifted;
pub use sphere::Sphere;
pub use surface_only::SurfaceOnly;
pub use sweep::{FirstContact, VertexPath, first_contact};

use crate::bounds::Bounds;
use cloth_core::error::{not_negative, positive, within};
use cloth_core::math::{Real, Vec3};
use std::fmt::Debug;

/// How far a point is from a surface, and which way is out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Signed distance φ (m): positive outside, negative inside.
    pub value: Real,
    /// Direction n (dimensionless, unit length) in which φ grows fastest. On the surface it is the outward normal.
    pub normal: Vec3,
    /// How fast φ grows along n (m per m): 1, but for distances that are interpolated.
    pub slope: Real,
}

impl Distance {
    /// Of a true distance, whose slope is 1.
    #[must_use]
    pub fn exact(value: Real, normal: Vec3) -> Self {
        Self {
            value,
            normal,
            slope: 1.0,
        }
    }

    /// ∂φ/∂x (dimensionless).
    #[must_use]
    pub fn gradient(&self) -> Vec3 {
        self.normal * self.slope
    }
}

/// A shape given by its signed distance, in its own frame.
///
/// Where the nearest point of the surface is not unique (the centre of a sphere), the normal is that of one of them.
pub trait SignedDistance: Debug + Send + Sync {
    /// Signed distance (m), normal and slope at `point` (m), which has to be finite.
    fn signed_distance(&self, point: Vec3) -> Distance;

    /// Hands `visit` distances d and weights w (dimensionless) of which Σ w ψ(d) is ψ(φ) wherever one point of the
    /// surface is nearest, and continuously differentiable outside, for any ψ that is and vanishes from `range` (m) on.
    /// By default φ alone, which is right for convex shapes.
    fn each_part(&self, point: Vec3, range: Real, visit: &mut dyn FnMut(Distance, Real)) {
        let _ = range;
        visit(self.signed_distance(point), 1.0);
    }

    /// How much φ can change per m of displacement (dimensionless): 1 for a distance.
    fn lipschitz(&self) -> Real {
        1.0
    }

    /// Whether φ is a convex function with a Lipschitz constant of 1, as it is if the shape is convex and φ its true
    /// distance. Searches along a path are then much shorter; with a larger constant their bound would not hold.
    fn is_convex(&self) -> bool {
        false
    }

    /// How far φ may be from the distance to the surface (m), 0 if it is that, and infinite if there is no such
    /// distance. Of a [`SampledDistance`] that holds in its grid; outside φ may be too small by more.
    fn error_bound(&self) -> Real {
        0.0
    }

    /// A box that contains the shape, or nothing if none does.
    fn bounds(&self) -> Option<Bounds>;
}

/// A finite vector, or which one is not.
fn finite(name: &'static str, value: Vec3) -> Result<Vec3, ObstacleError> {
    if cloth_core::math::is_finite(&value) {
        Ok(value)
    } else {
        Err(ObstacleError::NonFinite { name })
    }
}

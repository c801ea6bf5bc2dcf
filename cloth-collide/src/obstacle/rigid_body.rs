//! Mass, inertia and momentum of a body that forces move.

use super::{ObstacleError, Pose, RigidMotion, finite, positive};
use cloth_core::error::{OutOfRange, not_negative};
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use nalgebra::{Matrix3, Matrix6, Vector6};
use std::f64::consts::PI;

/// By how much a moment of inertia may be above the sum of the two others, over it: those of a disk are equal.
const ROUNDING: Real = 1e-9;

/// A rigid body of mass m with the inertia J about its centre of mass, which is the origin of its frame.
///
/// Its momentum P and angular momentum L are what is integrated, so that both change by impulses and by nothing else.
/// A step of Δt has
///
/// v = P/m + g Δt, ω = J⁻¹ L (with J turned half-way), then P ← P + m g Δt + ∫f dt, L ← L + ∫τ dt,
///
/// symplectic Euler, with the forces f and torques τ of the step in which the body has moved with v and ω. A force of
/// stiffness k is stable for Δt < 2 √(m/k): see [`RigidBody::highest_frequency`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    mass: Real,
    inertia: Matrix3<Real>,
    inverse_inertia: Matrix3<Real>,
    gravity: Vec3,
}

impl RigidBody {
    /// A body of this mass (kg) and inertia (kg·m²), in its own frame about the origin, which gravity (m/s²) pulls.
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`] for a mass or a principal moment of inertia that is not above zero, or a moment
    /// that is larger than the two others together (`∫x² + y² ≤ ∫y² + z² + ∫z² + x²`),
    /// [`ObstacleError::NonFinite`] for a moment of inertia, or gravity.
    pub fn new(mass: Real, inertia: Matrix3<Real>, gravity: Vec3) -> Result<Self, ObstacleError> {
        positive("mass of a body (kg)", mass)?;
        if !inertia.iter().all(|moment| moment.is_finite()) {
            let name = "moment of inertia of a body (kg·m²)";
            return Err(ObstacleError::NonFinite { name });
        }
        let inertia = 0.5 * (inertia + inertia.transpose());
        let moments = inertia.symmetric_eigenvalues();
        let least = moments.iter().copied().fold(Real::INFINITY, Real::min);
        let name = "moment of inertia of a body (kg·m²)";
        positive(name, least)?;
        let greatest = moments.max() / (moments.sum() - moments.max());
        if greatest > 1.0 + ROUNDING {
            return Err(ObstacleError::from(OutOfRange {
                name: "largest principal moment of inertia of a body, over the sum of the two others,",
                value: greatest,
                range: "at most 1",
            }));
        }
        let inverse_inertia = inertia.try_inverse();
        Ok(Self {
            mass,
            inertia,
            inverse_inertia: inverse_inertia.ok_or(OutOfRange {
                name,
                value: least,
                range: "above 0",
            })?,
            gravity: finite("gravity on a body", gravity)?,
        })
    }

    /// A ball of this density (kg/m³) and radius (m).
    ///
    /// # Errors
    /// As [`RigidBody::new`]; [`ObstacleError::OutOfRange`] for a size.
    pub fn sphere(density: Real, radius: Real, gravity: Vec3) -> Result<Self, ObstacleError> {
        positive("radius of a body (m)", radius)?;
        let mass = density * 4.0 / 3.0 * PI * radius.powi(3);
        let inertia = Matrix3::identity() * (0.4 * mass * radius * radius);
        Self::new(mass, inertia, gravity)
    }

    /// A box of this density (kg/m³) with half its edges (m).
    ///
    /// # Errors
    /// As [`RigidBody::new`]; [`ObstacleError::OutOfRange`] for a size.
    pub fn cuboid(density: Real, half: Vec3, gravity: Vec3) -> Result<Self, ObstacleError> {
        positive("half of an edge of a body (m)", half.min())?;
        let mass = density * 8.0 * half.product();
        let squares = half.component_mul(&half);
        let moments = Vec3::from_element(squares.sum()) - squares;
        Self::new(
            mass,
            Matrix3::from_diagonal(&(moments * (mass / 3.0))),
            gravity,
        )
    }

    /// A capsule of this density (kg/m³) along its z, with half the length (m) of its straight part and its radius (m).
    ///
    /// # Errors
    /// As [`RigidBody::new`]; [`ObstacleError::OutOfRange`] for a size.
    pub fn capsule(
        density: Real,
        half: Real,
        radius: Real,
        gravity: Vec3,
    ) -> Result<Self, ObstacleError> {
        positive("radius of a body (m)", radius)?;
        not_negative("half of the length of a body (m)", half)?;
        let square = radius * radius;
        let straight = density * PI * square * 2.0 * half;
        let ends = density * 4.0 / 3.0 * PI * square * radius;
        let along = 0.5 * straight * square + 0.4 * ends * square;
        // The centre of half a ball is ⅜ of the radius from its flat side.
        let across = straight * (0.25 * square + half * half / 3.0)
            + ends * (0.4 * square + half * half + 0.75 * half * radius);
        let inertia = Matrix3::from_diagonal(&Vec3::new(across, across, along));
        Self::new(straight + ends, inertia, gravity)
    }

    /// What a closed mesh of this density (kg/m³) encloses, and its centre of mass (m), about which its inertia is.
    /// Subtract the centre from the mesh and put the pose there: the origin of the frame has to be the centre of mass.
    ///
    /// # Errors
    /// As [`RigidBody::new`]; a mesh whose triangles point inwards has a negative mass.
    pub fn of_mesh(
        density: Real,
        mesh: &TriMesh,
        gravity: Vec3,
    ) -> Result<(Self, Vec3), ObstacleError> {
        let (mut volume, mut first, mut second) = (0.0, Vec3::zeros(), Matrix3::zeros());
        for triangle in mesh.triangles() {
            let [a, b, c] = gather(mesh.positions(), *triangle);
            // Of the tetrahedron with the origin.
            let part = a.dot(&b.cross(&c)) / 6.0;
            let sum = a + b + c;
            volume += part;
            first += sum * (part / 4.0);
            let squares = [a, b, c, sum].map(|x| x * x.transpose());
            second += squares.iter().sum::<Matrix3<Real>>() * (part / 20.0);
        }
        let mass = positive("mass of a body (kg)", density * volume)?;
        let centre = first / volume;
        let second = (second - centre * centre.transpose() * volume) * density;
        let inertia = Matrix3::identity() * second.trace() - second;
        Ok((Self::new(mass, inertia, gravity)?, centre))
    }

    /// The same with another mass (kg), to which its inertia is in proportion.
    ///
    /// # Errors
    /// As [`RigidBody::new`].
    pub fn with_mass(&self, mass: Real) -> Result<Self, ObstacleError> {
        Self::new(mass, self.inertia * (mass / self.mass), self.gravity)
    }

    /// The same with another inertia (kg·m²).
    ///
    /// # Errors
    /// As [`RigidBody::new`].
    pub fn with_inertia(&self, inertia: Matrix3<Real>) -> Result<Self, ObstacleError> {
        Self::new(self.mass, inertia, self.gravity)
    }

    /// m (kg).
    #[must_use]
    pub fn mass(&self) -> Real {
        self.mass
    }

    /// The gravity (m/s²) that pulls it.
    #[must_use]
    pub fn gravity(&self) -> Vec3 {
        self.gravity
    }

    /// J (kg·m²), in the frame of the body.
    #[must_use]
    pub fn inertia(&self) -> &Matrix3<Real> {
        &self.inertia
    }

    /// The highest angular frequency Ω (rad/s) at which the body swings if its whole `surface`, in its own frame, is
    /// pressed by contact of `stiffness` κ (Pa/m): the square root of the largest eigenvalue of M⁻¹K, with K = κ ∫ (n,
    /// r × n)(n, r × n)ᵀ dA. Steps of less than 2/Ω are stable while contact is in the quadratic part of its law, down
    /// to half of the thickness; pressed nearer it is stiffer.
    #[must_use]
    pub fn highest_frequency(&self, stiffness: Real, surface: &TriMesh) -> Real {
        let mut pressed = Matrix6::zeros();
        for triangle in surface.triangles() {
            let [a, b, c] = gather(surface.positions(), *triangle);
            let area = 0.5 * (b - a).cross(&(c - a));
            let Some(normal) = area.try_normalize(0.0) else {
                continue;
            };
            // The middles of the edges integrate squares exactly.
            for point in [a + b, b + c, c + a].map(|sum| sum / 2.0) {
                let turning = point.cross(&normal);
                let row = Vector6::new(
                    normal.x, normal.y, normal.z, turning.x, turning.y, turning.z,
                );
                pressed += row * row.transpose() * (area.norm() / 3.0);
            }
        }
        let mut inverse = Matrix6::zeros();
        inverse
            .fixed_view_mut::<3, 3>(0, 0)
            .fill_diagonal(1.0 / self.mass);
        inverse
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&self.inverse_inertia);
        // M⁻¹K has the eigenvalues of LᵀKL, with M⁻¹ = L Lᵀ.
        let Some(factor) = inverse.cholesky() else {
            return Real::INFINITY;
        };
        let scaled = factor.l().transpose() * pressed * factor.l();
        let largest = scaled.symmetric_eigenvalues().max();
        (stiffness * largest.max(0.0)).sqrt()
    }

    /// Momentum p (kg·m/s), and angular momentum L (kg·m²/s) about the centre of mass, with this motion; in world axes.
    pub(crate) fn momenta(&self, motion: &RigidMotion) -> [Vec3; 2] {
        let rotation = motion.pose.orientation.to_rotation_matrix();
        let local = rotation.inverse() * motion.angular_velocity;
        [
            motion.velocity * self.mass,
            rotation * (self.inertia * local),
        ]
    }

    /// ω (rad/s) in this pose.
    fn angular_velocity(&self, pose: &Pose, angular: Vec3) -> Vec3 {
        let rotation = pose.orientation.to_rotation_matrix();
        rotation * (self.inverse_inertia * (rotation.inverse() * angular))
    }

    /// How it moves from `pose` on with these momenta, in a step of `dt` (s).
    pub(crate) fn motion(&self, pose: Pose, momenta: [Vec3; 2], dt: Real) -> RigidMotion {
        let [linear, angular] = momenta;
        let start = self.angular_velocity(&pose, angular);
        let half = pose.turned(start * (0.5 * dt));
        RigidMotion {
            pose,
            velocity: linear / self.mass + self.gravity * dt,
            angular_velocity: self.angular_velocity(&half, angular),
        }
    }

    /// What an impulse (N·s) and one of rotation (N·m·s) make of its velocities (m/s, rad/s) in this pose.
    pub(crate) fn velocity_by(&self, pose: &Pose, [linear, angular]: [Vec3; 2]) -> [Vec3; 2] {
        [linear / self.mass, self.angular_velocity(pose, angular)]
    }

    /// A step of `dt` (s) ends, in which this impulse (N·s) and this one of rotation (N·m·s) have acted.
    pub(crate) fn push(&self, momenta: &mut [Vec3; 2], [linear, angular]: [Vec3; 2], dt: Real) {
        momenta[0] += self.gravity * (self.mass * dt) + linear;
        momenta[1] += angular;
    }
}

#[cfg(test)]
#[path = "../../tests/unit/obstacle_rigid_body.rs"]
mod tests;

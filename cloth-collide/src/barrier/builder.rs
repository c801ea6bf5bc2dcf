//! Settings of the barrier, checked.

use super::contacts::{BarrierContacts, BarrierReport};
use super::minimise::Minimiser;
use super::terms::Terms;
use crate::closest::point_triangle;
use crate::incidence::{edge_numbers, facing};
use crate::obstacle::{BodyWork, ObstacleContacts, PenaltyLaw};
use crate::separation::SeparationProbe;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::step::{BuildError, Outcome};

/// Settings of [`BarrierContacts`], to begin with [`BarrierContacts::builder`].
#[derive(Clone, Debug)]
pub struct BarrierBuilder<'a> {
    mesh: &'a TriMesh,
    distance: Real,
    stiffness: Real,
    accuracy: Real,
    most_iterations: u32,
    obstacles: Option<ObstacleContacts>,
    self_collision: bool,
}

impl<'a> BarrierBuilder<'a> {
    pub(super) fn new(mesh: &'a TriMesh) -> Self {
        Self {
            mesh,
            distance: 1e-3,
            stiffness: 1e5,
            accuracy: 1e-6,
            most_iterations: 200,
            obstacles: None,
            self_collision: true,
        }
    }

    /// Distance d̂ (m) at which the barrier begins.
    #[must_use]
    pub fn distance(mut self, distance: Real) -> Self {
        self.distance = distance;
        self
    }

    /// Stiffness κ of the barrier per area (N/m³).
    #[must_use]
    pub fn stiffness(mut self, stiffness: Real) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// The minimum is found when a Newton step is shorter than this part of d̂ (dimensionless).
    #[must_use]
    pub fn accuracy(mut self, accuracy: Real) -> Self {
        self.accuracy = accuracy;
        self
    }

    /// Most Newton steps in the search for the minimum.
    #[must_use]
    pub fn most_iterations(mut self, most_iterations: u32) -> Self {
        self.most_iterations = most_iterations;
        self
    }

    /// Obstacles, at whose thickness the barrier is infinite. Their margin, friction and restitution are not used.
    #[must_use]
    pub fn obstacles(mut self, obstacles: ObstacleContacts) -> Self {
        self.obstacles = Some(obstacles);
        self
    }

    /// Whether the cloth touches itself (it does unless told otherwise). If not, nothing is built for it.
    #[must_use]
    pub fn self_collision(mut self, self_collision: bool) -> Self {
        self.self_collision = self_collision;
        self
    }

    /// Builds the contact source.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`]: distance, stiffness and accuracy have to be positive, and with self-collision the distance not above the smallest
    /// height of a triangle onto an edge that it shares, or neighbours would push each other in the rest shape.
    pub fn build(self) -> Result<BarrierContacts, BuildError> {
        let refused = |name, value| BuildError::InvalidSetting {
            name,
            value,
            range: "positive and finite",
        };
        let positive = |value: Real| value > 0.0 && value.is_finite();
        if !positive(self.accuracy) {
            return Err(refused("accuracy of the barrier", self.accuracy));
        }
        let law = PenaltyLaw::barrier(self.stiffness, self.distance).map_err(|_| {
            if positive(self.stiffness) {
                refused("distance of the barrier (m)", self.distance)
            } else {
                refused("stiffness of the barrier (N/m³)", self.stiffness)
            }
        })?;
        if self.self_collision && self.distance > smallest_height(self.mesh) {
            return Err(BuildError::InvalidSetting {
                name: "distance of the barrier (m)",
                value: self.distance,
                range: "at most the smallest height of a triangle onto an edge that it shares",
            });
        }
        let thickness = self
            .obstacles
            .as_ref()
            .map_or(0.0, ObstacleContacts::thickness);
        let terms = Terms::new(self.mesh, law, thickness);
        // Not a number is equal to no position, so the first start is looked at.
        let unknown = Vec3::repeat(Real::NAN);
        Ok(BarrierContacts {
            minimiser: Minimiser::new(self.mesh, terms, self.self_collision, thickness),
            obstacles: self.obstacles,
            probe: self.self_collision.then(|| SeparationProbe::new(self.mesh)),
            safe: vec![unknown; self.mesh.vertex_count()],
            accuracy: self.accuracy,
            most_iterations: self.most_iterations,
            work: BodyWork::default(),
            report: BarrierReport {
                outcome: Outcome::Converged,
                newton_steps: 0,
                capped_steps: 0,
                rounds: 0,
                contacts: 0,
            },
        })
    }
}

/// The smallest rest distance (m) between a triangle and the vertex across one of its edges; infinite if no edge is shared.
fn smallest_height(mesh: &TriMesh) -> Real {
    let triangles = mesh.triangles();
    if edge_numbers(triangles).0.len() == 3 * triangles.len() {
        return Real::INFINITY;
    }
    let height = |(vertex, triangle): (u32, u32)| {
        let corners = gather(mesh.positions(), triangles[triangle as usize]);
        point_triangle(mesh.positions()[vertex as usize], corners).distance()
    };
    let heights = facing(triangles).into_iter().map(height);
    heights.fold(Real::INFINITY, Real::min)
}

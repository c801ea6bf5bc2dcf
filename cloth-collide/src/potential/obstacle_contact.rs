//! The energy of a vertex before an obstacle.

use super::near::Near;
use crate::obstacle::{Obstacle, PenaltyLaw};
use cloth_core::math::{Mat3, Real, Vec3};

/// An eigenvalue below this fraction of the largest one is rounding.
const SMALLEST: Real = 1e-9;

/// A vertex before an obstacle: the energy A Σ w ψ(d) over the parts of its surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObstacleContact<'a> {
    pub(super) vertex: usize,
    pub(super) number: usize,
    obstacle: &'a Obstacle,
    /// Where the vertex is (m), the area A that it stands for (m²), and its law.
    place: Vec3,
    area: Real,
    law: PenaltyLaw,
}

impl Near {
    /// A vertex at `place` (m) before an obstacle of this number.
    pub(super) fn before<'a>(
        &self,
        obstacle: &'a Obstacle,
        [vertex, number]: [usize; 2],
        place: Vec3,
    ) -> ObstacleContact<'a> {
        ObstacleContact {
            vertex,
            number,
            obstacle,
            place,
            area: self.vertex_area[vertex],
            law: self.law_at(vertex),
        }
    }
}

impl ObstacleContact<'_> {
    /// The energy (J), and its gradient (N) by the place.
    pub(super) fn value_and_gradient(&self) -> (Real, Vec3) {
        let (mut value, mut gradient) = (0.0, Vec3::zeros());
        let (place, range) = (self.place, self.law.range());
        self.obstacle.each_part(place, range, &mut |at, weight| {
            if at.value < range {
                let area = weight * self.area;
                value += area * self.law.energy(at.value);
                gradient += at.gradient() * (area * self.law.slope(at.value));
            }
        });
        (value, gradient)
    }

    /// Hands `visit` unit normals and stiffnesses (N/m) of which Σ k n nᵀ is A Σ w ψ″ ∂d ∂dᵀ, or what is positive in
    /// it: above a concave edge weights are of both signs.
    pub(super) fn each_stiffness(&self, mut visit: impl FnMut(Vec3, Real)) {
        let (mut count, mut only, mut sum) = (0, (Vec3::zeros(), 0.0), Mat3::zeros());
        let (place, range) = (self.place, self.law.range());
        self.obstacle.each_part(place, range, &mut |at, weight| {
            let stiffness = weight * self.area * self.law.curvature(at.value) * at.slope * at.slope;
            if stiffness != 0.0 {
                count += 1;
                only = (at.normal, stiffness);
                sum += at.normal * at.normal.transpose() * stiffness;
            }
        });
        if count < 2 {
            return visit(only.0, only.1);
        }
        let eigen = sum.symmetric_eigen();
        let least = SMALLEST * eigen.eigenvalues.max();
        for (k, &stiffness) in eigen.eigenvalues.iter().enumerate() {
            if stiffness > least {
                visit(eigen.eigenvectors.column(k).into(), stiffness);
            }
        }
    }
}

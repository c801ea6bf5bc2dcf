//! The energy between a vertex and a triangle, and between two edges.

use super::mollifier::Mollifier;
use crate::obstacle::PenaltyLaw;
use crate::pair::{Gap, Pair};
use cloth_core::math::{Real, Vec3};

/// E = A b(d) (J) of a vertex and a triangle, or E = A m b(d) of two edges: d their distance, m the [`Mollifier`] for
/// parallel ones.
///
/// Convex in the direction of n only: where a vertex is led around a corner, the second derivative of d, which the
/// barrier multiplies by its negative slope, pulls it off. Methods take the part A m b″ ∂d ∂dᵀ (Gauss–Newton), which
/// leaves this out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// What the two are.
    pub pair: Pair,
    /// Area A that the contact stands for (m²).
    pub area: Real,
    /// b; its stiffness is per area (N/m³).
    pub law: PenaltyLaw,
    /// m; none for a vertex and a triangle.
    pub mollifier: Option<Mollifier>,
}

impl PairContact {
    /// A, or A m (m²), at `x` (m).
    pub(super) fn area_at(&self, x: &[Vec3; 4]) -> Real {
        match &self.mollifier {
            Some(mollifier) => self.area * mollifier.at(x).0,
            None => self.area,
        }
    }

    /// E (J) and ∂E/∂x_k (N) at `x` (m).
    #[must_use]
    pub fn value_and_gradient(&self, x: &[Vec3; 4]) -> (Real, [Vec3; 4]) {
        let gap = Gap::new(self.pair.kind, x);
        let barrier = self.law.energy(gap.distance);
        if barrier == 0.0 {
            return (0.0, [Vec3::zeros(); 4]);
        }
        let (slope, of_gap) = (self.law.slope(gap.distance), gap.gradient());
        let Some(mollifier) = &self.mollifier else {
            return (self.area * barrier, of_gap.map(|g| g * (self.area * slope)));
        };
        let (m, of_m) = mollifier.at(x);
        let gradient =
            std::array::from_fn(|k| (of_gap[k] * (slope * m) + of_m[k] * barrier) * self.area);
        (self.area * m * barrier, gradient)
    }
}

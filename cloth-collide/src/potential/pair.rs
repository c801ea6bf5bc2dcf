//! The energy between a vertex and a triangle, and between two edges, as an element.

use super::mollifier::Mollifier;
use crate::obstacle::PenaltyLaw;
use crate::pair::{Gap, Pair};
use cloth_core::element::{Convexity, Element, Energy};
use cloth_core::math::{Blocks, Real, Vec3, make_semidefinite};

/// E = A ψ(d) (J) of a vertex and a triangle, or E = A m ψ(d) of two edges: d their distance, m the [`Mollifier`] for
/// parallel ones.
///
/// The second derivative of d, times ψ′ < 0, makes it indefinite where a vertex is led around a corner;
/// [`Convexity::GaussNewton`] leaves that out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// What the two are.
    pub pair: Pair,
    /// Area A that the contact stands for (m²).
    pub area: Real,
    /// ψ; its stiffness is per area (N/m³).
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
}

impl Element<4> for PairContact {
    fn vertices(&self) -> [u32; 4] {
        self.pair.vertices
    }
}

impl Energy<4> for PairContact {
    fn value(&self, x: &[Vec3; 4]) -> Real {
        self.value_and_gradient(x).0
    }

    fn gradient(&self, x: &[Vec3; 4]) -> [Vec3; 4] {
        self.value_and_gradient(x).1
    }

    fn value_and_gradient(&self, x: &[Vec3; 4]) -> (Real, [Vec3; 4]) {
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

    /// A m (ψ″ ∂d ∂dᵀ + ψ′ ∂²d) + A (ψ ∂²m + ψ′ (∂m ∂dᵀ + ∂d ∂mᵀ)), of which [`Convexity::GaussNewton`] keeps the first
    /// part.
    fn hessian(&self, x: &[Vec3; 4], convexity: Convexity) -> Blocks<4> {
        let gap = Gap::new(self.pair.kind, x);
        let (area, of_gap) = (self.area_at(x), gap.gradient());
        let slope = self.law.slope(gap.distance);
        let curvature = area * self.law.curvature(gap.distance);
        let mut blocks: Blocks<4> = std::array::from_fn(|k| {
            std::array::from_fn(|l| of_gap[k] * of_gap[l].transpose() * curvature)
        });
        if convexity == Convexity::GaussNewton {
            return blocks;
        }
        let bent = gap.curvature(x);
        let mollified = self.mollifier.map(|m| (m.at(x).1, m.curvature(x)));
        let barrier = self.law.energy(gap.distance);
        for k in 0..4 {
            for l in 0..4 {
                blocks[k][l] += bent[k][l] * (area * slope);
                if let Some((of_m, Some(of_m_twice))) = &mollified {
                    let crossed = of_m[k] * of_gap[l].transpose() + of_gap[k] * of_m[l].transpose();
                    blocks[k][l] += (of_m_twice[k][l] * barrier + crossed * slope) * self.area;
                }
            }
        }
        make_semidefinite(&blocks, convexity)
    }
}

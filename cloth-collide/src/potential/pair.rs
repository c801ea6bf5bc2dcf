//! The energy between a vertex and a triangle, and between two edges, as an element.

use super::mollifier::Mollifier;
use crate::obstacle::PenaltyLaw;
use crate::pair::{Gap, Pair};
use cloth_core::element::{Convexity, Element, Energy};
use cloth_core::math::{Blocks, Real, Vec3, make_semidefinite};

/// E = A ψ(d) (J) of a vertex and a triangle, or E = A m ψ(d) of two edges: d their distance, m the [`Mollifier`] for
/// parallel ones.
///
/// The twelve derivatives follow by the chain rule from those of d, which [`Gap`] has, and of m:
///
/// ∂E/∂x_k = A (m ψ′ c_k n + ψ ∂m/∂x_k).
///
/// Where the two touch E is infinite, even where m is zero, and the derivatives, which there are none of, come out
/// zero.
///
/// # The geometric term
///
/// In the second derivative ([`Energy::hessian`]) A m ψ″ ∂d ∂dᵀ has no negative eigenvalue; A m ψ′ ∂²d has, since
/// ψ′ < 0. Between a vertex and a corner the two are
///
/// A c_k c_l (ψ″ n nᵀ − (|ψ′|/d) (1 − n nᵀ)).
///
/// Below h/2 the second is as large as the first, because |ψ′| = d ψ″ there; from h/2 on it is (h − d)/d of it. The
/// same is true across an edge. Before a face, and between the insides of two edges, ∂²d has 1/ℓ in place of 1/d, where
/// ℓ is a height of the triangle, or the length of the edges times the sine of their angle. The geometric term is then
/// of the order of h/2ℓ of the other, or less. The minimum is the same whatever becomes of it:
///
/// | second derivative | what is left | price |
/// |---|---|---|
/// | kept: [`Convexity::Exact`] | everything; quadratic convergence where it is continuous | indefinite, so that a step need not go down |
/// | projected: [`Convexity::Clamp`], [`Convexity::Abs`] | no negative eigenvalue, as in [Li et al. 2020](super#references); quadratic only where none was negative | the eigenvalues of 9 × 9 numbers for each pair (12 less 3 translations) |
/// | dropped: [`Convexity::GaussNewton`] | A m ψ″ ∂d ∂dᵀ: rank one, and no eigenvalues to find | linear convergence, slower the larger what is dropped is beside the rest of the Hessian |
///
/// Methods get the last one in a step, as a [`ContactRow`](cloth_core::contact::ContactRow): a normal, four weights and
/// a stiffness a pair in place of 144 numbers. Between a vertex and a corner clamping leaves the same matrix. Of two
/// nearly parallel edges the derivatives of m are dropped too.
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
        // Nothing, or where they touch no direction; and 0 ∞ of parallel edges is no number.
        if barrier == 0.0 || barrier == Real::INFINITY {
            return (barrier, [Vec3::zeros(); 4]);
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
        if convexity == Convexity::GaussNewton || gap.distance == 0.0 {
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

//! The barrier between a vertex and a triangle, and between two edges, as elements.

use super::gap::Gap;
use super::mollifier::Mollifier;
use crate::obstacle::PenaltyLaw;
use cloth_core::element::{Convexity, Element, Energy};
use cloth_core::math::{Blocks, Real, Vec3, make_semidefinite};

/// E = A b(d) (J) of a vertex and a triangle, d their distance.
///
/// Convex in the direction of n only: where a vertex is led around a corner, the second derivative of d, which the
/// barrier multiplies by its negative slope, pulls it off. [`Convexity::GaussNewton`] leaves this out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexTriangleContact {
    /// The vertex, then the corners of the triangle.
    pub vertices: [u32; 4],
    /// Area A that the contact stands for (m²).
    pub area: Real,
    /// b; its stiffness is per area (N/m³).
    pub law: PenaltyLaw,
}

impl Element<4> for VertexTriangleContact {
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }
}

impl Energy<4> for VertexTriangleContact {
    fn value(&self, x: &[Vec3; 4]) -> Real {
        self.area * self.law.energy(Gap::vertex_triangle(x).distance)
    }

    fn gradient(&self, x: &[Vec3; 4]) -> [Vec3; 4] {
        let gap = Gap::vertex_triangle(x);
        let slope = self.area * self.law.slope(gap.distance);
        gap.gradient().map(|g| g * slope)
    }

    fn hessian(&self, x: &[Vec3; 4], convexity: Convexity) -> Blocks<4> {
        let gap = Gap::vertex_triangle(x);
        barrier_hessian(&gap, self.law, self.area, x, convexity)
    }
}

/// E = A m b(d) (J) of two edges, d their distance, m the [`Mollifier`] for parallel ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeEdgeContact {
    /// The ends of one edge, then those of the other.
    pub vertices: [u32; 4],
    /// Area A that the contact stands for (m²).
    pub area: Real,
    /// b; its stiffness is per area (N/m³).
    pub law: PenaltyLaw,
    /// m.
    pub mollifier: Mollifier,
}

impl Element<4> for EdgeEdgeContact {
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }
}

impl Energy<4> for EdgeEdgeContact {
    fn value(&self, x: &[Vec3; 4]) -> Real {
        let barrier = self.law.energy(Gap::edge_edge(x).distance);
        if barrier == 0.0 {
            return 0.0;
        }
        self.area * self.mollifier.at(x).value * barrier
    }

    fn gradient(&self, x: &[Vec3; 4]) -> [Vec3; 4] {
        let gap = Gap::edge_edge(x);
        let (barrier, slope) = (self.law.energy(gap.distance), self.law.slope(gap.distance));
        let mollified = self.mollifier.at(x);
        let of_gap = gap.gradient();
        std::array::from_fn(|k| {
            (of_gap[k] * (slope * mollified.value) + mollified.gradient[k] * barrier) * self.area
        })
    }

    fn hessian(&self, x: &[Vec3; 4], convexity: Convexity) -> Blocks<4> {
        let gap = Gap::edge_edge(x);
        let mollified = self.mollifier.at(x);
        let area = self.area * mollified.value;
        let curvature = self.mollifier.curvature(x);
        let (Some(curvature), false) = (curvature, convexity == Convexity::GaussNewton) else {
            return barrier_hessian(&gap, self.law, area, x, convexity);
        };
        let mut blocks = barrier_hessian(&gap, self.law, area, x, Convexity::Exact);
        let barrier = self.area * self.law.energy(gap.distance);
        let slope = self.area * self.law.slope(gap.distance);
        let of_gap = gap.gradient();
        for k in 0..4 {
            for l in 0..4 {
                let crossed = mollified.gradient[k] * of_gap[l].transpose()
                    + of_gap[k] * mollified.gradient[l].transpose();
                blocks[k][l] += curvature[k][l] * barrier + crossed * slope;
            }
        }
        make_semidefinite(&blocks, convexity)
    }
}

/// A (b″ ∂d ∂dᵀ + b′ ∂²d); of the second part, which makes it indefinite, nothing for [`Convexity::GaussNewton`], and
/// [`Gap::convex_part`] for [`Convexity::Clamp`].
fn barrier_hessian(
    gap: &Gap,
    law: PenaltyLaw,
    area: Real,
    x: &[Vec3; 4],
    convexity: Convexity,
) -> Blocks<4> {
    let slope = area * law.slope(gap.distance);
    let curvature = area * law.curvature(gap.distance);
    let along = gap.normal * gap.normal.transpose() * curvature;
    let (bent, times) = match convexity {
        Convexity::GaussNewton => (None, 0.0),
        Convexity::Clamp => (Some(gap.convex_part(x)), -slope),
        _ => (Some(gap.curvature(x)), slope),
    };
    let blocks = std::array::from_fn(|k| {
        std::array::from_fn(|l| {
            let block = along * (gap.weights[k] * gap.weights[l]);
            match &bent {
                Some(bent) => block + bent[k][l] * times,
                None => block,
            }
        })
    });
    match convexity {
        Convexity::Abs => make_semidefinite(&blocks, convexity),
        _ => blocks,
    }
}

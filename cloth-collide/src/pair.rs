//! Two pieces of cloth: how far apart they are, with the gradient, and whether they stay apart on their path.

use crate::ccd::{ContinuousTest, Query, QueryKind};
use crate::closest::{edge_edge, point_triangle};
use cloth_core::math::{Real, Vec3, gather};

/// A vertex and a triangle, or two edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pair {
    /// Which of these.
    pub kind: QueryKind,
    /// The vertex, then the corners of the triangle; or the ends of one edge, then those of the other.
    pub vertices: [u32; 4],
}

impl Pair {
    /// How far (m) the plane across `normal` has the two apart at least, at positions `x` (m) of all vertices.
    pub(crate) fn gap_along(self, normal: &Vec3, x: &[Vec3]) -> Real {
        gap_along(self.kind, normal, &gather(x, self.vertices))
    }
}

/// Σ c_k x_k (m), with positions `x` (m) of all vertices.
#[inline]
pub(crate) fn weighted(vertices: [u32; 4], weights: [Real; 4], x: &[Vec3]) -> Vec3 {
    let ends = vertices.into_iter().zip(weights);
    ends.map(|(v, w)| x[v as usize] * w).sum()
}

/// Between the nearest points of two primitives.
///
/// With the weights c_k(s) of the four vertices, which depend on up to two places s along edges, r = Σ c_k x_k goes
/// from one nearest point to the other, and d = min over s of ‖r‖. The minimum is stationary in s, so ∂d/∂x_k = c_k n
/// with n = r/d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Distance d (m).
    pub distance: Real,
    /// From the second nearest point to the first, n (unit length; zero at distance 0).
    pub normal: Vec3,
    /// c_k, dimensionless: positive on the first primitive, where they sum to 1, negative on the second.
    pub weights: [Real; 4],
}

impl Gap {
    /// Of a vertex and a triangle, or of two edges, at positions `x` (m) in this order.
    #[must_use]
    pub fn new(kind: QueryKind, x: &[Vec3; 4]) -> Self {
        let (weights, separation) = match kind {
            QueryKind::VertexTriangle => {
                let found = point_triangle(x[0], [x[1], x[2], x[3]]);
                let [a, b, c] = found.weights;
                ([1.0, -a, -b, -c], found.separation)
            }
            QueryKind::EdgeEdge => {
                let found = edge_edge([x[0], x[1]], [x[2], x[3]]);
                let [s, t] = found.along;
                ([1.0 - s, s, t - 1.0, -t], found.separation)
            }
        };
        let distance = separation.norm();
        let normal = if distance > 0.0 {
            separation / distance
        } else {
            Vec3::zeros()
        };
        Self {
            distance,
            normal,
            weights,
        }
    }

    /// Whether one of the two points is on the boundary of a triangle, or the end of an edge.
    pub(crate) fn is_at_boundary(&self) -> bool {
        self.weights.contains(&0.0)
    }

    /// ∂d/∂x_k (dimensionless).
    #[must_use]
    pub fn gradient(&self) -> [Vec3; 4] {
        self.weights.map(|c| self.normal * c)
    }
}

impl Query {
    /// The motion of a pair between two places (m) of all vertices.
    pub(crate) fn of(pair: Pair, from: &[Vec3], to: &[Vec3]) -> Self {
        Self {
            kind: pair.kind,
            from: gather(from, pair.vertices),
            to: gather(to, pair.vertices),
        }
    }

    /// The places (m) at a time (0..=1).
    pub(crate) fn at(&self, time: Real) -> [Vec3; 4] {
        std::array::from_fn(|k| self.from[k] + (self.to[k] - self.from[k]) * time)
    }

    /// Whether the four move as one, by a shift: what they do besides changes `distance` (m) by less than a part in
    /// 10⁵. Positions are rounded, so no shift is exact; and where they end so far away that their differences are
    /// lost, or `distance` is lost in the rounding of these, it is none.
    pub(crate) fn is_shift(&self, distance: Real) -> bool {
        let apart = |x: &[Vec3; 4], k: usize| x[k] - x[0];
        let besides = |k: usize| {
            let [from, to] = [apart(&self.from, k), apart(&self.to, k)];
            (to - from).norm() + 2.0 * Real::EPSILON * (from.norm() + to.norm())
        };
        self.from == self.to || (1..4).all(|k| besides(k) <= 1e-6 * distance)
    }

    /// Whether one steady plane has the pieces apart by more than `separation` (m) during the motion: it does if it
    /// does at both ends, because everything is linear in time.
    pub(crate) fn is_apart_along(&self, normal: &Vec3, separation: Real) -> bool {
        let is_apart = |x: &[Vec3; 4]| gap_along(self.kind, normal, x) - separation > 0.0;
        is_apart(&self.to) && is_apart(&self.from)
    }

    /// The first time (0..=1) at which the distance is down to `separation` (m); nothing if there is none.
    pub(crate) fn time_at(&self, separation: Real) -> Option<Real> {
        let found = ContinuousTest::new(separation, 0.0).and_then(|test| self.first_contact(&test));
        // Numbers too large: nothing is certain.
        found.map_or(Some(0.0), |impact| impact.map(|impact| impact.time))
    }
}

/// How far (m) the plane across `normal` has the two pieces apart at least, at positions `x` (m), rounding taken off.
fn gap_along(kind: QueryKind, normal: &Vec3, x: &[Vec3; 4]) -> Real {
    let displacements = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
    let [a, b, c] = displacements.map(|displacement| normal.dot(&displacement));
    let size = displacements.iter().fold(0.0, |size: Real, displacement| {
        size.max(displacement.amax())
    });
    let gap = match kind {
        QueryKind::VertexTriangle => -a.max(b).max(c),
        QueryKind::EdgeEdge => a.min(0.0) - b.max(c),
    };
    // One difference, three products, two sums, one more difference; n is off unit length by less.
    gap - 16.0 * Real::EPSILON * size
}

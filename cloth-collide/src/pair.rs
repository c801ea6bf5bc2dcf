//! Two pieces of cloth: where they are nearest, and whether they stay apart on their path.

use crate::ccd::{ContinuousTest, Query, QueryKind};
use crate::closest::{edge_edge, point_triangle};
use cloth_core::math::{Real, Vec3};

/// A vertex and a triangle, or two edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) kind: QueryKind,
    /// Vertex and three corners, or the two ends of each edge.
    pub(crate) vertices: [u32; 4],
}

/// The nearest points of the two pieces: Σ wᵢ xᵢ = d n.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// Weights wᵢ (dimensionless); those of the first piece sum to 1, those of the second to −1.
    pub(crate) weights: [Real; 4],
    /// Unit vector n from the second to the first; zero if they touch.
    pub(crate) normal: Vec3,
    /// Distance d (m).
    pub(crate) distance: Real,
}

impl Nearest {
    /// Whether one of the two points is on the boundary of a triangle, or the end of an edge.
    pub(crate) fn is_at_boundary(&self) -> bool {
        self.weights.contains(&0.0)
    }
}

/// The motion of the four vertices of a pair: positions (m) at both ends of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) from: [Vec3; 4],
    pub(crate) to: [Vec3; 4],
}

impl Motion {
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
}

/// Nearest points of two pieces at positions `x` (m).
pub(crate) fn nearest(kind: QueryKind, x: &[Vec3; 4]) -> Nearest {
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
    Nearest {
        weights,
        normal,
        distance,
    }
}

/// How far (m) the plane across `normal` has the two pieces apart at least, at positions `x` (m), rounding taken off.
pub(crate) fn gap_along(kind: QueryKind, normal: &Vec3, x: &[Vec3; 4]) -> Real {
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

/// By how much more than `separation` (m) one steady plane has the pieces apart during the motion, nothing if it does
/// not: it does if it does at both ends, because everything is linear in time.
pub(crate) fn room_along(
    kind: QueryKind,
    normal: &Vec3,
    motion: &Motion,
    separation: Real,
) -> Option<Real> {
    let room = |x: &[Vec3; 4]| Some(gap_along(kind, normal, x) - separation).filter(|&r| r > 0.0);
    Some(room(&motion.to)?.min(room(&motion.from)?))
}

/// Whether it does.
pub(crate) fn apart_along(
    kind: QueryKind,
    normal: &Vec3,
    motion: &Motion,
    separation: Real,
) -> bool {
    room_along(kind, normal, motion, separation).is_some()
}

/// The first time (0..=1) at which the distance is down to `separation` (m); nothing if there is none.
pub(crate) fn first_contact(kind: QueryKind, motion: &Motion, separation: Real) -> Option<Real> {
    let Ok(test) = ContinuousTest::new(separation, 0.0) else {
        return Some(0.0);
    };
    let query = Query {
        kind,
        from: motion.from,
        to: motion.to,
    };
    match query.first_contact(&test) {
        Ok(impact) => impact.map(|impact| impact.time),
        // Numbers too large: nothing is certain.
        Err(_) => Some(0.0),
    }
}

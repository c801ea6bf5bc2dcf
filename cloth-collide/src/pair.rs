//! Two primitives of cloth: how far apart they are, with both derivatives, and whether they stay apart on their path.

use crate::ccd::{ContinuousTest, Query, QueryKind};
use crate::closest::{edge_edge, point_triangle};
use cloth_core::math::{Blocks, Mat3, Real, Vec3, gather};

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
    #[inline(always)]
    pub(crate) fn gap_along(self, normal: &Vec3, x: &[Vec3]) -> Real {
        gap_along(self.kind, normal, &gather(x, self.vertices))
    }
}

/// Vertices, with their weights c_k.
#[inline]
pub(crate) fn ends(vertices: [u32; 4], weights: [Real; 4]) -> impl Iterator<Item = (usize, Real)> {
    vertices.map(|v| v as usize).into_iter().zip(weights)
}

/// Σ c_k x_k (m), with positions `x` (m) of all vertices.
#[inline]
pub(crate) fn weighted(vertices: [u32; 4], weights: [Real; 4], x: &[Vec3]) -> Vec3 {
    let [a, b, c, d] = gather(x, vertices);
    a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
}

/// The weights c_k of four vertices at `x` (m), and r = Σ c_k x_k (m), from the second nearest point to the first.
#[inline]
pub(crate) fn nearest(kind: QueryKind, x: &[Vec3; 4]) -> ([Real; 4], Vec3) {
    match kind {
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
    }
}

/// Distance of two primitives, with its first derivative.
///
/// With the weights c_k(s) of the four vertices, which depend on up to two places s along edges, r = Σ c_k x_k goes
/// from one nearest point to the other, and d = min over s of ‖r‖. The minimum is stationary in s, so ∂d/∂x_k = c_k n
/// with n = r/d: what s changes as the vertices move has no first-order effect. As they move, s moves such that n stays
/// at right angles to ∂r/∂s. That gives the second derivative, [`Gap::curvature`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Of what.
    pub kind: QueryKind,
    /// Distance d (m).
    pub distance: Real,
    /// From the second nearest point to the first, n (unit length; zero at distance 0).
    pub normal: Vec3,
    /// c_k, dimensionless: not negative on the first primitive, where they sum to 1, not positive on the second. Those
    /// of contact constraints too.
    pub weights: [Real; 4],
}

impl Gap {
    /// Of a vertex and a triangle, or of two edges, at positions `x` (m) in this order.
    #[must_use]
    pub fn new(kind: QueryKind, x: &[Vec3; 4]) -> Self {
        let (weights, separation) = nearest(kind, x);
        let distance = separation.norm();
        let normal = if distance > 0.0 {
            separation / distance
        } else {
            Vec3::zeros()
        };
        Self {
            kind,
            distance,
            normal,
            weights,
        }
    }

    /// ∂c/∂s for each place that is free to move, and how many are: on a corner nothing moves, on an edge the place
    /// between its ends, inside a triangle two of them.
    fn turns(&self) -> ([[Real; 4]; 2], usize) {
        let on = self.weights.map(|weight| weight != 0.0);
        let edges: &[[usize; 2]] = match (self.kind, on) {
            (QueryKind::VertexTriangle, [_, true, true, true]) => &[[1, 2], [1, 3]],
            (QueryKind::VertexTriangle, [_, true, true, false]) => &[[1, 2]],
            (QueryKind::VertexTriangle, [_, false, true, true]) => &[[2, 3]],
            (QueryKind::VertexTriangle, [_, true, false, true]) => &[[3, 1]],
            (QueryKind::EdgeEdge, [true, true, true, true]) => &[[1, 0], [2, 3]],
            (QueryKind::EdgeEdge, [true, true, ..]) => &[[1, 0]],
            (QueryKind::EdgeEdge, [.., true, true]) => &[[2, 3]],
            _ => &[],
        };
        let mut turns = [[0.0; 4]; 2];
        for (turn, &[from, to]) in turns.iter_mut().zip(edges) {
            (turn[from], turn[to]) = (1.0, -1.0);
        }
        (turns, edges.len())
    }

    /// ∂d/∂x_k (dimensionless).
    #[must_use]
    pub fn gradient(&self) -> [Vec3; 4] {
        self.weights.map(|c| self.normal * c)
    }

    /// ∂²d/∂x_k∂x_l (1/m) at the positions (m) that the gap was taken at. Between two regions, where it jumps, that of
    /// one of them; zero for primitives that touch, and where G⁻¹ is beyond all numbers.
    ///
    /// The Hessian of ½ r² by vertices and places s has the blocks, with J_a = Σ ∂c_k/∂s_a x_k,
    ///
    /// H_kl = c_k c_l 1, H_ka = ∂_a c_k d n + c_k J_a, H_ab = J_a·J_b = G_ab.
    ///
    /// Eliminating s leaves H_kl − Σ H_ka (G⁻¹)_ab H_lbᵀ = ∂²(½ d²) = d ∂²d + ∂d ∂dᵀ. So, with the projector T onto
    /// what is at right angles to n and all J,
    ///
    /// ∂²d = c_k c_l T/d − Σ (G⁻¹)_ab (∂_a c_k c_l n J_bᵀ + c_k ∂_b c_l J_a nᵀ + d ∂_a c_k ∂_b c_l n nᵀ),
    ///
    /// in which nothing cancels for small d. Before a face, and between the insides of two edges, T is zero.
    #[must_use]
    pub fn curvature(&self, x: &[Vec3; 4]) -> Blocks<4> {
        let mut blocks = [[Mat3::zeros(); 4]; 4];
        if self.distance == 0.0 {
            return blocks;
        }
        let n = self.normal;
        let (turns, free) = self.turns();
        let along = turns.map(|turn| (0..4).map(|k| x[k] * turn[k]).sum::<Vec3>());
        let Some(inverse) = inverse_metric(free, &along) else {
            return blocks;
        };
        let mut across = Mat3::identity() - n * n.transpose();
        match free {
            1 => across -= along[0] * along[0].transpose() * inverse[0][0],
            2 => across = Mat3::zeros(),
            _ => {}
        }
        across /= self.distance;
        for k in 0..4 {
            for l in 0..4 {
                let block = &mut blocks[k][l];
                *block = across * (self.weights[k] * self.weights[l]);
                for a in 0..free {
                    for b in 0..free {
                        let g = inverse[a][b];
                        let (turn_k, turn_l) = (turns[a][k], turns[b][l]);
                        *block -= n * along[b].transpose() * (g * turn_k * self.weights[l])
                            + along[a] * n.transpose() * (g * self.weights[k] * turn_l)
                            + n * n.transpose() * (g * self.distance * turn_k * turn_l);
                    }
                }
            }
        }
        blocks
    }
}

/// The inverse of G; nothing if it has none, or one beyond all numbers, as between edges that are parallel but for
/// 1e-154.
fn inverse_metric(free: usize, along: &[Vec3; 2]) -> Option<[[Real; 2]; 2]> {
    let [u, v] = along;
    let mut inverse = [[0.0; 2]; 2];
    match free {
        0 => {}
        1 => inverse[0][0] = 1.0 / u.norm_squared(),
        _ => {
            let determinant = u.cross(v).norm_squared();
            let off = -u.dot(v) / determinant;
            inverse = [
                [v.norm_squared() / determinant, off],
                [off, u.norm_squared() / determinant],
            ];
        }
    }
    let finite = inverse.iter().flatten().all(|g| g.is_finite());
    finite.then_some(inverse)
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

    /// Whether one steady plane has the primitives apart by more than `separation` (m) during the motion: it does if it
    /// does at both ends, because everything is linear in time.
    pub(crate) fn is_apart_along(&self, normal: &Vec3, separation: Real) -> bool {
        let is_apart = |x: &[Vec3; 4]| gap_along(self.kind, normal, x) - separation > 0.0;
        is_apart(&self.to) && is_apart(&self.from)
    }

    /// The first time (0..=1) at which the distance is down to `separation` (m); nothing if there is none.
    pub(crate) fn time_at(&self, separation: Real) -> Option<Real> {
        self.time_near(separation, 0.0)
    }

    /// The same, or sooner by a `slack` as in [`ContinuousTest::new`].
    pub(crate) fn time_near(&self, separation: Real, slack: Real) -> Option<Real> {
        let test = ContinuousTest::new(separation, slack);
        let found = test.and_then(|test| self.first_contact(&test));
        // Numbers too large: nothing is certain.
        found.map_or(Some(0.0), |impact| impact.map(|impact| impact.time))
    }
}

/// How far (m) the plane across `normal` has the two primitives apart at least, at positions `x` (m), rounding taken
/// off.
#[inline(always)]
fn gap_along(kind: QueryKind, normal: &Vec3, x: &[Vec3; 4]) -> Real {
    let displacements = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
    let [a, b, c] = displacements.map(|displacement| normal.dot(&displacement));
    let mut size: Real = 0.0;
    for d in displacements {
        size = size.max(d.x.abs()).max(d.y.abs()).max(d.z.abs());
    }
    let gap = match kind {
        QueryKind::VertexTriangle => -a.max(b).max(c),
        QueryKind::EdgeEdge => a.min(0.0) - b.max(c),
    };
    // One difference, three products, two sums, one more difference; n is off unit length by less.
    gap - 16.0 * Real::EPSILON * size
}

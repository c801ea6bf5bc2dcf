//! The method of the textbooks: when are the four vertices in one plane, and is there a contact at that moment?

use crate::bisection::bisected;
use cloth_collide::{Query, QueryKind, edge_edge, point_triangle};
use cloth_core::math::{Real, Vec3};

/// First contact (dimensionless, 0..=1) by the roots of the coplanarity cubic (X. Provot, Collision and self-collision
/// handling in cloth model dedicated to design garments, *Computer Animation and Simulation* 1997, DOI
/// 10.1007/978-3-7091-6874-5_13). For teaching and comparison: **it can miss contacts**.
///
/// Four vertices that touch as a vertex and a triangle, or as two edges, are in one plane. With the differences x_k(t)
/// of the vertex to the corners, or of the ends of the first edge to the start of the second and back,
///
/// f(t) = (x₀ − x₁) × (x₀ − x₂) · x₀ = 0,
///
/// a cubic in t. It is monotone between the zeros of its derivative, so bisection finds each root. At each root the
/// distance decides: contact if it is at most `tolerance` times the size of the motion.
///
/// Why it misses: if the four vertices stay in one plane, f is zero throughout and has no roots to look at (only both
/// ends are looked at then). If f touches zero without changing its sign, rounding decides. If parallel edges make f
/// nearly zero, its roots are made of rounding. A tolerance mends the tests at a root that was found, not the roots
/// that were not; and a large one reports contacts that are none. A time that was found may be late by what bisection
/// leaves.
pub fn first_contact(query: &Query, tolerance: Real) -> Option<Real> {
    let differences = |[a, b, c, d]: [Vec3; 4]| match query.kind {
        QueryKind::VertexTriangle => [a - b, a - c, a - d, a - d],
        QueryKind::EdgeEdge => [a - c, b - c, a - d, b - d],
    };
    let (from, to) = (differences(query.from), differences(query.to));
    let distance = |t: Real| {
        let [x0, x1, x2, _] = std::array::from_fn(|k| from[k] * (1.0 - t) + to[k] * t);
        match query.kind {
            QueryKind::VertexTriangle => point_triangle(Vec3::zeros(), [-x0, -x1, -x2]).distance(),
            QueryKind::EdgeEdge => edge_edge([x0, x1], [Vec3::zeros(), x0 - x2]).distance(),
        }
    };
    let size = from.iter().chain(&to).map(Vec3::amax).fold(0.0, Real::max);
    let cubic = Cubic::coplanarity(&from, &to);
    cubic.roots().find(|&t| distance(t) <= tolerance * size)
}

/// A cubic on 0..=1, by its Bernstein coefficients.
struct Cubic([Real; 4]);

impl Cubic {
    fn coplanarity(from: &[Vec3; 4], to: &[Vec3; 4]) -> Self {
        let sides = |x: &[Vec3; 4]| (x[0] - x[1], x[0] - x[2]);
        let ((u0, v0), (u1, v1)) = (sides(from), sides(to));
        let normal = [
            u0.cross(&v0),
            (u0.cross(&v1) + u1.cross(&v0)) * 0.5,
            u1.cross(&v1),
        ];
        Self([
            normal[0].dot(&from[0]),
            (2.0 * normal[1].dot(&from[0]) + normal[0].dot(&to[0])) / 3.0,
            (normal[2].dot(&from[0]) + 2.0 * normal[1].dot(&to[0])) / 3.0,
            normal[2].dot(&to[0]),
        ])
    }

    fn at(&self, t: Real) -> Real {
        let [a, b, c, d] = self.0;
        let s = 1.0 - t;
        s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
    }

    /// The roots in increasing order. Of a stretch of zeros only the ends.
    fn roots(&self) -> impl Iterator<Item = Real> {
        let [a, b, c, d] = self.0;
        // A third of the derivative, p + 2 (q − p) t + (p − 2 q + r) t².
        let (p, q, r) = (b - a, c - b, d - c);
        let [first, second] = quadratic_roots(p - 2.0 * q + r, q - p, p);
        let mut ends = [0.0, first.clamp(0.0, 1.0), second.clamp(0.0, 1.0), 1.0];
        ends.sort_by(Real::total_cmp);
        let values = ends.map(|t| self.at(t));
        let root = move |k: usize| self.bisect([ends[k], ends[k + 1]], [values[k], values[k + 1]]);
        (0..3).flat_map(root)
    }

    /// The root in the interval `ends`, in which the polynomial is monotone with these `values` at its ends; both ends
    /// if it is zero there.
    fn bisect(&self, ends: [Real; 2], values: [Real; 2]) -> impl Iterator<Item = Real> {
        let [low, high] = ends;
        let found = match (values[0] == 0.0, values[1] == 0.0) {
            (true, true) => [Some(low), Some(high)],
            (true, false) => [Some(low), None],
            (false, true) => [None, Some(high)],
            _ if values[0] * values[1] > 0.0 => [None, None],
            _ => {
                let is_below = |t| (self.at(t) > 0.0) == (values[0] > 0.0);
                [Some(bisected(ends, 60, is_below)[0]), None]
            }
        };
        found.into_iter().flatten()
    }
}

/// Both roots of a t² + 2 b t + c, or 0 where there are none (nothing is lost by splitting an interval there).
fn quadratic_roots(a: Real, b: Real, c: Real) -> [Real; 2] {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return [0.0; 2];
    }
    let q = -(b + b.signum() * discriminant.sqrt());
    [q / a, c / q].map(|root| if root.is_finite() { root } else { 0.0 })
}

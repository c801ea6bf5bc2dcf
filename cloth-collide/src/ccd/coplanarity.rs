//! The method of the textbooks: when are the four vertices in one plane, and is there a contact at that moment?

use super::difference::Difference;
use super::number::{Triple, cross, dot, minus, plus, value};
use crate::closest::{edge_edge, point_triangle};
use crate::error::CollideError;
use cloth_core::math::{Real, Vec3};

/// Continuous collision by the roots of the coplanarity cubic (Provot 1997). For teaching and comparison: **it can
/// miss contacts**.
///
/// Four vertices that touch as a vertex and a triangle, or as two edges, are in one plane. With x_k(t) as in
/// [`ContinuousTest`](super::ContinuousTest),
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoplanarityTest {
    /// The distance that counts as contact, as a fraction of the largest difference of two coordinates (dimensionless).
    pub tolerance: Real,
}

impl Default for CoplanarityTest {
    fn default() -> Self {
        Self { tolerance: 1e-9 }
    }
}

impl CoplanarityTest {
    /// First root with a contact (dimensionless, 0..=1) of a `vertex` and a `triangle`; positions (m) at the start and
    /// at the end of the step.
    ///
    /// # Errors
    /// As for [`ContinuousTest::vertex_triangle`](super::ContinuousTest::vertex_triangle).
    pub fn vertex_triangle(
        &self,
        vertex: [Vec3; 2],
        triangle: [[Vec3; 3]; 2],
    ) -> Result<Option<Real>, CollideError> {
        let polygon = Difference::vertex_triangle(vertex, triangle)?;
        Ok(self.first_contact(&polygon, |x| {
            point_triangle(Vec3::zeros(), x.map(|x| -x)).distance()
        }))
    }

    /// The same for two edges.
    ///
    /// # Errors
    /// As for [`ContinuousTest::edge_edge`](super::ContinuousTest::edge_edge).
    pub fn edge_edge(
        &self,
        first: [[Vec3; 2]; 2],
        second: [[Vec3; 2]; 2],
    ) -> Result<Option<Real>, CollideError> {
        let polygon = Difference::edge_edge(first, second)?;
        Ok(self.first_contact(&polygon, |[x0, x1, x2, _]| {
            edge_edge([x0, x1], [Vec3::zeros(), x0 - x2]).distance()
        }))
    }

    fn first_contact<const K: usize>(
        &self,
        polygon: &Difference<K>,
        distance: impl Fn([Vec3; K]) -> Real,
    ) -> Option<Real> {
        let cubic = Cubic::coplanarity(&polygon.at(0.0), &polygon.at(1.0));
        let close = self.tolerance * polygon.size;
        cubic
            .roots()
            .find(|&t| distance(polygon.at(t).map(|x| value(&x))) <= close)
    }
}

/// A cubic on 0..=1, by its Bernstein coefficients.
struct Cubic([Real; 4]);

impl Cubic {
    fn coplanarity<const K: usize>(from: &[Triple<Real>; K], to: &[Triple<Real>; K]) -> Self {
        let sides = |x: &[Triple<Real>; K]| (minus(&x[0], &x[1]), minus(&x[0], &x[2]));
        let ((u0, v0), (u1, v1)) = (sides(from), sides(to));
        let normal = [
            cross(&u0, &v0),
            plus(&cross(&u0, &v1), &cross(&u1, &v0)).map(|n| 0.5 * n),
            cross(&u1, &v1),
        ];
        Self([
            dot(&normal[0], &from[0]),
            (2.0 * dot(&normal[1], &from[0]) + dot(&normal[0], &to[0])) / 3.0,
            (dot(&normal[2], &from[0]) + 2.0 * dot(&normal[1], &to[0])) / 3.0,
            dot(&normal[2], &to[0]),
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
        let [mut low, mut high] = ends;
        let found = match (values[0] == 0.0, values[1] == 0.0) {
            (true, true) => [Some(low), Some(high)],
            (true, false) => [Some(low), None],
            (false, true) => [None, Some(high)],
            _ if values[0] * values[1] > 0.0 => [None, None],
            _ => {
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if (self.at(middle) > 0.0) == (values[0] > 0.0) {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                [Some(low), None]
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

//! How long the polygon is certainly further than the separation from the origin: the only place where something is
//! proved.
//!
//! Let x_k(t) be the corners of the polygon and n(t) any direction, for s in 0..=1 over an interval of time. If
//!
//! n(t) · x_k(t) > d |n(t)|  for every corner k,
//!
//! then the same holds for every point of the polygon, since it is a mean of the corners, and so the polygon is further
//! than d from the origin. With n of second degree and x_k linear the left side is of third degree; with N₀, N₁, N₂ and
//! X₀, X₁ for their Bernstein coefficients, those of the left side are
//!
//! N₀·X₀,  (2 N₁·X₀ + N₀·X₁)/3,  (N₂·X₀ + 2 N₁·X₁)/3,  N₂·X₁,
//!
//! and |n| is nowhere more than the polynomial whose coefficients are |N₀|, |N₁|, |N₂|, because the norm is convex. A
//! polynomial stays in the convex hull of its coefficients (the control points (i/3, c_i)), so it is positive as far as
//! the hull is.
//!
//! # Rounding
//!
//! Let u = 2⁻⁵³ be the relative error of one operation, S the largest coordinate of the corners (`size`), N the largest
//! 1-norm of the N_i. The N_i need no allowance, because they *are* the direction. A corner at a given time is off by 4
//! u S in each coordinate (`Difference::at`), so a product N·X by 4 u N S; its three multiplications and two additions
//! add 3 u N S, the mean of two products 3 u N S. |N_i| is off by 4 u |N_i|, its product with d and its mean by 4 u
//! more. The last two subtractions add 2 u (N S + N d). Together, this is less than 16 u N (S + d), also with the terms
//! in u² and with the rounding of N and S themselves; and this is subtracted. What underflows does not matter, as N is
//! of order one and S at least 2⁻⁵².
//!
//! Double-double numbers are rounded to `f64` for a first test, which takes another 2 u N S; there twice the above is
//! subtracted.

use super::direction::MovingDirection;
use super::number::{Number, Triple, dot, value};
use cloth_core::math::{Real, Vec3};

/// What has to be exceeded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margin {
    /// Separation d (own unit), not negative.
    pub(super) separation: Real,
    /// Largest coordinate S of a corner at the start or the end of the motion (own unit).
    pub(super) size: Real,
}

impl Margin {
    /// How much further than d the polygon `x` certainly is (own unit), going by the unit vector `direction`. Not
    /// positive: nothing is certain.
    pub(super) fn certified_gap<const K: usize>(self, direction: Vec3, x: &[Vec3; K]) -> Real {
        let nearest = x.iter().map(|x| direction.dot(x));
        nearest.fold(Real::INFINITY, Real::min) - self.limit(direction)
    }

    /// What n · x has to exceed for the steady direction n.
    fn limit(self, direction: Vec3) -> Real {
        let rounding = Real::ROUNDING * norm_1(&direction) * (self.size + self.separation);
        self.separation * direction.norm() + rounding
    }

    /// Whether one of the axes certifies the whole motion of the polygon from `from` to `to`: the boxes that it sweeps
    /// are apart.
    pub(super) fn apart_along_an_axis<const K: usize>(
        self,
        from: &[Vec3; K],
        to: &[Vec3; K],
    ) -> bool {
        let limit = self.limit(Vec3::x());
        let all = || from.iter().chain(to);
        let lower = all().fold(Vec3::repeat(Real::INFINITY), |low, x| low.inf(x));
        let upper = all().fold(Vec3::repeat(Real::NEG_INFINITY), |high, x| high.sup(x));
        lower.max() > limit || upper.min() < -limit
    }

    /// How much of the interval, 0..=1, the steady `direction` certifies as free of contact. The polygon moves from
    /// `from` to `to`.
    pub(super) fn steady_reach<const K: usize>(
        self,
        direction: Vec3,
        from: &[Vec3; K],
        to: &[Vec3; K],
    ) -> Real {
        let limit = self.limit(direction);
        let of_corner = |k: usize| {
            let over = [&from[k], &to[k]].map(|x| direction.dot(x) - limit);
            positive_until(over)
        };
        (0..K).map(of_corner).fold(1.0, Real::min)
    }

    /// The sign, 1 or −1, with which a moving direction that is `start` at first has the polygon `x` on its positive
    /// side there, nothing if it has not and so cannot certify anything: what is allowed for rounding only grows with
    /// what it is later.
    pub(super) fn facing<S: Number, const K: usize>(
        self,
        start: &Triple<S>,
        x: &[Triple<S>; K],
    ) -> Option<Real> {
        let rounded = value(start);
        let over = norm_1(&rounded) * (self.size + self.separation);
        // Mostly `f64` can tell that there are corners on both sides.
        let rough = x.map(|x| rounded.dot(&value(&x)));
        let clearly = |side: Real| rough.iter().any(|p| side * p > Real::ROUNDING * over);
        if clearly(1.0) && clearly(-1.0) {
            return None;
        }
        let products = x.map(|x| dot(start, &x).value());
        let sign = if products.iter().sum::<Real>() < 0.0 {
            -1.0
        } else {
            1.0
        };
        let nearest = products
            .iter()
            .fold(Real::INFINITY, |least, p| least.min(sign * p));
        let limit = self.separation * rounded.norm() + S::ROUNDING * over;
        (nearest > limit).then_some(sign)
    }

    /// The same with a `direction` that moves.
    pub(super) fn moving_reach<S: Number, const K: usize>(
        self,
        direction: &MovingDirection<S>,
        from: &[Triple<S>; K],
        to: &[Triple<S>; K],
    ) -> Real {
        let rounded = direction.map(|n| value(&n));
        let norm_1 = rounded.iter().map(norm_1).fold(0.0, Real::max);
        let [m0, m1, m2] = rounded.map(|n| self.separation * n.norm());
        let limit = [m0, (m0 + 2.0 * m1) / 3.0, (2.0 * m1 + m2) / 3.0, m2];
        let rounding = S::ROUNDING * norm_1 * (self.size + self.separation);
        let roughly = |x0: &Triple<S>, x1: &Triple<S>| {
            let [x0, x1] = [x0, x1].map(|x| x.map(S::value));
            let product = products(&direction.map(|n| n.map(S::value)), &x0, &x1);
            let rounding = Real::ROUNDING * norm_1 * (self.size + self.separation);
            (0..4).all(|i| product[i] - limit[i] > 2.0 * rounding)
        };
        let of_corner = |(x0, x1): (&Triple<S>, &Triple<S>)| {
            // Where `f64` can tell that all of them are positive, there is nothing more to know.
            if S::ROUNDING < Real::ROUNDING && roughly(x0, x1) {
                return 1.0;
            }
            let product = products(direction, x0, x1);
            let over: [Real; 4] = std::array::from_fn(|i| product[i] - limit[i] - rounding);
            positive_until(over)
        };
        from.iter().zip(to).map(of_corner).fold(1.0, Real::min)
    }
}

/// The Bernstein coefficients of n · x, of a corner that goes from `x0` to `x1`.
#[inline]
fn products<S: Number>(
    [n0, n1, n2]: &MovingDirection<S>,
    x0: &Triple<S>,
    x1: &Triple<S>,
) -> [Real; 4] {
    let twice = |s: S| s.times_power(2.0);
    [
        dot(n0, x0).value(),
        (twice(dot(n1, x0)) + dot(n0, x1)).value() / 3.0,
        (dot(n2, x0) + twice(dot(n1, x1))).value() / 3.0,
        dot(n2, x1).value(),
    ]
}

fn norm_1(v: &Vec3) -> Real {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// How far, from 0 towards 1, the polynomial with these Bernstein coefficients is certainly positive, to a few
/// roundings: where the convex hull of its control points meets zero. It is 1 only if all of them are positive.
fn positive_until<const N: usize>(coefficients: [Real; N]) -> Real {
    if coefficients[0] <= 0.0 {
        return 0.0;
    }
    let mut until: Real = 1.0;
    for (k, &below) in coefficients.iter().enumerate() {
        if below > 0.0 {
            continue;
        }
        for (i, &above) in coefficients[..k].iter().enumerate() {
            if above > 0.0 {
                let crossing = i as Real + (k - i) as Real * (above / (above - below));
                // If `below` is tiny the quotient rounds to one.
                let fraction = (crossing / (N - 1) as Real).min(1.0 - Real::EPSILON);
                until = until.min(fraction);
            }
        }
    }
    until
}

#[cfg(test)]
#[path = "../../tests/unit/ccd_reach.rs"]
mod tests;

//! Directions along which the polygon of differences stays on one side of the origin, chosen by the feature that is
//! nearest.
//!
//! Any direction may be tried: what it proves is computed by `reach`, which takes the direction as it stands.
//! A bad choice costs a step, never a miss.

use super::difference::Feature;
use super::number::{Number, Triple, cross, minus, plus, power_for, times_power, value};
use cloth_core::math::{Real, Vec3};

/// A direction that changes with time as a polynomial of second degree: its three Bernstein coefficients over an
/// interval (the values at both ends, and what the parabola leans to in between).
pub(super) type MovingDirection<S> = [Triple<S>; 3];

/// The direction (unit length) from the origin to the nearest point of the polygon `x`, if that point is on `feature`.
/// Nothing if the feature has no extent.
///
/// The difference vector to the nearest point itself would lose its digits when the polygon is near. Built from the
/// feature's edges, the direction keeps them: it is across those edges to within rounding, so all corners of the
/// feature are equally far along it.
pub(super) fn steady<const K: usize>(feature: Feature, x: &[Vec3; K]) -> Option<Vec3> {
    let direction = match feature {
        Feature::Face => {
            let (u, v) = (filled(x[0] - x[1])?, filled(x[0] - x[2])?);
            // In a sliver u × v has lost digits. Across the longest edge it needs them most.
            let (longest, other) = if (x[0] - x[1]).norm_squared() > (x[0] - x[2]).norm_squared() {
                (u, v)
            } else {
                (v, u)
            };
            across(filled(longest.cross(&other))?, longest)
        }
        Feature::Edge(k, l) => {
            let e = filled(x[k] - x[l])?;
            across(filled(e.cross(&filled(x[k].cross(&e))?))?, e)
        }
        Feature::Corner(k) => x[k],
    };
    let direction = filled(direction)?;
    let sign = facing(&direction, x);
    Some(direction * (sign / direction.norm()))
}

/// A direction that follows `feature` from `x`, where the polygon is now, to `end`, where it will be. Its length is of
/// order one.
///
/// - The face: u × v, the product of two vectors that move linearly, is the normal at all times, exactly.
/// - An edge e: e × q, where q is across e and the vector to it, now. It stays across e at all times.
/// - A corner: the vector to it.
///
/// The sign is that of `facing`, which is asked about the direction at the start. Most directions fail there already,
/// so the coefficients at later times are computed after it.
pub(super) fn moving<S: Number, const K: usize>(
    feature: Feature,
    x: &[Triple<S>; K],
    end: &[Triple<S>; K],
    facing: impl Fn(&Triple<S>) -> Option<Real>,
) -> Option<MovingDirection<S>> {
    let side = |k: usize, l: usize| both_filled(minus(&x[k], &x[l]), minus(&end[k], &end[l]));
    let linear = |a: Triple<S>, b: Triple<S>| [a, times_power(&plus(&a, &b), 0.5), b];
    let (direction, sign) = match feature {
        Feature::Face => {
            let ([u0, u1], [v0, v1]) = (side(0, 1)?, side(0, 2)?);
            let start = cross(&u0, &v0);
            let sign = facing(&start)?;
            let between = plus(&cross(&u0, &v1), &cross(&u1, &v0));
            let between = times_power(&between, 0.5);
            ([start, between, cross(&u1, &v1)], sign)
        }
        Feature::Edge(k, l) => {
            let [e0, e1] = side(k, l)?;
            let [q, _] = both_filled(cross(&x[k], &e0), cross(&x[k], &e0))?;
            let start = cross(&e0, &q);
            let sign = facing(&start)?;
            (linear(start, cross(&e1, &q)), sign)
        }
        Feature::Corner(k) => (linear(x[k], end[k]), facing(&x[k])?),
    };
    let largest = direction
        .iter()
        .map(|n| value(n).amax())
        .fold(0.0, Real::max);
    (largest > 0.0).then(|| direction.map(|n| times_power(&n, power_for(largest) * sign)))
}

/// `v` without its part along `e`.
fn across(v: Vec3, e: Vec3) -> Vec3 {
    v - e * (v.dot(&e) / e.norm_squared())
}

/// 1 or −1: the sign that makes `direction` point from the origin to the polygon `x`.
fn facing<const K: usize>(direction: &Vec3, x: &[Vec3; K]) -> Real {
    let total: Real = x.iter().map(|x| direction.dot(x)).sum();
    if total < 0.0 { -1.0 } else { 1.0 }
}

/// `v` scaled so that its largest coordinate is ±1; nothing if it is zero.
fn filled(v: Vec3) -> Option<Vec3> {
    let largest = v.amax();
    (largest > 0.0).then(|| v / largest)
}

/// Both times the same power of two, so that the largest coordinate is of order one; nothing if both are zero.
fn both_filled<S: Number>(a: Triple<S>, b: Triple<S>) -> Option<[Triple<S>; 2]> {
    let largest = value(&a).amax().max(value(&b).amax());
    (largest > 0.0).then(|| [a, b].map(|x| times_power(&x, power_for(largest))))
}

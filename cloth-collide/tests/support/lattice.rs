//! The same distances for whole coordinates, in exact integer arithmetic up to the last quotient and root. For tests.

use cloth_core::math::{Real, Vec3};
use proptest::prelude::*;

/// Coordinates that make coincident points, parallel and nearly parallel edges, slivers and zero areas frequent.
pub(crate) fn awkward() -> impl Strategy<Value = Vec3> {
    let whole = (-2i32..=2).prop_map(f64::from);
    let coordinate = (
        whole,
        prop_oneof![Just(0.0), -1e-9..1e-9, -1e-15..1e-15, -1.0..1.0],
    )
        .prop_map(|(whole, part)| whole + part);
    [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Vec3::from)
}

pub(crate) type Point = [i128; 3];

pub(crate) fn real(p: Point) -> Vec3 {
    p.map(|c| c as Real).into()
}

/// Four points on a lattice: a small one, so that they coincide, line up and share planes often; a large one; and one
/// that is long and thin, of which all points are in one plane. There, slivers and nearly parallel edges have
/// angles down to 1e-8 and are often at distance 0, where an error is most visible, and parallel edges have
/// coordinates too long for their cross product to come out as zero.
pub(crate) fn lattice() -> impl Strategy<Value = [Point; 4]> {
    let points = |size: i128| proptest::array::uniform4(proptest::array::uniform3(-size..=size));
    let directions = (points(100_000_000), points(1000), points(3), points(3));
    let long_and_thin = directions.prop_map(|(long, medium, short, steps)| {
        let [start, along] = [long[0], long[1]];
        let across = [short[0], medium[0]][usize::from(short[1][0] > 0)];
        steps.map(|[i, j, _]| [0, 1, 2].map(|k| start[k] + i * along[k] + j * across[k]))
    });
    prop_oneof![
        points(1),
        points(3),
        points(1000),
        points(500_000),
        long_and_thin.clone(),
        long_and_thin
    ]
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn root_of_quotient(a: i128, b: i128) -> Real {
    (a as Real / b as Real).sqrt()
}

fn point_segment(p: Point, [a, b]: [Point; 2]) -> Real {
    let (d, e) = (minus(p, a), minus(b, a));
    let along = dot(d, e);
    if along <= 0 {
        root_of_quotient(dot(d, d), 1)
    } else if along >= dot(e, e) {
        root_of_quotient(dot(minus(p, b), minus(p, b)), 1)
    } else {
        let n = cross(d, e);
        root_of_quotient(dot(n, n), dot(e, e))
    }
}

/// Distance of p from the plane through the origin across n.
fn height(p: Point, n: Point) -> Real {
    dot(p, n).unsigned_abs() as Real / root_of_quotient(dot(n, n), 1)
}

pub(crate) fn point_triangle(p: Point, [a, b, c]: [Point; 3]) -> Real {
    let n = cross(minus(b, a), minus(c, a));
    let left_of = |from: Point, to: Point| dot(n, cross(minus(to, from), minus(p, from))) >= 0;
    if n != [0; 3] && left_of(a, b) && left_of(b, c) && left_of(c, a) {
        height(minus(p, a), n)
    } else {
        [[a, b], [b, c], [c, a]]
            .map(|edge| point_segment(p, edge))
            .into_iter()
            .fold(Real::MAX, Real::min)
    }
}

pub(crate) fn edge_edge([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Real {
    let (u, v, w) = (minus(b, a), minus(d, c), minus(c, a));
    let n = cross(u, v);
    let inside = |x: i128| 0 <= x && x <= dot(n, n);
    // a + s u + h n = c + t v; Cramer's rule.
    if n != [0; 3] && inside(dot(n, cross(w, v))) && inside(dot(n, cross(w, u))) {
        height(w, n)
    } else {
        let ends = [(a, [c, d]), (b, [c, d]), (c, [a, b]), (d, [a, b])];
        ends.map(|(p, edge)| point_segment(p, edge))
            .into_iter()
            .fold(Real::MAX, Real::min)
    }
}

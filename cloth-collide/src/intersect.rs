//! The exact test whether two triangles meet.

mod apart;

use apart::certainly_apart;
use cloth_core::math::Vec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Whether two triangles (three positions each, m) have a point in common.
///
/// Triangles are closed: boundary and corners belong to them, so **touching counts**, be it corner to
/// face, corner to corner or two coplanar triangles that overlap or share part of an edge. A triangle without area
/// is the segment or the point that it has become. The answer does not change when the two triangles
/// change places or their corners change order.
///
/// Two triangles meet exactly if an edge of one meets the other. An edge pq that is not in the
/// plane of the triangle abc meets it exactly if p and q are not strictly on one side of the plane, and the three
/// volumes pqab, pqbc, pqca do not differ in sign (Guigue and Devillers 2003). Each volume's sign is
/// computed with as many digits as it needs (Shewchuk 1997). If everything is coplanar the same
/// question is asked of the three projections along the axes: they all meet exactly if the originals do,
/// because one of them at least is one-to-one. Most pairs do not get that far: they are apart by more than
/// rounding along the normal of a triangle or of its edges, which plain floating point can tell.
///
/// Exact means: right for the `f64` coordinates as they stand, without any tolerance. Only overflow and underflow of
/// a product of three coordinate differences, beyond about 1e100 m and below about 1e-100 m, are not guarded against.
///
/// ```
/// use cloth_collide::triangles_meet;
/// use cloth_core::math::Vec3;
///
/// let floor = [Vec3::zeros(), Vec3::x(), Vec3::y()];
/// let standing = |z| [Vec3::new(0.25, 0.25, z), Vec3::new(0.25, 0.25, z + 1.0), Vec3::new(0.5, 0.25, z + 1.0)];
/// assert!(triangles_meet(floor, standing(-0.5))); // through it
/// assert!(triangles_meet(floor, standing(0.0))); // on it, by a corner
/// assert!(!triangles_meet(floor, standing(1e-300))); // above it
/// ```
#[must_use]
pub fn triangles_meet(first: [Vec3; 3], second: [Vec3; 3]) -> bool {
    if certainly_apart(first, second) {
        return false;
    }
    let Some(second_sides) = sides_unless_apart(first, second) else {
        return false;
    };
    let Some(first_sides) = sides_unless_apart(second, first) else {
        return false;
    };
    (0..3).any(|i| {
        let j = (i + 1) % 3;
        edge_meets(
            [second[i], second[j]],
            [second_sides[i], second_sides[j]],
            first,
        ) || edge_meets(
            [first[i], first[j]],
            [first_sides[i], first_sides[j]],
            second,
        )
    })
}

/// Whether a segment (two positions, m) and a triangle (three positions, m) have a point in
/// common. Exact, and closed like [`triangles_meet`], which see for the method and its limits.
#[must_use]
pub fn segment_meets_triangle(segment: [Vec3; 2], triangle: [Vec3; 3]) -> bool {
    !certainly_apart(segment, triangle)
        && edge_meets(segment, segment.map(|p| side(triangle, p)), triangle)
}

/// The side of the plane of `triangle` on which `point` is: 1, −1, or 0 in the plane; always 0 for a triangle
/// without area.
fn side(triangle: [Vec3; 3], point: Vec3) -> i8 {
    let [a, b, c, p] = [triangle[0], triangle[1], triangle[2], point].map(|v| Coord3D {
        x: v.x,
        y: v.y,
        z: v.z,
    });
    sign(orient3d(a, b, c, p))
}

/// Sign of a number that is not NaN: 1, 0 or −1.
fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// The sides of the plane of `triangle` on which `points` are, or nothing if all are strictly on one.
fn sides_unless_apart(triangle: [Vec3; 3], points: [Vec3; 3]) -> Option<[i8; 3]> {
    let first = side(triangle, points[0]);
    let second = side(triangle, points[1]);
    let third = side(triangle, points[2]);
    let apart = first != 0 && first == second && second == third;
    (!apart).then_some([first, second, third])
}

/// Whether `segment`, whose ends are on the given `sides` of the plane of `triangle`, meets it.
fn edge_meets(segment: [Vec3; 2], sides: [i8; 2], triangle: [Vec3; 3]) -> bool {
    if sides[0] * sides[1] > 0 {
        return false;
    }
    let [p, q] = segment;
    let [a, b, c] = triangle;
    let around = [side([p, q, a], b), side([p, q, b], c), side([p, q, c], a)];
    if sides != [0, 0] {
        return same_side(around);
    }
    // Everything is in one plane, or the triangle has no area. In the second case the segment may still be skew to it.
    around == [0; 3] && (0..3).all(|axis| meet_in_projection(segment, triangle, axis))
}

/// Whether no two of the three signs are opposite.
fn same_side(signs: [i8; 3]) -> bool {
    !(signs.contains(&1) && signs.contains(&-1))
}

/// [`segment_meets_triangle`] for the projections along `axis`.
fn meet_in_projection(segment: [Vec3; 2], triangle: [Vec3; 3], axis: usize) -> bool {
    let flat = |v: Vec3| Coord {
        x: v[(axis + 1) % 3],
        y: v[(axis + 2) % 3],
    };
    let [p, q] = segment.map(flat);
    let [a, b, c] = triangle.map(flat);
    segments_meet([p, q], [a, b])
        || segments_meet([p, q], [b, c])
        || segments_meet([p, q], [c, a])
        // No edge is met, so the segment is inside or outside, and a triangle without area has no inside.
        || turn(a, b, c) != 0 && same_side([turn(a, b, p), turn(b, c, p), turn(c, a, p)])
}

/// Whether the path abc turns left (1), right (−1) or not at all (0).
fn turn(a: Coord<f64>, b: Coord<f64>, c: Coord<f64>) -> i8 {
    sign(orient2d(a, b, c))
}

/// Whether two closed segments of the plane, which may be points, meet: if each reaches across the line of the
/// other, and their boxes overlap. The boxes decide for collinear segments and for points.
fn segments_meet([p, q]: [Coord<f64>; 2], [a, b]: [Coord<f64>; 2]) -> bool {
    let overlap = |p: f64, q: f64, a: f64, b: f64| p.min(q) <= a.max(b) && a.min(b) <= p.max(q);
    overlap(p.x, q.x, a.x, b.x)
        && overlap(p.y, q.y, a.y, b.y)
        && turn(p, q, a) * turn(p, q, b) <= 0
        && turn(a, b, p) * turn(a, b, q) <= 0
}

#[cfg(test)]
#[path = "../tests/unit/intersect.rs"]
mod tests;

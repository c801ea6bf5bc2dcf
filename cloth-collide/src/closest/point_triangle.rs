//! The point of a triangle nearest to a given point.

use super::nearest_on_segment;
use cloth_core::math::{Real, Vec3};

/// Where a triangle comes nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointTriangle {
    /// Barycentric coordinates (dimensionless) of the nearest point of the triangle: not negative,
    /// their sum is 1 to rounding.
    pub weights: [Real; 3],
    /// The vector (m) from the nearest point of the triangle to the given point. Its length is the
    /// distance.
    pub separation: Vec3,
}

impl PointTriangle {
    /// Distance (m) of the point from the triangle.
    #[must_use]
    pub fn distance(&self) -> Real {
        self.separation.norm()
    }
}

/// Nearest point of `triangle` (three positions, m) to `point` (m).
///
/// The plane around a triangle falls into seven regions, by whether the nearest point is inside, on an edge or at a
/// vertex (Ericson 2005, section 5.1.5). With u = b − a, e = c − a, d = p − a and n = u × e, the foot of the
/// perpendicular from p has the weights
///
/// w_c = n · (u × d) / n²,  w_b = u · (d − w_c e) / u²,  w_a = 1 − w_b − w_c.
///
/// For d = w_b u + w_c e + z n: u × d = w_c n + z u × n, whose product with n is w_c n²; and d − w_c e = w_b u + z n,
/// whose product with u is w_b u².
///
/// If none is negative, that is the answer. Otherwise the nearest point is on the boundary, and the nearest of the
/// three edges' nearest points is it; clamping takes care of the vertices. Ericson goes through the regions one by one
/// with dot products, which is less work, but for slivers their differences cancel. Here, if c is θ times as high above
/// the edge ab as it is far from a, w_c has an error of 1e-16/θ. But w_b belongs to just this w_c, so what goes wrong
/// is the height of the foot in the triangle, by 1e-16/θ times θ. A triangle that has become a segment or a point is
/// all boundary.
///
/// The distance is accurate to a few roundings of the size of the configuration (the longest of the edges and of the
/// vector to the point), for every shape of triangle. The weights are less certain, as they have to be: moving the
/// nearest point by 1e-8 of that size changes the distance by one rounding only. For a triangle without area they are
/// not even unique; any that fit are returned.
///
/// ```
/// use cloth_collide::point_triangle;
/// use cloth_core::math::Vec3;
///
/// let triangle = [Vec3::zeros(), Vec3::x(), Vec3::y()];
/// let above = point_triangle(Vec3::new(0.25, 0.25, 2.0), triangle);
/// assert_eq!(above.weights, [0.5, 0.25, 0.25]);
/// assert_eq!(above.distance(), 2.0);
/// ```
#[must_use]
pub fn point_triangle(point: Vec3, triangle: [Vec3; 3]) -> PointTriangle {
    inside(point, triangle).unwrap_or_else(|| nearest_on_boundary(point, triangle))
}

/// The foot of the perpendicular from `point` to the plane of `triangle` (m), if it is inside.
fn inside(point: Vec3, triangle: [Vec3; 3]) -> Option<PointTriangle> {
    let [a, b, c] = triangle;
    let (u, e, d) = (b - a, c - a, point - a);
    let n = u.cross(&e);
    let wc = n.dot(&u.cross(&d)) / n.norm_squared();
    let above = d - e * wc;
    let wb = u.dot(&above) / u.norm_squared();
    let wa = 1.0 - wb - wc;
    // Written so that the NaN of a triangle without area is not inside.
    (wa >= 0.0 && wb >= 0.0 && wc >= 0.0).then(|| PointTriangle {
        weights: [wa, wb, wc],
        separation: above - u * wb,
    })
}

/// The nearest point (of `triangle`, to `point`, all in m) among those of the three edges.
fn nearest_on_boundary(point: Vec3, triangle: [Vec3; 3]) -> PointTriangle {
    let on_edge = |from: usize, to: usize| {
        let (d, edge) = (point - triangle[from], triangle[to] - triangle[from]);
        let t = nearest_on_segment(d, edge);
        let mut weights = [0.0; 3];
        weights[from] = 1.0 - t;
        weights[to] = t;
        PointTriangle {
            weights,
            separation: d - edge * t,
        }
    };
    let mut nearest = on_edge(0, 1);
    for next in [on_edge(1, 2), on_edge(2, 0)] {
        if next.separation.norm_squared() < nearest.separation.norm_squared() {
            nearest = next;
        }
    }
    nearest
}

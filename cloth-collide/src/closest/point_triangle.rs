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

#[cfg(test)]
mod tests {
    use super::super::reference;
    use super::*;
    use proptest::prelude::*;

    /// Coordinates that make coincident points, zero areas and slivers frequent.
    fn awkward() -> impl Strategy<Value = Vec3> {
        let whole = (-2i32..=2).prop_map(f64::from);
        let coordinate = (
            whole,
            prop_oneof![Just(0.0), -1e-9..1e-9, -1e-15..1e-15, -1.0..1.0],
        )
            .prop_map(|(whole, part)| whole + part);
        [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Vec3::from)
    }

    /// The nearest point q of a convex set to p is the one for which the whole set lies behind the plane
    /// through q across p − q: (p − q)·(x − q) ≤ 0. For a triangle its corners are enough.
    fn assert_nearest(p: Vec3, triangle: [Vec3; 3]) -> Result<(), TestCaseError> {
        let found = point_triangle(p, triangle);
        let [wa, wb, wc] = found.weights;
        prop_assert!(wa >= 0.0 && wb >= 0.0 && wc >= 0.0 && (wa + wb + wc - 1.0).abs() < 1e-14);
        let q = triangle[0] * wa + triangle[1] * wb + triangle[2] * wc;
        prop_assert!((p - q - found.separation).norm() < 1e-13, "{found:?} {q}");
        for x in triangle {
            let beyond = found.separation.dot(&(x - q));
            // Not tighter, because the weights are certain to 1e-8 only; the exact reference is for the distance.
            prop_assert!(beyond < 1e-6, "{x} is in front by {beyond:e}: {found:?}");
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn whole_triangle_lies_behind_the_nearest_point(
            p in awkward(), a in awkward(), b in awkward(), c in awkward()
        ) {
            assert_nearest(p, [a, b, c])?;
        }

        #[test]
        fn no_sampled_point_is_nearer(p in awkward(), a in awkward(), b in awkward(), c in awkward()) {
            let distance = point_triangle(p, [a, b, c]).distance();
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let sample = a * (1.0 - u - v) + b * u + c * v;
                    prop_assert!(distance <= (p - sample).norm() + 1e-14);
                }
            }
        }

        #[test]
        fn distance_is_that_of_integer_arithmetic([p, a, b, c] in reference::lattice()) {
            let exact = reference::point_triangle(p, [a, b, c]);
            let [p, a, b, c] = [p, a, b, c].map(reference::real);
            let found = point_triangle(p, [a, b, c]).distance();
            let size = [a - p, b - p, c - p].map(|d| d.norm()).into_iter().fold(0.0, f64::max);
            prop_assert!((found - exact).abs() <= 1e-14 * size, "{found:e} is not {exact:e}, size {size:e}");
        }

        #[test]
        fn distance_does_not_depend_on_the_order_of_the_corners(
            p in awkward(), a in awkward(), b in awkward(), c in awkward()
        ) {
            let d = point_triangle(p, [a, b, c]).distance();
            for order in [[b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]] {
                prop_assert!((point_triangle(p, order).distance() - d).abs() < 1e-13);
            }
        }
    }

    fn v(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x, y, z)
    }

    #[test]
    fn each_of_the_seven_regions_has_its_known_nearest_point() {
        let triangle = [v(0., 0., 0.), v(4., 0., 0.), v(0., 4., 0.)];
        // (point, weights, squared distance), exact in binary.
        for (point, weights, squared) in [
            (v(1., 1., 3.), [0.5, 0.25, 0.25], 9.), // inside
            (v(2., -3., 4.), [0.5, 0.5, 0.], 25.),  // edge ab
            (v(4., 4., 1.), [0., 0.5, 0.5], 9.),    // edge bc
            (v(-2., 1., 0.), [0.75, 0., 0.25], 4.), // edge ca
            (v(-3., -4., 0.), [1., 0., 0.], 25.),   // a
            (v(6., -1., 2.), [0., 1., 0.], 9.),     // b
            (v(1., 12., 0.), [0., 0., 1.], 65.),    // c
        ] {
            let found = point_triangle(point, triangle);
            assert_eq!(found.weights, weights, "{point}");
            assert_eq!(found.separation.norm_squared(), squared, "{point}");
        }
    }

    #[test]
    fn triangle_without_area_is_a_segment_and_without_length_a_point() {
        let segment = [v(0., 0., 0.), v(4., 0., 0.), v(1., 0., 0.)];
        assert_eq!(point_triangle(v(3., 2., 0.), segment).distance(), 2.0);
        assert_eq!(point_triangle(v(7., 4., 0.), segment).distance(), 5.0);
        let place = v(0.1, 0.2, 0.3);
        assert_eq!(
            point_triangle(place + v(0., 3., 4.), [place; 3]).distance(),
            (v(0.1, 3.2, 4.3) - place).norm()
        );
        assert_eq!(point_triangle(place, [place; 3]).distance(), 0.0);
        // So small that the squares of the edges are zero in floating point.
        let tiny = [v(0., 0., 0.), v(1e-170, 0., 0.), v(0., 1e-170, 0.)];
        assert_eq!(point_triangle(v(0., 0., 1.), tiny).distance(), 1.0);
    }

    fn direction() -> impl Strategy<Value = Vec3> {
        [-1.0..1.0, -1.0..1.0, -1.0..1.0f64].prop_map(|x| Vec3::from(x).normalize())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        /// Needles, caps and what is between, thin down to nothing; points above them, as near to the rim as can be.
        #[test]
        fn height_above_a_thin_triangle_is_accurate(
            (along, other) in (direction(), direction()),
            foot_of_c in prop_oneof![Just(1.0), Just(0.0), Just(0.5), 0.0..1.0],
            width in 0..20,
            exponents in [0..12, 0..12, 0..12],
            height in prop_oneof![Just(0.0), Just(0.25)],
        ) {
            let up = along.cross(&other).normalize();
            let width = 0.1f64.powi(width);
            let (a, b) = (Vec3::zeros(), along);
            let c = along * foot_of_c + up.cross(&along) * width;
            let [wa, wb, wc] = exponents.map(|e| 0.1f64.powi(e));
            let p = (a * wa + b * wb + c * wc) / (wa + wb + wc) + up * height;
            for triangle in [[a, b, c], [b, c, a], [c, a, b], [c, b, a], [b, a, c], [a, c, b]] {
                let error = (point_triangle(p, triangle).distance() - height).abs();
                prop_assert!(error < 3e-15, "{error:e}");
            }
        }
    }
}

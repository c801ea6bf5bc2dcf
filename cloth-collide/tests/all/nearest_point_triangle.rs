//! The nearest point of a triangle, against exact arithmetic and in awkward places.

use crate::lattice::{self as reference, awkward};
use cloth_collide::point_triangle;
use cloth_core::math::Vec3;
use proptest::prelude::*;

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

//! Nearest points of two edges, against exact arithmetic and in awkward places.

use crate::lattice::{self as reference, awkward};
use cloth_collide::edge_edge;
use cloth_core::math::Vec3;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]
    /// The differences x − y of points of two convex sets form a convex set, and the separation m is its
    /// point nearest to the origin exactly if m·(x − y − m) ≥ 0 for all of them; here, for the four pairs of ends.
    #[test]
    fn all_pairs_of_ends_lie_beyond_the_nearest_pair(
        a in awkward(), b in awkward(), c in awkward(), d in awkward()
    ) {
        let found = edge_edge([a, b], [c, d]);
        let [s, t] = found.along;
        prop_assert!((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t));
        let m = a.lerp(&b, s) - c.lerp(&d, t);
        prop_assert!((m - found.separation).norm() < 1e-13, "{found:?} {m}");
        for x in [a, b] {
            for y in [c, d] {
                let missing = -m.dot(&(x - y - m));
                // Not tighter, because the points are certain to 1e-8 only; the exact reference is for the
                // distance.
                prop_assert!(missing < 1e-6, "{x} {y} are in front by {missing:e}: {found:?}");
            }
        }
    }

    #[test]
    fn no_sampled_pair_is_nearer(a in awkward(), b in awkward(), c in awkward(), d in awkward()) {
        let distance = edge_edge([a, b], [c, d]).distance();
        for i in 0..=16 {
            for j in 0..=16 {
                let m = a.lerp(&b, f64::from(i) / 16.0) - c.lerp(&d, f64::from(j) / 16.0);
                prop_assert!(distance <= m.norm() + 1e-14);
            }
        }
    }

    #[test]
    fn distance_is_that_of_integer_arithmetic([a, b, c, d] in reference::lattice()) {
        let exact = reference::edge_edge([a, b], [c, d]);
        let [a, b, c, d] = [a, b, c, d].map(reference::real);
        let found = edge_edge([a, b], [c, d]).distance();
        let size = [b - a, c - a, d - a].map(|d| d.norm()).into_iter().fold(0.0, f64::max);
        prop_assert!((found - exact).abs() <= 1e-14 * size, "{found:e} is not {exact:e}, size {size:e}");
    }

    #[test]
    fn distance_does_not_depend_on_order_or_direction(
        a in awkward(), b in awkward(), c in awkward(), d in awkward()
    ) {
        let distance = edge_edge([a, b], [c, d]).distance();
        for (first, second) in [([c, d], [a, b]), ([b, a], [c, d]), ([a, b], [d, c])] {
            prop_assert!((edge_edge(first, second).distance() - distance).abs() < 1e-13);
        }
    }
}

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

#[test]
fn known_cases() {
    let edge = [v(0., 0., 0.), v(4., 0., 0.)];
    // (second edge, fractions, squared distance), exact in binary.
    for (second, along, squared) in [
        ([v(1., -1., 2.), v(1., 3., 2.)], [0.25, 0.25], 4.), // crossing above
        ([v(2., 3., 4.), v(2., 8., 4.)], [0.5, 0.], 25.),    // an end above the inside
        ([v(7., 4., 0.), v(9., 6., 0.)], [1., 0.], 25.),     // two ends
        ([v(2., 0., 0.), v(2., 5., 0.)], [0.5, 0.], 0.),     // touching
        ([v(9., 0., 0.), v(6., 0., 0.)], [1., 1.], 4.),      // on one line, apart
        ([v(3., 5., 0.), v(3., 5., 0.)], [0.75, 0.], 25.),   // a point
    ] {
        let found = edge_edge(edge, second);
        assert_eq!(found.along, along, "{second:?}");
        assert_eq!(found.separation.norm_squared(), squared, "{second:?}");
    }
}

#[test]
fn parallel_edges_and_edges_without_length() {
    let edge = [v(0., 0., 0.), v(4., 0., 0.)];
    assert_eq!(
        edge_edge(edge, [v(1., 2., 0.), v(9., 2., 0.)]).distance(),
        2.0
    );
    assert_eq!(
        edge_edge(edge, [v(9., 2., 0.), v(1., 2., 0.)]).distance(),
        2.0
    );
    assert_eq!(
        edge_edge(edge, [v(3., 0., 0.), v(9., 0., 0.)]).distance(),
        0.0
    ); // overlapping
    // One so short that the square of the cross product has hardly a digit.
    let short = [v(1.2, -1e-160, 0.), v(1.2, 1e-160, 0.)];
    assert!(edge_edge(edge, short).distance() < 1e-15);
    let (p, q) = (v(1., 3., 0.), v(1., 0., 4.));
    assert_eq!(edge_edge([p, p], [q, q]).distance(), 5.0);
    assert_eq!(edge_edge([p, p], [p, p]).distance(), 0.0);
}

/// Two edges that cross anywhere along them, at an angle of 2/k, have their height as distance, whatever k.
#[test]
fn nearly_parallel_edges_that_cross_have_their_height_as_distance() {
    for exponent in 0..20 {
        let slope = 0.1f64.powi(exponent);
        for (part, height) in [(0.1, 0.0), (0.37, 1e-9), (0.83, 0.25)] {
            let first = [
                v(-part, -part * slope, height),
                v(1. - part, (1. - part) * slope, height),
            ];
            let second = [v(-0.7, 0.7 * slope, 0.), v(0.9, -0.9 * slope, 0.)];
            let distance = edge_edge(first, second).distance();
            let error = (distance - height).abs();
            assert!(
                error < 5e-16,
                "slope {slope:e}: {distance:e} instead of {height:e}"
            );
        }
    }
}

//! Distances, their first and second derivatives, and the energies made from them, against differences and closed
//! forms.

use crate::random::Random;
use cloth_collide::QueryKind;
use cloth_collide::obstacle::PenaltyLaw;
use cloth_collide::potential::{Gap, Mollifier, Pair, PairContact};
use cloth_core::check::{gradient_error, hessian_error, smallest_eigenvalue};
use cloth_core::element::{Convexity, Energy};
use cloth_core::math::{Blocks, Mat3, Vec3};

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

fn pair(kind: QueryKind) -> Pair {
    let vertices = [0, 1, 2, 3];
    Pair { kind, vertices }
}

fn vertex_triangle() -> PairContact {
    PairContact {
        pair: pair(QueryKind::VertexTriangle),
        area: 0.7,
        law: PenaltyLaw::new(3.0, 1.0).unwrap(),
        mollifier: None,
    }
}

fn edge_edge(squared_lengths: [f64; 2]) -> PairContact {
    PairContact {
        pair: pair(QueryKind::EdgeEdge),
        mollifier: Some(Mollifier::new(squared_lengths)),
        ..vertex_triangle()
    }
}

/// A vertex in each of the seven regions around a triangle: face, three edges, three corners.
const REGIONS: [(f64, f64); 7] = [
    (0.4, 0.3),
    (0.45, -0.2),
    (0.75, 0.6),
    (-0.2, 0.4),
    (-0.3, -0.2),
    (1.3, -0.1),
    (-0.1, 1.3),
];

fn above_triangle(place: (f64, f64), height: f64) -> [Vec3; 4] {
    [
        v(place.0, place.1, height),
        v(0., 0., 0.),
        v(1., 0., 0.1),
        v(0., 1., -0.1),
    ]
}

/// Pairs of edges that are nearest inside both, at an end of one and inside the other, and at two ends.
fn edges() -> [[Vec3; 4]; 4] {
    let first = [v(0., 0., 0.), v(1., 0., 0.)];
    let second = [
        [v(0.4, -0.5, 0.3), v(0.6, 0.7, 0.35)],
        [v(0.4, 0.2, 0.3), v(0.6, 0.9, 0.35)],
        [v(1.3, -0.5, 0.3), v(1.2, 0.7, 0.35)],
        [v(1.2, 0.3, 0.1), v(1.7, 0.9, 0.35)],
    ];
    second.map(|other| [first[0], first[1], other[0], other[1]])
}

#[test]
fn vertex_triangle_derivatives_are_differences_in_all_regions() {
    let barrier = vertex_triangle();
    for height in [0.3, 0.03] {
        for place in REGIONS {
            let x = above_triangle(place, height);
            let scale = height.min(0.3);
            let (first, second) = (
                gradient_error(&barrier, &x, scale),
                hessian_error(&barrier, &x, scale),
            );
            assert!(first < 1e-8, "{place:?} {height}: {first:e}");
            assert!(second < 1e-7, "{place:?} {height}: {second:e}");
        }
    }
}

#[test]
fn derivatives_of_two_edges_are_those_of_differences_in_all_regions() {
    for x in edges() {
        // With and without the mollifier at work, whose threshold grows with the rest lengths.
        for lengths in [[1.0, 1.0], [1e3, 2.0]] {
            let barrier = edge_edge(lengths);
            let (first, second) = (
                gradient_error(&barrier, &x, 0.3),
                hessian_error(&barrier, &x, 0.3),
            );
            assert!(first < 1e-8, "{lengths:?}: {first:e}");
            assert!(second < 1e-7, "{lengths:?}: {second:e}");
        }
    }
}

#[test]
fn second_derivative_between_two_points_is_that_of_a_distance() {
    // (I − n nᵀ)/d, with the signs of the weights.
    let x = above_triangle((-0.3, -0.2), 0.3);
    let gap = Gap::new(QueryKind::VertexTriangle, &x);
    assert_eq!(gap.weights, [1.0, -1.0, 0.0, 0.0]);
    let n = x[0].normalize();
    let expected = (Mat3::identity() - n * n.transpose()) / x[0].norm();
    let found = gap.curvature(&x);
    assert!((found[0][0] - expected).amax() < 1e-15);
    assert!((found[0][1] + expected).amax() < 1e-15);
    assert_eq!(found[0][2].amax(), 0.0);
}

#[test]
fn height_above_a_plane_has_no_second_derivative_in_the_vertex() {
    let x = above_triangle((0.4, 0.3), 0.3);
    assert_eq!(
        Gap::new(QueryKind::VertexTriangle, &x).curvature(&x)[0][0].amax(),
        0.0
    );
}

/// Along n, with ∂c₀ = (−1, 0), only d (G⁻¹)₀₀ = d v²/|u × v|² is left of it, until that overflows.
#[test]
fn second_derivative_of_nearly_parallel_edges_is_zero_beyond_all_numbers() {
    let crossed = |slope: f64| {
        let (half, up) = (v(5.0, 5.0 * slope, 0.0), v(0.0, 0.0, 0.3));
        let along = v(0.5, 0.0, 0.0);
        let x = [up - along, up + along, -half, half];
        Gap::new(QueryKind::EdgeEdge, &x).curvature(&x)
    };
    for slope in [1e-2, 1e-9, 1e-100] {
        let expected = -0.3 * (1.0 + slope * slope) / (slope * slope);
        let found = crossed(slope)[0][0][(2, 2)];
        let error = (found / expected - 1.0).abs();
        assert!(error < 1e-15, "{slope:e}: {error:e}");
    }
    for block in crossed(2e-155).iter().flatten() {
        assert_eq!(*block, Mat3::zeros());
    }
}

/// From one region into the next, distance and gradient go on; only the second derivative may jump.
#[test]
fn gradient_is_continuous_across_the_seams() {
    let places = [
        ((0.5, 0.0), v(0., 1., 0.)),   // face | edge
        ((0.0, 0.3), v(1., 0., 0.)),   // face | edge
        ((0.5, 0.5), v(1., 1., 0.)),   // face | edge
        ((0.0, 0.0), v(1., 1., 0.)),   // face | corner
        ((0.0, -0.3), v(1., 0., 0.)),  // edge | corner
        ((1.0, -0.3), v(1., 0.0, 0.)), // edge | corner
    ];
    let barrier = vertex_triangle();
    for (place, across) in places {
        let flat = [v(0., 0., 0.), v(1., 0., 0.), v(0., 1., 0.)];
        let at = |step: f64| {
            let vertex = v(place.0, place.1, 0.3) + across * step;
            [vertex, flat[0], flat[1], flat[2]]
        };
        for step in [1e-4, 1e-7] {
            let (one, other) = (at(step), at(-step));
            let jump = barrier
                .gradient(&one)
                .iter()
                .zip(barrier.gradient(&other))
                .map(|(a, b)| (a - b).amax())
                .fold(0.0, f64::max);
            assert!(jump < 100.0 * step, "{place:?} {step:e}: {jump:e}");
        }
    }
    // Two edges, of which one is pushed beyond the end of the other.
    let barrier = edge_edge([1.0, 1.0]);
    let at = |step: f64| {
        let along = v(1.0 + step, 0., 0.3);
        [
            v(0., 0., 0.),
            v(1., 0., 0.),
            along - v(0., 0.4, 0.),
            along + v(0.1, 0.6, 0.),
        ]
    };
    for step in [1e-4, 1e-7] {
        let (one, other) = (barrier.gradient(&at(step)), barrier.gradient(&at(-step)));
        for (a, b) in one.iter().zip(other) {
            assert!((a - b).amax() < 100.0 * step, "{step:e}");
        }
    }
}

/// One edge turns, over the other, from one end being the lower one to the other end being it. The nearest points jump
/// as it passes the parallel; the mollifier takes the force away there.
#[test]
fn force_is_continuous_through_parallel_edges() {
    let barrier = edge_edge([1.0, 1.0]);
    let at = |angle: f64| {
        let along = v(0.4 * angle.cos(), 0.0, 0.4 * angle.sin());
        let middle = v(0.5, 0.0, 0.3);
        [v(0., 0., 0.), v(1., 0., 0.), middle - along, middle + along]
    };
    let jump = |one: [Vec3; 4], other: [Vec3; 4]| {
        let parts = one.iter().zip(&other).map(|(a, b)| (a - b).amax());
        parts.fold(0.0, f64::max)
    };
    for angle in [1e-3, 1e-5, 1e-7, 1e-9] {
        let [one, other] = [angle, -angle].map(|a| barrier.gradient(&at(a)));
        assert!(jump(one, other) < 1e4 * angle, "{:e}", jump(one, other));
        let [one, other] =
            [angle, -angle].map(|a| Gap::new(QueryKind::EdgeEdge, &at(a)).gradient());
        assert!(jump(one, other) > 0.7);
    }
    assert_eq!(barrier.value(&at(0.0)), 0.0);
}

#[test]
fn hessians_that_are_made_convex_have_no_negative_eigenvalue() {
    let mut random = Random::new(7);
    let mut indefinite = 0;
    for _ in 0..300 {
        let x: [Vec3; 4] = std::array::from_fn(|_| random.point(0.7));
        let (one, other) = (vertex_triangle(), edge_edge([1e3, 1.0]));
        let lowest = |convexity| {
            let (a, b) = (
                smallest_eigenvalue(&one, &x, convexity),
                smallest_eigenvalue(&other, &x, convexity),
            );
            let size = |h: Blocks<4>| h.iter().flatten().map(|b| b.amax()).fold(1e-300, f64::max);
            (a / size(one.hessian(&x, convexity))).min(b / size(other.hessian(&x, convexity)))
        };
        indefinite += usize::from(lowest(Convexity::Exact) < -1e-6);
        for convexity in [Convexity::Clamp, Convexity::GaussNewton] {
            assert!(lowest(convexity) > -1e-12, "{:e}", lowest(convexity));
        }
    }
    assert!(indefinite > 100, "{indefinite}");
}

/// Moving everything changes nothing, so forces add up to zero, and so do their moments.
#[test]
fn forces_and_moments_add_up_to_nothing() {
    let mut random = Random::new(3);
    for _ in 0..200 {
        let x: [Vec3; 4] = std::array::from_fn(|_| random.point(0.6));
        for g in [
            vertex_triangle().gradient(&x),
            edge_edge([1e3, 1.0]).gradient(&x),
        ] {
            let size: f64 = g.iter().map(|g| g.norm()).sum();
            let force: Vec3 = g.iter().sum();
            let moment: Vec3 = x.iter().zip(&g).map(|(x, g)| x.cross(g)).sum();
            assert!(force.norm() <= 1e-13 * size && moment.norm() <= 1e-12 * size);
        }
    }
}

/// Where two primitives touch the energy is infinite, and what has no value is zero: parallel edges with m = 0 too.
#[test]
fn pieces_that_touch_have_an_infinite_energy_and_no_direction() {
    let along = |y: f64| [v(0.0, y, 0.0), v(1.0, y, 0.0)];
    let across = [v(0.5, -0.5, 0.0), v(0.5, 0.5, 0.0)];
    let [[a, b], [c, d]] = [along(0.0), across];
    for (contact, x) in [
        (edge_edge([1.0; 2]), [a, b, a, b]),
        (edge_edge([1.0; 2]), [a, b, c, d]),
        (edge_edge([1e4; 2]), [a, b, c, d]),
        (
            vertex_triangle(),
            [v(0.2, 0.2, 0.0), a, b, v(0.0, 1.0, 0.0)],
        ),
    ] {
        let (value, gradient) = contact.value_and_gradient(&x);
        assert_eq!((value, gradient), (f64::INFINITY, [Vec3::zeros(); 4]));
        for convexity in [Convexity::Exact, Convexity::Clamp, Convexity::GaussNewton] {
            let blocks = contact.hessian(&x, convexity);
            assert!(blocks.iter().flatten().all(|block| *block == Mat3::zeros()));
        }
    }
}

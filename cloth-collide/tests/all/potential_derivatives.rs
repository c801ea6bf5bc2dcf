//! The energies of pairs and their gradients, against differences and closed forms.

use crate::random::Random;
use cloth_collide::QueryKind;
use cloth_collide::obstacle::PenaltyLaw;
use cloth_collide::potential::{Gap, Mollifier, Pair, PairContact};
use cloth_core::check::gradient_error;
use cloth_core::element::{Convexity, Element, Energy};
use cloth_core::math::{Blocks, Vec3};

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// As an element, for the checks of those.
#[derive(Clone, Copy, Debug)]
struct Barrier(PairContact);

impl Element<4> for Barrier {
    fn vertices(&self) -> [u32; 4] {
        self.0.pair.vertices
    }
}

impl Energy<4> for Barrier {
    fn value(&self, x: &[Vec3; 4]) -> f64 {
        self.0.value_and_gradient(x).0
    }

    fn gradient(&self, x: &[Vec3; 4]) -> [Vec3; 4] {
        self.0.value_and_gradient(x).1
    }

    fn hessian(&self, _: &[Vec3; 4], _: Convexity) -> Blocks<4> {
        unreachable!("the gradient alone is checked")
    }
}

fn pair(kind: QueryKind) -> Pair {
    let vertices = [0, 1, 2, 3];
    Pair { kind, vertices }
}

fn vertex_triangle() -> Barrier {
    Barrier(PairContact {
        pair: pair(QueryKind::VertexTriangle),
        area: 0.7,
        law: PenaltyLaw::new(3.0, 1.0).unwrap(),
        mollifier: None,
    })
}

fn edge_edge(squared_lengths: [f64; 2]) -> Barrier {
    Barrier(PairContact {
        pair: pair(QueryKind::EdgeEdge),
        mollifier: Some(Mollifier::new(squared_lengths)),
        ..vertex_triangle().0
    })
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
fn vertex_triangle_gradient_is_that_of_differences_in_all_regions() {
    let barrier = vertex_triangle();
    for height in [0.3, 0.03] {
        for place in REGIONS {
            let x = above_triangle(place, height);
            let scale = height.min(0.3);
            let error = gradient_error(&barrier, &x, scale);
            assert!(error < 1e-8, "{place:?} {height}: {error:e}");
        }
    }
}

#[test]
fn gradient_of_two_edges_is_that_of_differences_in_all_regions() {
    for x in edges() {
        // With and without the mollifier at work, whose threshold grows with the rest lengths.
        for lengths in [[1.0, 1.0], [1e3, 2.0]] {
            let barrier = edge_edge(lengths);
            let error = gradient_error(&barrier, &x, 0.3);
            assert!(error < 1e-8, "{lengths:?}: {error:e}");
        }
    }
}

/// From one region into the next, energy and gradient go on.
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

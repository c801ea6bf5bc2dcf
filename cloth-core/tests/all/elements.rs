//! Elements against finite differences, against their own invariances, and against each other.

use cloth_core::check;
use cloth_core::element::{Constraint, Convexity, Element, Energy};
use cloth_core::energy::{Attachment, CurvatureHinge, SoftPin, Spring};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::family::Energies;
use cloth_core::pin::PinMotion;
use cloth_core::step::BuildError;

/// Deterministic numbers in (−1, 1).
fn noise(index: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let t = (3 * index + axis) as Real * 0.754_877_666 + 0.17;
        2.0 * t.fract() - 1.0
    })
}

fn shape<const N: usize>(seed: usize) -> [Vec3; N] {
    std::array::from_fn(|i| noise(17 * seed + i))
}

/// A rotation that is none of the simple ones.
fn rotation() -> Mat3 {
    let axis = Vec3::new(0.6, -0.48, 0.64);
    let cross = axis.cross_matrix();
    let angle: Real = 1.234;
    Mat3::identity() + cross * angle.sin() + cross * cross * (1.0 - angle.cos())
}

const SPRING: Spring = Spring {
    vertices: [3, 8],
    rest_length: 0.7,
    stiffness: 40.0,
};

const FLAT: [Vec3; 4] = [
    Vec3::new(0.1, 0.2, 0.0),
    Vec3::new(1.3, 0.1, 0.0),
    Vec3::new(0.5, 0.9, 0.0),
    Vec3::new(0.8, -0.7, 0.0),
];

fn hinge() -> CurvatureHinge {
    CurvatureHinge::new([0, 1, 2, 3], &FLAT, 2.5)
}

/// Derivatives to the accuracy that differences allow, and convex choices that are convex.
fn holds<const N: usize, E: Energy<N>>(element: &E, x: &[Vec3; N]) {
    assert!(
        check::gradient_error(element, x, 1.0) <= 1e-7,
        "gradient of {element:?} at {x:?}"
    );
    assert!(
        check::hessian_error(element, x, 1.0) <= 1e-6,
        "Hessian of {element:?} at {x:?}"
    );
    is_convex(element, x);
}

fn is_convex<const N: usize, E: Energy<N>>(element: &E, x: &[Vec3; N]) {
    let size = check_size(&element.hessian(x, Convexity::Abs));
    for convexity in [Convexity::Clamp, Convexity::Abs, Convexity::GaussNewton] {
        let least = check::smallest_eigenvalue(element, x, convexity);
        assert!(
            least >= -1e-13 * size,
            "{convexity:?} of {element:?} at {x:?}: {least:e}"
        );
    }
}

fn check_size<const N: usize>(blocks: &cloth_core::math::Blocks<N>) -> Real {
    blocks.iter().flatten().map(Mat3::norm).fold(0.0, Real::max)
}

#[test]
fn derivatives_agree_with_differences_at_random_shapes() {
    for seed in 0..100 {
        holds(&SPRING, &shape(seed));
        holds(&hinge(), &shape(seed));
        let attachment = Attachment {
            vertex: 0,
            target: noise(seed + 500),
            stiffness: 3.0,
        };
        holds(&attachment, &shape(seed));
    }
}

#[test]
fn attachments_to_no_place_are_refused() {
    let at = |coordinate| Attachment {
        vertex: 0,
        target: Vec3::new(0.0, coordinate, 0.0),
        stiffness: 3.0,
    };
    at(1.0).check().unwrap();
    for coordinate in [Real::NAN, Real::INFINITY] {
        assert!(at(coordinate).check().is_err());
        let start = at(coordinate).target;
        let pin = SoftPin::new(0, 3.0, start, PinMotion::NONE, 0.0);
        assert!(pin.check().is_err());
    }
}

#[test]
fn derivatives_agree_with_differences_at_degenerate_shapes() {
    // A spring pressed to a hundredth of its length; differences need steps small against that.
    let short = [Vec3::zeros(), Vec3::new(0.004, 0.004, -0.004)];
    assert!(check::gradient_error(&SPRING, &short, 0.01) <= 1e-7);
    assert!(check::hessian_error(&SPRING, &short, 0.01) <= 1e-6);
    // A spring at rest length, where the force is zero: only the Hessian can be compared.
    let at_rest = [Vec3::zeros(), Vec3::new(0.0, 0.7, 0.0)];
    assert!(check::hessian_error(&SPRING, &at_rest, 1.0) <= 1e-6);
    // Hinges folded onto themselves, on a line, in a point.
    let folded = [FLAT[0], FLAT[1], FLAT[2], FLAT[2]];
    let line = [0.0, 1.0, 2.0, 3.0].map(|t| Vec3::new(t, t, t));
    holds(&hinge(), &folded);
    holds(&hinge(), &line);
    assert!(check::hessian_error(&hinge(), &[noise(1); 4], 1.0) <= 1e-6);
}

#[test]
fn coincident_ends_are_finite_everywhere() {
    for x in [[Vec3::zeros(); 2], [noise(4); 2]] {
        for spring in [
            SPRING,
            Spring {
                rest_length: 0.0,
                ..SPRING
            },
        ] {
            let gradient = spring.gradient(&x);
            assert!(gradient.iter().all(|g| g.iter().all(|c| c.is_finite())));
            assert_eq!(gradient[0], -gradient[1]);
            // The force is that of a spring pressed by its whole length.
            assert!((gradient[0].norm() - 40.0 * spring.rest_length).abs() < 1e-13);
            for convexity in [
                Convexity::Exact,
                Convexity::Clamp,
                Convexity::Abs,
                Convexity::GaussNewton,
            ] {
                // Equal and opposite, symmetric, and k along the force.
                let [[own, other], rows] = spring.hessian(&x, convexity);
                assert_eq!(other, -own);
                assert!((own - own.transpose()).amax() < 1e-14);
                if spring.rest_length > 0.0 {
                    let n = gradient[0].normalize();
                    assert!((n.dot(&(own * n)) - 40.0).abs() < 1e-13);
                }
                assert_eq!(rows, [other, own]);
            }
            is_convex(&spring, &x);
        }
    }
}

#[test]
fn a_spring_without_rest_length_is_smooth_where_its_ends_meet() {
    let spring = Spring {
        rest_length: 0.0,
        ..SPRING
    };
    assert!(check::hessian_error(&spring, &[noise(4); 2], 1.0) <= 1e-6);
}

/// `E` and the forces do not notice a translation, and turn with a rotation.
fn is_invariant<const N: usize, E: Energy<N>>(element: &E, x: &[Vec3; N]) {
    let turn = rotation();
    let moved = x.map(|x| turn * x + Vec3::new(3.0, -5.0, 2.0));
    let (before, after) = (element.value(x), element.value(&moved));
    assert!((after - before).abs() < 1e-13 * before.max(1.0) * 10.0);
    let (g, moved_g) = (element.gradient(x), element.gradient(&moved));
    let size = g.iter().map(Vec3::norm).fold(0.0, Real::max);
    for i in 0..N {
        assert!((turn * g[i] - moved_g[i]).norm() < 1e-13 * size.max(1.0) * 10.0);
    }
    // No net force and no net torque: the same in the small.
    assert!(g.iter().sum::<Vec3>().norm() < 1e-13 * size.max(1.0));
    let torque: Vec3 = x.iter().zip(&g).map(|(x, g)| x.cross(g)).sum();
    assert!(torque.norm() < 1e-13 * size.max(1.0));
}

#[test]
fn springs_and_hinges_do_not_notice_rigid_motions() {
    for seed in 0..50 {
        is_invariant(&SPRING, &shape(seed));
        is_invariant(&hinge(), &shape(seed));
    }
}

#[test]
fn the_projective_view_gives_the_same_forces() {
    for seed in 0..50 {
        assert!(check::projection_error::<2, 1, _>(&SPRING, &shape(seed)) < 1e-14);
        assert!(check::projection_error::<4, 1, _>(&hinge(), &shape(seed)) < 1e-13);
        let attachment = Attachment {
            vertex: 0,
            target: noise(seed + 500),
            stiffness: 3.0,
        };
        assert!(check::projection_error::<1, 1, _>(&attachment, &shape(seed)) < 1e-15);
    }
}

#[test]
fn dropping_only_touches_compressed_springs() {
    let stretched = [Vec3::zeros(), Vec3::new(0.5, 0.6, 0.7)];
    let pressed = stretched.map(|x| x * 0.3);
    let hessian = |x, convexity| SPRING.hessian(x, convexity);
    for convexity in [Convexity::Clamp, Convexity::Abs] {
        assert_eq!(
            hessian(&stretched, convexity),
            hessian(&stretched, Convexity::Exact)
        );
        assert_ne!(
            hessian(&pressed, convexity),
            hessian(&pressed, Convexity::Exact)
        );
    }
    assert_eq!(
        hessian(&pressed, Convexity::Clamp),
        hessian(&pressed, Convexity::GaussNewton)
    );
    assert!(check::smallest_eigenvalue(&SPRING, &pressed, Convexity::Exact) < -1.0);
}

#[test]
fn hinge_coefficients_sum_to_zero() {
    assert!(hinge().coefficients.iter().sum::<Real>().abs() < 1e-15);
    assert_eq!(hinge().vertices(), [0, 1, 2, 3]);
}

#[test]
fn every_flat_shape_costs_nothing() {
    let (turn, hinge) = (rotation(), hinge());
    // Any affine map of the plane: stretched, sheared, turned and moved.
    let stretch = Mat3::new(1.7, 0.4, 0.0, -0.2, 0.6, 0.0, 0.0, 0.0, 1.0);
    for map in [Mat3::identity(), turn, stretch, turn * stretch] {
        let x = FLAT.map(|x| map * x + Vec3::new(7.0, 8.0, 9.0));
        assert!(hinge.value(&x) < 1e-26, "{map}: {:e}", hinge.value(&x));
    }
}

#[test]
fn an_isometric_fold_by_theta_has_the_length_of_the_formula() {
    let hinge = hinge();
    let edge = FLAT[1] - FLAT[0];
    for theta in [1e-4, 0.3, 1.0, 2.5, std::f64::consts::PI] {
        // The second wing turned about the edge.
        let axis = edge.normalize().cross_matrix();
        let turn: Mat3 =
            Mat3::identity() + axis * Real::sin(theta) + axis * axis * (1.0 - Real::cos(theta));
        let mut x = FLAT;
        x[3] = FLAT[0] + turn * (FLAT[3] - FLAT[0]);
        let z: Real = hinge
            .rows(&x)
            .iter()
            .map(|row| row.value * row.value)
            .sum::<Real>()
            .sqrt();
        let expected = 2.0 * edge.norm() * (0.5 * theta).sin();
        assert!(
            (z - expected).abs() < 1e-14,
            "{theta}: {z} against {expected}"
        );
    }
}

#[test]
fn an_element_that_names_a_vertex_twice_is_refused() {
    // Its Hessian has a block beside the diagonal that belongs on it, and with its transpose.
    let hinge = CurvatureHinge::new([0, 1, 2, 0], &FLAT, 2.5);
    let refused = Energies::new(4).with(vec![hinge]).unwrap_err();
    let (element, vertex) = (0, 0);
    let named = |kind, family, element, vertex| BuildError::RepeatedVertex {
        kind,
        family: Some(family),
        element,
        vertex,
    };
    assert_eq!(refused, named("CurvatureHinge", 0, element, vertex));
    let spring = |vertices| Spring { vertices, ..SPRING };
    let springs = vec![spring([0, 1]), spring([1, 1])];
    let refused = Energies::new(2).with(springs).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "element 1 of family 0 (Spring) names vertex 1 twice"
    );
}

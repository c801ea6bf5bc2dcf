//! Projective views against the energies of the same elements, and the elements with strain limits.

use crate::element_checks::{
    balanced, convex_choices_are_convex, derivatives_agree, is_invariant, largest, noise, shape,
};
use cloth_core::check;
use cloth_core::element::{Convexity, Energy, Projective};
use cloth_core::energy::{
    ArapTriangle, Attachment, CurvatureHinge, CurvedHinge, Spring, StrainLimitSpring,
    StrainLimitTriangle,
};
use cloth_core::math::{Mat3, Real, Vec3};
use nalgebra::DMatrix;

const TRIANGLE: [Vec3; 3] = [
    Vec3::new(0.1, 0.2, 0.3),
    Vec3::new(1.3, 0.1, -0.2),
    Vec3::new(0.5, 0.9, 0.1),
];

const HINGE: [Vec3; 4] = [
    Vec3::new(0.0, 0.0, 0.0),
    Vec3::new(1.0, 0.1, 0.0),
    Vec3::new(0.4, 0.8, 0.3),
    Vec3::new(0.6, -0.7, 0.2),
];

fn limited_spring(limits: [Real; 2]) -> StrainLimitSpring {
    StrainLimitSpring::along(&TRIANGLE, &[[0, 1]], limits, 30.0)[0]
}

fn limited_triangle(limits: [Real; 2]) -> StrainLimitTriangle {
    StrainLimitTriangle::new([0, 1, 2], &TRIANGLE, limits, 40.0)
}

/// `w Gᵀ (G x − p)` of the projective view is the gradient. Its R is `I − ∂p/∂z`, by differences of p, with the absolute
/// values of its eigenvalues, and none above 1; and `w Gᵀ R G` the Hessian under [`Convexity::Abs`], in all digits,
/// where none was below −1.
fn views_agree<const N: usize, const K: usize, E: Energy<N> + Projective<N, K>>(
    element: &E,
    x: &[Vec3; N],
) {
    let error = check::projection_error(element, x);
    assert!(error < 1e-12, "{element:?}: {error:e}");
    let operator = element.operator();
    let z: [Vec3; K] = std::array::from_fn(|k| (0..N).map(|i| x[i] * operator[k][i]).sum());
    let resistance = element.projected_hessian(z);
    let is_saturated = resistance_is_absolute(element, z, &resistance);
    if is_saturated {
        return;
    }
    let hessian = element.hessian(x, Convexity::Abs);
    let size = largest(&hessian).max(element.weight());
    for i in 0..N {
        for j in 0..N {
            let mut sum = Mat3::zeros();
            for k in 0..K {
                for l in 0..K {
                    sum += resistance[k][l] * (operator[k][i] * operator[l][j]);
                }
            }
            let difference = (sum * element.weight() - hessian[i][j]).amax();
            assert!(
                difference < 1e-12 * size,
                "{element:?} at {x:?}: {difference:e}"
            );
        }
    }
}

/// Asserts that R (dimensionless) at z is what it should be; returns whether an eigenvalue was below −1.
fn resistance_is_absolute<const N: usize, const K: usize, E: Projective<N, K>>(
    element: &E,
    z: [Vec3; K],
    resistance: &[[Mat3; K]; K],
) -> bool {
    let size = z.iter().map(Vec3::norm).fold(0.0, Real::max);
    let step = if size > 0.0 { 1e-6 * size } else { 1e-6 };
    let mut exact = DMatrix::identity(3 * K, 3 * K);
    for (l, axis) in (0..K).flat_map(|l| (0..3).map(move |axis| (l, axis))) {
        let moved = [step, -step].map(|step| {
            let mut z = z;
            z[l][axis] += step;
            element.project(z)
        });
        for k in 0..K {
            let derivative = (moved[0][k] - moved[1][k]) / (2.0 * step);
            for row in 0..3 {
                exact[(3 * k + row, 3 * l + axis)] -= derivative[row];
            }
        }
    }
    let mut eigen = exact.symmetric_eigen();
    let is_saturated = eigen.eigenvalues.min() < -1.0 + 1e-6;
    let filtered = |value: &Real| value.abs().min(1.0);
    eigen.eigenvalues.apply(|value| *value = filtered(value));
    let expected = eigen.recompose();
    for (k, l) in (0..K).flat_map(|k| (0..K).map(move |l| (k, l))) {
        let block = expected.fixed_view::<3, 3>(3 * k, 3 * l);
        let difference = (block - resistance[k][l]).amax();
        assert!(difference < 1e-6, "{element:?} at {z:?}: {difference:e}");
    }
    is_saturated
}

#[test]
fn projective_views_are_those_of_the_energies() {
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 0.8,
        stiffness: 25.0,
    };
    let attachment = Attachment {
        vertex: 0,
        target: Vec3::new(0.1, 0.2, 0.3),
        stiffness: 7.0,
    };
    for seed in 0..200 {
        let (x, y, z, w) = (shape(seed), shape(seed), shape(seed), shape(seed));
        views_agree(&attachment, &x);
        views_agree(&spring, &y);
        views_agree(&ArapTriangle::new([0, 1, 2], &TRIANGLE, 40.0), &z);
        views_agree(&CurvatureHinge::new([0, 1, 2, 3], &HINGE, 3.0), &w);
        views_agree(&CurvedHinge::new([0, 1, 2, 3], &HINGE, 3.0), &w);
        for limits in [[0.0, 1.1], [0.9, 1.1], [1.0, 1.0], [0.5, 1e9]] {
            views_agree(&limited_spring(limits), &y);
            views_agree(&limited_triangle(limits), &z);
        }
    }
}

#[test]
fn derivatives_of_limited_elements_agree_with_differences() {
    for seed in 0..100 {
        for limits in [[0.9, 1.1], [0.2, 0.4], [2.0, 3.0], [1.0, 1.0]] {
            let x = shape(seed);
            let element = limited_spring(limits);
            let length = (x[0] - x[1]).norm();
            let near = |limit: Real| (length - limit).abs() < 1e-3;
            if length > 0.1 && !near(element.shortest) && !near(element.longest) {
                derivatives_agree(&element, &x, 1.0);
            }
            convex_choices_are_convex(&element, &x);
            is_invariant(&element, &x);
            let x = shape(seed);
            let element = limited_triangle(limits);
            convex_choices_are_convex(&element, &x);
            is_invariant(&element, &x);
            if stretches(&x)
                .iter()
                .all(|s| limits.iter().all(|l| (s - l).abs() > 1e-3) && *s > 0.1)
            {
                derivatives_agree(&element, &x, 1.0);
            }
        }
    }
}

/// Singular values of the map from [`TRIANGLE`] to x, from `FᵀF` by trace and determinant.
fn stretches(x: &[Vec3; 3]) -> [Real; 2] {
    let gram = |x: &[Vec3; 3]| {
        let (a, b) = (x[1] - x[0], x[2] - x[0]);
        nalgebra::Matrix2::new(a.dot(&a), a.dot(&b), a.dot(&b), b.dot(&b))
    };
    let product = gram(&TRIANGLE).try_inverse().unwrap() * gram(x);
    let (half, determinant) = (0.5 * product.trace(), product.determinant());
    let root = (half * half - determinant).max(0.0).sqrt();
    [(half + root).sqrt(), (half - root).max(0.0).sqrt()]
}

#[test]
fn between_the_limits_nothing_is_felt_and_beyond_them_the_excess() {
    let area = 0.5
        * (TRIANGLE[1] - TRIANGLE[0])
            .cross(&(TRIANGLE[2] - TRIANGLE[0]))
            .norm();
    for seed in 0..200 {
        let limits = [0.6, 1.2];
        let outside = |s: Real| s - s.clamp(limits[0], limits[1]);
        let x: [Vec3; 3] = shape(seed);
        let expected: Real = stretches(&x).map(|s| outside(s).powi(2)).iter().sum();
        let error = limited_triangle(limits).value(&x) - 0.5 * area * 40.0 * expected;
        assert!(error.abs() < 1e-12, "{error:e}");
        let x: [Vec3; 2] = shape(seed);
        let rest = (TRIANGLE[0] - TRIANGLE[1]).norm();
        let excess = rest * outside((x[0] - x[1]).norm() / rest);
        let error = limited_spring(limits).value(&x) - 15.0 * excess * excess;
        assert!(error.abs() < 1e-12, "{error:e}");
    }
    let x = TRIANGLE.map(|x| x * 1.1);
    let element = limited_triangle([0.9, 1.2]);
    assert_eq!(element.value(&x), 0.0);
    assert_eq!(element.gradient(&x), [Vec3::zeros(); 3]);
    assert_eq!(largest(&element.hessian(&x, Convexity::Exact)), 0.0);
    // A plain stretch beyond the limit: both singular values are s.
    let x = TRIANGLE.map(|x| x * 1.5);
    derivatives_agree(&element, &x, 0.1);
    views_agree(&element, &x);
}

#[test]
fn with_equal_limits_they_are_a_spring_and_an_arap_triangle() {
    for seed in 0..50 {
        let x = shape(seed);
        let spring = Spring::along(&TRIANGLE, &[[0, 1]], 30.0)[0];
        let limited = limited_spring([1.0, 1.0]);
        assert!((limited.value(&x) - spring.value(&x)).abs() < 1e-14);
        assert_eq!(limited.gradient(&x), spring.gradient(&x));
        assert_eq!(
            limited.hessian(&x, Convexity::Exact),
            spring.hessian(&x, Convexity::Exact)
        );
        let x = shape(seed);
        let arap = ArapTriangle::new([0, 1, 2], &TRIANGLE, 40.0);
        let limited = limited_triangle([1.0, 1.0]);
        assert_eq!(limited.value(&x), arap.value(&x));
        assert_eq!(limited.gradient(&x), arap.gradient(&x));
        let (a, b) = (
            limited.hessian(&x, Convexity::Exact),
            arap.hessian(&x, Convexity::Exact),
        );
        for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((a - b).amax() < 1e-11 * largest(&arap.hessian(&x, Convexity::Abs)));
        }
    }
}

#[test]
fn collapsed_elements_with_limits_are_finite() {
    for limits in [[0.0, 0.0], [0.0, 1.0], [0.9, 1.1]] {
        for x in [
            [noise(1); 3],
            [noise(1), noise(1), noise(2)],
            [Vec3::zeros(); 3],
        ] {
            let element = limited_triangle(limits);
            if x[0] == x[1] && x[1] == x[2] {
                // Both singular values are 0, and each lies the lower limit away from the set.
                let expected = element.weight() * limits[0] * limits[0];
                assert!((element.value(&x) - expected).abs() <= 1e-15 * expected);
            }
            balanced(&element, &x);
            let p = element.project([x[1] - x[0], x[2] - x[0]]);
            assert!(p.iter().flatten().all(|p| p.is_finite()));
            let x = [x[0], x[1]];
            let element = limited_spring(limits);
            if x[0] == x[1] {
                // Pressed to a point, the spring is short of its lower limit by all of it: E = ½ k (l₀ s)².
                let expected = 0.5 * element.stiffness * element.shortest * element.shortest;
                assert!((element.value(&x) - expected).abs() <= 1e-15 * expected);
            }
            balanced(&element, &x);
            views_agree(&element, &x);
        }
    }
}

#[test]
#[should_panic(expected = "strain limits 1.1 to 0.9")]
fn limits_in_the_wrong_order_are_refused() {
    let _ = limited_triangle([1.1, 0.9]);
}

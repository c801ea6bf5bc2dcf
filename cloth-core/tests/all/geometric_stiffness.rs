//! The geometric stiffness of every element.

use crate::element_checks::{largest, noise, shape};
use cloth_core::element::{Constraint, Convexity};
use cloth_core::energy::{
    ArapTriangle, Attachment, CurvatureHinge, CurvedHinge, DihedralHinge, Spring, StvkTriangle,
};
use cloth_core::math::{Blocks, Mat3, Real, Vec3};

fn dense<const N: usize>(blocks: &Blocks<N>) -> nalgebra::DMatrix<Real> {
    nalgebra::DMatrix::from_fn(3 * N, 3 * N, |r, c| blocks[r / 3][c / 3][(r % 3, c % 3)])
}

/// With `λ = −k C` it is the curvature that the element writes for Newton's method, eigenvalue by eigenvalue.
fn is_the_curvature<const N: usize, C: Constraint<N>>(element: &C, x: &[Vec3; N], tolerance: Real) {
    let rows = element.rows(x);
    let multipliers: Vec<Real> = rows
        .as_ref()
        .iter()
        .map(|row| -row.stiffness * row.value)
        .collect();
    for convexity in [Convexity::Exact, Convexity::Clamp, Convexity::Abs] {
        let expected = element.curvature(x, convexity);
        let measured = element.geometric_stiffness(x, &multipliers, convexity);
        let size = largest(&element.curvature(x, Convexity::Abs)).max(1e-300);
        let error = (dense(&measured) - dense(&expected)).amax() / size;
        assert!(error < tolerance, "{convexity:?} of {element:?}: {error:e}");
    }
    let none = element.geometric_stiffness(x, &multipliers, Convexity::GaussNewton);
    assert!(none.iter().flatten().all(|block| *block == Mat3::zeros()));
}

#[test]
fn it_is_the_curvature_of_the_energy_for_the_forces_of_the_energy() {
    for seed in 0..8 {
        let spring = Spring {
            vertices: [0, 1],
            rest_length: 0.9,
            stiffness: 30.0,
        };
        is_the_curvature(&spring, &shape(seed), 1e-13);
        let attachment = Attachment {
            vertex: 0,
            target: noise(5),
            stiffness: 4.0,
        };
        is_the_curvature(&attachment, &shape(seed), 1e-13);
        let rest = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8], [0.5, -0.9]];
        let rest = rest.map(|[x, y]| Vec3::new(x, y, 0.0));
        let mut bent = rest;
        bent[2].z = 0.4;
        let v = [0, 1, 2, 3];
        is_the_curvature(&CurvatureHinge::new(v, &rest, 2.0), &shape(seed), 1e-13);
        is_the_curvature(&CurvedHinge::new(v, &bent, 2.0), &shape(seed), 1e-7);
        let near: [Vec3; 4] = std::array::from_fn(|i| bent[i] + noise(seed + i) * 0.1);
        is_the_curvature(&DihedralHinge::grinspun(v, &rest, 2.0), &near, 1e-7);
        let flat: [Vec3; 3] = [rest[0], rest[1], rest[2]];
        let x: [Vec3; 3] = std::array::from_fn(|i| flat[i] * 1.3 + noise(seed + i) * 0.2);
        is_the_curvature(&StvkTriangle::new([0, 1, 2], &flat, 50.0, 0.3), &x, 1e-7);
    }
}

/// The corotated triangle clamps by modes of all rows together, so only the sum is compared.
#[test]
fn the_rows_of_a_corotated_triangle_turn_as_its_energy_says() {
    let rest = [Vec3::zeros(), Vec3::x(), Vec3::new(0.4, 0.8, 0.0)];
    for seed in 0..8 {
        let element = ArapTriangle::new([0, 1, 2], &rest, 50.0);
        let x: [Vec3; 3] = std::array::from_fn(|i| rest[i] * 1.4 + noise(seed + i) * 0.2);
        let rows = element.rows(&x);
        let multipliers = rows.map(|row| -row.stiffness * row.value);
        let measured = element.geometric_stiffness(&x, &multipliers, Convexity::Exact);
        let hessian = cloth_core::element::Energy::hessian(&element, &x, Convexity::Exact);
        let outer = cloth_core::element::Energy::hessian(&element, &x, Convexity::GaussNewton);
        let error = (dense(&measured) - (dense(&hessian) - dense(&outer))).amax();
        assert!(error < 1e-7 * largest(&hessian), "{error:e}");
    }
}

#[test]
fn it_is_finite_where_an_element_has_collapsed() {
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 0.9,
        stiffness: Real::INFINITY,
    };
    let point = [Vec3::x(); 2];
    let k = spring.geometric_stiffness(&point, &[-3.0], Convexity::Clamp);
    assert!(k.iter().flatten().all(|block| *block == Mat3::zeros()));
    let rest = [Vec3::zeros(), Vec3::x(), Vec3::new(0.4, 0.8, 0.0)];
    let triangle = StvkTriangle::new([0, 1, 2], &rest, 50.0, 0.3);
    let k = triangle.geometric_stiffness(&[Vec3::x(); 3], &[1.0; 3], Convexity::Clamp);
    assert!(k.iter().flatten().all(|block| *block == Mat3::zeros()));
}

/// It is made of numbers like λ/size²: exact in powers of two, until they overflow.
#[test]
fn it_grows_with_the_square_as_a_hinge_shrinks() {
    let rest = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8], [0.5, -0.9]];
    let bent: [Vec3; 4] =
        std::array::from_fn(|i| Vec3::new(rest[i][0], rest[i][1], 0.3 * i as Real));
    let hinge = DihedralHinge::grinspun([0, 1, 2, 3], &bent, 2.0);
    let two_to = |power: i32| Real::powi(2.0, power);
    let shrunk = |power: i32, multiplier, convexity| {
        let x = bent.map(|p| p * two_to(-power));
        let blocks = hinge.geometric_stiffness(&x, &[multiplier], convexity);
        dense(&blocks)
    };
    let whole = shrunk(0, 1.0, Convexity::Exact);
    let small = shrunk(100, two_to(700), Convexity::Exact);
    assert_eq!(small, whole * two_to(900));
    for convexity in [Convexity::Exact, Convexity::Clamp, Convexity::Abs] {
        assert_eq!(shrunk(100, two_to(900), convexity).amax(), 0.0);
    }
}

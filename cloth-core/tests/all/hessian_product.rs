//! A Hessian times displacements, without its blocks, against the blocks: for every element and every choice of
//! convexity.

use cloth_core::element::{Convexity, Energy};
use cloth_core::energy::{
    ArapTriangle, AreaTriangle, Attachment, CubicShell, CurvatureHinge, CurvedHinge, DihedralHinge,
    MidpointHinge, Spring, StrainLimitSpring, StrainLimitTriangle, StvkTriangle, VolumeTetrahedron,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::random::SplitMix64;

/// The largest difference, as a part of what the blocks give at most.
fn error<const N: usize, E: Energy<N>>(element: &E, x: &[Vec3; 5], p: &[Vec3; 5]) -> Real {
    let (x, p): ([Vec3; N], [Vec3; N]) =
        (std::array::from_fn(|i| x[i]), std::array::from_fn(|i| p[i]));
    let mut worst: Real = 0.0;
    for convexity in [
        Convexity::Exact,
        Convexity::Clamp,
        Convexity::Abs,
        Convexity::GaussNewton,
    ] {
        let blocks = element.hessian(&x, convexity);
        let found = element.hessian_product(&x, &p, convexity);
        let mut size = Real::MIN_POSITIVE;
        let mut difference: Real = 0.0;
        for i in 0..N {
            let parts = (0..N).map(|j| blocks[i][j] * p[j]);
            size = parts.clone().map(|part| part.amax()).fold(size, Real::max);
            difference = difference.max((parts.sum::<Vec3>() - found[i]).amax());
        }
        worst = worst.max(difference / size);
    }
    worst
}

#[test]
fn the_product_is_that_of_the_blocks() {
    let mut random = SplitMix64::new(5);
    let mut points = |size: Real| -> [Vec3; 5] {
        std::array::from_fn(|_| Vec3::from_fn(|_, _| size * random.symmetric()))
    };
    let rest = [
        Vec3::new(0.1, 0.2, 0.0),
        Vec3::new(1.3, 0.1, 0.0),
        Vec3::new(0.5, 0.9, 0.1),
        Vec3::new(0.8, -0.7, 0.2),
    ];
    let [a, b, c, _] = rest;
    let three = [a, b, c];
    let spring = |rest_length| Spring {
        vertices: [0, 1],
        rest_length,
        stiffness: 40.0,
    };
    let limited = |limits| StrainLimitSpring::along(&rest, &[[0, 1]], limits, 40.0)[0];
    let attachment = Attachment {
        vertex: 0,
        target: Vec3::x(),
        stiffness: 3.0,
    };
    // Of every size, so that springs are pulled and pushed, triangles turned over, hinges folded.
    for round in 0..300 {
        let x = points([0.2, 1.0, 3.0][round % 3]);
        let p = points(1.0);
        let errors = [
            error(&spring(0.7), &x, &p),
            error(&spring(0.0), &x, &p),
            error(&limited([0.9, 1.1]), &x, &p),
            error(&limited([0.0, 0.1]), &x, &p),
            error(&attachment, &x, &p),
            error(&AreaTriangle::new([0, 1, 2], &three, 5.0), &x, &p),
            error(&StvkTriangle::new([0, 1, 2], &three, 5.0, 0.3), &x, &p),
            error(&ArapTriangle::new([0, 1, 2], &three, 5.0), &x, &p),
            error(
                &StrainLimitTriangle::new([0, 1, 2], &three, [0.9, 1.1], 5.0),
                &x,
                &p,
            ),
            error(&VolumeTetrahedron::new([0, 1, 2, 3], &rest, 5.0), &x, &p),
            error(&CurvatureHinge::new([0, 1, 2, 3], &rest, 2.5), &x, &p),
            error(&CurvedHinge::new([0, 1, 2, 3], &rest, 2.5), &x, &p),
            error(&DihedralHinge::bridson([0, 1, 2, 3], &rest, 2.5), &x, &p),
            error(&CubicShell::new([0, 1, 2, 3], &rest, 2.5), &x, &p),
            error(&MidpointHinge::new([0, 1, 2, 3, 4], &rest, 2.5), &x, &p),
        ];
        for (element, error) in errors.into_iter().enumerate() {
            assert!(error < 1e-13, "element {element}, round {round}: {error:e}");
        }
    }
}

/// Where a spring has no length, and no direction of its own.
#[test]
fn a_collapsed_spring_has_the_product_of_its_blocks() {
    let x = [Vec3::repeat(0.3); 5];
    let p = std::array::from_fn(|i| Vec3::new(1.0, -2.0, 0.5) * i as Real);
    for rest_length in [0.0, 0.7] {
        let spring = Spring {
            vertices: [0, 1],
            rest_length,
            stiffness: 40.0,
        };
        let error = error(&spring, &x, &p);
        assert!(error < 1e-15, "{rest_length}: {error:e}");
    }
}

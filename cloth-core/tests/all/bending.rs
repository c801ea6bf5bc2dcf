//! Bending elements against finite differences, their own invariances, and their closed-form energies.

use crate::element_checks::{
    balanced, convex_choices_are_convex, derivatives_agree, is_invariant, noise, shape,
};
use cloth_core::check;
use cloth_core::element::{Constraint, Convexity, Element, Energy};
use cloth_core::energy::{CubicShell, CurvatureHinge, CurvedHinge, DihedralHinge, Spring};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::mesh::{TriMesh, generate};
use cloth_core::topology::{EdgeTable, HingeTable};

const VERTICES: [u32; 4] = [0, 1, 2, 3];
const FLAT: [Vec3; 4] = [
    Vec3::new(0.1, 0.2, 0.0),
    Vec3::new(1.3, 0.1, 0.0),
    Vec3::new(0.5, 0.9, 0.0),
    Vec3::new(0.8, -0.7, 0.0),
];

/// The flat hinge with its second wing turned about the edge, so that the edge becomes a ridge for θ > 0.
fn folded(theta: Real) -> [Vec3; 4] {
    let axis = (FLAT[1] - FLAT[0]).normalize().cross_matrix();
    let turn = Mat3::identity() + axis * theta.sin() + axis * axis * (1.0 - theta.cos());
    let mut x = FLAT;
    x[3] = FLAT[0] + turn * (FLAT[3] - FLAT[0]);
    x
}

/// `e²/(A₀ + A₁)`.
fn shape_factor() -> Real {
    let edge = FLAT[1] - FLAT[0];
    let twice = |tip: Vec3| edge.cross(&(tip - FLAT[0])).norm();
    edge.norm_squared() / (0.5 * (twice(FLAT[2]) + twice(FLAT[3])))
}

fn rest_angles() -> [Real; 5] {
    [0.0, 0.4, -1.1, 2.0, -3.0]
}

#[test]
fn derivatives_agree_with_differences() {
    let mut shapes: Vec<[Vec3; 4]> = (0..60).map(shape).collect();
    // Almost flat, folded by 170° and pressed together.
    shapes.extend([1e-3, -1e-3, 0.5, 2.967, -2.967].map(folded));
    shapes.push(folded(0.7).map(|x| x.component_mul(&Vec3::new(0.5, 0.6, 0.7))));
    for rest_angle in rest_angles() {
        let rest = folded(rest_angle);
        for x in &shapes {
            // Differences need steps small against the height of the wing, or they are not the derivative.
            let edge = x[1] - x[0];
            let height = |tip: Vec3| edge.cross(&(tip - x[0])).norm() / edge.norm();
            let curved = CurvedHinge::new(VERTICES, &rest, 2.5);
            // Near flat E is a cone, whose tip is ‖z‖ away.
            let tip = curved.rows(x)[0].value + curved.rest_curvature;
            if tip > 1e-9 {
                derivatives_agree(&curved, x, tip.min(1.0));
            }
            let cubic = CubicShell::new(VERTICES, &rest, 2.5);
            derivatives_agree(&cubic, x, 1.0);
            convex_choices_are_convex(&cubic, x);
            convex_choices_are_convex(&curved, x);
            let dihedral = DihedralHinge::grinspun(VERTICES, &rest, 2.5);
            convex_choices_are_convex(&dihedral, x);
            let bridson = DihedralHinge::bridson(VERTICES, &rest, 2.5);
            convex_choices_are_convex(&bridson, x);
            let opposite = dihedral.rows(x)[0].value.abs() > 3.1;
            let scale = height(x[2]).min(height(x[3])).min(edge.norm());
            if scale > 0.05 && !opposite {
                derivatives_agree(&dihedral, x, scale.min(1.0));
                derivatives_agree(&bridson, x, scale.min(1.0));
            }
        }
    }
}

#[test]
fn a_hinge_without_wings_has_no_angle_and_makes_no_nan() {
    let line = [0.0, 1.0, 2.0, 3.0].map(|t| Vec3::new(t, 0.3 * t, -t));
    let mut one_wing = FLAT;
    one_wing[3] = (FLAT[0] + FLAT[1]) * 0.5;
    let mut no_edge = FLAT;
    no_edge[1] = no_edge[0];
    for x in [line, one_wing, no_edge, [noise(1); 4]] {
        let dihedral = DihedralHinge::grinspun(VERTICES, &folded(0.5), 2.5);
        assert_eq!(dihedral.value(&x), 0.0);
        assert_eq!(dihedral.gradient(&x), [Vec3::zeros(); 4]);
        balanced(&dihedral, &x);
        balanced(&CurvedHinge::new(VERTICES, &folded(0.5), 2.5), &x);
        balanced(&CubicShell::new(VERTICES, &folded(0.5), 2.5), &x);
        // Wings that are slivers but not nothing.
        for sliver in [1e-4, 1e-8, 1e-12, 1e-100, 1e-300] {
            let nearly: [Vec3; 4] = std::array::from_fn(|i| x[i] + noise(i + 40) * sliver);
            balanced(&dihedral, &nearly);
        }
    }
}

/// A rest shape without area has no cotangents; builders ask.
#[test]
fn a_hinge_of_a_triangle_without_area_is_refused() {
    let with_tip = |y| {
        let rest = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [1.0, y]];
        let rest = rest.map(|[x, y]| Vec3::new(x, y, 0.0));
        CurvatureHinge::new(VERTICES, &rest, 2.5).check()
    };
    assert!(with_tip(-1.0).is_ok());
    let error = with_tip(0.0).unwrap_err();
    assert!(error.to_string().contains("coefficient"), "{error}");
}

#[test]
fn rigid_motions_are_not_noticed() {
    for rest_angle in rest_angles() {
        let rest = folded(rest_angle);
        for x in [folded(0.3), folded(-2.0), shape(4), shape(9)] {
            is_invariant(&DihedralHinge::grinspun(VERTICES, &rest, 2.5), &x);
            is_invariant(&CubicShell::new(VERTICES, &rest, 2.5), &x);
            is_invariant(&CurvedHinge::new(VERTICES, &rest, 2.5), &x);
        }
    }
}

#[test]
fn the_rest_shape_costs_nothing() {
    for rest_angle in rest_angles() {
        let rest = folded(rest_angle);
        let dihedral = DihedralHinge::grinspun(VERTICES, &rest, 2.5);
        assert!((dihedral.rest_angle - rest_angle).abs() < 1e-14);
        assert!(dihedral.value(&rest) < 1e-28);
        assert!(CurvedHinge::new(VERTICES, &rest, 2.5).value(&rest) < 1e-28);
        assert!(CubicShell::new(VERTICES, &rest, 2.5).value(&rest).abs() < 1e-13);
    }
}

/// Each model with its own coefficient k = 0.7 N·m, folded without stretching: exact at any angle.
#[test]
fn a_fold_costs_what_each_model_says() {
    let (k, factor) = (0.7, shape_factor());
    for rest_angle in rest_angles() {
        let rest = folded(rest_angle);
        for theta in [-3.1, -1.0, -1e-3, 1e-5, 0.2, 1.5, 3.0] {
            let x = folded(theta);
            let mut difference: Real = theta - rest_angle;
            difference -= std::f64::consts::TAU * (difference / std::f64::consts::TAU).round();
            let sines = (0.5 * theta).sin().abs() - (0.5 * rest_angle).sin().abs();
            let squared = factor * difference * difference;
            let close = |value: Real, expected: Real, name: &str| {
                let error = (value - expected).abs();
                assert!(
                    error < 1e-12 * expected.max(1e-2),
                    "{name} {rest_angle} {theta}: {value} {expected}"
                );
            };
            close(
                DihedralHinge::grinspun(VERTICES, &rest, k).value(&x),
                3.0 * k * squared,
                "Grinspun",
            );
            // From k e²/(|N₁| + |N₂|) (sin θ/2 − sin θ₀/2) along ∂θ, with |N| twice the area.
            let [a, b] = [0.5 * rest_angle, 0.5 * theta];
            let work = 2.0 * (a.cos() - b.cos()) - 2.0 * (b - a) * a.sin();
            close(
                DihedralHinge::bridson(VERTICES, &rest, k).value(&x),
                0.5 * k * factor * work,
                "Bridson",
            );
            let cubic = 3.0 * k * factor * 2.0 * (0.5 * difference).sin().powi(2);
            close(
                CubicShell::new(VERTICES, &rest, k).value(&x),
                cubic,
                "cubic",
            );
            close(
                CurvedHinge::new(VERTICES, &rest, k).value(&x),
                6.0 * k * factor * sines * sines,
                "curved",
            );
        }
    }
}

/// One rigidity D, and each model with its own constant costs `½ D e²/(A₀ + A₁) θ²`.
#[test]
fn one_rigidity_makes_all_models_alike_at_small_angles() {
    let mut positions = FLAT.to_vec();
    for p in &mut positions {
        p.z = 0.0;
    }
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [1, 0, 3]]).unwrap();
    let hinges = HingeTable::build(&mesh, &EdgeTable::build(&mesh).unwrap());
    assert_eq!(hinges.hinges(), [VERTICES]);
    let (d, theta) = (0.3, 1e-3);
    let x = folded(theta);
    let expected = 0.5 * d * shape_factor() * theta * theta;
    let bridson = DihedralHinge::bridson_coefficient(d);
    for value in [
        CurvatureHinge::across(&mesh, &hinges, d)[0].value(&x),
        CurvedHinge::across(&mesh, &hinges, d)[0].value(&x),
        CubicShell::across(&mesh, &hinges, d)[0].value(&x),
        DihedralHinge::across(&mesh, &hinges, d)[0].value(&x),
        DihedralHinge::bridson(VERTICES, &FLAT, bridson).value(&x),
    ] {
        assert!((value / expected - 1.0).abs() < 1e-6, "{value} {expected}");
    }
}

#[test]
fn the_force_of_an_angle_has_the_directions_of_bridson() {
    // u₃ = |E| N₁/|N₁|² and so on, with N the area-weighted normals of the two wings.
    let x = folded(0.8);
    let row = DihedralHinge::grinspun(VERTICES, &FLAT, 1.0).rows(&x)[0];
    let e = x[1] - x[0];
    let n1 = (x[2] - x[0]).cross(&(x[2] - x[1]));
    let n2 = (x[3] - x[1]).cross(&(x[3] - x[0]));
    let [u1, u2] = [n1, n2].map(|n| n * (e.norm() / n.norm_squared()));
    let share = |tip: Vec3, end: Vec3| (tip - end).dot(&e) / e.norm();
    let u3 =
        n1 * (share(x[2], x[1]) / n1.norm_squared()) + n2 * (share(x[3], x[1]) / n2.norm_squared());
    let u4 = -n1 * (share(x[2], x[0]) / n1.norm_squared())
        - n2 * (share(x[3], x[0]) / n2.norm_squared());
    for (u, g) in [u3, u4, u1, u2].iter().zip(&row.gradient) {
        assert!((u + g).norm() < 1e-13, "{u} {g}");
    }
    // His force: k |E|²/(|N₁| + |N₂|) (sin θ/2 − sin θ₀/2) u, of a fold that has not been stretched.
    let (k, rest_angle) = (0.7, -0.4);
    let hinge = DihedralHinge::bridson(VERTICES, &folded(rest_angle), k);
    let size = k * e.norm_squared() / (n1.norm() + n2.norm());
    let force = size * (0.4_f64.sin() - (0.5_f64 * rest_angle).sin());
    for (u, g) in [u3, u4, u1, u2].iter().zip(&hinge.gradient(&x)) {
        assert!((u * force + g).norm() < 1e-13, "{u} {g}");
    }
}

#[test]
fn a_bending_spring_does_not_feel_a_small_fold() {
    let rest = [
        Vec3::new(0.0, 0.0, 0.0),
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(0.3, 0.8, 0.0),
        Vec3::new(0.3, -0.8, 0.0),
    ];
    let mesh = TriMesh::new(rest.to_vec(), vec![[0, 1, 2], [1, 0, 3]]).unwrap();
    let hinges = HingeTable::build(&mesh, &EdgeTable::build(&mesh).unwrap());
    let spring = Spring::across(&rest, &hinges, 50.0)[0];
    assert_eq!((spring.vertices, spring.rest_length), ([2, 3], 1.6));
    for theta in [0.02_f64, 0.1, 1.0, 3.0] {
        let tip = Vec3::new(0.3, -0.8 * theta.cos(), -0.8 * theta.sin());
        let energy = spring.value(&[rest[2], tip]);
        let exact = 0.5 * 50.0 * (1.6 * (1.0 - (0.5 * theta).cos())).powi(2);
        assert!((energy / exact - 1.0).abs() < 1e-10);
        let fourth = 50.0 * 1.6 * 1.6 * theta.powi(4) / 128.0;
        assert!(
            (energy / fourth - 1.0).abs() < 0.05 * theta * theta,
            "{theta}"
        );
    }
}

#[test]
fn the_projective_view_of_a_curved_hinge_gives_the_same_forces() {
    for seed in 0..50 {
        let curved = CurvedHinge::new(VERTICES, &folded(1.2), 2.5);
        assert!(check::projection_error::<4, 1, _>(&curved, &shape(seed)) < 1e-12);
    }
    // With a flat rest shape it is the quadratic hinge.
    let [flat, quadratic] = [
        CurvedHinge::new(VERTICES, &FLAT, 2.5).value(&shape(3)),
        CurvatureHinge::new(VERTICES, &FLAT, 2.5).value(&shape(3)),
    ];
    assert!((flat / quadratic - 1.0).abs() < 1e-13);
}

#[test]
fn a_flat_sheet_is_flat_for_curved_hinges_wherever_it_lies() {
    // Coordinates that are no round numbers: each hinge is flat up to rounding only.
    let flat = generate::irregular(12, 1.0, 1.0, 4).unwrap();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    let place = |p: &Vec3| turn * p + Vec3::new(0.3, -7.0, 2.0);
    let moved: Vec<Vec3> = flat.positions().iter().map(place).collect();
    let mesh = TriMesh::new(moved, flat.triangles().to_vec()).unwrap();
    let hinges = HingeTable::build(&mesh, &EdgeTable::build(&mesh).unwrap());
    for hinge in CurvedHinge::across(&mesh, &hinges, 1.0) {
        assert_eq!(hinge.rest_curvature, 0.0);
        let x = hinge.vertices.map(|v| mesh.positions()[v as usize]);
        let quadratic = CurvatureHinge::new(hinge.vertices, &x, 1.0 / 3.0);
        let [own, other] = [
            hinge.hessian(&x, Convexity::Exact),
            quadratic.hessian(&x, Convexity::Exact),
        ];
        for (a, b) in own.iter().flatten().zip(other.iter().flatten()) {
            assert!((a - b).amax() < 1e-9 * hinge.stiffness);
        }
    }
}

/// The limit that the docs of the cubic shell state.
#[test]
fn a_curved_cubic_shell_pulls_outwards_at_rest() {
    for rest_angle in rest_angles() {
        let rest = folded(rest_angle);
        let shell = CubicShell::new(VERTICES, &rest, 0.7);
        let gradient = shell.gradient(&rest);
        let by_scale: Real = gradient.iter().zip(&rest).map(|(g, x)| g.dot(x)).sum();
        let c = rest_angle.cos();
        let expected = -3.0 * 0.7 * shape_factor() * (1.0 - c) * (3.0 + c);
        assert!((by_scale - expected).abs() < 1e-12, "{by_scale} {expected}");
    }
}

#[test]
fn a_curved_sheet_is_at_rest_and_the_quadratic_model_is_not() {
    let flat = generate::irregular(9, 1.0, 1.0, 4).unwrap();
    let bent = flat.positions().iter().map(|p| {
        let (s, c) = p.x.sin_cos();
        Vec3::new(s, p.y, 1.0 - c)
    });
    let mesh = TriMesh::new(bent.collect(), flat.triangles().to_vec()).unwrap();
    let hinges = HingeTable::build(&mesh, &EdgeTable::build(&mesh).unwrap());
    let x = mesh.positions();
    let at = |v: [u32; 4]| v.map(|v| x[v as usize]);
    let sum = |values: Vec<Real>| values.iter().sum::<Real>();
    let dihedral = DihedralHinge::across(&mesh, &hinges, 1.0);
    let curved = CurvedHinge::across(&mesh, &hinges, 1.0);
    let cubic = CubicShell::across(&mesh, &hinges, 1.0);
    let quadratic = CurvatureHinge::across(&mesh, &hinges, 1.0);
    assert!(sum(dihedral.iter().map(|h| h.value(&at(h.vertices))).collect()) < 1e-26);
    assert!(sum(curved.iter().map(|h| h.value(&at(h.vertices))).collect()) < 1e-26);
    assert!(
        sum(cubic
            .iter()
            .map(|h| h.value(&at(h.vertices)).abs())
            .collect())
            < 1e-11
    );
    // ½ D κ² times a factor between 3 and 9 of the pattern, over 3.
    let stored = sum(quadratic.iter().map(|h| h.value(&at(h.vertices))).collect());
    assert!(stored > 0.3 && stored < 3.0, "{stored}");
}

#[test]
fn clamped_is_half_way_between_exact_and_absolute() {
    let shell = CubicShell::new(VERTICES, &folded(2.0), 0.7);
    for seed in 0..20 {
        let x = shape(seed);
        let [exact, abs, clamped] = [Convexity::Exact, Convexity::Abs, Convexity::Clamp]
            .map(|convexity| shell.hessian(&x, convexity));
        for i in 0..4 {
            for j in 0..4 {
                let half = (exact[i][j] + abs[i][j]) * 0.5;
                assert!((half - clamped[i][j]).amax() < 1e-11);
            }
        }
    }
}

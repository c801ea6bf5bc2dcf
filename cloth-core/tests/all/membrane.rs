//! Membrane elements against finite differences, their own invariances, and the patch tests.

use crate::element_checks::{
    balanced, convex_choices_are_convex, derivatives_agree, is_invariant, largest, noise, shape,
};
use cloth_core::check;
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::element::{Convexity, Energy};
use cloth_core::energy::{ArapTriangle, StvkTriangle};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::{TriMesh, generate};
use cloth_core::method::family::Energies;

const REST: [Vec3; 3] = [
    Vec3::new(0.1, 0.2, 0.3),
    Vec3::new(1.3, 0.1, -0.2),
    Vec3::new(0.5, 0.9, 0.1),
];

fn stvk() -> StvkTriangle {
    StvkTriangle::new([0, 1, 2], &REST, 40.0, 0.3)
}

fn arap() -> ArapTriangle {
    ArapTriangle::new([0, 1, 2], &REST, 40.0)
}

#[test]
fn derivatives_agree_with_differences() {
    let mut shapes: Vec<[Vec3; 3]> = (0..60).map(shape).collect();
    // Compressed, stretched, and at rest.
    shapes.extend([0.2, 0.7, 1.0, 1.5].map(|s| REST.map(|x| x * s)));
    shapes.push(REST.map(|x| x.component_mul(&Vec3::new(1.4, 0.6, 0.5))));
    for x in &shapes {
        derivatives_agree(&stvk(), x, 1.0);
        convex_choices_are_convex(&stvk(), x);
        convex_choices_are_convex(&arap(), x);
        let height = (x[1] - x[0]).cross(&(x[2] - x[0])).norm();
        if height > 0.02 {
            derivatives_agree(&arap(), x, height.min(1.0));
        }
    }
}

#[test]
fn collapsed_triangles_are_finite_everywhere() {
    let line = [0.0, 1.0, 3.0].map(|t| Vec3::new(t, 0.3 * t, -t));
    let doubled = [REST[0], REST[1], REST[1]];
    for start in [line, doubled, [noise(1); 3], [Vec3::zeros(); 3]] {
        for size in [0.0, 1e-300, 1e-100, 1e-12, 1e-8] {
            let x: [Vec3; 3] = std::array::from_fn(|i| start[i] + noise(i + 9) * size);
            balanced(&stvk(), &x);
            balanced(&arap(), &x);
            convex_choices_are_convex(&arap(), &x);
        }
    }
    // Pressed to a point, ARAP costs its whole strain: E = ½ A k (1 + 1).
    let area = 0.5 * (REST[1] - REST[0]).cross(&(REST[2] - REST[0])).norm();
    assert!((arap().value(&[noise(1); 3]) / (area * 40.0) - 1.0).abs() < 1e-14);
}

#[test]
fn rigid_motions_are_not_noticed_and_the_rest_shape_costs_nothing() {
    for seed in 0..20 {
        is_invariant(&stvk(), &shape(seed));
        is_invariant(&arap(), &shape(seed));
    }
    assert!(stvk().value(&REST) < 1e-28 && arap().value(&REST) < 1e-28);
}

#[test]
fn the_projective_view_of_arap_gives_the_same_forces() {
    for seed in 0..50 {
        let error = check::projection_error::<3, 2, _>(&arap(), &shape(seed));
        assert!(error < 1e-13, "{error:e}");
    }
}

#[test]
fn clamping_a_stretched_triangle_changes_nothing() {
    let x = REST.map(|x| x * 1.2);
    for convexity in [Convexity::Clamp, Convexity::Abs] {
        let same = |a: Real, b: Real| assert!((a - b).abs() < 1e-12);
        let [exact, chosen] = [Convexity::Exact, convexity].map(|c| stvk().hessian(&x, c));
        same(largest(&exact), largest(&chosen));
        let [exact, chosen] = [Convexity::Exact, convexity].map(|c| arap().hessian(&x, c));
        same(largest(&exact), largest(&chosen));
    }
    let pressed = REST.map(|x| x * 0.5);
    assert!(check::smallest_eigenvalue(&stvk(), &pressed, Convexity::Exact) < -1.0);
    assert!(check::smallest_eigenvalue(&arap(), &pressed, Convexity::Exact) < -1.0);
}

/// First Piola–Kirchhoff stress (N/m) of the sheet along and across a direction, `d·P d`, by virtual work: the
/// derivative of the energy by an affine stretch of the whole patch.
fn stress(energies: &Energies, mesh: &TriMesh, angle: Real, stretch: [Real; 2]) -> [Real; 2] {
    let (s, c) = angle.sin_cos();
    let axes = [Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0)];
    let at = |p: &Vec3| -> Vec3 {
        (0..2)
            .map(|k| axes[k] * (stretch[k] * axes[k].dot(p)))
            .sum()
    };
    let x: Vec<Vec3> = mesh.positions().iter().map(at).collect();
    let mut gradient = vec![Vec3::zeros(); x.len()];
    energies.add_gradient(&x, &mut gradient);
    axes.map(|axis| {
        let pairs = gradient.iter().zip(mesh.positions());
        let work: Real = pairs.map(|(g, p)| axis.dot(g) * axis.dot(p)).sum();
        work / mesh.area()
    })
}

const ANGLES: [Real; 4] = [0.0, 0.3, 1.1, -0.8];

fn irregular() -> TriMesh {
    generate::irregular(7, 1.0, 1.0, 3).unwrap()
}

#[test]
fn stvk_sheets_answer_a_pull_with_the_closed_form() {
    let mesh = irregular();
    for (modulus, nu) in [(40.0, 0.3), (2.0, 0.0), (7.0, -0.4)] {
        let energies = Energies::new(mesh.vertex_count())
            .with(StvkTriangle::on(&mesh, modulus, nu))
            .unwrap();
        for angle in ANGLES {
            for s in [0.8, 1.0, 1.01, 1.4] {
                let square: Real = s * s - 1.0;
                let lateral = (1.0 - nu * square).sqrt();
                let [along, across] = stress(&energies, &mesh, angle, [s, lateral]);
                assert!((along - modulus * s * square / 2.0).abs() < 1e-12 * modulus);
                assert!(across.abs() < 1e-12 * modulus, "{across}");
                for pull in stress(&energies, &mesh, angle, [s, s]) {
                    let expected = modulus * s * square / (2.0 * (1.0 - nu));
                    assert!((pull - expected).abs() < 1e-12 * modulus);
                }
            }
        }
    }
}

/// Derived from `E/area = ½ k Σ (σ − 1)²`: `P = k (s − 1)` along, nothing across, so Y = k and ν = 0.
#[test]
fn arap_sheets_answer_a_pull_linearly_and_keep_their_width() {
    let mesh = irregular();
    let energies = Energies::new(mesh.vertex_count())
        .with(ArapTriangle::on(&mesh, 40.0))
        .unwrap();
    for angle in ANGLES {
        for s in [0.8, 1.0, 1.01, 1.4] {
            let [along, across] = stress(&energies, &mesh, angle, [s, 1.0]);
            assert!((along - 40.0 * (s - 1.0)).abs() < 1e-11);
            assert!(across.abs() < 1e-11);
            for pull in stress(&energies, &mesh, angle, [s, s]) {
                assert!((pull - 40.0 * (s - 1.0)).abs() < 1e-11);
            }
        }
    }
}

#[test]
fn an_affine_stretch_leaves_inner_vertices_in_equilibrium() {
    // Constant strain is what these triangles hold exactly, on any mesh.
    let mesh = irregular();
    let x: Vec<Vec3> = mesh
        .positions()
        .iter()
        .map(|p| Vec3::new(1.2 * p.x + 0.3 * p.y, 0.9 * p.y, 0.2 * p.x))
        .collect();
    let edges = cloth_core::topology::EdgeTable::build(&mesh).unwrap();
    let rim: Vec<u32> = (0..edges.len())
        .filter(|&e| edges.is_boundary(e))
        .flat_map(|e| edges.ends()[e])
        .collect();
    let count = mesh.vertex_count();
    let stvk = Energies::new(count).with(StvkTriangle::on(&mesh, 40.0, 0.3));
    let arap = Energies::new(count).with(ArapTriangle::on(&mesh, 40.0));
    for energies in [stvk.unwrap(), arap.unwrap()] {
        let mut gradient = vec![Vec3::zeros(); count];
        energies.add_gradient(&x, &mut gradient);
        let inner = (0..count).filter(|&v| !rim.contains(&(v as u32)));
        assert!(inner.map(|v| gradient[v].norm()).fold(0.0, Real::max) < 1e-12);
        assert!(gradient.iter().map(Vec3::norm).fold(0.0, Real::max) > 0.1);
    }
}

/// Of what springs of a modulus would store in even strain, the part that is left once the inner vertices have given
/// way, along with the boundary that is held: `E − ½ gᵀ K⁻¹ g`, by conjugate gradients.
fn share_of_the_modulus(mesh: &TriMesh, strain: Vec3) -> Real {
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::Modulus(1e3),
        bending_rigidity: 0.0,
    };
    let springs = cloth.on(mesh).unwrap().energies().unwrap();
    let (rest, eps) = (mesh.positions(), 1e-6);
    let x: Vec<Vec3> = rest
        .iter()
        .map(|x| x + x.component_mul(&strain) * eps)
        .collect();
    let is_inner = |x: &Vec3| [x.x, x.y].iter().all(|c| (1e-9..1.0 - 1e-9).contains(c));
    let dot = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<Real>();
    // In the plane and inside.
    let project = |mut f: Vec<Vec3>| {
        for (f, x) in f.iter_mut().zip(rest) {
            *f = if is_inner(x) {
                Vec3::new(f.x, f.y, 0.0)
            } else {
                Vec3::zeros()
            };
        }
        f
    };
    let mut r = vec![Vec3::zeros(); rest.len()];
    let stored = springs.add_gradient(&x, &mut r);
    let gradient = project(r);
    let (mut r, mut y) = (gradient.clone(), vec![Vec3::zeros(); rest.len()]);
    let (mut p, first) = (r.clone(), dot(&r, &r));
    let mut square = first;
    while square > 1e-16 * first && first > 1e-20 {
        let mut product = vec![Vec3::zeros(); rest.len()];
        springs.add_hessian_product(rest, &p, Convexity::GaussNewton, &mut product);
        let product = project(product);
        let length = square / dot(&p, &product);
        for v in 0..rest.len() {
            y[v] += p[v] * length;
            r[v] -= product[v] * length;
        }
        let next = dot(&r, &r);
        for v in 0..rest.len() {
            p[v] = r[v] + p[v] * (next / square);
        }
        square = next;
    }
    // An isotropic sheet of Poisson's ratio 1/3.
    let [a, b] = [strain.x, strain.y];
    let law = 0.5 * 1e3 * 9.0 / 8.0 * (a * a + b * b + 2.0 / 3.0 * a * b) * eps * eps;
    (stored - 0.5 * dot(&gradient, &y)) / law
}

/// [`Membrane::Modulus`]: what springs have of it on an irregular mesh, however fine.
#[test]
fn springs_of_a_modulus_give_way_on_an_irregular_mesh() {
    let grid = generate::grid(17, 17, 1.0, 1.0, generate::Diagonals::Alternating).unwrap();
    for (strain, expected) in [
        (Vec3::new(1.0, 1.0, 0.0), 0.715..0.745),
        (Vec3::new(1.0, 0.0, 0.0), 0.75..0.775),
    ] {
        assert!((share_of_the_modulus(&grid, strain) - 1.0).abs() < 1e-5);
        for n in [17, 33, 65] {
            let mesh = generate::irregular(n, 1.0, 1.0, 1).unwrap();
            let share = share_of_the_modulus(&mesh, strain);
            assert!(expected.contains(&share), "{n}, {strain}: {share}");
        }
    }
}

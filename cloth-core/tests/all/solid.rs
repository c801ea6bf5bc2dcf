//! Solids: tetrahedra, their meshes and files, and the moduli that come out.

use crate::element_checks::{
    balanced, convex_choices_are_convex, derivatives_agree, is_invariant, noise, shape,
};
use cloth_core::ClothModel;
use cloth_core::cloth::{Elements, Solid, SolidPiece};
use cloth_core::element::{Energy, Projective};
use cloth_core::energy::{ArapTetrahedron, Spring, VolumeTetrahedron};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::mesh::generate::{ball, block, sphere};
use cloth_core::mesh::{MeshError, TetMesh, gmsh};
use cloth_core::topology::{EdgeTable, Topology, inconsistently_oriented_edges};

const REST: [Vec3; 4] = [
    Vec3::new(0.1, 0.2, 0.3),
    Vec3::new(1.3, 0.1, -0.2),
    Vec3::new(0.5, 0.9, 0.1),
    Vec3::new(0.4, 0.3, 1.1),
];

fn arap() -> ArapTetrahedron {
    ArapTetrahedron::new([0, 1, 2, 3], &REST, 40.0)
}

fn volume(x: &[Vec3; 4]) -> Real {
    (x[1] - x[0]).dot(&(x[2] - x[0]).cross(&(x[3] - x[0]))) / 6.0
}

/// A rotation by an angle (rad) about an oblique axis.
fn turn(angle: Real) -> Mat3 {
    let axis = Vec3::new(0.6, -0.48, 0.64).cross_matrix();
    Mat3::identity() + axis * angle.sin() + axis * axis * (1.0 - angle.cos())
}

#[test]
fn derivatives_agree_with_differences() {
    let mut seen = 0;
    for seed in 0..400 {
        let x: [Vec3; 4] = shape(seed);
        convex_choices_are_convex(&arap(), &x);
        is_invariant(&arap(), &x);
        if volume(&x).abs() > 0.1 {
            derivatives_agree(&arap(), &x, 0.1);
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen}");
    for scale in [0.2, 0.9, 1.0, 1.5] {
        derivatives_agree(&arap(), &REST.map(|x| turn(2.0) * x * scale), 1.0);
    }
}

/// `E = ½ w ‖S x − p‖²` with p the nearest of all rotations: no other is nearer.
#[test]
fn it_is_projected_to_the_nearest_rotation() {
    for seed in 0..200 {
        let x: [Vec3; 4] = shape(seed);
        let operator = arap().operator();
        let z = operator.map(|row| (0..4).map(|i| x[i] * row[i]).sum::<Vec3>());
        let p = arap().project(z);
        let map = Mat3::from_columns(&p);
        assert!((map.transpose() * map - Mat3::identity()).amax() < 1e-14);
        assert!((map.determinant() - 1.0).abs() < 1e-14);
        let distance =
            |p: [Vec3; 3]| -> Real { (0..3).map(|k| (z[k] - p[k]).norm_squared()).sum() };
        let energy = 0.5 * arap().weight() * distance(p);
        assert!((energy / arap().value(&x) - 1.0).abs() < 1e-12);
        for other in 0..40 {
            let other = turn(0.1 * Real::from(other)) * map;
            let columns = [0, 1, 2].map(|k| other.column(k).into());
            assert!(distance(columns) >= distance(p) - 1e-12);
        }
    }
    // At rest and turned, exactly that.
    let z = [0, 1, 2].map(|k| turn(1.0).column(k).into());
    let p = Mat3::from_columns(&arap().project(z));
    assert!((p - turn(1.0)).amax() < 1e-15);
}

#[test]
fn collapsed_shapes_are_finite_everywhere() {
    let line = [0.0, 1.0, 3.0, 4.0].map(|t| Vec3::new(t, 0.3 * t, -t));
    let flat = REST.map(|x| x.component_mul(&Vec3::new(1.0, 1.0, 0.0)));
    for start in [line, flat, [noise(1); 4], [Vec3::zeros(); 4]] {
        for size in [0.0, 1e-300, 1e-100, 1e-12, 1e-8] {
            let x: [Vec3; 4] = std::array::from_fn(|i| start[i] + noise(i + 9) * size);
            balanced(&arap(), &x);
        }
    }
    // Inside out: the smallest stretch is negative, and pushes it back.
    let mirrored = REST.map(|x| x.component_mul(&Vec3::new(1.0, 1.0, -1.0)));
    let rest = volume(&REST);
    assert!((arap().value(&mirrored) / (40.0 * rest * 4.0) - 1.0).abs() < 1e-13);
}

/// Both generators: all of the volume once, and one closed surface around it.
#[test]
fn solids_fill_their_surface() {
    let size = Vec3::new(0.4, 0.2, 0.3);
    for (mesh, expected, accuracy) in [
        (block([4, 2, 3], size).unwrap(), size.product(), 1e-13),
        (ball(12, 0.5).unwrap(), std::f64::consts::PI / 6.0, 0.01),
    ] {
        let (surface, x) = (mesh.surface(), mesh.surface().positions());
        let each = mesh.tetrahedra().iter();
        let volumes = each.map(|t| volume(&t.map(|v| x[v as usize])));
        let inside: Real = volumes.inspect(|v| assert!(*v > 0.0)).sum();
        let around = surface.triangles().iter();
        let around = around.map(|t| {
            let [a, b, c] = t.map(|v| x[v as usize]);
            a.dot(&b.cross(&c)) / 6.0
        });
        let around: Real = around.sum();
        assert!((around / inside - 1.0).abs() < 1e-12, "{around} {inside}");
        assert!((inside / expected - 1.0).abs() < accuracy, "{inside}");
        let edges = EdgeTable::build(surface).unwrap();
        assert_eq!(edges.boundary_edge_count(), 0);
        assert!(inconsistently_oriented_edges(surface, &edges).is_empty());
        let used: std::collections::BTreeSet<_> =
            surface.triangles().as_flattened().iter().collect();
        let euler = used.len() + surface.triangle_count() - edges.len();
        assert_eq!(euler, 2);
        assert!(used.len() < x.len(), "vertices inside");
    }
    let (solid, shell) = (ball(5, 0.1).unwrap(), sphere(5, 0.1).unwrap());
    assert_eq!(solid.surface().triangle_count(), shell.triangle_count());
    assert_eq!(solid.tetrahedra().len(), 20 * 125);
    let edges = EdgeTable::build(&shell).unwrap();
    assert_eq!(Topology::of(&shell, &edges).vertices, 252);
    // 1 + Σ (10 k² + 2).
    assert_eq!(solid.surface().vertex_count(), 1 + 550 + 10);
}

/// A mesh that is no lattice.
fn jittered() -> TetMesh {
    let (mesh, tetrahedra) = block([3, 3, 3], Vec3::new(0.3, 0.3, 0.3))
        .unwrap()
        .into_parts();
    let x = mesh.positions().iter().enumerate();
    let x = x.map(|(v, x)| x + noise(v) * 0.015).collect();
    TetMesh::new(x, tetrahedra).unwrap()
}

/// The sum of the volumes (m³) of all tetrahedra.
fn whole_volume(mesh: &TetMesh) -> Real {
    let x = mesh.surface().positions();
    let volumes = mesh.tetrahedra().iter();
    volumes.map(|t| volume(&t.map(|v| x[v as usize]))).sum()
}

fn model(mesh: &TetMesh, solid: Solid) -> ClothModel {
    let tetrahedra = mesh.tetrahedra().to_vec();
    ClothModel::of_pieces(mesh.surface(), &[], &[SolidPiece { solid, tetrahedra }]).unwrap()
}

/// In any mesh a small uniform strain costs what the linear elastic solid of E and ν stores, and pushes no vertex
/// inside: stretch, shear, and equal pressure from all sides, by the bulk modulus E/(3(1 − 2ν)).
#[test]
fn moduli_are_those_of_the_material() {
    let mesh = jittered();
    let rest = mesh.surface().positions();
    let total = whole_volume(&mesh);
    let on_surface: Vec<u32> = mesh.surface().triangles().as_flattened().to_vec();
    for nu in [0.0, 0.25, 0.45] {
        let solid = Solid {
            density: 900.0,
            modulus: 2e4,
            poisson_ratio: nu,
        };
        let model = model(&mesh, solid);
        let mass: Real = model.particles.mass().iter().sum();
        assert!((mass / (900.0 * total) - 1.0).abs() < 1e-13);
        let energies = model.energies().unwrap();
        let (shear, bulk) = (2e4 / (2.0 * (1.0 + nu)), 2e4 / (3.0 * (1.0 - 2.0 * nu)));
        let size: Real = 1e-5;
        let mut strains = vec![Mat3::identity()];
        strains.extend((0..8).map(|k| {
            let any = Mat3::from_columns(&[noise(3 * k), noise(3 * k + 1), noise(3 * k + 2)]);
            any + any.transpose()
        }));
        // A pull along x that leaves the width free costs ½ E ε².
        strains.push(Mat3::from_diagonal(&Vec3::new(1.0, -nu, -nu)));
        for (number, strain) in strains.iter().enumerate() {
            let strain = strain * size;
            let x: Vec<Vec3> = rest.iter().map(|x| turn(0.7) * (x + strain * x)).collect();
            let trace = strain.trace();
            let deviator = strain - Mat3::identity() * (trace / 3.0);
            let mut law = shear * deviator.norm_squared() + 0.5 * bulk * trace * trace;
            if number + 1 == strains.len() {
                assert!((law / (0.5 * 2e4 * size * size) - 1.0).abs() < 1e-12);
                law = 0.5 * 2e4 * size * size;
            }
            let error = energies.value(&x) / (law * total) - 1.0;
            assert!(error.abs() < 1e-3, "ν = {nu}, {strain}: {error:e}");
            let mut gradient = vec![Vec3::zeros(); x.len()];
            energies.add_gradient(&x, &mut gradient);
            let force = |v: &usize| gradient[*v].norm();
            let inner = (0..x.len()).filter(|v| !on_surface.contains(&(*v as u32)));
            let inner = inner.map(|v| force(&v)).fold(0.0, Real::max);
            let outer = (0..x.len()).map(|v| force(&v)).fold(0.0, Real::max);
            assert!(inner < 1e-8 * outer, "ν = {nu}: {inner:e} of {outer:e}");
        }
    }
}

/// For ν = 0 a pull answers with E (s − 1) at any s, and for any ν pressure from all sides is what bulk and shear
/// store.
#[test]
fn large_strains_cost_what_the_formula_says() {
    let mesh = jittered();
    let rest = mesh.surface().positions();
    let total = whole_volume(&mesh);
    for s in [0.3, 0.8, 1.7] as [Real; 3] {
        let of = |nu, stretch: Vec3| {
            let solid = Solid {
                density: 1.0,
                modulus: 100.0,
                poisson_ratio: nu,
            };
            let x: Vec<Vec3> = rest.iter().map(|x| x.component_mul(&stretch)).collect();
            model(&mesh, solid).energies().unwrap().value(&x) / total
        };
        let law = 0.5 * 100.0 * (s - 1.0).powi(2);
        assert!((of(0.0, Vec3::new(s, 1.0, 1.0)) / law - 1.0).abs() < 1e-12);
        let (shear, lambda) = (100.0 / 2.8, 100.0 * 0.4 / (1.4 * 0.2));
        let law = 3.0 * shear * (s - 1.0).powi(2) + 0.5 * lambda * (s.powi(3) - 1.0).powi(2);
        assert!((of(0.4, Vec3::new(s, s, s)) / law - 1.0).abs() < 1e-12);
    }
}

#[test]
fn what_is_no_solid_is_refused() {
    let mut x = REST.to_vec();
    x.extend([Vec3::new(2.0, 2.0, 2.5), Vec3::new(-1.0, 0.3, 3.0)]);
    let refused =
        |tetrahedra: Vec<[u32; 4]>| TetMesh::new(x.clone(), tetrahedra).unwrap_err().to_string();
    for (tetrahedra, words) in [
        (vec![], "no triangles"),
        (vec![[0, 1, 2, 6]], "names a vertex that does not exist"),
        (vec![[0, 1, 2, 1]], "names a vertex twice"),
        (
            vec![[0, 1, 2, 3], [3, 2, 1, 0]],
            "has the vertices of another one",
        ),
        (
            vec![[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]],
            "is the third at one of its faces",
        ),
    ] {
        let found = refused(tetrahedra);
        assert!(found.contains(words), "{found}");
    }
    let flat = REST.map(|x| Vec3::new(x.x, x.y, 0.0)).to_vec();
    let error = TetMesh::new(flat, vec![[0, 1, 2, 3]]).unwrap_err();
    assert!(
        matches!(error, MeshError::BadTetrahedron { tetrahedron: 0, .. }),
        "{error}"
    );
    // Turned inside out it becomes right.
    x.truncate(4);
    let right = TetMesh::new(x.clone(), vec![[0, 2, 1, 3]]).unwrap();
    let [corners] = right.tetrahedra() else {
        panic!()
    };
    assert!(volume(&corners.map(|v| x[v as usize])) > 0.0);
    for nu in [-0.1, 0.5, Real::NAN] {
        let solid = Solid {
            density: 1.0,
            modulus: 1.0,
            poisson_ratio: nu,
        };
        let piece = SolidPiece {
            solid,
            tetrahedra: right.tetrahedra().to_vec(),
        };
        let error = ClothModel::of_pieces(right.surface(), &[], &[piece]).unwrap_err();
        assert!(error.to_string().contains("Poisson"), "{error}");
    }
}

const MSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n4 0 1 0\n9 5 5 5\n7 0 0 1\n\
     8 1 1 1\n$EndNodes\n$Elements\n3\n1 2 2 0 1 1 2 4\n2 4 2 0 1 1 2 4 7\n3 4 2 0 1 2 4 7 8\n$EndElements\n";

#[test]
fn a_file_of_gmsh_is_read() {
    let mesh = gmsh::parse(MSH).unwrap();
    // Node 9 is in no tetrahedron.
    assert_eq!(mesh.surface().vertex_count(), 5);
    assert_eq!(mesh.surface().positions()[3], Vec3::z());
    assert_eq!(mesh.surface().triangle_count(), 6);
    let sorted = |mut t: [u32; 4]| {
        t.sort_unstable();
        t
    };
    let found: Vec<_> = mesh.tetrahedra().iter().map(|t| sorted(*t)).collect();
    assert_eq!(found, [[0, 1, 2, 3], [1, 2, 3, 4]]);
}

#[test]
fn mistakes_in_a_file_of_gmsh_are_told_with_their_line() {
    for (from, to, words) in [
        ("2.2 0 8", "4.1 0 8", "line 2: only version 2.2 in ASCII"),
        ("2.2 0 8", "2.2 1 8", "line 2: only version 2.2 in ASCII"),
        (
            "\n2 1 0 0",
            "\n2 1 x 0",
            "line 7: a number should be here, and not x",
        ),
        (
            "\n2 1 0 0",
            "\n2 1 0",
            "line 7: a number should be here, and not the end of the line",
        ),
        (
            "\n2 1 0 0",
            "\n2 1 0 inf",
            "line 7: a coordinate is not a finite number",
        ),
        (
            "\n2 1 0 0",
            "\n1 1 0 0",
            "line 7: there is a node 1 already",
        ),
        ("1 2 4 7 8", "1 2 4 7", "line 17"),
        ("2 4 7 8", "2 4 7 3", "line 17: there is no node 3"),
        ("0 1 2 4 7 8", "0 1 2 4 7 7", "line 17: tetrahedron 1"),
        (
            "2 4 7 8",
            "2 4 7 1",
            "line 17: tetrahedron 1 with the vertices [1, 2, 0, 3] has the vertices of another one",
        ),
        (
            "$EndElements\n",
            "$EndElements\n$Nodes\n0\n",
            "line 19: there is a section $Nodes before this one",
        ),
        (
            "$EndElements\n",
            "$EndElements\n$Elements\n0\n",
            "line 19: there is a section $Elements before this one",
        ),
        ("$Nodes", "$Knots", "there is no section $Nodes"),
        ("$Elements", "$Parts", "there is no section $Elements"),
        (
            "\n3\n",
            "\n7\n",
            "a number should be here, and not $EndElements",
        ),
    ] {
        let found = gmsh::parse(&MSH.replacen(from, to, 1))
            .unwrap_err()
            .to_string();
        assert!(found.contains(words), "{to}: {found}");
    }
}

/// What is lost of families is found where the rest is unchanged and in order, and nothing else is called a loss.
#[test]
fn losses_of_families_are_found() {
    let spring = |n: u32| Spring {
        vertices: [n, n + 1],
        rest_length: 1.0,
        stiffness: 2.0,
    };
    let springs = |numbers: &[u32]| Elements::Springs(numbers.iter().map(|&n| spring(n)).collect());
    let volumes = Elements::Volumes(vec![VolumeTetrahedron::new([0, 1, 2, 3], &REST, 1.0)]);
    let all = [springs(&[0, 1, 2, 3]), volumes.clone(), springs(&[7, 8])];
    let lost = |left: &[Elements]| Elements::lost(&all, left);
    assert_eq!(lost(&all), Some(vec![]));
    let left = [springs(&[1, 3]), volumes.clone(), springs(&[8])];
    assert_eq!(lost(&left), Some(vec![[0, 0], [0, 2], [2, 0]]));
    assert_eq!(
        lost(&[springs(&[0, 1, 2, 3]), springs(&[7, 8])]),
        Some(vec![[1, 0]])
    );
    assert_eq!(lost(&[springs(&[7])]).unwrap().len(), 6);
    assert_eq!(lost(&[springs(&[1, 0]), volumes, springs(&[7, 8])]), None);
    assert_eq!(lost(&[springs(&[0, 1, 2, 3, 4])]), None);
}

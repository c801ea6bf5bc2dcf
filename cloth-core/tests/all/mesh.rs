//! Generated meshes: counts, areas, orientation and shape in closed form.

use cloth_core::error::OutOfRange;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{
    Diagonals, cuboid, disk, equilateral, grid, irregular, join, moebius, sphere, torus, tube,
    without_triangles,
};
use cloth_core::mesh::{MeshError, TriMesh};
use cloth_core::topology::{EdgeTable, HingeTable, NONE, inconsistently_oriented_edges};
use std::f64::consts::{PI, TAU};

const PATTERNS: [Diagonals; 3] = [
    Diagonals::OneWay,
    Diagonals::Alternating,
    Diagonals::Crossed,
];

fn corners(mesh: &TriMesh, triangle: [u32; 3]) -> [Vec3; 3] {
    triangle.map(|v| mesh.positions()[v as usize])
}

fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    0.5 * (b - a).cross(&(c - a))
}

fn close(a: Real, b: Real) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

fn faces_up(mesh: &TriMesh) -> bool {
    let mut all = mesh.triangles().iter();
    all.all(|&t| area_vector(corners(mesh, t)).z > 0.0)
}

fn edge_lengths(mesh: &TriMesh) -> Vec<Real> {
    let edges = EdgeTable::build(mesh).unwrap();
    let length =
        |[a, b]: [u32; 2]| (mesh.positions()[a as usize] - mesh.positions()[b as usize]).norm();
    edges.ends().iter().map(|&ends| length(ends)).collect()
}

fn longest_over_shortest_edge(mesh: &TriMesh) -> Real {
    let lengths = edge_lengths(mesh);
    lengths.iter().fold(0.0, |m: Real, &l| m.max(l))
        / lengths.iter().fold(Real::INFINITY, |m, &l| m.min(l))
}

#[test]
fn grids_cover_their_rectangle_facing_up() {
    for pattern in PATTERNS {
        for (columns, rows) in [(2, 2), (5, 3), (8, 9)] {
            let mesh = grid(columns, rows, 0.7, 1.3, pattern).unwrap();
            let cells = (columns - 1) * (rows - 1);
            let crossed = pattern == Diagonals::Crossed;
            let middles = if crossed { cells } else { 0 };
            assert_eq!(mesh.vertex_count(), columns * rows + middles);
            assert_eq!(mesh.triangle_count(), cells * if crossed { 4 } else { 2 });
            assert!(close(mesh.area(), 0.7 * 1.3));
            assert!(faces_up(&mesh));
            // The far corner is exact, not a sum of rounded steps.
            let last = mesh.positions()[columns * rows - 1];
            assert_eq!(last, Vec3::new(0.7, 1.3, 0.0));
        }
    }
}

#[test]
fn alternating_grids_are_their_own_mirror_image() {
    let mesh = grid(5, 5, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let mirror = |v: u32| v / 5 * 5 + 4 - v % 5;
    let sorted = |mut triangle: [u32; 3]| {
        triangle.sort_unstable();
        triangle
    };
    let mut here: Vec<_> = mesh.triangles().iter().map(|&t| sorted(t)).collect();
    let mut there: Vec<_> = here.iter().map(|t| sorted(t.map(mirror))).collect();
    here.sort_unstable();
    there.sort_unstable();
    assert_eq!(here, there);
}

#[test]
fn one_way_diagonals_rise() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    assert!(edges.find(0, 4).is_some() && edges.find(4, 8).is_some());
    assert!(edges.find(1, 3).is_none());
}

#[test]
fn all_edges_of_an_equilateral_sheet_are_equal() {
    let mesh = equilateral(6, 7, 0.25).unwrap();
    assert!(edge_lengths(&mesh).iter().all(|&l| close(l, 0.25)));
    assert!(faces_up(&mesh));
    assert!(close(
        mesh.area(),
        60.0 * 0.25 * 0.25 * 3.0_f64.sqrt() / 4.0
    ));
}

#[test]
fn a_disk_has_the_area_of_its_polygon() {
    for rings in [1, 2, 3, 10] {
        let mesh = disk(rings, 0.8).unwrap();
        let n = 6.0 * rings as Real;
        assert_eq!(mesh.vertex_count(), 1 + 3 * rings * (rings + 1));
        assert_eq!(mesh.triangle_count(), 6 * rings * rings);
        assert!(close(mesh.area(), 0.5 * n * 0.64 * (TAU / n).sin()));
        assert!(faces_up(&mesh));
    }
    assert!(longest_over_shortest_edge(&disk(30, 1.0).unwrap()) < 1.8);
}

#[test]
fn a_tube_has_the_area_of_its_prism_and_faces_outward() {
    let (n, m, radius, length) = (7, 3, 0.4, 1.1);
    let mesh = tube(n, m, radius, length).unwrap();
    assert_eq!(mesh.vertex_count(), n * (m + 1));
    assert_eq!(mesh.triangle_count(), 2 * n * m);
    let side = 2.0 * radius * (PI / n as Real).sin();
    assert!(close(mesh.area(), n as Real * side * length));
    for &t in mesh.triangles() {
        let [a, b, c] = corners(&mesh, t);
        let outward = Vec3::new(a.x + b.x + c.x, a.y + b.y + c.y, 0.0);
        assert!(area_vector([a, b, c]).dot(&outward) > 0.0);
    }
}

/// Volume (m³) enclosed by a closed surface, positive if it is wound outward.
fn volume(mesh: &TriMesh) -> Real {
    let tetrahedron = |[a, b, c]: [Vec3; 3]| a.dot(&b.cross(&c)) / 6.0;
    let all = mesh.triangles().iter();
    all.map(|&t| tetrahedron(corners(mesh, t))).sum()
}

#[test]
fn a_box_is_closed_and_encloses_its_volume() {
    let half = [0.1, 0.25, 0.7];
    let mesh = cuboid(half).unwrap();
    assert!(close(volume(&mesh), 8.0 * half.iter().product::<Real>()));
    let edges = EdgeTable::build(&mesh).unwrap();
    assert_eq!((mesh.vertex_count(), edges.ends().len()), (8, 18));
    assert!(inconsistently_oriented_edges(&mesh, &edges).is_empty());
    let on_corners = |x: &Vec3| (0..3).all(|axis| x[axis].abs() == half[axis]);
    assert!(mesh.positions().iter().all(on_corners));
}

#[test]
fn spheres_approach_the_sphere_from_inside() {
    // Frequency 1 is the icosahedron, V = 5(3 + √5)/12 a³ with circumradius a sin(2π/5).
    let edge = 1.0 / (TAU / 5.0).sin();
    let icosahedron = 5.0 * (3.0 + 5.0_f64.sqrt()) / 12.0 * edge.powi(3);
    assert!(close(volume(&sphere(1, 1.0).unwrap()), icosahedron));
    let mut before = [4.0 * PI, 4.0 / 3.0 * PI];
    for n in [2, 4, 8, 16] {
        let mesh = sphere(n, 1.0).unwrap();
        assert_eq!(mesh.vertex_count(), 10 * n * n + 2);
        assert_eq!(mesh.triangle_count(), 20 * n * n);
        assert!(mesh.positions().iter().all(|p| close(p.norm(), 1.0)));
        assert!(mesh.triangles().iter().all(|&t| {
            let [a, b, c] = corners(&mesh, t);
            area_vector([a, b, c]).dot(&(a + b + c)) > 0.0
        }));
        let missing = [4.0 * PI - mesh.area(), 4.0 / 3.0 * PI - volume(&mesh)];
        for k in 0..2 {
            // Second order, from below.
            let ratio = before[k] / missing[k];
            assert!(missing[k] > 0.0 && (n == 2 || (3.5..4.5).contains(&ratio)));
        }
        before = missing;
        assert!(longest_over_shortest_edge(&mesh) < 1.5);
    }
}

#[test]
fn tori_enclose_their_volume() {
    let mesh = torus(200, 100, 1.0, 0.3).unwrap();
    assert_eq!(
        (mesh.vertex_count(), mesh.triangle_count()),
        (20_000, 40_000)
    );
    let exact = 2.0 * PI * PI * 0.09;
    assert!(volume(&mesh) > 0.0 && (volume(&mesh) / exact - 1.0).abs() < 2e-3);
    assert!(inconsistently_oriented_edges(&mesh, &EdgeTable::build(&mesh).unwrap()).is_empty());
}

#[test]
fn a_moebius_band_turns_over_at_its_seam_only() {
    for (around, cells) in [(3, 1), (3, 2), (12, 3)] {
        let mesh = moebius(around, cells, 1.0, 0.5).unwrap();
        let edges = EdgeTable::build(&mesh).unwrap();
        assert_eq!(inconsistently_oriented_edges(&mesh, &edges).len(), cells);
    }
}

/// The definition, tried out: no vertex lies inside the circle through a triangle.
#[test]
fn irregular_sheets_are_delaunay() {
    for (n, seed) in [(2, 0), (3, 1), (9, 2), (14, 3)] {
        let mesh = irregular(n, 1.5, 1.0, seed).unwrap();
        assert_eq!(mesh.vertex_count(), n * n);
        assert_eq!(mesh.triangle_count(), 2 * (n - 1) * (n - 1));
        assert!(close(mesh.area(), 1.5) && faces_up(&mesh));
        for &t in mesh.triangles() {
            let [a, b, c] = corners(&mesh, t);
            let (ab, ac) = (b - a, c - a);
            let twice = 2.0 * ab.cross(&ac).z;
            let (p, q) = (ab.norm_squared(), ac.norm_squared());
            let to_center = Vec3::new(ac.y * p - ab.y * q, ab.x * q - ac.x * p, 0.0) / twice;
            let radius = to_center.norm();
            for d in mesh.positions() {
                assert!((d - a - to_center).norm() > radius * (1.0 - 1e-7));
            }
        }
    }
}

#[test]
fn irregular_sheets_are_irregular_but_well_shaped() {
    let mesh = irregular(30, 1.0, 1.0, 7).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    let mut neighbours = vec![0; mesh.vertex_count()];
    for &[a, b] in edges.ends() {
        neighbours[a as usize] += 1;
        neighbours[b as usize] += 1;
    }
    for valence in [5, 6, 7] {
        assert!(neighbours.iter().filter(|&&k| k == valence).count() > 100);
    }
    // No direction is preferred: the mean of e^{i m φ} over the edges is small for the two
    // symmetries the starting grid has.
    for m in [2.0, 4.0] {
        let (mut cos, mut sin) = (0.0, 0.0);
        for &[a, b] in edges.ends() {
            let d = mesh.positions()[a as usize] - mesh.positions()[b as usize];
            let angle = m * d.y.atan2(d.x);
            cos += angle.cos() / edges.len() as Real;
            sin += angle.sin() / edges.len() as Real;
        }
        assert!(cos.hypot(sin) < 0.1, "m = {m}: {}", cos.hypot(sin));
    }
    for &t in mesh.triangles() {
        let [a, b, c] = corners(&mesh, t);
        for [p, q, r] in [[a, b, c], [b, c, a], [c, a, b]] {
            assert!((q - p).angle(&(r - p)).to_degrees() > 15.0);
        }
    }
}

#[test]
fn the_same_arguments_give_the_same_bits_and_another_seed_does_not() {
    let [a, b, c] = [5, 5, 6].map(|seed| irregular(12, 1.0, 2.0, seed).unwrap());
    assert_eq!(a, b);
    assert_ne!(a, c);
}

#[test]
fn the_boundary_of_an_irregular_sheet_is_straight() {
    let n = 11;
    let mesh = irregular(n, 2.0, 1.0, 3).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    assert_eq!(edges.boundary_edge_count(), 4 * (n - 1));
    for (ends, sides) in edges.ends().iter().zip(edges.sides()) {
        let [a, b] = ends.map(|v| mesh.positions()[v as usize]);
        let on_side = (a.x == b.x && (a.x == 0.0 || a.x == 2.0))
            || (a.y == b.y && (a.y == 0.0 || a.y == 1.0));
        assert_eq!(sides[1] == NONE, on_side);
    }
}

#[test]
fn cutting_a_hole_keeps_the_order_and_drops_what_is_alone() {
    let sheet = grid(7, 7, 6.0, 6.0, Diagonals::OneWay).unwrap();
    let inside = |p: Vec3| (p - Vec3::new(3.0, 3.0, 0.0)).amax() <= 1.0;
    let cut = without_triangles(&sheet, |_, corners| corners.into_iter().all(inside)).unwrap();
    // A hole of 2 × 2 cells takes its middle vertex with it.
    assert_eq!(cut.triangle_count(), sheet.triangle_count() - 8);
    assert_eq!(cut.vertex_count(), sheet.vertex_count() - 1);
    assert!(close(cut.area(), 32.0));
    assert_eq!(
        without_triangles(&sheet, |_, _| true),
        Err(MeshError::Empty)
    );
}

#[test]
fn joined_meshes_keep_their_triangles() {
    let parts = [disk(2, 1.0).unwrap(), tube(5, 2, 1.0, 1.0).unwrap()];
    let both = join(&parts).unwrap();
    assert!(close(both.area(), parts[0].area() + parts[1].area()));
    assert_eq!(join(&[]), Err(MeshError::Empty));
}

#[test]
fn meshes_that_do_not_exist_are_refused_by_name() {
    let nan = Real::NAN;
    let name = |result: Result<TriMesh, MeshError>| match result {
        Err(MeshError::OutOfRange(OutOfRange { name, .. })) => name,
        other => panic!("{other:?}"),
    };
    assert_eq!(name(grid(1, 2, 1.0, 1.0, Diagonals::OneWay)), "columns");
    assert_eq!(name(grid(2, 0, 1.0, 1.0, Diagonals::OneWay)), "rows");
    assert_eq!(name(grid(2, 2, nan, 1.0, Diagonals::OneWay)), "width");
    assert_eq!(name(grid(2, 2, 1.0, -1.0, Diagonals::OneWay)), "height");
    assert_eq!(
        name(grid(usize::MAX, usize::MAX, 1.0, 1.0, Diagonals::Crossed)),
        "the number of vertices"
    );
    assert_eq!(name(equilateral(2, 2, 0.0)), "edge");
    assert_eq!(name(disk(0, 1.0)), "rings");
    assert_eq!(name(disk(1, Real::INFINITY)), "radius");
    assert_eq!(name(tube(2, 1, 1.0, 1.0)), "around");
    assert_eq!(name(tube(3, 0, 1.0, 1.0)), "cells_along");
    assert_eq!(name(torus(3, 3, 1.0, 1.0)), "minor");
    assert_eq!(name(cuboid([1.0, 0.0, 1.0])), "half extent");
    assert_eq!(name(sphere(0, 1.0)), "n");
    assert_eq!(name(sphere(usize::MAX, 1.0)), "the number of vertices");
    assert_eq!(name(moebius(3, 1, 1.0, 2.0)), "width");
    assert_eq!(name(irregular(1, 1.0, 1.0, 0)), "n");
    let error = disk(0, 1.0).unwrap_err();
    assert_eq!(error.to_string(), "rings is 0, but it has to be at least 1");
}

#[test]
fn every_mesh_bends_where_two_triangles_meet() {
    let mesh = sphere(3, 1.0).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    let hinges = HingeTable::build(&mesh, &edges);
    assert_eq!(hinges.len(), edges.len());
}

/// Some of the triangles may leave vertices alone; none may be wrong.
#[test]
fn other_triangles_are_checked_as_those_of_a_new_mesh() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let some = mesh.with_triangles(mesh.triangles()[..2].to_vec()).unwrap();
    assert_eq!((some.vertex_count(), some.triangle_count()), (9, 2));
    assert_eq!(mesh.with_triangles(Vec::new()), Err(MeshError::Empty));
    let beyond = MeshError::IndexOutOfRange {
        triangle: 1,
        vertex: 99,
        vertex_count: 9,
    };
    let first = mesh.triangles()[0];
    assert_eq!(mesh.with_triangles(vec![first, [0, 1, 99]]), Err(beyond));
    let [a, b, _] = first;
    let repeated = mesh.with_triangles(vec![[a, a, b]]);
    assert!(matches!(repeated, Err(MeshError::RepeatedVertex { .. })));
}

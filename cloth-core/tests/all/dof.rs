//! Degrees of freedom: closed forms and a dense computation.

use cloth_core::dof::{EdgeRank, perturbed};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{self, Diagonals};
use cloth_core::topology::{EdgeTable, Topology};

fn measured(mesh: &TriMesh, positions: &[Vec3]) -> (Topology, EdgeRank) {
    let edges = EdgeTable::build(mesh).unwrap();
    let rank = EdgeRank::measure(positions, &edges).unwrap();
    (Topology::of(mesh, &edges), rank)
}

/// Rank and smallest kept singular value by a dense singular value decomposition.
fn dense(positions: &[Vec3], edges: &EdgeTable) -> (usize, Real) {
    let mut j = nalgebra::DMatrix::<Real>::zeros(edges.len(), 3 * positions.len());
    for (row, [a, b]) in edges.ends().iter().enumerate() {
        let n = (positions[*a as usize] - positions[*b as usize]).normalize();
        for axis in 0..3 {
            j[(row, 3 * *a as usize + axis)] = n[axis];
            j[(row, 3 * *b as usize + axis)] = -n[axis];
        }
    }
    let kept: Vec<Real> = j
        .singular_values()
        .iter()
        .copied()
        .filter(|&s| s > 1e-9)
        .collect();
    (
        kept.len(),
        kept.iter().copied().fold(Real::INFINITY, Real::min),
    )
}

#[test]
fn eight_by_eight_cells_have_84_motions_flat_and_35_bent() {
    let mesh = generate::grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let (topology, flat) = measured(&mesh, mesh.positions());
    assert_eq!(topology.count_3v_e, 35);
    assert_eq!(flat.nullity, 84);
    assert_eq!(flat.self_stresses, 49);
    let (_, curved) = measured(&mesh, &perturbed(mesh.positions()));
    assert_eq!(curved.nullity, 35);
    assert_eq!(curved.self_stresses, 0);
}

#[test]
fn a_flat_sheet_keeps_one_motion_per_vertex_and_three_more() {
    let sheets = [
        generate::grid(7, 12, 1.0, 2.0, Diagonals::OneWay).unwrap(),
        generate::grid(12, 7, 2.0, 1.0, Diagonals::Alternating).unwrap(),
        generate::grid(6, 6, 1.0, 1.0, Diagonals::Crossed).unwrap(),
        generate::disk(6, 0.5).unwrap(),
        generate::irregular(10, 1.0, 1.0, 7).unwrap(),
    ];
    for mesh in sheets {
        let (topology, flat) = measured(&mesh, mesh.positions());
        assert_eq!(flat.nullity, topology.vertices + 3);
        let inner = topology.vertices - topology.boundary_edges;
        assert_eq!(
            flat.self_stresses, inner,
            "one self-stress per inner vertex"
        );
        let (_, curved) = measured(&mesh, &perturbed(mesh.positions()));
        assert_eq!(curved.nullity as i64, topology.count_3v_e);
    }
}

#[test]
fn the_rank_agrees_with_a_dense_singular_value_decomposition() {
    let meshes = [
        generate::grid(6, 5, 1.0, 1.0, Diagonals::OneWay).unwrap(),
        generate::tube(7, 4, 0.3, 1.0).unwrap(),
        generate::sphere(2, 1.0).unwrap(),
        generate::torus(9, 6, 1.0, 0.3).unwrap(),
        generate::irregular(6, 1.0, 1.0, 3).unwrap(),
    ];
    for mesh in meshes {
        let edges = EdgeTable::build(&mesh).unwrap();
        for positions in [mesh.positions().to_vec(), perturbed(mesh.positions())] {
            let sparse = EdgeRank::measure(&positions, &edges).unwrap();
            let (rank, smallest) = dense(&positions, &edges);
            assert_eq!(sparse.rank, rank);
            assert!(
                (sparse.smallest_nonzero_singular_value / smallest - 1.0).abs() < 2e-3,
                "{} against {smallest}",
                sparse.smallest_nonzero_singular_value
            );
        }
    }
}

#[test]
fn a_closed_convex_surface_has_only_its_rigid_motions() {
    let mesh = generate::sphere(6, 1.0).unwrap();
    let (topology, rank) = measured(&mesh, mesh.positions());
    assert_eq!(topology.count_3v_e, 6);
    assert_eq!(rank.nullity, 6);
    assert_eq!(rank.self_stresses, 0);
}

/// 3V − E = 3χ + E_b, and the nullity is that plus the self-stresses, on every kind of surface; dense where it is
/// small.
#[test]
fn the_formula_holds_on_every_kind_of_surface() {
    let holed = |cells: usize| {
        let sheet = generate::grid(cells + 1, cells + 1, 1.0, 1.0, Diagonals::Alternating).unwrap();
        generate::without_triangles(&sheet, |_, [a, b, c]| {
            let middle = (a + b + c) / 3.0;
            [middle.x, middle.y]
                .iter()
                .all(|t| (t * 5.0) as usize % 2 == 1)
        })
        .unwrap()
    };
    let pieces = [
        generate::disk(3, 1.0).unwrap(),
        generate::tube(7, 3, 0.3, 1.0).unwrap(),
        generate::sphere(2, 1.0).unwrap(),
    ];
    // Mesh, χ, E_b, self-stresses when bent: those of a torus, which six rigid motions force on it.
    for (name, mesh, euler, boundary, stresses) in [
        ("disk", generate::disk(4, 1.0).unwrap(), 1, 24, 0),
        ("tube", generate::tube(9, 5, 0.3, 1.0).unwrap(), 0, 18, 0),
        ("sphere", generate::sphere(3, 1.0).unwrap(), 2, 0, 0),
        ("torus", generate::torus(11, 7, 1.0, 0.4).unwrap(), 0, 0, 6),
        (
            "Möbius",
            generate::moebius(12, 3, 1.0, 0.5).unwrap(),
            0,
            24,
            0,
        ),
        ("holes", holed(10), 1 - 4, 40 + 4 * 8, 0),
        (
            "pieces",
            generate::join(&pieces).unwrap(),
            1 + 2,
            18 + 14,
            0,
        ),
    ] {
        let edges = EdgeTable::build(&mesh).unwrap();
        let curved = perturbed(mesh.positions());
        let (topology, rank) = measured(&mesh, &curved);
        assert_eq!(
            (topology.euler, topology.boundary_edges),
            (euler, boundary),
            "{name}"
        );
        assert_eq!(topology.count_3v_e, 3 * euler + boundary as i64, "{name}");
        assert_eq!(rank.self_stresses, stresses, "{name}");
        assert_eq!(
            rank.nullity as i64,
            topology.count_3v_e + stresses as i64,
            "{name}"
        );
        let (dense_rank, smallest) = dense(&curved, &edges);
        assert_eq!(rank.rank, dense_rank, "{name}");
        assert!(
            (rank.smallest_nonzero_singular_value / smallest - 1.0).abs() < 2e-3,
            "{name}"
        );
    }
}

/// A sheet lifted by next to nothing has singular values as small, whose squares drown in rounding: they are found all
/// the same.
#[test]
fn a_barely_bent_sheet_keeps_its_weakest_conditions() {
    let mesh = generate::grid(6, 5, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    for height in [1e-5, 1e-6, 1e-7] {
        let lifted: Vec<Vec3> = mesh
            .positions()
            .iter()
            .map(|p| p + Vec3::z() * (height * ((3.0 * p.x).sin() + (2.0 * p.y + p.x).cos())))
            .collect();
        let sparse = EdgeRank::measure(&lifted, &edges).unwrap();
        let (rank, smallest) = dense(&lifted, &edges);
        assert_eq!(rank, edges.len());
        assert_eq!(sparse.rank, rank, "{height:e}");
        let error = (sparse.smallest_nonzero_singular_value / smallest - 1.0).abs();
        assert!(error < 2e-3, "{height:e}: {error:e}");
    }
}

/// One singular value is just weak enough to be looked for itself, and many more are as weak but for a little: telling
/// it from those takes all iterations there are.
#[test]
fn the_weakest_condition_is_told_from_others_nearly_as_weak() {
    let mesh = generate::grid(9, 8, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    let lifted = |height: Real| -> Vec<Vec3> {
        let wave = |p: &Vec3| (3.0 * p.x).sin() + (2.0 * p.y + p.x).cos();
        let positions = mesh.positions().iter();
        positions
            .map(|p| p + Vec3::z() * (height * wave(p)))
            .collect()
    };
    // As long as the sheet is nearly flat they go with its height.
    let (_, smallest) = dense(&lifted(1e-4), &edges);
    for weakest in [0.9e-6, 0.5e-6, 0.2e-6] {
        let x = lifted(1e-4 * weakest / smallest);
        let (rank, smallest) = dense(&x, &edges);
        assert!((smallest / weakest - 1.0).abs() < 1e-2, "{smallest:e}");
        let sparse = EdgeRank::measure(&x, &edges).unwrap();
        assert_eq!(sparse.rank, rank, "{weakest:e}");
        let error = (sparse.smallest_nonzero_singular_value / smallest - 1.0).abs();
        assert!(error < 1e-6, "{weakest:e}: {error:e}");
    }
}

/// Large and irregular enough that one condition is weaker than 1e-6.
#[test]
fn twenty_thousand_jittered_vertices_have_the_freedom_of_their_boundary() {
    let mesh = generate::irregular(142, 1.0, 1.0, 1).unwrap();
    let (topology, rank) = measured(&mesh, &perturbed(mesh.positions()));
    assert!(topology.vertices > 20_000);
    assert_eq!(rank.nullity as i64, topology.count_3v_e);
    assert_eq!(rank.self_stresses, 0);
    assert!(
        rank.smallest_nonzero_singular_value < 1e-6,
        "{:e}",
        rank.smallest_nonzero_singular_value
    );
}

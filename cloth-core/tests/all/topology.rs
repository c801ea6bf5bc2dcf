//! Topology against brute force and against what is known of each surface.

use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{
    Diagonals, disk, equilateral, grid, irregular, join, moebius, sphere, torus, tube,
    without_triangles,
};
use cloth_core::mesh::{MeshError, TriMesh};
use cloth_core::topology::{
    EdgeTable, HingeTable, NONE, Topology, boundary_loops, bow_tie_vertices, components,
    inconsistently_oriented_edges, triangle_edges,
};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

fn count(mesh: &TriMesh) -> Topology {
    Topology::of(mesh, &EdgeTable::build(mesh).unwrap())
}

/// A mesh with the given triangles; the vertices are put on a curve that no plane meets more than
/// three times, so that no triangle is degenerate.
fn abstract_mesh(triangles: &[[u32; 3]]) -> Result<TriMesh, MeshError> {
    let vertices = triangles.as_flattened().iter().max().unwrap() + 1;
    let curve = (0..vertices)
        .map(f64::from)
        .map(|t| Vec3::new(t, t * t, t * t * t));
    TriMesh::new(curve.collect(), triangles.to_vec())
}

/// Sheet with `k` separate square holes of one cell each.
fn sheet_with_holes(k: usize) -> TriMesh {
    let sheet = grid(2 * k + 2, 4, 1.0, 1.0, Diagonals::Alternating).unwrap();
    // Two triangles per cell, 2k + 1 cells per row; holes in every second cell of the middle row.
    let row = 2 * (2 * k + 1);
    let hole = |t: usize| t >= row && t < 2 * row && (t - row) / 2 % 2 == 1;
    without_triangles(&sheet, |t, _| hole(t)).unwrap()
}

#[test]
fn each_surface_has_its_euler_characteristic_and_boundary() {
    let two = join(&[disk(3, 1.0).unwrap(), torus(5, 4, 1.0, 0.2).unwrap()]).unwrap();
    // (mesh, χ, E_b, pieces, loops)
    let surfaces = [
        (
            grid(5, 4, 1.0, 1.0, Diagonals::OneWay).unwrap(),
            1,
            14,
            1,
            1,
        ),
        (
            grid(5, 4, 1.0, 1.0, Diagonals::Crossed).unwrap(),
            1,
            14,
            1,
            1,
        ),
        (equilateral(4, 4, 1.0).unwrap(), 1, 12, 1, 1),
        (irregular(6, 1.0, 1.0, 1).unwrap(), 1, 20, 1, 1),
        (disk(4, 1.0).unwrap(), 1, 24, 1, 1),
        (tube(7, 3, 1.0, 1.0).unwrap(), 0, 14, 1, 2),
        (tube(3, 1, 1.0, 1.0).unwrap(), 0, 6, 1, 2),
        (torus(3, 3, 1.0, 0.5).unwrap(), 0, 0, 1, 0),
        (torus(8, 5, 1.0, 0.5).unwrap(), 0, 0, 1, 0),
        (sphere(1, 1.0).unwrap(), 2, 0, 1, 0),
        (sphere(4, 1.0).unwrap(), 2, 0, 1, 0),
        (moebius(3, 1, 1.0, 0.5).unwrap(), 0, 6, 1, 1),
        (moebius(9, 3, 1.0, 0.5).unwrap(), 0, 18, 1, 1),
        (sheet_with_holes(1), 0, 16, 1, 2),
        (sheet_with_holes(3), -2, 32, 1, 4),
        (two, 1, 18, 2, 1),
    ];
    for (index, (mesh, euler, boundary, pieces, loops)) in surfaces.into_iter().enumerate() {
        let counts = count(&mesh);
        assert_eq!(counts.euler, euler, "surface {index}: {counts:?}");
        assert_eq!(counts.components, pieces, "surface {index}");
        assert_eq!(counts.boundary_loops, loops, "surface {index}");
        assert_eq!(counts.count_3v_e, 3 * euler + counts.boundary_edges as i64);
        assert_eq!(counts.boundary_edges, boundary, "surface {index}");
    }
}

#[test]
fn generated_meshes_are_wound_consistently_and_have_no_bow_tie() {
    for mesh in [
        grid(5, 4, 1.0, 1.0, Diagonals::Alternating).unwrap(),
        grid(5, 4, 1.0, 1.0, Diagonals::Crossed).unwrap(),
        equilateral(4, 5, 1.0).unwrap(),
        irregular(6, 1.0, 1.0, 1).unwrap(),
        disk(4, 1.0).unwrap(),
        tube(7, 3, 1.0, 1.0).unwrap(),
        torus(3, 4, 1.0, 0.5).unwrap(),
        sphere(4, 1.0).unwrap(),
    ] {
        let edges = EdgeTable::build(&mesh).unwrap();
        assert!(inconsistently_oriented_edges(&mesh, &edges).is_empty());
        assert!(bow_tie_vertices(&mesh, &edges).is_empty());
    }
}

#[test]
fn a_hinge_has_its_first_wing_on_the_left() {
    let mesh = grid(4, 4, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let hinges = HingeTable::build(&mesh, &EdgeTable::build(&mesh).unwrap());
    for &hinge in hinges.hinges() {
        let [a, b, left, right] = hinge.map(|v| mesh.positions()[v as usize]);
        assert!((b - a).cross(&(left - a)).z > 0.0);
        assert!((b - a).cross(&(right - a)).z < 0.0);
    }
}

#[test]
fn a_hinge_without_a_left_side_starts_at_the_lower_triangle() {
    // Both triangles run 1 → 2, then both run 2 → 1.
    for triangles in [[[1, 2, 3], [1, 2, 0]], [[2, 1, 3], [2, 1, 0]]] {
        let mesh = abstract_mesh(&triangles).unwrap();
        let edges = EdgeTable::build(&mesh).unwrap();
        assert_eq!(HingeTable::build(&mesh, &edges).hinges(), [[1, 2, 3, 0]]);
        let shared = edges.find(2, 1).unwrap() as u32;
        assert_eq!(inconsistently_oriented_edges(&mesh, &edges), [shared]);
    }
}

#[test]
fn an_edge_with_three_triangles_is_refused() {
    let mesh = abstract_mesh(&[[0, 1, 2], [3, 1, 0], [0, 1, 4], [0, 5, 1]]).unwrap();
    let refused = EdgeTable::build(&mesh).unwrap_err();
    let expected = MeshError::NonManifoldEdge {
        ends: [0, 1],
        triangles: [0, 1, 2],
    };
    assert_eq!(refused, expected);
}

#[test]
fn the_boundary_keeps_the_surface_on_its_left() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    assert_eq!(boundary_loops(&mesh, &edges), [[0, 1, 2, 5, 8, 7, 6, 3]]);
}

#[test]
fn the_boundary_does_not_jump_at_a_bow_tie() {
    // Two triangles that touch at vertex 2 only: two fans there.
    let mesh = abstract_mesh(&[[0, 1, 2], [2, 3, 4]]).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    assert_eq!(bow_tie_vertices(&mesh, &edges), [2]);
    assert_eq!(boundary_loops(&mesh, &edges), [[0, 1, 2], [2, 3, 4]]);
    assert_eq!(components(5, &edges), [0; 5]);
    // A hole that touches the outer boundary at a vertex: still a walk for each.
    let sheet = grid(4, 4, 3.0, 3.0, Diagonals::OneWay).unwrap();
    let centers = [Vec3::new(0.5, 0.5, 0.0), Vec3::new(1.5, 1.5, 0.0)];
    let near = |c: Vec3| centers.iter().any(|p| (p - c).amax() < 0.4);
    let cut = without_triangles(&sheet, |_, [a, b, c]| near((a + b + c) / 3.0)).unwrap();
    let edges = EdgeTable::build(&cut).unwrap();
    assert_eq!(bow_tie_vertices(&cut, &edges).len(), 1);
    let loops = boundary_loops(&cut, &edges);
    assert_eq!(
        loops.len(),
        1,
        "the bow-tie vertex joins the hole to the outside: {loops:?}"
    );
    assert_eq!(loops[0].len(), edges.boundary_edge_count());
}

#[test]
fn a_million_triangles_take_well_below_a_second() {
    let mesh = grid(708, 708, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let start = std::time::Instant::now();
    let edges = EdgeTable::build(&mesh).unwrap();
    let taken = start.elapsed();
    println!("{} edges in {taken:?}", edges.len());
    // Loose, for a busy machine; tens of milliseconds on an idle one.
    assert!(taken.as_secs_f64() < 1.0 || cfg!(debug_assertions));
}

/// Up to 40 triangles on up to 12 vertices: mostly not manifold, often in pieces, winding mixed.
fn triangle_soup() -> impl Strategy<Value = TriMesh> {
    let triangle = prop::array::uniform3(0_u32..12);
    prop::collection::vec(triangle, 1..40).prop_filter_map("no mesh", |mut triangles| {
        let key = |t: &[u32; 3]| {
            let mut sorted = *t;
            sorted.sort_unstable();
            sorted
        };
        let mut seen = BTreeSet::new();
        let mut degree = BTreeMap::new();
        triangles.retain(|t| {
            let [a, b, c] = key(t);
            if a == b || b == c || !seen.insert([a, b, c]) {
                return false;
            }
            // Leave a few non-manifold edges in: at most three triangles at an edge.
            let sides = [[a, b], [a, c], [b, c]];
            let free = sides
                .iter()
                .all(|s| degree.get(s).copied().unwrap_or(0) < 2);
            if free || (a + b + c) % 13 == 0 {
                sides
                    .iter()
                    .for_each(|&s| *degree.entry(s).or_insert(0) += 1);
                return true;
            }
            false
        });
        // Number the vertices that are left without gaps.
        let used: BTreeSet<u32> = triangles.as_flattened().iter().copied().collect();
        let number: BTreeMap<u32, u32> = used.into_iter().zip(0..).collect();
        let renumbered: Vec<_> = triangles.iter().map(|t| t.map(|v| number[&v])).collect();
        (!renumbered.is_empty()).then(|| abstract_mesh(&renumbered).unwrap())
    })
}

/// Triangles at each edge, the slow way.
fn brute_force(mesh: &TriMesh) -> BTreeMap<[u32; 2], Vec<u32>> {
    let mut at: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    for (&[a, b, c], t) in mesh.triangles().iter().zip(0..) {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            at.entry([p.min(q), p.max(q)]).or_default().push(t);
        }
    }
    at
}

proptest! {
    #[test]
    fn tables_agree_with_brute_force(mesh in triangle_soup()) {
        let expected = brute_force(&mesh);
        let manifold = expected.values().all(|t| t.len() <= 2);
        let edges = match EdgeTable::build(&mesh) {
            Ok(edges) => edges,
            Err(MeshError::NonManifoldEdge { ends, triangles }) => {
                let first = expected.iter().find(|(_, t)| t.len() > 2).unwrap();
                prop_assert_eq!(ends, *first.0);
                prop_assert_eq!(triangles.to_vec(), first.1[..3].iter().map(|&t| t as usize).collect::<Vec<_>>());
                return Ok(());
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        };
        prop_assert!(manifold);
        let keys: Vec<[u32; 2]> = expected.keys().copied().collect();
        prop_assert_eq!(edges.ends(), keys.as_slice());
        for (sides, triangles) in edges.sides().iter().zip(expected.values()) {
            prop_assert_eq!(sides[0], triangles[0]);
            prop_assert_eq!(sides[1], triangles.get(1).copied().unwrap_or(NONE));
        }
        for (&t, sides) in mesh.triangles().iter().zip(triangle_edges(&mesh, &edges)) {
            for k in 0..3 {
                prop_assert_eq!(edges.find(t[k], t[(k + 1) % 3]), Some(sides[k] as usize));
            }
        }
        let counts = Topology::of(&mesh, &edges);
        prop_assert_eq!(counts.count_3v_e, 3 * counts.euler + counts.boundary_edges as i64);
    }

    #[test]
    fn hinges_name_both_triangles(mesh in triangle_soup()) {
        let Ok(edges) = EdgeTable::build(&mesh) else { return Ok(()) };
        let hinges = HingeTable::build(&mesh, &edges);
        let inner: Vec<usize> = (0..edges.len()).filter(|&e| !edges.is_boundary(e)).collect();
        prop_assert_eq!(hinges.len(), inner.len());
        for (&[a, b, left, right], e) in hinges.hinges().iter().zip(inner) {
            prop_assert_eq!([a, b], edges.ends()[e]);
            let set = |t: [u32; 3]| BTreeSet::from(t);
            let sides = edges.sides()[e].map(|t| set(mesh.triangles()[t as usize]));
            let wings = [set([a, b, left]), set([a, b, right])];
            let swapped = [wings[1].clone(), wings[0].clone()];
            prop_assert!(sides == wings || sides == swapped);
        }
    }

    #[test]
    fn boundary_loops_pass_every_boundary_edge_once(mesh in triangle_soup()) {
        let Ok(edges) = EdgeTable::build(&mesh) else { return Ok(()) };
        let mut passed = BTreeSet::new();
        for walk in boundary_loops(&mesh, &edges) {
            for (k, &from) in walk.iter().enumerate() {
                let to = walk[(k + 1) % walk.len()];
                let edge = edges.find(from, to);
                prop_assert!(edge.is_some_and(|e| edges.is_boundary(e)));
                prop_assert!(passed.insert(edge));
            }
        }
        prop_assert_eq!(passed.len(), edges.boundary_edge_count());
    }

    #[test]
    fn pieces_and_bow_ties_agree_with_brute_force(mesh in triangle_soup()) {
        let Ok(edges) = EdgeTable::build(&mesh) else { return Ok(()) };
        let pieces = components(mesh.vertex_count(), &edges);
        // Spread the lowest vertex number over triangles until nothing changes.
        let mut lowest: Vec<usize> = (0..mesh.vertex_count()).collect();
        loop {
            let before = lowest.clone();
            for t in mesh.triangles() {
                let low = t.iter().map(|&v| lowest[v as usize]).min().unwrap();
                t.iter().for_each(|&v| lowest[v as usize] = low);
            }
            if lowest == before { break }
        }
        for a in 0..lowest.len() {
            for b in 0..a {
                prop_assert_eq!(pieces[a] == pieces[b], lowest[a] == lowest[b]);
            }
        }
        // The triangles around a vertex form a disk or half a disk exactly if each can be
        // reached from the first over edges at that vertex.
        let at = brute_force(&mesh);
        let expected = (0..mesh.vertex_count() as u32).filter(|&v| {
            let around: Vec<u32> = (0..mesh.triangle_count() as u32)
                .filter(|&t| mesh.triangles()[t as usize].contains(&v)).collect();
            let mut reached = BTreeSet::from([around[0]]);
            for _ in 0..around.len() {
                for (_, both) in at.iter().filter(|(ends, both)| ends.contains(&v) && both.len() == 2) {
                    if both.iter().any(|t| reached.contains(t)) {
                        reached.extend(both.iter().copied());
                    }
                }
            }
            reached.len() < around.len()
        });
        prop_assert_eq!(bow_tie_vertices(&mesh, &edges), expected.collect::<Vec<_>>());
    }
}

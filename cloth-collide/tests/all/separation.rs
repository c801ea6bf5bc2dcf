//! The measured separation, against all pairs.

use crate::random::Random;
use crate::shapes::{deformed, sheet};
use cloth_collide::{
    CollideError, Separation, SeparationProbe, distance_from_surface, edge_edge, point_triangle,
    segment_meets_triangle,
};
use cloth_core::math::{Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::join;

fn measure(mesh: &TriMesh, positions: &[Vec3]) -> Separation {
    SeparationProbe::new(mesh).measure(positions).unwrap()
}

fn edges(mesh: &TriMesh) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = mesh
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Straight from the definition, without boxes, owners or cases: all pairs without a common vertex.
fn brute_force(mesh: &TriMesh, x: &[Vec3]) -> Separation {
    let triangles = mesh.triangles();
    // An edge and a triangle without a common vertex meet: then so do all triangles of the edge and that triangle.
    let sides = |t: [u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let pierces = |one: [u32; 3], other: [u32; 3]| {
        sides(one).into_iter().any(|edge| {
            !edge.iter().any(|v| other.contains(v))
                && segment_meets_triangle(gather(x, edge), gather(x, other))
        })
    };
    let mut intersecting_pairs = 0;
    for (i, &a) in triangles.iter().enumerate() {
        for &b in &triangles[..i] {
            intersecting_pairs += usize::from(pierces(a, b) || pierces(b, a));
        }
    }
    let mut nearest = f64::INFINITY;
    for vertex in 0..mesh.vertex_count() as u32 {
        for &t in triangles.iter().filter(|t| !t.contains(&vertex)) {
            nearest = nearest.min(point_triangle(x[vertex as usize], gather(x, t)).distance());
        }
    }
    let edges = edges(mesh);
    for (i, &a) in edges.iter().enumerate() {
        for &b in edges[..i]
            .iter()
            .filter(|b| !b.iter().any(|v| a.contains(v)))
        {
            nearest = nearest.min(edge_edge(gather(x, a), gather(x, b)).distance());
        }
    }
    let min_distance = if intersecting_pairs > 0 { 0.0 } else { nearest };
    Separation {
        intersecting_pairs,
        min_distance: nearest.is_finite().then_some(min_distance),
    }
}

fn assert_as_brute_force(name: &str, mesh: &TriMesh, positions: &[Vec3]) -> Separation {
    let found = measure(mesh, positions);
    let expected = brute_force(mesh, positions);
    assert_eq!(
        found.intersecting_pairs, expected.intersecting_pairs,
        "{name}"
    );
    let [d, e] = [found, expected].map(|s| s.min_distance.unwrap());
    assert!((d - e).abs() < 1e-15, "{name}: {d} instead of {e}");
    found
}

#[test]
fn measurement_is_that_of_brute_force() {
    let mesh = sheet(13);
    let intersecting = deformed(&mesh).into_iter().filter(|(name, positions)| {
        assert_as_brute_force(name, &mesh, positions).intersecting_pairs > 0
    });
    assert_eq!(
        intersecting.count(),
        3,
        "crumpled, line and point meet themselves, the others do not"
    );
}

/// Noise makes every pair of primitives the nearest one now and then: both kinds, inside and at ends.
#[test]
fn measurement_of_rough_cloth_is_that_of_brute_force() {
    let mesh = sheet(6);
    let mut state = 1u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let mut apart = 0;
    for round in 0..300 {
        let height = [0.1, 0.3, 0.6][round % 3];
        let width = [0.15, 0.25, 0.35][round % 3];
        let rough = |x: &Vec3| x + Vec3::new(width * noise(), width * noise(), height * noise());
        let positions: Vec<Vec3> = mesh.positions().iter().map(rough).collect();
        let found = assert_as_brute_force("rough", &mesh, &positions);
        apart += usize::from(found.intersecting_pairs == 0);
    }
    assert!(
        (50..250).contains(&apart),
        "{apart} of 300 do not meet themselves"
    );
}

#[test]
fn flat_square_grid_has_half_the_diagonal_of_a_cell_as_distance() {
    let mesh = sheet(9);
    let found = measure(&mesh, mesh.positions());
    assert_eq!(found.intersecting_pairs, 0);
    let expected = 0.125 / 2f64.sqrt();
    assert!((found.min_distance.unwrap() - expected).abs() < 1e-16);
}

#[test]
fn layers_have_their_gap_as_distance() {
    for gap in [0.08, 1e-3, 1e-9] {
        let lifted = |z: f64| {
            let sheet = sheet(9);
            let up = sheet
                .positions()
                .iter()
                .map(|x| x + Vec3::z() * z)
                .collect();
            TriMesh::new(up, sheet.triangles().to_vec()).unwrap()
        };
        let mesh = join(&[lifted(0.0), lifted(1.0), lifted(1.0 + gap)]).unwrap();
        let found = measure(&mesh, mesh.positions());
        let error = (found.min_distance.unwrap() - gap).abs();
        assert!(
            found.intersecting_pairs == 0 && error < 1e-15,
            "{found:?} instead of {gap}"
        );
    }
}

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Two triangles with vertex 0 in common; the edge 3–4 of the second stands upright at `x` = y.
fn two_with_a_common_vertex(x: f64, lift: f64) -> Separation {
    let positions = vec![
        v(0., 0., 0.),
        v(2., 0., 0.),
        v(0., 2., 0.),
        v(x, x, -1. + lift),
        v(x, x, 1. + lift),
    ];
    let mesh = TriMesh::new(positions.clone(), vec![[0, 1, 2], [0, 3, 4]]).unwrap();
    // Whichever corner they share, and whichever triangle comes first.
    for triangles in [
        [[1, 2, 0], [3, 4, 0]],
        [[4, 0, 3], [2, 0, 1]],
        [[2, 1, 0], [0, 4, 3]],
    ] {
        let turned = TriMesh::new(positions.clone(), triangles.to_vec()).unwrap();
        assert_eq!(measure(&turned, &positions), measure(&mesh, &positions));
    }
    measure(&mesh, &positions)
}

#[test]
fn triangles_with_a_common_vertex_intersect_if_they_share_more_than_it() {
    assert_eq!(two_with_a_common_vertex(0.5, 0.0).intersecting_pairs, 1); // pierced by the far edge
    assert_eq!(two_with_a_common_vertex(0.5, 1.0).intersecting_pairs, 1); // touched by its end
    assert_eq!(two_with_a_common_vertex(5.0, 0.0).intersecting_pairs, 1); // pierces with its own far edge
    assert_eq!(two_with_a_common_vertex(0.5, 1.25).intersecting_pairs, 0); // above
    assert_eq!(two_with_a_common_vertex(-0.5, 0.0).intersecting_pairs, 0); // on the other side
}

#[test]
fn triangles_with_a_common_vertex_have_a_distance() {
    let found = two_with_a_common_vertex(0.5, 1.25);
    assert_eq!(found.min_distance, Some(0.25));
}

#[test]
fn folding_along_an_edge_is_no_intersection_but_a_small_distance() {
    let rest = vec![
        v(0., 0., 0.),
        v(0., 1., 0.),
        v(1., 0.5, 0.),
        v(-1., 0.5, 0.),
    ];
    let mesh = TriMesh::new(rest.clone(), vec![[0, 2, 1], [0, 1, 3]]).unwrap();
    // Flat, the two pairs of parallel outer edges are nearest; they are closer than the corners 2 and 3 are to the
    // edge between them.
    let outer = 2.0 / 5f64.sqrt();
    assert!((measure(&mesh, &rest).min_distance.unwrap() - outer).abs() < 1e-15);
    let folded = |z: f64| {
        let mut x = rest.clone();
        x[3] = v(0.5, 0.5, z);
        measure(&mesh, &x)
    };
    assert_eq!(
        folded(0.125),
        Separation {
            intersecting_pairs: 0,
            min_distance: Some(0.125)
        }
    );
    assert_eq!(
        folded(0.0),
        Separation {
            intersecting_pairs: 0,
            min_distance: Some(0.0)
        }
    );
}

#[test]
fn distance_is_zero_where_cloth_passes_far_from_vertices_and_edges() {
    // A large triangle, and a small one that stands in its middle: no vertex and no edge is within 0.5 of the other's.
    let x = vec![
        v(-9., -9., 0.),
        v(9., -9., 0.),
        v(0., 9., 0.),
        v(0., 0., -0.5),
        v(0.5, 0., 1.),
        v(-0.5, 0., 1.),
    ];
    let mesh = TriMesh::new(x.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    assert_eq!(
        measure(&mesh, &x),
        Separation {
            intersecting_pairs: 1,
            min_distance: Some(0.0)
        }
    );
}

/// Above the face of a large square hangs the tip of a sail: a distance of vertex and face. Beside its rim, the
/// foot of another: one of edge and edge. Whichever of the triangles comes first.
#[test]
fn nearest_vertex_and_nearest_edges_are_found_whichever_comes_first() {
    let square = [
        v(-9., -9., 0.),
        v(9., -9., 0.),
        v(9., 9., 0.),
        v(-9., 9., 0.),
    ];
    let tip = |z| [v(1., 0., z), v(2., 0., 5.), v(1., 0., 9.), v(-1., 0., 5.)];
    let foot = [
        v(1., -10., 0.125),
        v(1., -8., 0.125),
        v(1., -8., 9.),
        v(1., -10., 9.),
    ];
    for (sail, expected) in [(tip(0.25), 0.25), (tip(0.9375), 0.9375), (foot, 0.125)] {
        for turn in 0..4 {
            for x in [[square, sail], [sail, square]] {
                let x = x
                    .map(|corners| [0, 1, 2, 3].map(|k| corners[(k + turn) % 4]))
                    .concat();
                let mesh =
                    TriMesh::new(x.clone(), vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
                        .unwrap();
                assert_eq!(
                    measure(&mesh, &x),
                    Separation {
                        intersecting_pairs: 0,
                        min_distance: Some(expected)
                    }
                );
            }
        }
    }
}

#[test]
fn single_triangle_has_no_distance() {
    let x = vec![Vec3::zeros(), Vec3::x(), Vec3::y()];
    let mesh = TriMesh::new(x.clone(), vec![[0, 1, 2]]).unwrap();
    assert_eq!(
        measure(&mesh, &x),
        Separation {
            intersecting_pairs: 0,
            min_distance: None
        }
    );
}

#[test]
fn result_does_not_depend_on_earlier_measurements() {
    let mesh = sheet(12);
    let shapes = deformed(&mesh);
    let mut used = SeparationProbe::new(&mesh);
    for (name, positions) in shapes.iter().chain(shapes.iter().rev()) {
        assert_eq!(
            used.measure(positions).unwrap(),
            measure(&mesh, positions),
            "{name}"
        );
    }
}

#[test]
fn diverged_positions_are_refused_and_the_probe_stays_usable() {
    let mesh = sheet(5);
    let mut probe = SeparationProbe::new(&mesh);
    let mut positions = mesh.positions().to_vec();
    positions[3].x = f64::NAN;
    assert_eq!(
        probe.measure(&positions),
        Err(CollideError::NonFinitePosition { vertex: 3 })
    );
    positions[3].x = mesh.positions()[3].x;
    assert_eq!(
        probe.measure(&positions).unwrap(),
        measure(&mesh, &positions)
    );
}

#[test]
fn distance_from_a_surface_is_that_of_all_pairs() {
    let (mut random, mesh) = (Random::new(7), sheet(9));
    for (name, surface) in deformed(&mesh) {
        let at = random.point(3.0);
        let points: Vec<Vec3> = (0..40).map(|_| at + random.point(0.5)).collect();
        let corners = mesh.triangles().iter().map(|&t| gather(&surface, t));
        let distances = corners.flat_map(|triangle| {
            let distance = move |&point: &Vec3| point_triangle(point, triangle).distance();
            points.iter().map(distance)
        });
        let expected = distances.reduce(f64::min);
        let found = distance_from_surface(&points, &surface, mesh.triangles());
        let off = found.unwrap() - expected.unwrap();
        assert!(off.abs() < 1e-15, "{name}: {off:e}");
    }
    let corners = [Vec3::zeros(), Vec3::x(), Vec3::y()];
    let far = [Vec3::repeat(f64::NAN), Vec3::repeat(f64::INFINITY)];
    assert_eq!(distance_from_surface(&far, &corners, &[[0, 1, 2]]), None);
    assert_eq!(distance_from_surface(&[], &corners, &[[0, 1, 2]]), None);
    assert_eq!(distance_from_surface(&corners, &[], &[]), None);
}

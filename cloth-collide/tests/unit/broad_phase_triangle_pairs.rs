use super::*;
use crate::shapes::{deformed, sheet};
use cloth_core::math::Real;
use std::cell::Cell;

/// Distance of two boxes, written another way than the code has it.
fn box_distance(a: [Vec3; 3], b: [Vec3; 3]) -> Real {
    let mut squared = 0.0;
    for axis in 0..3 {
        let range = |t: [Vec3; 3]| {
            let mut c = t.map(|x| x[axis]);
            c.sort_by(f64::total_cmp);
            (c[0], c[2])
        };
        let ((low, high), (other_low, other_high)) = (range(a), range(b));
        let gap = if other_low > high {
            other_low - high
        } else if low > other_high {
            low - other_high
        } else {
            0.0
        };
        squared += gap * gap;
    }
    squared.sqrt()
}

fn brute_force(mesh: &TriMesh, positions: &[Vec3], distance: Real) -> Vec<[u32; 2]> {
    let corners = |t: u32| gather(positions, mesh.triangles()[t as usize]);
    let count = mesh.triangle_count() as u32;
    let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    all.filter(|&[a, b]| box_distance(corners(a), corners(b)) <= distance)
        .collect()
}

#[test]
fn pairs_are_those_of_brute_force_in_order() {
    let mesh = sheet(9);
    for (name, positions) in deformed(&mesh) {
        let mut pairs = TrianglePairs::new(&mesh);
        // Many boxes of the flat sheet touch.
        let expected = brute_force(&mesh, &positions, 0.0);
        pairs.find(&positions).unwrap();
        assert_eq!(pairs.pairs, expected, "{name}");
    }
}

#[test]
fn pairs_far_from_the_origin_are_not_lost_to_rounding() {
    let mesh = sheet(9);
    let positions: Vec<Vec3> = mesh
        .positions()
        .iter()
        .map(|x| x + Vec3::repeat(1e9))
        .collect();
    let mut pairs = TrianglePairs::new(&mesh);
    let expected = brute_force(&mesh, &positions, 0.0);
    pairs.find(&positions).unwrap();
    assert_eq!(pairs.pairs, expected);
}

#[test]
fn visit_meets_every_pair_that_is_nearer_once_and_follows_a_falling_limit() {
    let mesh = sheet(9);
    for (name, positions) in deformed(&mesh) {
        let mut pairs = TrianglePairs::new(&mesh);
        pairs.find(&positions).unwrap();
        let mut visited = Vec::new();
        let limit = Cell::new(0.2 * 0.2);
        pairs
            .broad_phase
            .visit_near(&limit, |a, b| visited.push([a, b]));
        visited.sort_unstable();
        // The tree's boxes are larger by rounding, and a box at exactly the limit is no longer of interest.
        let expected = brute_force(&mesh, &positions, 0.2 - 1e-9);
        assert_eq!(
            expected,
            brute_force(&mesh, &positions, 0.2 + 1e-9),
            "{name}: not a good distance"
        );
        assert_eq!(visited, expected, "{name}");

        let mut count = 0;
        pairs.broad_phase.visit_near(&limit, |_, _| {
            count += 1;
            limit.set(0.0);
        });
        assert!(
            count <= 4,
            "{name}: {count} pairs, where nothing is nearer than 0"
        );
    }
}

#[test]
fn pairs_do_not_depend_on_what_was_asked_before() {
    let mesh = sheet(12);
    let shapes = deformed(&mesh);
    let mut used = TrianglePairs::new(&mesh);
    for (name, positions) in shapes.iter().chain(shapes.iter().rev()) {
        let mut fresh = TrianglePairs::new(&mesh);
        used.find(positions).unwrap();
        fresh.find(positions).unwrap();
        assert_eq!(used.pairs, fresh.pairs, "{name}");
    }
}

/// The tree has special cases for one and two leaves.
#[test]
fn one_two_and_three_triangles() {
    let strip: Vec<Vec3> = (0..5)
        .map(|i| Vec3::new(f64::from(i), f64::from(i % 2), 0.0))
        .collect();
    for count in 1..=3 {
        let triangles = (0..count).map(|i| [i, i + 1, i + 2]).collect();
        let mesh = TriMesh::new(strip[..count as usize + 2].to_vec(), triangles).unwrap();
        let mut pairs = TrianglePairs::new(&mesh);
        let moved: Vec<Vec3> = mesh.positions().iter().map(|x| x * 2.0).collect();
        let expected = brute_force(&mesh, &moved, 0.0);
        pairs.find(&moved).unwrap();
        assert_eq!(pairs.pairs, expected);
    }
}

#[test]
fn position_that_is_not_finite_is_refused_and_changes_nothing() {
    let mesh = sheet(4);
    let mut pairs = TrianglePairs::new(&mesh);
    pairs.find(mesh.positions()).unwrap();
    let before = pairs.pairs.clone();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut positions = vec![Vec3::zeros(); mesh.vertex_count()];
        positions[7].y = bad;
        positions[9].z = bad;
        assert_eq!(pairs.find(&positions), Err(NonFinite { vertex: 7 }));
    }
    assert_eq!(pairs.pairs, before);
}

#[test]
#[should_panic(expected = "number of vertices")]
fn wrong_number_of_positions_is_a_bug_of_the_caller() {
    let _ = TrianglePairs::new(&sheet(4)).find(&[Vec3::zeros()]);
}

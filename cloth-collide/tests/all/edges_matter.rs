//! Why a vertex and a triangle are not enough: what the first picture of the chapter shows, in numbers.

use cloth_collide::potential::PotentialContacts;
use cloth_collide::{ContinuousTest, Query, SeparationProbe};
use cloth_core::contact::{ContactStep, Projection};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;

const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [3, 4, 5]];

/// Two upright triangles (m): the lower one has an edge on top, the upper one has an edge at its bottom, across the
/// other one, `height` (m) above it.
fn blades(height: f64) -> Vec<Vec3> {
    let corners = [
        (-1.0, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        (0.0, 0.0, -1.0),
        (0.0, -1.0, height),
        (0.0, 1.0, height),
        (0.0, 0.0, 1.0 + height),
    ];
    corners.map(|(x, y, z)| Vec3::new(x, y, z)).to_vec()
}

#[test]
fn edges_cross_with_all_vertices_in_the_clear_and_the_response_sees_it() {
    let (from, through) = (blades(0.45), blades(-0.45));
    let mesh = TriMesh::new(from.clone(), TRIANGLES.to_vec()).unwrap();
    let mut probe = SeparationProbe::new(&mesh);
    assert_eq!(probe.measure(&from).unwrap().intersecting_pairs, 0);
    assert_eq!(probe.measure(&through).unwrap().intersecting_pairs, 1);

    // No vertex comes near the other triangle on its path.
    let test = ContinuousTest::new(0.3, 0.0).unwrap();
    let path = |v: usize| [from[v], through[v]];
    for (vertices, [a, b, c]) in [([0, 1, 2], [3, 4, 5]), ([3, 4, 5], [0, 1, 2])] {
        let triangle = [&from, &through].map(|x| [x[a], x[b], x[c]]);
        for v in vertices {
            let found = Query::vertex_triangle(path(v), triangle).first_contact(&test);
            assert_eq!(found, Ok(None), "vertex {v}");
        }
    }
    // Halfway the two edges meet.
    let edge = |a: usize, b: usize| [&from, &through].map(|x| [x[a], x[b]]);
    let exact = ContinuousTest::new(0.0, 0.0).unwrap();
    let crossing = Query::edge_edge(edge(0, 1), edge(3, 4));
    let impact = crossing.first_contact(&exact).unwrap().unwrap();
    assert!(impact.time <= 0.5 && impact.time > 0.5 - 1e-12);

    let builder = PotentialContacts::builder(&mesh).thickness(0.02);
    let mut contacts = builder.build().unwrap();
    let (mut kept, mut velocities) = (through, vec![Vec3::zeros(); 6]);
    let step = ContactStep {
        from: &from,
        inverse_mass: &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        dt: 0.1,
    };
    Projection::default()
        .step(&mut contacts, &step, 4, &mut kept, &mut velocities)
        .unwrap();
    assert_eq!(probe.measure(&kept).unwrap().intersecting_pairs, 0);
    let gap = probe.measure(&kept).unwrap().min_distance.unwrap();
    // Edges push from half the thickness on.
    assert!((gap - 0.01).abs() < 5e-4, "{gap}");
}

//! By how much the distance of a pair differs from what its term of the second derivative says.

use crate::random::Random;
use cloth_collide::obstacle::AnimatedMesh;
use cloth_collide::potential::{PotentialBuilder, PotentialContacts};
use cloth_core::contact::{ContactPotential, ContactRow, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

const H: Real = 2e-3;

/// A triangle with an edge along y, 0.2 h above the edge along x of another one.
fn triangles() -> [[Vec3; 3]; 2] {
    let upper = [[0.0, -0.03, 0.2 * H], [0.0, 0.03, 0.2 * H], [0.1, 0.0, 0.1]];
    let lower = [[-0.03, 0.0, 0.0], [0.03, 0.0, 0.0], [0.0, -0.1, -0.1]];
    [upper, lower].map(|corners| corners.map(Vec3::from))
}

/// The distance (m) of the lines through two edges, positive where a and b lie above c and d.
fn height([a, b, c, d]: [Vec3; 4]) -> Real {
    let normal = (b - a).cross(&(d - c)).normalize();
    normal
        .dot(&(a - c))
        .copysign((a - c).dot(&normal) * normal.z)
}

/// Moves the corners at random, half of the time to the other side, and compares what contact says of the two edges
/// with the distance of their lines. `positions` has all corners, those of a body at the end if there is one.
fn check(builder: PotentialBuilder<'_>, x: &[Vec3], below: [Vec3; 2]) {
    let mut contacts = builder.thickness(H).friction(0.3).build().unwrap();
    let step = ContactStep {
        from: x,
        inverse_mass: &vec![1.0; x.len()],
        dt: 0.01,
    };
    contacts.begin(&step, &mut x.to_vec()).unwrap();
    contacts.limit(x, x).unwrap();
    let mut rows: Vec<ContactRow> = Vec::new();
    contacts.linearize(x, &mut rows);
    let mut random = Random::new(3);
    let (mut largest, mut crossed) = (0.0, 0);
    for sunk in [0.0, 5e-3] {
        for _ in 0..10 {
            let moved = |v: usize| x[v] - Vec3::z() * if v < 2 { sunk } else { 0.0 };
            let to: Vec<Vec3> = (0..x.len())
                .map(|v| moved(v) + random.point(4e-3))
                .collect();
            let mut errors = Vec::new();
            contacts.linearization_errors(x, &to, &mut errors);
            assert_eq!(errors.len(), 1);
            let lower = |x: &[Vec3], k: usize| x.get(3 + k).copied().unwrap_or(below[k]);
            let heights = [x, &to].map(|x| height([x[0], x[1], lower(x, 0), lower(x, 1)]));
            let ends = rows[0].vertices.into_iter().zip(rows[0].weights);
            let along =
                ends.map(|(v, w)| rows[0].normal.dot(&(to[v as usize] - x[v as usize])) * w);
            let expected = heights[1] - heights[0] - along.sum::<Real>();
            let off = (errors[0] - expected).abs();
            assert!(off < 1e-16, "{} m, but {expected} m", errors[0]);
            largest = expected.abs().max(largest);
            crossed += u32::from(heights[1] < 0.0);
        }
    }
    assert!(largest > 1e-4 && crossed >= 8, "{largest} m, {crossed}");
}

#[test]
fn an_error_of_edges_is_that_of_the_distance_of_their_lines() {
    let [upper, lower] = triangles();
    let below = [lower[0], lower[1]];
    let both = [upper, lower].concat();
    let cloth = TriMesh::new(both.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    check(PotentialContacts::builder(&cloth), &both, below);

    let cloth = TriMesh::new(upper.to_vec(), vec![[0, 1, 2]]).unwrap();
    let surface = TriMesh::new(lower.to_vec(), vec![[0, 1, 2]]).unwrap();
    let still = AnimatedMesh::new(vec![lower.to_vec()], 1.0).unwrap();
    let builder = PotentialContacts::builder(&cloth).animated(surface, still, 0.3);
    check(builder, &upper, below);
}

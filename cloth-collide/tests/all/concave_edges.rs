//! Bodies with concave edges: what an energy of contact takes in the place of the distance is smooth.

use crate::random::Random;
use cloth_collide::obstacle::{ClosedMesh, PenaltyLaw, SampledDistance, SignedDistance};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::{TriMesh, generate};

/// A cube of 1 m without its upper quarter at x, z > 0.5 m: a concave edge along y at (0.5, 0.5), and convex edges.
fn stair() -> ClosedMesh {
    let section = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 0.5],
        [0.5, 0.5],
        [0.5, 1.0],
        [0.0, 1.0],
    ];
    let positions = [0.0, 1.0]
        .into_iter()
        .flat_map(|y| section.map(|[x, z]| Vec3::new(x, y, z)));
    let ends = [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]];
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for [a, b, c] in ends {
        triangles.extend([[a, b, c], [6 + a, 6 + c, 6 + b]]);
    }
    for a in 0..6 {
        let b = (a + 1) % 6;
        triangles.extend([[a, 6 + a, 6 + b], [a, 6 + b, b]]);
    }
    ClosedMesh::new(&TriMesh::new(positions.collect(), triangles).unwrap()).unwrap()
}

/// Σ w ψ(d) and its gradient.
fn energy(body: &ClosedMesh, law: &PenaltyLaw, x: Vec3) -> (Real, Vec3) {
    let (mut value, mut gradient) = (0.0, Vec3::zeros());
    body.each_part(x, law.range(), &mut |at, weight| {
        value += weight * law.energy(at.value);
        gradient += at.gradient() * (weight * law.slope(at.value));
    });
    (value, gradient)
}

/// Above the concave edge both sides press, less the edge between them; elsewhere the distance is all there is.
#[test]
fn parts_are_the_distance_but_above_a_concave_edge() {
    let (body, law) = (stair(), PenaltyLaw::new(1.0, 0.2).unwrap());
    let mut random = Random::new(3);
    let mut seen = [0, 0];
    for _ in 0..20_000 {
        let x = random.point(0.75) + Vec3::repeat(0.5);
        let distance = body.signed_distance(x).value;
        if distance <= 0.0 {
            continue;
        }
        let (u, w) = (x.x - 0.5, x.z - 0.5);
        let is_inside = (0.2..0.8).contains(&x.y);
        let (place, expected) = if is_inside && (0.0..0.3).contains(&u) && (0.0..0.3).contains(&w) {
            let edge = law.energy(u.hypot(w));
            (0, law.energy(u) + law.energy(w) - edge)
        } else if u < -0.2 || w < -0.2 {
            (1, law.energy(distance))
        } else {
            continue;
        };
        seen[place] += 1;
        let found = energy(&body, &law, x).0;
        assert!(
            (found - expected).abs() < 1e-13 * (1.0 + expected),
            "{x}: {found} and not {expected}"
        );
    }
    assert!(seen[0] > 100 && seen[1] > 3000, "{seen:?}");
}

/// In the plane between both sides the gradient of φ turns by 90°, and in a ring of flat parts at all of its concave
/// edges.
#[test]
fn gradient_of_the_energy_jumps_nowhere() {
    let law = PenaltyLaw::new(1.0, 0.2).unwrap();
    let ring = generate::torus(12, 8, 0.4, 0.15).unwrap();
    let bodies = [stair(), ClosedMesh::new(&ring).unwrap()];
    for (body, origin) in bodies.iter().zip([Vec3::repeat(0.5), Vec3::zeros()]) {
        let mut random = Random::new(4);
        let mut jumps = 0;
        for _ in 0..200_000 {
            let x = random.point(0.75) + origin;
            let at = body.signed_distance(x);
            if !(0.05..0.2).contains(&at.value) {
                continue;
            }
            let step = random.point(2e-3);
            let there = body.signed_distance(x + step);
            jumps += u32::from((there.normal - at.normal).norm() > 0.05);
            // ψ″ is 4 N/m at 0.05 m, and curvature adds ψ′/d = 4 N/m; a few parts add up.
            let change = energy(body, &law, x + step).1 - energy(body, &law, x).1;
            let bound = 50.0 * step.norm();
            assert!(change.norm() < bound, "{x}: {} > {bound}", change.norm());
        }
        assert!(jumps > 5, "{jumps} jumps of the gradient of φ");
    }
}

/// Its derivative is at most two of its slopes in a spacing, along each pair of axes.
#[test]
fn gradient_of_samples_jumps_nowhere() {
    let (body, spacing) = (stair(), 0.05);
    let grid = SampledDistance::new(&body, spacing, 0.2).unwrap();
    let mut random = Random::new(5);
    for _ in 0..20_000 {
        let x = random.point(0.65) + Vec3::repeat(0.5);
        let step = random.point(1e-4);
        let change = grid.signed_distance(x + step).gradient() - grid.signed_distance(x).gradient();
        let bound = 6.0 * grid.lipschitz() / spacing * step.norm();
        assert!(change.norm() < bound, "{x}: {} > {bound}", change.norm());
    }
}

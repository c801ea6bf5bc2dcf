//! Once warm, nothing asks for memory.

use crate::counting_allocator::allocations_once_warm;
use cloth_collide::obstacle::*;
use cloth_collide::{BroadPhase, ClothCandidates, Hierarchy, MortonGrid, SpatialHash};
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid, torus};

#[test]
fn a_broad_phase_allocates_nothing_once_warm() {
    let mesh = grid(12, 12, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let wave = |x: &Vec3| 0.3 * Vec3::new((9.0 * x.x).sin(), (7.0 * x.y).sin(), x.x * x.y);
    let to: Vec<Vec3> = mesh.positions().iter().map(wave).collect();
    let kinds: [Box<dyn BroadPhase>; 3] = [
        Box::new(Hierarchy::default()),
        Box::new(SpatialHash::default()),
        Box::new(MortonGrid::default()),
    ];
    for kind in kinds {
        let mut candidates = ClothCandidates::new(&mesh, kind);
        let update = || candidates.update(mesh.positions(), &to, 0.01).unwrap();
        assert_eq!(allocations_once_warm(update), 0);
        assert!(candidates.edge_edge().len() > 1000);
    }
}

#[test]
fn obstacles_allocate_nothing_once_warm() {
    let body = torus(12, 8, 0.4, 0.15).unwrap();
    let samples = SampledDistance::new(&Sphere::new(0.3).unwrap(), 0.05, 0.1).unwrap();
    let mut obstacles = [
        Obstacle::new(ClosedMesh::new(&body).unwrap()),
        Obstacle::new(samples),
    ];
    let step = || {
        let mut found = 0;
        for i in 0..300 {
            let from = Vec3::new(0.003 * f64::from(i), 0.1, 0.4);
            let path = VertexPath::straight(from, from - Vec3::z() * 0.5, 0.1);
            for obstacle in &obstacles {
                found += usize::from(first_contact(obstacle, &path, 0.0, 0.1, 0.01).is_some());
            }
        }
        assert!(found > 100, "{found}");
        // An obstacle that moves on costs nothing.
        for obstacle in &mut obstacles {
            obstacle.advance(1e-3).unwrap();
        }
    };
    assert_eq!(allocations_once_warm(step), 0);
}

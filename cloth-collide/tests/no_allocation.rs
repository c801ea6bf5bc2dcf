//! Once warm, nothing asks for memory.

#[path = "../../cloth-core/tests/support/counting_allocator.rs"]
mod counting_allocator;

use cloth_collide::obstacle::*;
use cloth_collide::{BroadPhase, ClothCandidates, Hierarchy, MortonGrid, SpatialHash};
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid, torus};
use counting_allocator::allocations_once_warm;

#[test]
fn a_broad_phase_allocates_nothing_once_warm() {
    let mesh = grid(20, 20, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let wave = |x: &Vec3| 0.3 * Vec3::new((9.0 * x.x).sin(), (7.0 * x.y).sin(), x.x * x.y);
    let to: Vec<Vec3> = mesh.positions().iter().map(wave).collect();
    let kinds: [Box<dyn BroadPhase>; 3] = [
        Box::new(Hierarchy::new()),
        Box::new(SpatialHash::new()),
        Box::new(MortonGrid::new()),
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
    let law = ImpactLaw::new(0.3, 0.0).unwrap();
    let samples = SampledDistance::new(&Sphere::new(0.3).unwrap(), 0.05, 0.1).unwrap();
    let mut contacts = ObstacleContacts::new(0.01, 0.01)
        .unwrap()
        .with(Obstacle::new(ClosedMesh::new(&body).unwrap()), law)
        .with(Obstacle::new(samples), law);
    let from: Vec<Vec3> = (0..300)
        .map(|i| Vec3::new(0.003 * f64::from(i), 0.1, 0.4))
        .collect();
    let to: Vec<Vec3> = from.iter().map(|x| x - Vec3::z() * 0.5).collect();
    let (mut out, mut positions, mut velocities) = (Vec::new(), to.clone(), to.clone());
    let inverse_mass = vec![1.0; to.len()];
    let step = || {
        contacts.detect(&from, &to, 0.1, &mut out).unwrap();
        positions.copy_from_slice(&to);
        velocities.copy_from_slice(&to);
        contacts
            .respond(&mut positions, &mut velocities, &inverse_mass, 0.0)
            .unwrap();
        // An obstacle that moves on costs nothing.
        contacts
            .obstacles_mut()
            .for_each(|o| o.advance(1e-3).unwrap());
    };
    assert_eq!(allocations_once_warm(step), 0);
    assert!(out.len() > 100, "{}", out.len());
}

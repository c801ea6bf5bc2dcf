//! Once warm, the barrier asks for no memory.

#[path = "../../cloth-core/tests/support/counting_allocator.rs"]
mod counting_allocator;

use cloth_collide::barrier::BarrierContacts;
use cloth_collide::obstacle::{ImpactLaw, Obstacle, ObstacleContacts, Pose, RigidMotion, Sphere};
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join};
use counting_allocator::allocations_once_warm;

#[test]
fn step_with_contact_allocates_nothing_once_warm() {
    let flat = grid(8, 8, 0.3, 0.3, Diagonals::Alternating).unwrap();
    let above = flat.positions().iter();
    let above = above.map(|x| x + Vec3::new(0.011, 0.007, 0.004)).collect();
    let upper = TriMesh::new(above, flat.triangles().to_vec()).unwrap();
    let mesh = join(&[flat, upper]).unwrap();
    let motion = RigidMotion {
        pose: Pose::at(Vec3::new(0.15, 0.15, -0.11)),
        velocity: Vec3::z() * 0.3,
        ..RigidMotion::default()
    };
    let ball = Obstacle::moving(Sphere::new(0.1).unwrap(), motion).unwrap();
    let law = ImpactLaw::new(0.0, 0.0).unwrap();
    let obstacles = ObstacleContacts::new(1e-3, 0.0).unwrap().with(ball, law);
    let mut contacts = BarrierContacts::builder(&mesh)
        .obstacles(obstacles)
        .build()
        .unwrap();
    let from = mesh.positions().to_vec();
    let w: Vec<f64> = (0..128).map(|v| if v < 8 { 0.0 } else { 1e4 }).collect();
    let down = |x: &Vec3| x - Vec3::z() * (x.z + 0.01);
    let mut to: Vec<Vec3> = from.iter().map(down).collect();
    to[..8].copy_from_slice(&from[..8]);
    let (mut positions, mut velocities) = (to.clone(), to.clone());
    let step = ContactStep {
        from: &from,
        inverse_mass: &w,
        dt: 0.01,
    };
    let run = || {
        for obstacle in contacts.obstacles_mut().unwrap().obstacles_mut() {
            obstacle.set_motion(motion).unwrap();
        }
        positions.copy_from_slice(&to);
        velocities.fill(Vec3::zeros());
        contacts
            .resolve(&step, &mut positions, &mut velocities)
            .unwrap();
    };
    assert_eq!(allocations_once_warm(run), 0);
    assert!(contacts.report().contacts > 100);
    assert!(contacts.report().rounds > 0);
}

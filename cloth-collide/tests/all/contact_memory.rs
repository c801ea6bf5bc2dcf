//! What contact costs in memory: nothing once warm, and nothing for what is not asked for.

use crate::counting_allocator::allocations_once_warm;
use cloth_collide::obstacle::{HalfSpace, Obstacle};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactStep, Projection};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};

/// A sheet and its accordion: layers 3 mm apart.
fn folded() -> (TriMesh, Vec<Vec3>) {
    let mesh = grid(33, 9, 0.8, 0.2, Diagonals::Alternating).unwrap();
    let fold = |x: &Vec3| {
        let (layer, part) = ((x.x / 0.1).floor(), (x.x / 0.1).fract());
        let along = if layer % 2.0 == 0.0 { part } else { 1.0 - part };
        Vec3::new(0.1 * along, x.y, 0.003 * (layer + part) + 0.003)
    };
    let positions = mesh.positions().iter().map(fold).collect();
    (mesh, positions)
}

fn floor() -> Obstacle {
    Obstacle::new(HalfSpace::new(Vec3::z()).unwrap())
}

/// How often twenty resolved steps of a pressed pile of layers ask for memory.
fn allocations_of(contacts: &mut PotentialContacts, from: &[Vec3]) -> usize {
    let inverse_mass = vec![1.0; from.len()];
    let down = Vec3::new(0.1, 0.05, -0.3);
    let mut projection = Projection::default();
    let (mut positions, mut velocities) = (from.to_vec(), from.to_vec());
    let step = || {
        velocities.fill(down);
        for (to, x) in positions.iter_mut().zip(from) {
            *to = x + Vec3::new(0.1 * x.z, 0.0, -0.5 * x.z);
        }
        let step = ContactStep {
            from,
            inverse_mass: &inverse_mass,
            dt: 0.01,
        };
        let (x, v) = (&mut positions, &mut velocities);
        projection.step(contacts, &step, 4, x, v).unwrap();
    };
    allocations_once_warm(step)
}

#[test]
fn response_allocates_nothing_once_warm() {
    let (mesh, from) = folded();
    let builder = PotentialContacts::builder(&mesh)
        .thickness(2e-3)
        .friction(0.3);
    let mut contacts = builder.obstacle(floor(), 0.3).build().unwrap();
    // The second step knows the contacts of the first one, and may do more.
    allocations_of(&mut contacts, &from);
    assert_eq!(allocations_of(&mut contacts, &from), 0);
    let report = contacts.constraint_report();
    assert!(report.constraints > 500, "{report:?}");
}

#[test]
fn obstacles_alone_need_no_search_of_the_cloth() {
    let (mesh, from) = folded();
    let builder = PotentialContacts::builder(&mesh)
        .thickness(2e-3)
        .self_collision(false);
    let mut contacts = builder.obstacle(floor(), 0.3).build().unwrap();
    assert_eq!(allocations_of(&mut contacts, &from), 0);
    let report = contacts.constraint_report();
    assert!(report.constraints > 0, "{report:?}");
    assert_eq!((report.searches, report.detections), (0, 0));
}

#[test]
fn contact_with_nothing_does_nothing() {
    let (mesh, from) = folded();
    let builder = || {
        PotentialContacts::builder(&mesh)
            .thickness(2e-3)
            .self_collision(false)
    };
    let mut contacts = builder().build().unwrap();
    assert_eq!(allocations_of(&mut contacts, &from), 0);
    assert_eq!(contacts.constraint_report().constraints, 0);
}

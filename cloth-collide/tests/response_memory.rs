//! What contact costs in memory: nothing once warm, and nothing for what is not asked for.

#[path = "../../cloth-core/tests/support/counting_allocator.rs"]
mod counting_allocator;

use cloth_collide::ClothContacts;
use cloth_collide::obstacle::{HalfSpace, ImpactLaw, Obstacle, ObstacleContacts};
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use counting_allocator::allocations_once_warm;

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

fn floor() -> ObstacleContacts {
    let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let law = ImpactLaw::new(0.3, 0.0).unwrap();
    ObstacleContacts::new(2e-3, 2e-3).unwrap().with(floor, law)
}

/// How often twenty resolved steps of a pressed pile of layers ask for memory.
fn allocations_of(contacts: &mut ClothContacts, from: &[Vec3]) -> usize {
    let inverse_mass = vec![1.0; from.len()];
    let down = Vec3::new(0.1, 0.05, -0.3);
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
        contacts
            .resolve(&step, &mut positions, &mut velocities)
            .unwrap();
    };
    allocations_once_warm(step)
}

#[test]
fn response_allocates_nothing_once_warm() {
    let (mesh, from) = folded();
    let builder = ClothContacts::builder(&mesh).thickness(2e-3).friction(0.3);
    let mut contacts = builder.obstacles(floor()).build().unwrap();
    // The second step knows the contacts of the first one, and may do more.
    allocations_of(&mut contacts, &from);
    assert_eq!(allocations_of(&mut contacts, &from), 0);
    let report = contacts.report();
    assert!(
        report.contacts > 500 && report.continuous_tests > 0,
        "{report:?}"
    );
}

#[test]
fn obstacles_alone_need_no_search_of_the_cloth() {
    let (mesh, from) = folded();
    let builder = ClothContacts::builder(&mesh).self_collision(false);
    let mut contacts = builder.obstacles(floor()).build().unwrap();
    assert_eq!(allocations_of(&mut contacts, &from), 0);
    let report = contacts.report();
    assert!(report.contacts > 0, "{report:?}");
    assert_eq!((report.searches, report.candidates), (0, 0));
}

#[test]
fn contact_with_nothing_does_nothing() {
    let (mesh, from) = folded();
    let builder = || ClothContacts::builder(&mesh).self_collision(false);
    let build = || drop(builder().build().unwrap());
    assert_eq!(allocations_once_warm(build), 0);
    let mut contacts = builder().build().unwrap();
    assert_eq!(allocations_of(&mut contacts, &from), 0);
    assert_eq!(contacts.report().contacts, 0);
}

/// Layers at twice the thickness that keep their distance: the broad phase has candidates, and none of them takes a continuous test.
#[test]
fn what_stays_apart_takes_no_continuous_test() {
    let (mesh, from) = folded();
    let builder = ClothContacts::builder(&mesh).thickness(1.5e-3);
    let mut contacts = builder.build().unwrap();
    let inverse_mass = vec![1.0; from.len()];
    let ends: Vec<_> = from.iter().map(|x| x + Vec3::new(0.1, 0.2, 0.3)).collect();
    let velocities = vec![Vec3::new(1.0, 2.0, 3.0); from.len()];
    let step = ContactStep {
        from: &from,
        inverse_mass: &inverse_mass,
        dt: 0.1,
    };
    let (mut positions, mut changed) = (ends.clone(), velocities.clone());
    contacts
        .resolve(&step, &mut positions, &mut changed)
        .unwrap();
    let report = contacts.report();
    assert!(report.candidates > 1000, "{report:?}");
    assert_eq!((report.contacts, report.continuous_tests), (0, 0));
    assert_eq!((positions, changed), (ends, velocities));
}

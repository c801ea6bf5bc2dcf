//! Vertices that would go where coordinates no longer tell distances of contact apart, and lists of another length.

use super::taken_back::{DT, THICKNESS, triangle};
use cloth_collide::obstacle::{HalfSpace, Obstacle};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactSource, ContactStep, Projection,
};
use cloth_core::math::{Real, Vec3};

/// In both views a vertex beyond h/(100 ε) is named, whichever way it flies, and whether something is near or not; one
/// within goes there.
#[test]
fn a_vertex_that_is_too_fast_for_contact_is_named() {
    let mesh = triangle(0.7 * THICKNESS);
    let from = mesh.positions();
    let bound = 0.01 * THICKNESS / Real::EPSILON;
    let step = ContactStep {
        from,
        inverse_mass: &[1.0; 3],
        dt: DT,
    };
    let floor = || Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let build = |has_floor: bool| {
        let builder = PotentialContacts::builder(&mesh).thickness(THICKNESS);
        match has_floor {
            true => builder.obstacle(floor(), 0.0),
            false => builder,
        }
        .build()
        .unwrap()
    };
    for has_floor in [true, false] {
        for direction in [Vec3::x(), Vec3::z(), -Vec3::y()] {
            let to = |distance: Real| [from[0], from[1] + direction * distance, from[2]];
            let potential = |distance: Real| {
                ContactPotential::begin(&mut build(has_floor), &step, &mut to(distance))
            };
            let constraints = |distance: Real| {
                let mut contacts = build(has_floor);
                contacts.begin_step(&step).unwrap();
                contacts.begin_substep(&step, &to(distance))
            };
            for (distance, is_far) in [(0.9, false), (1.1, true), (1e8, true)] {
                for ended in [potential(distance * bound), constraints(distance * bound)] {
                    let Err(error) = ended else {
                        assert!(!is_far, "{distance}");
                        continue;
                    };
                    let ContactError::TooFar { vertex, most, .. } = error else {
                        panic!("{error}");
                    };
                    assert!(is_far && vertex == 1 && most == bound, "{error}");
                }
            }
            for ended in [potential(Real::NAN), constraints(Real::INFINITY)] {
                assert_eq!(ended, Err(ContactError::NonFinite { vertex: 1 }));
            }
        }
    }
}

/// Lists of another length, and velocities that are not finite, are refused wherever a program of one's own hands them
/// over.
#[test]
fn lists_of_another_length_are_refused() {
    let mesh = triangle(0.7 * THICKNESS);
    let from = mesh.positions();
    let mut contacts = PotentialContacts::builder(&mesh).build().unwrap();
    let wrong = |found| ContactError::VertexCount { expected: 3, found };
    let step = ContactStep {
        from,
        inverse_mass: &[1.0; 3],
        dt: DT,
    };
    let potential = contacts.potential();
    potential.begin(&step, &mut from.to_vec()).unwrap();
    assert_eq!(potential.limit(from, &from[..2]), Err(wrong(2)));
    assert_eq!(potential.limit(&from[..1], from), Err(wrong(1)));
    let each = |x: &[Vec3], to: usize, fractions: usize, potential: &mut dyn ContactPotential| {
        potential.limit_each(x, &mut vec![Vec3::zeros(); to], &mut vec![0.0; fractions])
    };
    assert_eq!(each(&from[..2], 3, 3, potential), Err(wrong(2)));
    assert_eq!(each(from, 4, 3, potential), Err(wrong(4)));
    assert_eq!(each(from, 3, 1, potential), Err(wrong(1)));
    let mut project = |v: &mut [Vec3]| {
        let (x, contacts) = (&mut from.to_vec(), contacts.constraints());
        Projection::default().step(contacts, &step, 1, x, v)
    };
    assert_eq!(
        project(&mut [Vec3::zeros(); 2]),
        Err(ContactError::VertexCount {
            expected: 3,
            found: 2
        })
    );
    let nan = Vec3::new(0.0, Real::NAN, 0.0);
    assert_eq!(
        project(&mut [Vec3::zeros(), nan, Vec3::zeros()]),
        Err(ContactError::NonFinite { vertex: 1 })
    );
    assert_eq!(project(&mut [Vec3::zeros(); 3]), Ok(()));
}

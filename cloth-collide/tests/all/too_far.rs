//! Vertices that would go where coordinates no longer tell distances of contact apart.

use super::taken_back::{DT, THICKNESS, triangle};
use cloth_collide::obstacle::{HalfSpace, Obstacle};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactConstraints, ContactError, ContactPotential, ContactStep};
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

//! Exact answers: impulses, momentum, friction.

use super::flight::{Flight, together};
use cloth_collide::ClothContacts;
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;

fn triangle(z: f64, size: f64) -> TriMesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (0.25, 1.0)];
    let positions = corners.map(|(x, y)| Vec3::new(size * x, size * y, z));
    TriMesh::new(positions.to_vec(), vec![[0, 1, 2]]).unwrap()
}

/// A vertex p against the inside of a triangle: the impulse is −vₙ / (w_p + Σ bᵢ² wᵢ).
#[test]
fn one_contact_has_the_impulse_of_two_bodies() {
    let (h, dt) = (1e-3, 0.01);
    // The second triangle stands on its tip above the first.
    let mut tip = vec![Vec3::new(0.1, -0.3, h)];
    tip.extend([Vec3::new(-0.5, -0.3, 2.0), Vec3::new(0.5, 0.3, 2.0)]);
    let mesh = together(&[
        triangle(0.0, 1.0),
        TriMesh::new(tip, vec![[0, 1, 2]]).unwrap(),
    ]);
    let contacts = ClothContacts::builder(&mesh).thickness(h).build().unwrap();
    let mut flight = Flight::new(&mesh, contacts);
    flight.inverse_mass = vec![1.0, 0.5, 2.0, 0.25, 1.0, 1.0];
    let v = Vec3::new(0.3, -0.1, -2.0);
    flight.velocities[3] = v;
    flight.step(dt).unwrap();
    let corners = [0, 1, 2].map(|k: usize| mesh.positions()[k]);
    let at = cloth_collide::point_triangle(mesh.positions()[3], corners);
    let b = at.weights;
    let w = &flight.inverse_mass;
    let effective = w[3] + (0..3).map(|k| b[k] * b[k] * w[k]).sum::<f64>();
    let impulse = 2.0 / effective;
    let report = flight.contacts.report();
    assert_eq!(report.contacts, 1, "{report:?}");
    let expected = v + Vec3::z() * (impulse * w[3]);
    assert!((flight.velocities[3] - expected).norm() < 1e-14);
    for k in 0..3 {
        let expected = Vec3::z() * (-impulse * b[k] * w[k]);
        assert!((flight.velocities[k] - expected).norm() < 1e-14);
    }
    assert_eq!(flight.crossings(), 0);
}

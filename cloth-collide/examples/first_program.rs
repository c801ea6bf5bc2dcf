//! The contact potential as a plain loop over vertices, beside the real one: a sheet on a ball and above a floor.
//!
//! `cargo run --release -p cloth-collide --example first_program`
//!
//! Without edges and faces, that is: what they add, and every candidate, filter and friction, is in the crate.

use cloth_collide::obstacle::{HalfSpace, Obstacle, Pose, RigidMotion, Sphere};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactPotential, ContactStep};
use cloth_core::{Diagonals, TriMesh, Vec3, grid};

const THICKNESS: f64 = 2e-3; // h (m)
const STIFFNESS: f64 = 1e6; // κ (Pa/m)
const RADIUS: f64 = 0.1; // of the ball, whose top is half a millimetre above the floor (m)

/// Signed distances (m) of a point from the floor z = 0 and from a ball below it, with their gradients.
fn distances(x: Vec3) -> [(f64, Vec3); 2] {
    let center = Vec3::new(0.1, 0.1, 0.5e-3 - RADIUS);
    let from_center = x - center;
    [
        (x.z, Vec3::z()),
        (from_center.norm() - RADIUS, from_center.normalize()),
    ]
}

/// `E = Σ A ψ(d)` (J) with `ψ = ½ κ (h − d)²` below h, and its gradient (N). A vertex has a third of the area of the
/// triangles around it.
fn energy(mesh: &TriMesh, x: &[Vec3]) -> (f64, Vec<Vec3>) {
    let mut area = vec![0.0; x.len()];
    for (triangle, size) in mesh.triangles().iter().zip(mesh.areas()) {
        for &vertex in triangle {
            area[vertex as usize] += size / 3.0;
        }
    }
    let (mut energy, mut gradient) = (0.0, vec![Vec3::zeros(); x.len()]);
    for vertex in 0..x.len() {
        for (distance, normal) in distances(x[vertex]) {
            let missing = (THICKNESS - distance).max(0.0);
            energy += 0.5 * STIFFNESS * area[vertex] * missing * missing;
            gradient[vertex] -= normal * (STIFFNESS * area[vertex] * missing);
        }
    }
    (energy, gradient)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 1.7 mm above the floor: between h/2 and h, where the potential is quadratic.
    let flat = grid(17, 17, 0.2, 0.2, Diagonals::Alternating)?;
    let x: Vec<Vec3> = flat
        .positions()
        .iter()
        .map(|p| p + Vec3::z() * 1.7e-3)
        .collect();
    let (naive, slope) = energy(&flat, &x);

    let below = RigidMotion::still(Pose::at(Vec3::new(0.1, 0.1, 0.5e-3 - RADIUS)));
    let mut contacts = PotentialContacts::builder(&flat)
        .thickness(THICKNESS)
        .stiffness(STIFFNESS)
        .obstacle(Obstacle::new(HalfSpace::new(Vec3::z())?), 0.0)
        .obstacle(Obstacle::moving(Sphere::new(RADIUS)?, below)?, 0.0)
        .build()?;
    let step = ContactStep {
        from: &x,
        inverse_mass: &vec![1.0; x.len()],
        dt: 0.01,
    };
    contacts.begin(&step, &mut x.clone())?;
    contacts.limit(&x, &x)?; // an empty path: finds the pairs
    let mut gradient = vec![Vec3::zeros(); x.len()];
    let real = contacts.add_gradient(&x, &mut gradient);

    let apart = slope
        .iter()
        .zip(&gradient)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    let largest = gradient.iter().map(Vec3::norm).fold(0.0, f64::max);
    println!("{naive:.6} J and {real:.6} J; the forces differ by {apart:.1e} N of {largest:.3} N");
    assert!((naive / real - 1.0).abs() < 1e-12 && apart < 1e-12 * largest);
    Ok(())
}

#[test]
fn the_naive_loop_and_the_contact_potential_give_the_same_forces() {
    main().unwrap();
}

//! The local step against the energies of the elements, one by one.

use crate::cloth::{noise, sheet};
use cloth_core::element::Energy;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::particles::Particles;
use cloth_pd::LocalStep;

/// Sums of energies (J) and gradients (N), element by element.
fn expected(springs: &[Spring], x: &[Vec3]) -> (Real, Vec<Vec3>) {
    let (mut energy, mut gradient) = (0.0, vec![Vec3::zeros(); x.len()]);
    for spring in springs {
        let ends = gather(x, spring.vertices);
        energy += spring.value(&ends);
        for (vertex, own) in spring.vertices.into_iter().zip(spring.gradient(&ends)) {
            gradient[vertex as usize] += own;
        }
    }
    (energy, gradient)
}

fn agrees(what: &str, particles: &Particles, springs: &[Spring], x: &[Vec3]) {
    let mut local = LocalStep::new(particles, springs.to_vec()).unwrap();
    let (energy, gradient) = expected(springs, x);
    let scale = gradient.iter().map(Vec3::norm).fold(1.0, Real::max);
    // Twice: nothing is left over from the first time.
    for _ in 0..2 {
        let mut out = vec![Vec3::zeros(); x.len()];
        let value = local.add_gradient(x, &mut out);
        assert!(
            (value - energy).abs() <= 1e-13 * energy,
            "{what}: {value} J, not {energy} J"
        );
        for (out, gradient) in out.iter().zip(&gradient) {
            assert!((out - gradient).norm() < 1e-14 * scale, "{what}: {out} N");
        }
    }
}

#[test]
fn springs_side_by_side_pull_as_each_does_alone() {
    let (model, _) = sheet(9, 1e4);
    let x = noise(81);
    // Whole blocks and the rest of one.
    for count in [1, 2, 31, 32, 33, 63, 64, model.springs.len()] {
        let springs = &model.springs[..count];
        agrees("springs", &model.particles, springs, &x);
    }
}

#[test]
fn springs_whose_length_is_lost_do_not_spoil_their_neighbours() {
    let (model, _) = sheet(9, 1e4);
    let mut x = noise(81);
    x[10] = x[11]; // no direction
    x[30] = x[31] + Vec3::x() * 1e-170; // the square of the length is zero
    agrees("lost", &model.particles, &model.springs, &x);
    let without_length = |spring: &Spring| Spring {
        rest_length: 0.0,
        ..*spring
    };
    let springs: Vec<Spring> = model.springs.iter().map(without_length).collect();
    agrees("without length", &model.particles, &springs, &x);
    agrees(
        "in a point",
        &model.particles,
        &springs,
        &[Vec3::zeros(); 81],
    );
}

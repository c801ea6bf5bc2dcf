//! The exact cases of contact.

use crate::random::Random;
use cloth_collide::obstacle::*;
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactStep, Projection};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

#[test]
fn a_law_is_its_derivatives_integral() {
    let law = PenaltyLaw::new(300.0, 0.02).unwrap();
    for i in 1..100 {
        let gap = 0.0003 * f64::from(i);
        let h = 1e-6 * gap;
        let slope = (law.energy(gap + h) - law.energy(gap - h)) / (2.0 * h);
        let bend = (law.slope(gap + h) - law.slope(gap - h)) / (2.0 * h);
        let across = (gap - 0.02).abs() < 1e-5;
        assert!((slope - law.slope(gap)).abs() < 1e-7 * (1.0 + law.slope(gap).abs()));
        assert!(across || (bend - law.curvature(gap)).abs() < 1e-6 * (1.0 + bend.abs()));
        assert!(law.slope(gap) <= 0.0 && law.curvature(gap) >= 0.0);
    }
    for gap in [0.02, 0.03, 1e9] {
        let all = [law.energy(gap), law.slope(gap), law.curvature(gap)];
        assert_eq!(all, [0.0; 3]);
    }
    // Where it is passed it pulls back as it does at f = 10⁻¹² of its range r: E′ = −k r/4f, E″ = k/4f².
    for gap in [-1.0, 0.0, 1e-300] {
        let f: Real = 1e-12;
        assert!((law.slope(gap) / (-300.0 * 0.02 / (4.0 * f)) - 1.0).abs() < 1e-14);
        assert!((law.curvature(gap) / (300.0 / (4.0 * f * f)) - 1.0).abs() < 1e-14);
    }
    assert_eq!(law.energy(0.0), f64::INFINITY);
}

/// Under a weight of up to k h/2 at h − weight/k, under more at k h²/(4 weight).
#[test]
fn a_mass_rests_where_the_closed_forms_say() {
    let (k, h) = (700.0, 0.01);
    let law = PenaltyLaw::new(k, h).unwrap();
    for weight in [0.3, 3.0, 3.5, 6.9, 100.0] {
        let gap = match weight {
            w if w <= 0.5 * k * h => h - w / k,
            w => k * h * h / (4.0 * w),
        };
        assert!((law.slope(gap) + weight).abs() < 1e-13 * weight, "{weight}");
    }
}

/// With restitution, cloth that lies on a floor lies still. In short substeps, with g Δt² below h/1000, the law carries
/// its weight; in longer ones, with g Δt² above (1 + e) h/1000, it carries 1/(1 + e) of it, and the rebound the rest.
#[test]
fn what_lies_on_a_floor_lies_still_with_restitution() {
    let (g, h, kappa, mass, e) = (9.81, 1e-3, 1e6, 0.01, 0.5);
    let flat = grid(4, 4, 0.3, 0.3, Diagonals::Alternating).unwrap();
    let mut area = vec![0.0; flat.vertex_count()];
    for (corners, whole) in flat.triangles().iter().zip(flat.areas()) {
        for v in corners {
            area[*v as usize] += whole / 3.0;
        }
    }
    let inverse_mass = vec![1.0 / mass; area.len()];
    for (dt, share) in [(3e-4, 1.0), (1e-3, 1.0 / (1.0 + e))] {
        let builder = PotentialContacts::builder(&flat)
            .thickness(h)
            .stiffness(kappa)
            .restitution(e)
            .obstacle(Obstacle::new(HalfSpace::new(Vec3::z()).unwrap()), 0.0);
        let mut contacts = builder.build().unwrap();
        let height = |v: usize| h - share * mass * g / (kappa * area[v]);
        let speed = (1.0 - share) * g * dt;
        let places = flat.positions().iter().enumerate();
        let start: Vec<Vec3> = places.map(|(v, x)| x + Vec3::z() * height(v)).collect();
        let mut x = start.clone();
        let mut velocities = vec![Vec3::z() * speed; x.len()];
        let mut projection = Projection::default();
        for _ in 0..100 {
            let from = x.clone();
            for (x, v) in x.iter_mut().zip(&mut velocities) {
                v.z -= g * dt;
                *x += *v * dt;
            }
            let step = ContactStep {
                from: &from,
                inverse_mass: &inverse_mass,
                dt,
            };
            let (x, v) = (&mut x, &mut velocities);
            projection.step(&mut contacts, &step, 5, x, v).unwrap();
        }
        for v in 0..x.len() {
            let moved = (x[v] - start[v]).norm();
            assert!(moved < 1e-12, "{dt} s, vertex {v}: {moved:e} m");
            let change = (velocities[v] - Vec3::z() * speed).norm();
            assert!(change < 1e-9, "{dt} s, vertex {v}: {change:e} m/s");
        }
    }
}

#[test]
fn contact_energies_have_the_right_gradients() {
    let motion = RigidMotion::still(Pose::at(v(0.1, 0.2, -0.1)).turned(v(0.3, 0.1, 0.9)));
    let samples = SampledDistance::new(&Sphere::new(0.5).unwrap(), 0.1, 0.2).unwrap();
    let obstacles = [
        Obstacle::moving(Cuboid::new(v(0.4, 0.3, 0.5)).unwrap(), motion).unwrap(),
        Obstacle::moving(samples, motion).unwrap(),
    ];
    let mut random = Random::new(4);
    let law = PenaltyLaw::new(50.0, 0.4).unwrap();
    for obstacle in &obstacles {
        let mut pushed = 0;
        for _ in 0..300 {
            let x = random.point(1.0);
            let at = obstacle.signed_distance(x, 0.0);
            if at.value < 0.02 {
                continue;
            }
            let gradient = at.gradient() * law.slope(at.value);
            let h = 1e-6;
            let energy = |d: Vec3| law.energy(obstacle.signed_distance(x + d, 0.0).value);
            let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|e| e * h);
            let curved = |e: Vec3| (energy(e) + energy(-e) - 2.0 * energy(Vec3::zeros())).abs();
            if axes.iter().any(|&e| curved(e) > 1e5 * h * h) {
                continue; // a border between cells or regions
            }
            let differences = Vec3::from(axes.map(|e| (energy(e) - energy(-e)) / (2.0 * h)));
            let error = (differences - gradient).norm();
            assert!(error < 1e-5 * (1.0 + differences.norm()), "{x} {error:e}");
            pushed += u32::from(differences.norm() > 0.0);
        }
        assert!(pushed > 50, "{pushed}");
    }
}

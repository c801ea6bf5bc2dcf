//! The exact cases of contact.

#[path = "support/random.rs"]
mod random;

use cloth_collide::obstacle::*;
use cloth_core::check;
use cloth_core::element::{Convexity, Energy};
use cloth_core::math::{Real, Vec3};
use random::Random;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

fn law(friction: Real, restitution: Real) -> ImpactLaw {
    ImpactLaw::new(friction, restitution).unwrap()
}

/// Coulomb's cone, no rebound beyond e, no energy gained relative to the surface, for any normal and velocity.
#[test]
fn impulses_stay_in_the_friction_cone_and_never_turn_a_velocity() {
    let mut random = Random::new(2);
    for _ in 0..10_000 {
        let (normal, u) = (random.point(1.0).normalize(), random.point(5.0));
        let (mu, e) = (random.real(2.0).abs(), random.real(1.0).abs());
        let change = law(mu, e).velocity_change(u, normal);
        let (along, after) = (u.dot(&normal), u + change);
        if along >= 0.0 {
            assert_eq!(change, Vec3::zeros());
            continue;
        }
        assert!((after.dot(&normal) + e * along).abs() < 1e-14);
        let push = change.dot(&normal);
        let tangent = |w: Vec3| w - normal * w.dot(&normal);
        assert!(tangent(change).norm() <= mu * push + 1e-14);
        assert!(tangent(after).dot(&tangent(u)) >= -1e-14);
        assert!(after.norm() <= u.norm() + 1e-14);
        // Either it sticks, or friction is at its limit.
        let sticks = tangent(after).norm() < 1e-14;
        assert!(sticks || (tangent(change).norm() - mu * push).abs() < 1e-13);
    }
}

#[test]
fn discrete_response_moves_a_vertex_out_and_tells_the_impulse() {
    let motion = RigidMotion {
        velocity: v(0.0, 0.0, 1.0),
        angular_velocity: v(0.0, 0.0, 2.0),
        ..RigidMotion::default()
    };
    let ball = Obstacle::moving(Sphere::new(0.5).unwrap(), motion).unwrap();
    let mut random = Random::new(3);
    let start: Vec<Vec3> = (0..200).map(|_| random.point(0.6)).collect();
    let speeds: Vec<Vec3> = (0..200).map(|_| random.point(2.0)).collect();
    let (mut x, mut u) = (start.clone(), speeds.clone());
    let mut pushed = 0;
    for i in 0..200 {
        let change = law(0.4, 0.2).respond(&ball, 0.1, 0.01, &mut x[i], &mut u[i]);
        assert!((u[i] - speeds[i] - change).norm() < 1e-14);
        pushed += u32::from(change != Vec3::zeros());
        let (before, after) = (
            ball.signed_distance(start[i], 0.1),
            ball.signed_distance(x[i], 0.1),
        );
        assert!(after.value > 0.01 - 1e-14);
        if before.value >= 0.01 {
            assert_eq!((x[i], u[i]), (start[i], speeds[i]));
        } else {
            let surface = ball.velocity_at(start[i], 0.1);
            assert!((u[i] - surface).dot(&before.normal) > -1e-14);
        }
    }
    assert!(pushed > 20, "{pushed}");
}

#[test]
fn penalty_and_barrier_are_their_derivatives_integrals() {
    let laws = [
        PenaltyLaw::quadratic(300.0, 0.02).unwrap(),
        PenaltyLaw::barrier(300.0, 0.02).unwrap(),
    ];
    for law in laws {
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
            assert_eq!(
                [law.energy(gap), law.slope(gap), law.curvature(gap)],
                [0.0; 3]
            );
        }
    }
    for gap in [-1.0, 0.0, 1e-300] {
        let quadratic = [laws[0].slope(gap), laws[0].curvature(gap)];
        assert_eq!(quadratic, [300.0 * (gap - 0.02), 300.0]);
        // A barrier that is passed pulls back as it does at f = 10⁻¹² of its range r: E′ = k r (2 (1 − f) ln f − (1 −
        // f)²/f), E″ = k ((1 − f)²/f² + 4 (1 − f)/f − 2 ln f).
        let f: Real = 1e-12;
        let left = (1.0 - f) / f;
        let slope = 300.0 * 0.02 * (2.0 * (1.0 - f) * f.ln() - (1.0 - f) * left);
        let bend = 300.0 * (left * left + 4.0 * left - 2.0 * f.ln());
        assert!((laws[1].slope(gap) / slope - 1.0).abs() < 1e-14);
        assert!((laws[1].curvature(gap) / bend - 1.0).abs() < 1e-14);
    }
    assert_eq!(laws[1].energy(0.0), f64::INFINITY);
}

/// The gap (m) at which a vertex comes to rest under a weight (N): the minimum of its energy, by Newton's method.
fn resting_gap(law: PenaltyLaw, weight: Real) -> Real {
    let floor = PlanePenalty {
        vertex: 0,
        normal: Vec3::z(),
        offset: 0.0,
        law,
    };
    let mut z = 0.9 * law.range();
    for _ in 0..100 {
        let x = [Vec3::z() * z];
        let [[hessian]] = floor.hessian(&x, Convexity::Exact);
        let step = (floor.gradient(&x)[0].z + weight) / hessian.m33;
        z = if step < z { z - step } else { 0.5 * z };
    }
    z
}

/// The barrier −k (d − h)² ln(d/h) presses at d = q h with k h (1 − q) (1/q − 1 − 2 ln q): at h/2 with k h (½ + ln 2),
/// at h/e with k h (e − 1/e).
#[test]
fn a_mass_rests_where_the_closed_forms_say() {
    use std::f64::consts::{E, LN_2};
    let (k, h) = (700.0, 0.01);
    for weight in [0.3, 3.0, 6.9] {
        let gap = resting_gap(PenaltyLaw::quadratic(k, h).unwrap(), weight);
        assert!((h - gap - weight / k).abs() < 1e-17, "{gap}");
    }
    for (part, pressed) in [(0.5, 0.5 + LN_2), (1.0 / E, E - 1.0 / E)] {
        let gap = resting_gap(PenaltyLaw::barrier(k, h).unwrap(), k * h * pressed);
        assert!((gap / (part * h) - 1.0).abs() < 1e-15, "{part}: {gap}");
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
    for obstacle in &obstacles {
        for law in [
            PenaltyLaw::quadratic(50.0, 0.4).unwrap(),
            PenaltyLaw::barrier(50.0, 0.4).unwrap(),
        ] {
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

                // The element on the tangent plane starts from the same energy and gradient.
                let plane = PlanePenalty {
                    vertex: 0,
                    normal: at.normal,
                    offset: at.normal.dot(&x) - at.value,
                    law,
                };
                assert!((plane.value(&[x]) - energy(Vec3::zeros())).abs() < 1e-12);
                let scaled = plane.gradient(&[x])[0] * at.slope;
                assert!((scaled - gradient).norm() < 1e-11 * (1.0 + scaled.norm()));
                if at.value > 0.399 {
                    continue; // the second derivative may jump where the range ends
                }
                let scale = 0.1 * at.value;
                assert!(check::gradient_error(&plane, &[x], scale) < 1e-7);
                assert!(check::hessian_error(&plane, &[x], scale) < 1e-6);
            }
            assert!(pushed > 50, "{pushed}");
        }
    }
}

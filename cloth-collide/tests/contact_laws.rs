//! The exact cases of contact.

#[path = "support/random.rs"]
mod random;

use cloth_collide::obstacle::*;
use cloth_core::check;
use cloth_core::element::{Convexity, Energy};
use cloth_core::math::{Real, Vec3};
use random::Random;

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);
const DT: Real = 1.0 / 60.0;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

fn law(friction: Real, restitution: Real) -> ImpactLaw {
    ImpactLaw::new(friction, restitution).unwrap()
}

fn floor() -> Obstacle {
    Obstacle::new(HalfSpace::new(Vec3::z()).unwrap())
}

fn mass_at(position: Vec3, velocity: Vec3) -> PointMass {
    PointMass {
        position,
        velocity,
        mass: 0.3,
    }
}

#[test]
fn a_block_slides_if_the_tangent_exceeds_the_friction_as_far_as_exact() {
    for degrees in [5.0, 20.0, 30.0, 45.0, 60.0f64] {
        for friction in [0.0, 0.1, 0.36, 0.58, 0.99, 1.2, 2.0] {
            for turn in [0.0, 0.7] {
                let angle = degrees.to_radians();
                let plane = HalfSpace::inclined(angle).unwrap();
                // The incline stands somewhere and looks somewhere.
                let place = v(3.0, -2.0, 1.0);
                let pose = Pose::at(place).turned(Vec3::z() * turn);
                let incline = Obstacle::moving(plane, RigidMotion::still(pose)).unwrap();
                let downhill = pose.orientation * v(angle.cos(), 0.0, -angle.sin());
                let thickness = 0.004;
                let start = place + incline.signed_distance(place, 0.0).normal * thickness;
                let mut block = mass_at(start, Vec3::zeros());
                for _ in 0..120 {
                    block.advance(&incline, law(friction, 0.5), thickness, GRAVITY, 0.0, DT);
                }
                let time = 120.0 * DT;
                let pull = (angle.sin() - friction * angle.cos()).max(0.0);
                let exact = start + downhill * (0.5 * 9.81 * pull * time * time);
                let error = (block.position - exact).norm();
                assert!(error < 1e-10, "{degrees}° μ = {friction}: {error:e}");
                assert_eq!(pull > 0.0, angle.tan() > friction);
                assert_eq!(block.velocity.norm() > 1e-9, pull > 0.0);
            }
        }
    }
}

#[test]
fn a_ball_bounces_to_the_square_of_the_restitution_each_time() {
    for restitution in [0.0, 0.3, 0.8, 1.0] {
        let (height, floor) = (1.3, floor());
        let mut ball = mass_at(v(0.2, 0.0, height), Vec3::zeros());
        let fall = (2.0 * height / 9.81f64).sqrt();
        let mut energies = Vec::new();
        for step in 1..=180 {
            ball.advance(&floor, law(0.4, restitution), 0.0, GRAVITY, 0.0, DT);
            let time = f64::from(step) * DT;
            // The nth flight begins at `begin` with the speed eⁿ g t₀.
            let (mut begin, mut speed) = (fall, restitution * 9.81 * fall);
            let mut bounces = 1;
            while speed > 1e-12 && begin + 2.0 * speed / 9.81 < time {
                begin += 2.0 * speed / 9.81;
                speed *= restitution;
                bounces += 1;
            }
            let (exact, peak) = if time < fall {
                (height - 0.5 * 9.81 * time * time, height)
            } else if speed <= 1e-12 {
                (0.0, 0.0)
            } else {
                let t = time - begin;
                let peak = height * restitution.powi(2 * bounces);
                (speed * t - 0.5 * 9.81 * t * t, peak)
            };
            assert!(
                (ball.position.z - exact).abs() < 1e-10,
                "e = {restitution}, {time} s"
            );
            let reach = ball.position.z + ball.velocity.z.powi(2) / (2.0 * 9.81);
            assert!((reach - peak).abs() < 1e-10, "e = {restitution}, {time} s");
            energies.push(reach);
        }
        assert!(energies.windows(2).all(|e| e[1] <= e[0] + 1e-12));
    }
}

#[test]
fn a_mass_at_rest_stays_and_presses_with_its_weight() {
    for friction in [0.0, 0.5] {
        for angle in [0.0, 0.3] {
            if angle > 0.0 && friction == 0.0 {
                continue;
            }
            let plane = Obstacle::new(HalfSpace::inclined(angle).unwrap());
            let start = plane.signed_distance(Vec3::zeros(), 0.0).normal * 0.01;
            let mut block = mass_at(start, Vec3::zeros());
            for _ in 0..10_000 {
                let impulse = block.advance(&plane, law(friction, 0.9), 0.01, GRAVITY, 0.0, DT);
                assert!((impulse + GRAVITY * (0.3 * DT)).norm() < 1e-15);
            }
            assert!(
                (block.position - start).norm() < 1e-12,
                "{}",
                block.position
            );
            assert!(block.velocity.norm() < 1e-14);
        }
    }
}

#[test]
fn a_moving_plane_carries_what_lies_on_it() {
    let moving = |velocity: Vec3| {
        let motion = RigidMotion {
            velocity,
            ..RigidMotion::default()
        };
        Obstacle::moving(HalfSpace::new(Vec3::z()).unwrap(), motion).unwrap()
    };
    // A lift, for which the mass has the right speed, and a belt that has to accelerate it: v = μ g t up to the speed
    // of the belt.
    let lift = v(0.0, 0.0, 2.0);
    let mut rider = mass_at(Vec3::zeros(), lift);
    for step in 0..100 {
        let start = f64::from(step) * DT;
        rider.advance(&moving(lift), law(0.0, 0.0), 0.0, GRAVITY, start, DT);
    }
    assert!((rider.position - lift * (100.0 * DT)).norm() < 1e-12);

    // μ g Δt divides the speed of the belt, so that no step both slides and sticks.
    let friction = 0.25;
    let belt = v(friction * 9.81 * DT * 40.0, 0.0, 0.0);
    let mut rider = mass_at(Vec3::zeros(), Vec3::zeros());
    let mut impulse = Vec3::zeros();
    for step in 0..100 {
        let start = f64::from(step) * DT;
        impulse += rider.advance(&moving(belt), law(friction, 0.0), 0.0, GRAVITY, start, DT);
    }
    let exact = belt * (20.0 * DT + 60.0 * DT);
    assert!(
        (rider.position - exact).norm() < 1e-10,
        "{}",
        rider.position
    );
    assert!((rider.velocity - belt).norm() < 1e-12);
    assert!((impulse.x - 0.3 * belt.x).abs() < 1e-12);

    // A wall that runs into a mass at rest throws it ahead with (1 + e) times its own speed.
    let wall = RigidMotion {
        pose: Pose::at(v(-1.0, 0.0, 0.0)),
        velocity: v(3.0, 0.0, 0.0),
        ..RigidMotion::default()
    };
    let wall = Obstacle::moving(HalfSpace::new(Vec3::x()).unwrap(), wall).unwrap();
    let mut ball = mass_at(Vec3::zeros(), Vec3::zeros());
    let impulse = ball.advance(&wall, law(0.0, 0.6), 0.0, Vec3::zeros(), 0.0, 1.0);
    assert!((ball.velocity - v(4.8, 0.0, 0.0)).norm() < 1e-13);
    assert!((ball.position - v(4.8 * (1.0 - 1.0 / 3.0), 0.0, 0.0)).norm() < 1e-13);
    assert!((impulse - ball.velocity * 0.3).norm() < 1e-14);
}

#[test]
fn momentum_changes_by_the_impulse_and_by_gravity_alone() {
    let spinning = RigidMotion {
        pose: Pose::at(v(0.1, 0.0, -0.6)).turned(v(0.4, 0.2, 0.0)),
        velocity: v(0.3, 0.0, 0.5),
        angular_velocity: v(1.0, -2.0, 0.5),
    };
    let obstacle = Obstacle::moving(Cuboid::new(v(0.8, 0.7, 0.2)).unwrap(), spinning).unwrap();
    let mut random = Random::new(1);
    let mut touched = 0;
    for _ in 0..300 {
        let mut mass = mass_at(random.point(0.3) + v(0.0, 0.0, 0.4), random.point(0.8));
        for step in 0..60 {
            let before = mass.velocity;
            let start = f64::from(step) * DT;
            let impulse = mass.advance(&obstacle, law(0.3, 0.4), 0.002, GRAVITY, start, DT);
            let change = (mass.velocity - before - GRAVITY * DT) * mass.mass;
            assert!((change - impulse).norm() < 1e-14 * (1.0 + mass.velocity.norm()));
            touched += u32::from(impulse != Vec3::zeros());
            let gap = obstacle.signed_distance(mass.position, start + DT).value;
            assert!(gap > 0.002 - 1e-12, "inside by {gap}");
        }
    }
    assert!(touched > 200, "{touched} impacts");
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
fn discrete_response_moves_vertices_out_and_tells_the_impulse() {
    let motion = RigidMotion {
        velocity: v(0.0, 0.0, 1.0),
        angular_velocity: v(0.0, 0.0, 2.0),
        ..RigidMotion::default()
    };
    let ball = Obstacle::moving(Sphere::new(0.5).unwrap(), motion).unwrap();
    let contacts = ObstacleContacts::new(0.01, 0.0).unwrap();
    let contacts = contacts.with(ball.clone(), law(0.4, 0.2));
    let mut random = Random::new(3);
    let start: Vec<Vec3> = (0..200).map(|_| random.point(0.6)).collect();
    let speeds: Vec<Vec3> = (0..200).map(|_| random.point(2.0)).collect();
    let mut inverse_mass: Vec<Real> = (0..200).map(|_| 1.5 + random.real(1.0)).collect();
    inverse_mass[7] = 0.0;
    let (mut x, mut u) = (start.clone(), speeds.clone());
    let impulse = contacts
        .respond(&mut x, &mut u, &inverse_mass, 0.1)
        .unwrap();
    let mut sum = Vec3::zeros();
    for i in 0..200 {
        if i == 7 {
            assert_eq!((x[i], u[i]), (start[i], speeds[i]));
            continue;
        }
        sum += (u[i] - speeds[i]) / inverse_mass[i];
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
    assert!((sum - impulse).norm() < 1e-12 && sum.norm() > 1.0);

    let mut bad = vec![Vec3::zeros(); 3];
    bad[2].x = f64::NAN;
    let error = contacts.respond(&mut bad, &mut [Vec3::zeros(); 3], &[1.0; 3], 0.0);
    assert!(error.unwrap_err().to_string().contains("vertex 2"));
    let error = contacts.detect(&[Vec3::zeros(); 3], &bad, 0.1, &mut Vec::new());
    assert!(error.unwrap_err().to_string().contains("vertex 2"));
    let error = contacts.detect(&[Vec3::zeros()], &[Vec3::zeros()], 0.0, &mut Vec::new());
    assert!(error.unwrap_err().to_string().contains("time step"));
}

#[test]
fn contacts_are_the_tangent_planes_at_the_end_of_the_step() {
    let motion = RigidMotion {
        velocity: v(0.0, 0.0, 1.5),
        ..RigidMotion::default()
    };
    let rising = Obstacle::moving(HalfSpace::new(Vec3::z()).unwrap(), motion).unwrap();
    let contacts = ObstacleContacts::new(0.01, 0.005).unwrap();
    let contacts = contacts.with(rising, law(0.7, 0.0));
    // Hit on the way; near in the end; far.
    let from = [v(0.0, 0.0, 0.1), v(0.0, 0.0, 0.3), v(0.0, 0.0, 0.5)];
    let to = [v(0.0, 0.0, -0.1), v(0.0, 0.0, 0.164), v(0.0, 0.0, 0.4)];
    let mut out = Vec::new();
    contacts.detect(&from, &to, 0.1, &mut out).unwrap();
    assert_eq!(out.iter().map(|c| c.vertex).collect::<Vec<_>>(), [0, 1]);
    for contact in &out {
        assert!((contact.offset - 0.16).abs() < 1e-14, "{contact:?}");
        assert_eq!(contact.normal, Vec3::z());
        assert_eq!(contact.surface_velocity, v(0.0, 0.0, 1.5));
    }
    let none = ObstacleContacts::new(0.01, 0.0).unwrap();
    none.detect(&from, &to, 0.1, &mut out).unwrap();
    assert!(out.is_empty());
}

/// What is spared a search has no contact.
#[test]
fn contacts_are_those_of_a_search_for_every_vertex_and_obstacle() {
    let mut random = Random::new(5);
    let torus = cloth_core::mesh::generate::torus(12, 8, 0.4, 0.15).unwrap();
    let torus = Obstacle::new(ClosedMesh::new(&torus).unwrap());
    let mut found = 0;
    for _ in 0..100 {
        let mut obstacles = [
            torus.clone(),
            Obstacle::new(Sphere::new(0.2).unwrap()),
            floor(),
        ];
        for obstacle in &mut obstacles {
            let motion = RigidMotion {
                pose: Pose::at(random.point(0.5)).turned(random.point(2.0)),
                velocity: random.point(2.0),
                angular_velocity: random.point(3.0),
            };
            obstacle.set_motion(motion).unwrap();
        }
        let mut contacts = ObstacleContacts::new(0.01, 0.02).unwrap();
        for obstacle in &obstacles {
            contacts = contacts.with(obstacle.clone(), law(0.1, 0.0));
        }
        let from: Vec<Vec3> = (0..50).map(|_| random.point(1.5)).collect();
        let to: Vec<Vec3> = from.iter().map(|x| x + random.point(0.6)).collect();
        let mut expected = Vec::new();
        for (vertex, (a, b)) in from.iter().zip(&to).enumerate() {
            for (number, obstacle) in obstacles.iter().enumerate() {
                let path = VertexPath::straight(*a, *b, 0.2);
                let is_hit = first_contact(obstacle, &path, 0.0, 0.2, 0.01).is_some();
                if is_hit || obstacle.signed_distance(*b, 0.2).value <= 0.03 {
                    expected.push((vertex as u32, number as u32));
                }
            }
        }
        let mut out = Vec::new();
        contacts.detect(&from, &to, 0.2, &mut out).unwrap();
        let pairs: Vec<_> = out.iter().map(|c| (c.vertex, c.obstacle)).collect();
        assert_eq!(pairs, expected);
        found += out.iter().filter(|c| c.obstacle < 2).count();
    }
    assert!(found > 100, "{found}");
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
            let penalty = ObstaclePenalty {
                obstacle,
                law,
                time: 0.0,
            };
            let mut pushed = 0;
            for _ in 0..300 {
                let x = random.point(1.0);
                let at = obstacle.signed_distance(x, 0.0);
                if at.value < 0.02 {
                    continue;
                }
                let mut gradient = [Vec3::zeros()];
                penalty.add_gradient(&[x], &mut gradient);
                let h = 1e-6;
                let energy = |d: Vec3| penalty.value(&[x + d]);
                let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|e| e * h);
                let curved = |e: Vec3| (energy(e) + energy(-e) - 2.0 * energy(Vec3::zeros())).abs();
                if axes.iter().any(|&e| curved(e) > 1e5 * h * h) {
                    continue; // a border between cells or regions
                }
                let differences = Vec3::from(axes.map(|e| (energy(e) - energy(-e)) / (2.0 * h)));
                let error = (differences - gradient[0]).norm();
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
                assert!((scaled - gradient[0]).norm() < 1e-11 * (1.0 + scaled.norm()));
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

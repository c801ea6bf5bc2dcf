//! A point mass among obstacles, against what is known of slopes, bounces and belts.

use cloth_bench::laws::point_mass::PointMass;
use cloth_collide::obstacle::{Cuboid, HalfSpace, Pose, RigidMotion};
use cloth_collide::obstacle::{ImpactLaw, Obstacle};
use cloth_core::math::{Real, Vec3};
use cloth_core::random::SplitMix64;

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
    // A lift, for which the mass has the right speed, and a belt that has to accelerate it: v = μ g t up to the
    // speed of the belt.
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
    let mut random = SplitMix64::new(1);
    let mut point = |size: Real| Vec3::from([0; 3].map(|_| size * random.symmetric()));
    let mut touched = 0;
    for _ in 0..300 {
        let mut mass = mass_at(point(0.3) + v(0.0, 0.0, 0.4), point(0.8));
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

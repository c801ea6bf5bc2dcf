//! What stops a body that the cloth pushes: held vertices, and other bodies.

use crate::rigid_bodies::{body, watch};
use crate::scene_text::{scene, written};
use cloth_core::math::Vec3;
use serde_json::Value;
use std::process::Command;

/// A ball falls on a sheet that is held in all of its vertices: it ends at half of the thickness from it, presses with
/// its weight, and turns no more.
#[test]
fn ball_on_a_sheet_that_is_held_everywhere_rests_on_it() {
    let text = "dt = 0.01\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\ntranslate = [-0.45, -0.42, 0]\n[[pins]]\n\
         box = [[-1, -1, -1], [1, 1, 1]]\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.06\ndensity = 300\n\
         position = [0, 0, 0.2]\n[contact]\nthickness = 4e-3\n";
    let scene = scene("held-everywhere", text);
    let (_, ball) = scene.touch.as_ref().unwrap().free_bodies().next().unwrap();
    let weight = -9.81 * ball.mass();
    for (method, settings) in [
        ("xpbd", &["substeps=20"][..]),
        ("symplectic-euler", &[]),
        ("implicit-euler", &[]),
        ("pd", &[]),
    ] {
        let (mut motion, mut force) = (Vec3::zeros(), 0.0);
        let mut speed = Vec3::zeros();
        // Kinetic and of the weight, over the mass (m²/s²).
        let mut most: f64 = 0.0;
        watch(&scene, method, settings, 60, |moment| {
            motion = body(moment).pose.position;
            speed = body(moment).velocity;
            most = most.max(0.5 * speed.norm_squared() + 9.81 * (motion.z - 0.2));
            force = moment.forces.unwrap().bodies[0].force.z;
        });
        println!("{method}: {motion:?} {speed:?} {force} of {weight}");
        assert!(most < 1e-12, "{method}: {most} J/kg from nowhere");
        let gap = motion.z - 0.06;
        assert!((gap - 2e-3).abs() < 0.03 * 2e-3, "{method}: {gap} m");
        assert!(speed.norm() < 1e-3, "{method}: {speed:?}");
        assert!((force / -weight - 1.0).abs() < 1e-3, "{method}: {force} N");
    }
}

/// Without gravity, far from the cloth: a ball meets one of half its mass head on, and both go on with their common
/// momentum.
#[test]
fn two_balls_keep_their_momentum_and_go_on_together() {
    let text = "dt = 0.01\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [5, 0, 0]\n\
         [[obstacle]]\nshape = \"sphere\"\nradius = 0.1\ndensity = 200\nposition = [-0.3, 0, 0]\nvelocity = [3, 0, 0]\n\
         [[obstacle]]\nshape = \"sphere\"\nradius = 0.1\ndensity = 100\nposition = [0.3, 0, 0]\n";
    let scene = scene("two-balls", text);
    for method in ["xpbd", "implicit-euler"] {
        let (mut first, mut second) = (Vec3::zeros(), Vec3::zeros());
        watch(&scene, method, &[], 40, |moment| {
            let touch = moment.scene.touch.as_ref().unwrap();
            let mut motions = touch.obstacles().map(|obstacle| obstacle.motion().velocity);
            (first, second) = (motions.next().unwrap(), motions.next().unwrap());
        });
        println!("{method}: {first:?} {second:?}");
        let momentum = (first * 2.0 + second) / 6.0 - Vec3::x();
        assert!(momentum.norm() < 1e-9, "{method}: {momentum:?}");
        let apart = (first - second).norm();
        assert!(apart < 1e-2, "{method}: {first:?} {second:?}");
    }
}

/// A box comes down on the border of a sheet, which is held, and a ball and a box on a sheet that lies on a floor: the
/// runs go on to their ends, and no triangle meets another one.
#[test]
fn bodies_on_held_borders_and_on_floors_cross_nothing() {
    let border = "dt = 0.008333333333333333\nsteps = 100\n[[mesh]]\ngenerator = \"grid:25x25:alternating\"\n\
         translate = [-0.5, -0.5, 0]\n[cloth]\ndensity = 0.3\nstiffness = 5e3\n[[pins]]\nselect = \"border\"\n\
         [[obstacle]]\nshape = \"box\"\nsize = [0.2, 0.2, 0.2]\nrotate = [0.2, 0.1, 0]\ndensity = 1000\n\
         position = [0.38, 0.1, 0.3]\n[contact]\nthickness = 4e-3\n";
    let floor = "dt = 0.01\nsteps = 70\n[[mesh]]\ngenerator = \"grid:17x17:alternating\"\nscale = 0.6\n\
         translate = [-0.5, -0.5, 0.02]\n[[obstacle]]\nshape = \"plane\"\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.05\n\
         density = 500\nposition = [-0.2, -0.2, 0.15]\n[[obstacle]]\nshape = \"box\"\nsize = [0.08, 0.08, 0.08]\n\
         density = 500\nrotate = [0.3, 0.2, 0]\nposition = [-0.19, -0.21, 0.3]\n[contact]\nself = true\n";
    for (name, text, methods) in [
        ("border", border, ["symplectic-euler", "implicit-euler"]),
        ("on-a-floor", floor, ["xpbd", "implicit-euler"]),
    ] {
        for method in methods {
            let run = Command::new(env!("CARGO_BIN_EXE_cloth-bench"))
                .arg("run")
                .arg(written(name, text))
                .args(["--method", method, "--watch", "--json"])
                .output()
                .expect("the program runs");
            let said = String::from_utf8_lossy(&run.stderr);
            assert!(run.status.success(), "{name}, {method}: {said}");
            let object: Value = serde_json::from_slice(&run.stdout).unwrap();
            for key in ["most_intersections", "most_obstacle_intersections"] {
                // Cloth that cannot touch itself has none of the first kind to count.
                assert!(
                    object[key].as_u64().unwrap_or(0) == 0,
                    "{name}, {method}: {key}"
                );
            }
        }
    }
}

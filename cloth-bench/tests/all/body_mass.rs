//! Bodies by their mass, their inertia and their centre of mass.

use crate::rigid_bodies::{body, watch};
use crate::scene_text::{scene, written};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_collide::obstacle::RigidBody;
use cloth_core::math::Vec3;
use std::f64::consts::PI;

const SHEET: &str = "dt = 0.01\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\n\
     translate = [0, 0, 50]\n[[obstacle]]\n";

fn rigid(scene: &Scene) -> RigidBody {
    *scene
        .touch
        .as_ref()
        .unwrap()
        .free_bodies()
        .next()
        .unwrap()
        .1
}

#[test]
fn a_mass_is_a_density_times_a_volume() {
    for (name, shape, volume) in [
        (
            "ball",
            "shape = \"sphere\"\nradius = 0.3\n",
            4.0 / 3.0 * PI * 0.027,
        ),
        ("box", "shape = \"box\"\nsize = [0.1, 0.2, 0.4]\n", 0.008),
        (
            "capsule",
            "shape = \"capsule\"\nradius = 0.1\nlength = 0.4\n",
            PI * 0.01 * (0.4 + 4.0 / 3.0 * 0.1),
        ),
    ] {
        let by_density = scene(name, &format!("{SHEET}{shape}density = 50\n"));
        let mass = 50.0 * volume;
        let by_mass = scene(name, &format!("{SHEET}{shape}mass = {mass:?}\n"));
        let [a, b] = [&by_density, &by_mass].map(rigid);
        assert!((a.mass() / b.mass() - 1.0).abs() < 1e-14, "{name}");
        let off = (a.inertia() - b.inertia()).norm() / a.inertia().norm();
        assert!(off < 1e-14, "{name}: {off:e}");
    }
    let mesh = "shape = \"mesh\"\ngenerator = \"sphere:3\"\nscale = 0.4\n";
    let by_mass = rigid(&scene("mesh", &format!("{SHEET}{mesh}mass = 3\n")));
    assert!((by_mass.mass() - 3.0).abs() < 1e-14);
}

/// Without torque the axis of a symmetric top goes around its angular momentum by L/I₁, and keeps its angle to that.
#[test]
fn a_top_precesses_as_fast_as_its_inertia_says() {
    let [across, along] = [2e-3, 3.5e-3];
    let (spin, tilt) = (9.0, 4.0);
    let text = format!(
        "{SHEET}shape = \"sphere\"\nradius = 0.1\nmass = 1\ninertia = [{across}, {across}, {along}]\n\
         angular_velocity = [{tilt:?}, 0, {spin:?}]\n"
    );
    let scene = scene("top", &text);
    let momentum = Vec3::new(across * tilt, 0.0, along * spin);
    let rate = momentum.norm() / across;
    let around = momentum.normalize();
    let (mut worst, mut turned): (f64, f64) = (0.0, 0.0);
    watch(&scene, "xpbd", &[], 60, |moment| {
        let axis = body(moment).pose.orientation * Vec3::z();
        let angle = rate * moment.state.time;
        let turn = nalgebra::Rotation3::from_scaled_axis(around * angle);
        worst = worst.max((axis - turn * Vec3::z()).norm());
        turned = angle;
    });
    assert!(turned > 9.0 && worst < 1e-6, "{worst:e}");
}

/// A body that spins in free fall turns about its centre of mass, which falls as all do, wherever its middle is.
#[test]
fn a_body_turns_about_its_centre_of_mass() {
    const CENTRE: [f64; 3] = [0.05, -0.02, 0.03];
    let turn =
        "rotate = [0.3, 0.2, -0.5]\nvelocity = [0.1, 0.2, 0.4]\nangular_velocity = [0, 0, 6]\n";
    for (name, shape) in [
        ("loaded-ball", "shape = \"sphere\"\nradius = 0.1\n"),
        (
            "loaded-mesh",
            "shape = \"mesh\"\ngenerator = \"sphere:5\"\nscale = 0.2\n",
        ),
    ] {
        let text = format!(
            "{SHEET}{shape}{turn}mass = 2\ninertia = [0.01, 0.01, 0.01]\ncentre = {CENTRE:?}\n"
        )
        .replace("gravity = [0, 0, 0]", "gravity = [0, 0, -9.81]");
        let scene = scene(name, &text);
        let start = nalgebra::Rotation3::new(Vec3::new(0.3, 0.2, -0.5));
        let centre = Vec3::from(CENTRE);
        let first = start * centre;
        let mut worst: f64 = 0.0;
        watch(&scene, "xpbd", &[], 30, |moment| {
            let time = moment.state.time;
            let fallen = Vec3::new(0.1, 0.2, 0.4) * time - Vec3::z() * (0.5 * 9.81 * time * time);
            let turned = nalgebra::Rotation3::new(Vec3::z() * (6.0 * time)) * start;
            let middle = first + fallen - turned * centre;
            let (surface, _) = moment.scene.obstacle_surfaces(time).remove(0);
            let mean = surface.iter().sum::<Vec3>() / surface.len() as f64;
            worst = worst.max((mean - middle).norm());
            // Contact sees the ball there too.
            let obstacle = moment
                .scene
                .touch
                .as_ref()
                .unwrap()
                .obstacles()
                .next()
                .unwrap();
            let probe = middle + Vec3::new(0.0, 0.4, 0.3);
            let clearance = obstacle.signed_distance(probe, time).value;
            worst =
                worst.max((clearance - 0.4).abs() - if name == "loaded-ball" { 0.0 } else { 2e-3 });
        });
        // Symplectic Euler falls by g t Δt/2 too far.
        assert!(worst < 0.5 * 9.81 * 0.3 * 0.01, "{name}: {worst:e}");
    }
}

/// A ball that is pushed off its centre of mass begins to turn: J ω = r × p, with the impulse p of the sheet that hits
/// it.
#[test]
fn an_impulse_beside_the_centre_of_mass_turns_a_body() {
    let text = "dt = 0.005\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\nscale = 0.2\n\
         translate = [-0.1, -0.1, 0.12]\n[start]\nvelocity = [0, 0, -2]\n[contact]\nfriction = 0\n\
         [[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nmass = 0.5\ninertia = [0.004, 0.004, 0.004]\n\
         centre = [0.03, 0, 0]\n";
    let scene = scene("pushed", text);
    let mut end = None;
    watch(
        &scene,
        "implicit-euler",
        &["tolerance=1e-8"],
        40,
        |moment| {
            end = Some(body(moment));
        },
    );
    let end = end.unwrap();
    // Without friction every force goes through the middle, 3 cm beside the centre of mass.
    let impulse = end.velocity * 0.5;
    assert!(impulse.z < -1e-3, "{impulse}");
    let expected = 0.03 * impulse.z / 0.004;
    let error = (end.angular_velocity.y / expected - 1.0).abs();
    assert!(error < 0.02, "{} {expected}", end.angular_velocity.y);
}

#[test]
fn what_is_wrong_with_the_mass_of_a_body_is_said_with_its_line() {
    let ball = "shape = \"sphere\"\nradius = 0.1\n";
    for (name, more, line, words) in [
        (
            "both",
            "density = 3\nmass = 3\n",
            10,
            "a density is given too",
        ),
        (
            "alone",
            "inertia = [1, 1, 1]\n",
            9,
            "inertia has no meaning without a mass or a density",
        ),
        (
            "middle",
            "centre = [1, 1, 1]\n",
            9,
            "centre has no meaning without a mass or a density",
        ),
        (
            "long",
            "mass = 1\ninertia = [1, 1, 2.5]\n",
            10,
            "more than the other two together",
        ),
        (
            "minus",
            "mass = 1\ninertia = [1, 1, -1]\n",
            10,
            "inertia is `[1, 1, -1]`",
        ),
        (
            "off",
            "mass = 1\n[contact]\ncontact = \"none\"\n",
            9,
            "mass has no meaning with contact=none",
        ),
    ] {
        let path = written(name, &format!("{SHEET}{ball}{more}"));
        let said = file::build(&path, &Settings::default())
            .unwrap_err()
            .to_string();
        let place = format!("{name}.toml: line {line}: ");
        assert!(said.contains(&place) && said.contains(words), "{said}");
    }
    let plane = written(
        "plane-mass",
        &format!("{SHEET}shape = \"plane\"\nmass = 1\n"),
    );
    let said = file::build(&plane, &Settings::default())
        .unwrap_err()
        .to_string();
    assert!(
        said.contains("line 8") && said.contains("a plane has no end"),
        "{said}"
    );
}

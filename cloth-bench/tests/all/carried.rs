//! Pins that go with a body: `obstacle` of `[[pins]]`.

use crate::animations::shapes;
use crate::rigid_bodies::{body, watch};
use crate::scene_text::{scene, written};
use cloth_bench::scene::file;
use cloth_bench::settings::Settings;
use cloth_collide::obstacle::Pose;
use cloth_core::math::Vec3;

/// A sheet whose corners a box takes along from 0.1 to 0.4 s; the box is driven otherwise at 0.25 s.
const GRIPPED: &str = "dt = 0.01\n[[mesh]]\ngenerator = \"grid:7x7:alternating\"\nscale = 0.2\n\
    [[obstacle]]\nshape = \"box\"\nsize = [0.3, 0.05, 0.05]\nposition = [0.1, 0.23, 0.1]\n\
    velocity = [0.1, 0, 0.2]\nangular_velocity = [0, 1, 2]\n\
    [[event]]\ntime = 0.25\ndo = \"drive\"\nobstacle = 0\nvelocity = [0, 0, -0.1]\nangular_velocity = [1, 0, 0]\n\
    [[pins]]\nselect = \"corners\"\nobstacle = 0\nfrom = 0.1\nuntil = 0.4\n\
    [[pins]]\nvertices = [0]\n";

/// In the frame of the box they do not move, until they are released.
#[test]
fn pins_go_with_a_body_that_is_driven() {
    let scene = scene("gripped", GRIPPED);
    for method in ["symplectic-euler", "implicit-euler", "pd", "xpbd"] {
        let local = |pose: &Pose, x: &[Vec3]| [42, 48].map(|v: usize| pose.to_local(x[v]));
        let mut held = [Vec3::zeros(); 2];
        watch(&scene, method, &[], 60, |moment| {
            let (pose, x) = (body(moment).pose, &moment.state.positions);
            match moment.step {
                10 => held = local(&pose, x),
                11..=40 => {
                    let moved = (local(&pose, x)[1] - held[1]).norm();
                    assert!(moved < 1e-12, "{method}, step {}: {moved:e} m", moment.step);
                }
                60 => {
                    let moved = (local(&pose, x)[1] - held[1]).norm();
                    assert!(moved > 0.05, "{method}, not released: {moved:e} m");
                }
                _ => {}
            }
        });
    }
}

/// A triangle that turns about the vertical by 0.2 rad every 0.1 s takes the whole border of a sheet along: at every
/// shape it is where a rigid motion takes it.
#[test]
fn pins_go_with_a_surface_that_changes_its_shape() {
    let pose = |k: f64| Pose::at(Vec3::z() * (0.05 * k)).turned(Vec3::z() * (0.2 * k));
    let corners = |k: usize| {
        let corners = [[-1.0, -1.0, 0.0], [2.0, -1.0, 0.0], [-1.0, 2.0, 0.0]];
        corners.map(|x| pose(k as f64).to_world(Vec3::from(x)).into())
    };
    let names: Vec<String> = (0..6).map(|k| format!("{k}.obj")).collect();
    let files: Vec<(&str, _)> = names
        .iter()
        .enumerate()
        .map(|(k, name)| (name.as_str(), corners(k)))
        .collect();
    shapes("turning", &files);
    let scene = scene(
        "turning-pins",
        "dt = 0.05\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.4\n\
         translate = [0, 0, 0.01]\n[[obstacle]]\nshape = \"animation\"\nfolder = \"turning\"\ninterval = 0.1\n\
         [[pins]]\nselect = \"border\"\nobstacle = 0\n",
    );
    for method in ["implicit-euler", "xpbd"] {
        watch(&scene, method, &[], 10, |moment| {
            let shape = moment.step as f64 / 2.0;
            if shape.fract() > 0.0 {
                return;
            }
            let held = scene.model.particles.inverse_mass().iter();
            let held = held
                .zip(&moment.state.positions)
                .zip(&scene.start.positions);
            let held: Vec<_> = held.filter(|((w, _), _)| **w == 0.0).collect();
            assert_eq!(held.len(), 16);
            for ((_, x), start) in held {
                let error = (x - pose(shape).to_world(*start)).norm();
                assert!(error < 1e-12, "{method}, shape {shape}: {error:e} m");
            }
        });
    }
}

#[test]
fn what_cannot_take_pins_along_is_refused() {
    for (from, to, words) in [
        (
            "obstacle = 0\nfrom",
            "obstacle = 1\nfrom",
            "there is no obstacle 1, only 0",
        ),
        (
            "obstacle = 0\nfrom",
            "obstacle = 0\nturn = [0, 0, 1]\nfrom",
            "turn has no meaning with an obstacle",
        ),
        (
            "obstacle = 0\nfrom",
            "obstacle = 0\nstiffness = 10\nfrom",
            "stiffness has no meaning with an obstacle",
        ),
        (
            "[[pins]]\nvertices = [0]",
            "[[pins]]\nselect = \"corners\"\nmove = [1, 0, 0]",
            "held at the same time",
        ),
    ] {
        assert!(GRIPPED.contains(from), "{from}");
        let text = written("carried-wrong", &GRIPPED.replacen(from, to, 1));
        let error = file::build(&text, &Settings::default())
            .unwrap_err()
            .to_string();
        assert!(error.contains(words), "{error}");
    }
    let free = "[[mesh]]\ngenerator = \"grid:7x7:alternating\"\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\n\
        density = 100\nposition = [0, 0, -1]\n[[pins]]\nselect = \"corners\"\nobstacle = 0\n";
    let error = file::build(&written("carried-free", free), &Settings::default()).unwrap_err();
    assert!(
        error.to_string().contains("obstacle 0 has a mass"),
        "{error}"
    );
}

/// It would leave them behind; who wants that releases and grabs them.
#[test]
fn a_drag_of_what_a_body_takes_along_is_refused() {
    let text = |events: &str| {
        format!(
            "[[mesh]]\ngenerator = \"grid:7x7:alternating\"\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\n\
             position = [0, 0, -1]\n[[pins]]\nselect = \"corners\"\nobstacle = 0\n{events}"
        )
    };
    let event =
        |deed: &str| format!("[[event]]\ntime = 0.5\ndo = \"{deed}\"\nselect = \"corners\"\n");
    let drag = event("drag") + "move = [0, 0, 1]\n";
    let path = written("carried-dragged", &text(&drag));
    let error = file::build(&path, &Settings::default()).unwrap_err();
    let (error, words) = (
        error.to_string(),
        "line 10: [[event]]: at 0.5 s vertex 42 goes with obstacle 0",
    );
    assert!(error.contains(words), "{error}");
    let released = [event("release"), event("grab"), drag].concat();
    scene("carried-regrabbed", &text(&released));
}

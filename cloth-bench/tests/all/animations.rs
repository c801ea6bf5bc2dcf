//! Bodies that change their shape: `shape = "animation"` of scene files.

use crate::scene_text::{scene, written};
use cloth_bench::method::Method;
use cloth_bench::run::{Plan, SeparationWatch, Solver, Summary, Watched, run_changing};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::mesh::obj;

/// A folder of shapes of one triangle, beside the scene files of this program.
pub(crate) fn shapes(name: &str, files: &[(&str, [[f64; 3]; 3])]) {
    let folder = written(name, "").with_extension("");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    for (file, corners) in files {
        let text = obj::format(&corners.map(Vec3::from), &[[0, 1, 2]]);
        std::fs::write(folder.join(file), text).unwrap();
    }
}

/// A flat sheet of 1 m at the height of 1 m in no gravity, and an animation with a shape every 0.1 s.
fn above(name: &str, more: &str) -> Scene {
    scene(name, &text(name, more))
}

fn text(name: &str, more: &str) -> String {
    format!(
        "dt = 0.01\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\n\
         translate = [0, 0, 1]\n[[obstacle]]\nshape = \"animation\"\nfolder = \"{name}\"\ninterval = 0.1\n{more}"
    )
}

/// What a run and a look after every step tell.
fn watched(scene: &Scene, steps: u32) -> (Summary, Watched) {
    let mut watch = SeparationWatch::new(scene).unwrap();
    let (method, settings) = (Method::find("xpbd").unwrap(), Settings::default());
    let mut solver = Solver::new(method, &settings, scene, scene.dt).unwrap();
    let mut state = scene.start.clone();
    let plan = Plan::new(scene.dt, steps);
    let (summary, _) = run_changing(scene, &mut solver, &mut state, plan, |moment| {
        watch.look(moment.scene, moment.state)
    })
    .unwrap();
    (summary, watch.seen())
}

/// A triangle whose edge is at x = 1.5 comes up to the height of 0.5, passes, and goes down again: a corner of the
/// sheet, at x = 1, is nearest to it.
#[test]
fn clearance_is_the_distance_from_the_triangles() {
    let at = |z: f64| [[1.5, -1.0, z], [3.0, 0.5, z], [1.5, 2.0, z]];
    let files = [("0.obj", at(-1.0)), ("1.obj", at(0.5)), ("2.obj", at(-0.5))];
    shapes("beside", &files);
    let alone = above("beside", "");
    let (end, seen) = watched(&alone, 15);
    // At 0.15 s the triangle is at the height of 0, and the nearest it came was at 0.1 s.
    let close = |found: Option<f64>, expected: f64| {
        let found = found.expect("a distance");
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    };
    close(end.min_clearance, 0.5_f64.hypot(1.0));
    close(seen.min_clearance, 0.5_f64.hypot(0.5));
    // A rigid body that is nearer, and one that is not.
    for (height, expected) in [(1.5, 0.25), (5.0, 0.5_f64.hypot(1.0))] {
        let ball = format!(
            "[[obstacle]]\nshape = \"sphere\"\nradius = 0.25\nposition = [0.5, 0.5, {height}]\n"
        );
        let (end, _) = watched(&above("beside", &ball), 15);
        close(end.min_clearance, expected);
    }
}

/// Shape k, at the height k, is the file of the k-th of these names, and written in another order.
#[test]
fn shapes_come_in_the_order_of_the_numbers_in_their_names() {
    let in_order = [
        "1.obj",
        "2.obj",
        "010.obj",
        "11-b.obj",
        "100000000000000000000000000001.obj",
        "body9_walk2.obj",
        "body9_walk10.obj",
        "body10_walk1.obj",
    ];
    let at = |k: usize| {
        let z = k as f64;
        [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]]
    };
    let mut files: Vec<_> = (0..in_order.len()).map(|k| (in_order[k], at(k))).collect();
    files.sort_by_key(|(name, _)| name.len());
    files.reverse();
    shapes("natural", &files);
    let scene = above("natural", "");
    for (k, name) in in_order.iter().enumerate() {
        let surfaces = scene.obstacle_surfaces(0.1 * k as f64);
        let height = surfaces[0].0[0].z;
        assert!((height - k as f64).abs() < 1e-12, "{name}: {height}");
    }
}

/// Frames a second in the place of the time between two of them.
#[test]
fn intervals_of_seconds_are_told() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    shapes("slow", &[("0.obj", corners), ("1.obj", corners)]);
    let slow = text("slow", "").replace("interval = 0.1", "interval = 24");
    let hints = scene("slow-frames", &slow).hints;
    let words = "slow-frames.toml: line 9: interval is 24 s from one shape to the next";
    assert!(hints.iter().any(|hint| hint.contains(words)), "{hints:?}");
    let hints = above("slow", "").hints;
    assert!(
        !hints.iter().any(|hint| hint.contains("interval")),
        "{hints:?}"
    );
}

/// Each of these folders has a file without a place among the others, which the error names.
#[test]
fn files_without_a_place_in_the_order_are_refused() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for (files, words) in [
        (
            &["1.obj", "2.obj", "rest.obj"][..],
            &["`rest.obj`", "`1.obj`"][..],
        ),
        (&["01.obj", "1.obj", "2.obj"], &["`01.obj` and `1.obj`"]),
        (&["walk_1.obj", "walk_01.obj"], &["`walk_1.obj`"]),
        (&[], &["folder `unordered`", "no OBJ or PLY file"]),
        (&["a.obj", "b.obj"], &[]),
    ] {
        let files: Vec<_> = files.iter().map(|&file| (file, corners)).collect();
        shapes("unordered", &files);
        let path = written("unordered", &text("unordered", ""));
        let built = file::build(&path, &Settings::default());
        match (built, words) {
            (Ok(_), []) => {}
            (Ok(_), _) => panic!("{files:?}"),
            (Err(error), words) => {
                let told = error.to_string();
                let all = [&["unordered.toml: line 8: "], words].concat();
                assert!(all.iter().all(|word| told.contains(word)), "{told}");
            }
        }
    }
}

//! Cloth that comes to rest above a concave edge of a body.

use crate::scene_text::scene;
use cloth_bench::method::Method;
use cloth_bench::run::from_start;
use cloth_bench::settings::Settings;
use std::path::PathBuf;

/// A block with a groove of 90°, 0.12 m deep, along y.
fn write_groove() {
    let section = [
        [-0.25, -0.2],
        [0.25, -0.2],
        [0.25, 0.0],
        [0.12, 0.0],
        [0.0, -0.12],
        [-0.12, 0.0],
        [-0.25, 0.0],
    ];
    let mut text = String::new();
    for y in [-0.25, 0.25] {
        for [x, z] in section {
            text += &format!("v {x} {y} {z}\n");
        }
    }
    for [a, b, c] in [[1, 2, 5], [2, 3, 4], [2, 4, 5], [1, 5, 6], [1, 6, 7]] {
        text += &format!("f {a} {b} {c}\nf {} {} {}\n", 7 + a, 7 + c, 7 + b);
    }
    for a in 1..=7 {
        let b = a % 7 + 1;
        text += &format!("f {a} {} {}\nf {a} {} {b}\n", 7 + a, 7 + b, 7 + b);
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_CRATE_NAME"));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("groove.obj"), text).unwrap();
}

/// The middle row of a sheet falls to the bottom of the groove, where both sides are nearest. By the distance from the
/// nearest one alone 14 of these 24 steps ended at their 4000 iterations.
#[test]
fn implicit_steps_end_where_two_sides_of_a_body_are_nearest() {
    write_groove();
    let scene = scene(
        "groove",
        "dt = 0.0166\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\nscale = 0.4\n\
         translate = [-0.2, -0.2, 0.01]\n[cloth]\nstiffness = 2000\nrigidity = 1e-6\n\
         [[obstacle]]\nshape = \"mesh\"\nfile = \"groove.obj\"\n[contact]\nself = true\nfriction = 0.1\n",
    );
    for method in ["implicit-euler", "bdf2"] {
        let method = Method::find(method).unwrap();
        let settings = Settings::default();
        let ran = from_start(&scene, method, &settings, scene.dt, 24, |_, _, _| Ok(()));
        let (summary, _) = ran.unwrap();
        assert_eq!(summary.unfinished_steps, 0, "{}", method.name);
        let iterations = summary.iterations;
        assert!(iterations < 2000, "{}: {iterations}", method.name);
    }
}

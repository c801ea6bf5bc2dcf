//! An obstacle whose signed distance is looked up in a grid.

use cloth_bench::method::Method;
use cloth_bench::run::from_start;
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use std::path::PathBuf;

/// A box of 0.6 m × 0.6 m × 0.2 m, its top at z = 0.1 m.
fn box_file() -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let side = |axis: usize, half: f64| if corner >> axis & 1 == 1 { half } else { -half };
        text += &format!("v {} {} {}\n", side(0, 0.3), side(1, 0.3), side(2, 0.1));
    }
    for [a, b, c, d] in [
        [1, 3, 4, 2],
        [5, 6, 8, 7],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 5, 7, 3],
        [2, 4, 8, 6],
    ] {
        text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    text
}

fn read(name: &str, obstacle: &str) -> Result<Scene, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("sampled");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("box.obj"), box_file()).unwrap();
    let path = folder.join(format!("{name}.toml"));
    let text = format!(
        "dt = 0.01\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\nscale = 0.3\n\
         translate = [-0.15, -0.15, 0.102]\n[[obstacle]]\n{obstacle}"
    );
    std::fs::write(&path, text).unwrap();
    file::build(&path, &Settings::default()).map_err(|error| error.to_string())
}

/// On a flat side interpolation is exact, whatever the spacing: a sheet rests where its weight presses it,
/// h − ρ g/κ above it.
#[test]
fn sheet_rests_on_a_sampled_box_as_on_the_box() {
    let height = 0.1 + 2e-3 - 0.2 * 9.81 / 1e6;
    for spacing in ["", "sampled = 0.03\n", "sampled = 0.007\n"] {
        let obstacle = format!("shape = \"mesh\"\nfile = \"box.obj\"\n{spacing}");
        let scene = read("box", &obstacle).unwrap();
        for (method, setting, bound) in [
            ("implicit-euler", "tolerance=1e-8", 1e-7),
            ("xpbd", "substeps=10", 1e-6),
        ] {
            let method = Method::find(method).unwrap();
            let settings = Settings::parse(&[setting]).unwrap();
            let ran = from_start(&scene, method, &settings, scene.dt, 60, |_, _, _| Ok(()));
            let (summary, end) = ran.unwrap();
            assert_eq!(summary.obstacle_intersections, Some(0));
            for x in &end.positions {
                let off = (x.z - height).abs();
                assert!(off < bound, "{} {spacing:?}: {off} m off", method.name);
            }
        }
    }
}

#[test]
fn grids_that_cannot_be_are_refused() {
    for (name, obstacle, line, words) in [
        (
            "fine",
            "shape = \"mesh\"\nfile = \"box.obj\"\nsampled = 1e-6\n",
            9,
            "samples",
        ),
        (
            "zero",
            "shape = \"mesh\"\nfile = \"box.obj\"\nsampled = 0\n",
            9,
            "sampled is `0`",
        ),
        (
            "ball",
            "shape = \"sphere\"\nradius = 0.1\nsampled = 0.01\n",
            9,
            "sampled has no meaning for this shape",
        ),
    ] {
        let said = read(name, obstacle).unwrap_err();
        let place = format!("{name}.toml: line {line}: ");
        assert!(said.contains(&place) && said.contains(words), "{said}");
    }
}

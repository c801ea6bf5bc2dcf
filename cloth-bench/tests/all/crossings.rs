//! Crossings that a run makes are counted, and said.

use crate::animations::shapes;
use crate::program::program;
use crate::scene_text::written;
use serde_json::Value;

const SHEET: &str = "dt = 0.01\ngravity = [0, 0, 0]\n[contact]\ncontact = \"none\"\n\
                     [[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [0, 0, 1]\n";

/// What a run of a scene of this text prints, and its warnings.
fn run(name: &str, text: &str, steps: u32, more: &[&str]) -> (Value, Vec<String>) {
    let (path, steps) = (written(name, text), steps.to_string());
    let mut arguments = vec!["run", path.to_str().unwrap(), "--method", "xpbd"];
    arguments.extend(["--json", "--steps", &steps]);
    arguments.extend(more);
    let output = program(&arguments);
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{told}");
    let warnings = told.lines().filter_map(|l| l.strip_prefix("warning: "));
    let warnings = warnings.map(str::to_owned).collect();
    (serde_json::from_slice(&output.stdout).unwrap(), warnings)
}

/// A narrow triangle of 0.5 m goes up by 0.21 m a step from 1 m below 0, and jumps down after ten steps: it is in one
/// triangle of the sheet, at the height of 1 m, after steps 8 and 9.
#[test]
fn crossings_with_a_body_are_counted_and_said() {
    let at = |z: f64| [[0.2, 0.1, z], [0.21, 0.1, z], [0.2, 0.1, z + 0.5]];
    shapes("needle", &[("0.obj", at(-1.0)), ("1.obj", at(1.1))]);
    let text = format!(
        "{SHEET}[[obstacle]]\nshape = \"animation\"\nfolder = \"needle\"\ninterval = 0.1\n"
    );
    let why = "; nothing is touched in this scene";
    let through =
        "the cloth has passed through a body: crossing pairs of triangles were 0 at the start";
    let (told, warnings) = run("needle-end", &text, 9, &[]);
    assert_eq!(told["obstacle_intersections"], 1);
    assert_eq!(told["obstacle_crossed_steps"], Value::Null);
    assert_eq!(warnings, [format!("{through}, 1 at the end{why}")]);
    // What comes and goes is seen by those who look.
    let (told, warnings) = run("needle-gone", &text, 12, &[]);
    assert_eq!(told["obstacle_intersections"], 0);
    assert!(warnings.is_empty(), "{warnings:?}");
    let (told, warnings) = run("needle-seen", &text, 12, &["--watch"]);
    let counts = ["crossed_steps", "obstacle_crossed_steps"].map(|key| told[key].as_u64());
    assert_eq!(counts, [Some(0), Some(2)]);
    assert_eq!(
        warnings,
        [format!(
            "{through}, 0 at the end, and 1 at most, in 2 of 12 steps{why}"
        )]
    );
}

/// Two triangles of a narrow upright sheet that is held and goes up by 1 m in ten steps through one triangle of the
/// other; or that is in it from the start.
#[test]
fn crossings_of_the_cloth_with_itself_are_counted_and_said() {
    let narrow = |z: f64, way: f64| {
        format!(
            "{SHEET}[[mesh]]\ngenerator = \"grid:2x2:one-way\"\nscale = [0.01, 0.5, 1]\n\
             rotate = [1.5707963267948966, 0, 0]\ntranslate = [0.2, 0.1, {z}]\n\
             [[pins]]\nvertices = [9, 10, 11, 12]\nmove = [0, 0, {way}]\nduration = 0.1\n"
        )
    };
    let (told, warnings) = run("narrow", &narrow(0.22, 0.5), 10, &["--watch"]);
    assert_eq!(told["intersections"], 2);
    assert_eq!(
        warnings,
        [
            "the cloth has passed through itself: crossing pairs of triangles were 0 at the start, 2 at the end, \
          and 2 at most, in 5 of 10 steps; nothing is touched in this scene"
        ]
    );
    let (told, warnings) = run("narrow-start", &narrow(0.7, 0.01), 10, &["--watch"]);
    assert_eq!(told["crossed_steps"], 10);
    assert!(warnings.is_empty(), "{warnings:?}");
}

/// A sheet that falls onto a ball whose distance is known at three points across: it is off by more than the thickness,
/// but the triangles of the ball keep the cloth out all the same. (It used to end with crossings, or in an error.)
#[test]
fn nothing_crosses_a_body_that_is_sampled_too_coarsely() {
    for spacing in ["0.05", "0.1"] {
        let text = format!(
            "dt = 0.01\n[[mesh]]\ngenerator = \"grid:17x17:alternating\"\nscale = 0.4\n\
             translate = [-0.17, -0.23, 0.13]\n[contact]\nself = true\n[[obstacle]]\nshape = \"mesh\"\n\
             generator = \"sphere:1\"\nscale = 0.1\nsampled = {spacing}\n"
        );
        let (told, warnings) = run("sampled-coarsely", &text, 30, &["--watch"]);
        assert_eq!(told["most_obstacle_intersections"], 0, "{spacing}");
        assert!(warnings.is_empty(), "{warnings:?}");
        // It has landed: in free fall it would have come down by 0.46 m.
        let fall = told["center_of_mass_drop"].as_f64().unwrap();
        assert!((0.15..0.2).contains(&fall), "{fall}");
    }
}

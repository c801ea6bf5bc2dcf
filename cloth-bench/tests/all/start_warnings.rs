//! What is said of scenes that can run and do nothing sensible, or that say two things at once.

use crate::program::program;
use crate::scene_text::written;

/// What a run of one step says on a scene, and its exit code.
fn told(name: &str, scene: &str, more: &[&str]) -> (i32, String) {
    let path = written(name, scene);
    let arguments = ["run", path.to_str().unwrap(), "--steps", "1", "--method"];
    let output = program(&[&arguments[..], more].concat());
    let said = String::from_utf8(output.stderr).unwrap();
    (output.status.code().unwrap(), said)
}

const SHEET: &str = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n";

/// Two motions of one vertex cannot both be; two tables that agree can.
#[test]
fn two_motions_of_one_vertex_are_refused() {
    let pins = |motion: &str| format!("[[pins]]\nselect = \"corners\"\n{motion}\n");
    for (second, is_refused) in [
        ("move = [1, 0, 0]", true),
        ("", true),
        ("move = [0, 0, 1]", false),
    ] {
        let scene = [SHEET, &pins("move = [0, 0, 1]"), &pins(second)].concat();
        let (code, said) = told("two-motions", &scene, &["implicit-euler"]);
        assert_eq!(code, if is_refused { 2 } else { 0 }, "{said}");
        for line in ["line 3", "line 6"] {
            assert_eq!(said.contains(line), is_refused, "{said}");
        }
    }
}

#[test]
fn cloth_that_is_held_as_a_whole_is_told() {
    let scene = format!("{SHEET}[[pins]]\nselect = \"highest\"\n");
    let (code, said) = told("all-held", &scene, &["implicit-euler"]);
    assert_eq!(code, 0);
    assert!(said.contains("all vertices are held, for ever"), "{said}");
}

/// A ball that starts in a box hangs there; beside it, it falls.
#[test]
fn free_body_in_another_is_told() {
    let scene = |height: f64| {
        format!(
            "{SHEET}translate = [0, 0, 3]\n\
             [[obstacle]]\nshape = \"sphere\"\nradius = 0.3\nmass = 1\nposition = [0, 0, {height}]\n\
             [[obstacle]]\nshape = \"box\"\nsize = [1, 1, 1]\n"
        )
    };
    let (_, said) = told("ball-in-box", &scene(0.6), &["implicit-euler"]);
    // At its lowest vertex, 0.2 m below the top.
    let words = "obstacle 1 (sphere), which the cloth can push, starts in obstacle 2 (box), 2.000e-1 m deep";
    assert!(said.contains(words), "{said}");
    let (_, said) = told("ball-on-box", &scene(0.8), &["implicit-euler"]);
    assert!(!said.contains("starts in"), "{said}");
}

/// Who asks for elements that a method cannot take hears which it can.
#[test]
fn elements_that_fit_are_named() {
    for (key, instead) in [
        ("membrane=stvk", "membrane=arap"),
        ("bending=cubic", "bending=quadratic"),
    ] {
        let (code, said) = told("sheet", SHEET, &["pd", "--set", key]);
        assert_eq!(code, 2);
        assert!(said.contains(&format!("; {instead} has one")), "{said}");
    }
}

/// PBD gains energy by itself, which is said where it does.
#[test]
fn energy_of_pbd_is_said_to_be_its_own() {
    let strip = r#"
steps = 60
[[mesh]]
generator = "grid:5x41:alternating"
scale = [0.1, 0.1, 1]
rotate = [1.5707963267948966, 0, 0]
[[pins]]
select = "highest"
"#;
    let path = written("pbd-strip", strip);
    let fall = |method: &str| {
        let output = program(&["run", path.to_str().unwrap(), "--json", "--method", method]);
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        (told["center_of_mass_drop"].as_f64().unwrap(), said)
    };
    let ((pbd, said), (expected, _)) = (fall("pbd"), fall("implicit-euler"));
    assert!(said.contains("that is pbd's own"), "{said}");
    // By its default; the figure in the list of methods and in the README.
    let ratio = pbd / expected;
    assert!((26.0..28.0).contains(&ratio), "{ratio}");
}

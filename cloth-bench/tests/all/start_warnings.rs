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
    let words = "obstacle 0 (sphere), which the cloth can push, starts in obstacle 1 (box), 2.000e-1 m deep";
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

/// What a run of one step says on a sheet with these tables, and whether it says what `word` begins.
fn says(name: &str, scene: &str, word: &str) -> bool {
    let (code, said) = told(name, scene, &["implicit-euler"]);
    assert_eq!(code, 0, "{said}");
    said.contains(word)
}

/// Each with the largest number that is left alone, and a smaller one that is not.
#[test]
fn numbers_in_other_units_are_told() {
    let held = format!("{SHEET}[[pins]]\nselect = \"corners\"\n");
    let cloth = |key: &str| format!("{held}[cloth]\n{key}\n");
    for (sound, wrong, word) in [
        (
            "density = 20",
            "density = 20.5",
            "density = 20.5 kg/m² is that of no cloth",
        ),
        (
            "stiffness = 1e7",
            "stiffness = 1.5e7",
            "stiffness = 1.5e7 N/m is that of no cloth",
        ),
        (
            "modulus = 1e7",
            "modulus = 2e7",
            "modulus = 2e7 N/m is that of no cloth",
        ),
    ] {
        assert!(!says("sound-unit", &cloth(sound), "is that of no cloth"));
        assert!(says("wrong-unit", &cloth(wrong), word));
    }
    let turned =
        |angle: f64| format!("{SHEET}rotate = [0, {angle}, 0]\n[[pins]]\nselect = \"corners\"\n");
    assert!(!says("turned-once", &turned(-6.2), "rotate"));
    assert!(says(
        "turned-often",
        &turned(90.0),
        "line 1: [[mesh]]: rotate is by 90 rad"
    ));
    let ball = |radius: f64| {
        format!(
            "{held}[[obstacle]]\nshape = \"sphere\"\nposition = [0, 0, -1]\nradius = {radius}\n"
        )
    };
    assert!(!says(
        "small-ball",
        &ball(0.004),
        "all lengths are in metres"
    ));
    assert!(says("tiny-ball", &ball(0.001), "all lengths are in metres"));
    let large = |scale: u32| format!("{SHEET}scale = {scale}\n[[pins]]\nselect = \"corners\"\n");
    assert!(!says("large-cloth", &large(140), "lengths are in metres"));
    assert!(says(
        "larger-cloth",
        &large(142),
        "m across: lengths are in metres"
    ));
    // A file more often is in other units than a generator.
    let path = written("large-file", "").with_extension("obj");
    std::fs::write(&path, "v 0 0 0\nv 12 0 0\nv 0 16 0\nf 1 2 3\n").unwrap();
    let file = |scale: &str| {
        format!("[[mesh]]\nfile = {path:?}\nscale = {scale}\n[[pins]]\nselect = \"corners\"\n")
    };
    let across = "the cloth of the file is 21 m across: lengths are in metres (scale = 0.01 makes";
    assert!(!says(
        "cloth-of-a-file",
        &file("0.99"),
        "lengths are in metres"
    ));
    assert!(says("large-cloth-of-a-file", &file("1.05"), across));
    let small = |scale: &str| format!("{SHEET}scale = {scale}\n[[pins]]\nselect = \"corners\"\n");
    let across = "the cloth is 0.85 mm across: lengths are in metres";
    assert!(says("small-cloth", &small("6e-4"), across));
    assert!(!says("hand-width", &small("4e-3"), "lengths are in metres"));
    let pulled = |down: f64| format!("gravity = [0, 0, -{down}]\n{held}");
    assert!(says(
        "gravity-in-mm",
        &pulled(9810.0),
        "gravity is 9810 m/s²"
    ));
    assert!(!says("strong-gravity", &pulled(99.0), "gravity is"));
    let slow = |dt: &str| format!("dt = {dt}\n{held}");
    assert!(!says("long-step", &slow("0.5"), "dt is in seconds"));
    assert!(says("longer-step", &slow("16"), "dt = 16 s is longer"));
}

#[test]
fn events_after_the_end_and_free_falls_are_told() {
    let event = |time: f64| {
        format!(
            "steps = 60\n{SHEET}[[pins]]\nselect = \"corners\"\n[[event]]\ntime = {time}\ndo = \"release\"\n\
             select = \"corners\"\n"
        )
    };
    // Of the steps of the command line, not of the file.
    assert!(!says("in-time", &event(0.01), "it does not happen"));
    let words = "line 6: [[event]]: at 0.99 s, but the run ends with step 1,";
    assert!(says("too-late", &event(0.99), words));
    let late = |more: &str| format!("{SHEET}[[pins]]\nselect = \"corners\"\n{more}");
    let words = "at 0.5 s, but the run ends with step 1,";
    for (name, more) in [
        ("pins", "from = 0.5\n"),
        (
            "force",
            "[[force]]\nvertices = [0]\nforce = [0, 0, 1]\nfrom = 0.5\n",
        ),
        (
            "released",
            "[[obstacle]]\nshape = \"sphere\"\nposition = [0, 0, -1]\nradius = 0.1\nmass = 1\nreleased = 0.5\n",
        ),
    ] {
        assert!(says(&format!("late-{name}"), &late(more), words), "{name}");
    }
    let falls = "it falls freely all along";
    assert!(says("free-fall", SHEET, falls));
    for more in [
        "[[obstacle]]\nshape = \"plane\"\nposition = [0, 0, -1]\n",
        "[[pins]]\nselect = \"corners\"\n",
        "[start]\nvelocity = [1, 0, 1]\n",
    ] {
        assert!(!says("no-free-fall", &format!("{SHEET}{more}"), falls));
    }
    assert!(!says(
        "weightless",
        &format!("gravity = [0, 0, 0]\n{SHEET}"),
        falls
    ));
}

/// Strips that hang by their modulus: the mean drop of a uniform one is ρ g L²/(3 Y). Of square cells springs have it,
/// of others they do not, which is said with how much the drop is off by; triangles have it.
#[test]
fn a_modulus_that_springs_do_not_have_is_told() {
    let strip = |cells: [u32; 2], membrane: &str| {
        // Upright, 1 m long and 0.25 m wide.
        let [across, along] = cells;
        format!(
            "steps = 400\n[[mesh]]\ngenerator = \"grid:{}x{}:alternating\"\nscale = [0.25, {}, 1]\n\
             rotate = [1.5707963267948966, 0, 0]\n[cloth]\ndensity = 0.3\nmodulus = 300\nmembrane = \"{membrane}\"\n\
             [[pins]]\nselect = \"highest\"\n",
            across + 1,
            along + 1,
            f64::from(across) / f64::from(along)
        )
    };
    let expected = 0.3 * 9.81 / (3.0 * 300.0);
    for (cells, membrane, stiffer) in [
        ([8, 32], "springs", None),
        ([8, 8], "springs", Some(2.67)),
        ([8, 8], "arap", None),
    ] {
        let path = written("hung-strip", &strip(cells, membrane));
        let arguments = [
            "run",
            path.to_str().unwrap(),
            "--json",
            "--method",
            "implicit-euler",
        ];
        let output = program(&arguments);
        let end: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        let ratio = expected / end["center_of_mass_drop"].as_f64().unwrap();
        let factor = stiffer.unwrap_or(1.0);
        // The ends are held across too, and the strip is finite.
        assert!(
            (ratio / factor - 1.0).abs() < 0.05,
            "{cells:?} {membrane}: {ratio}"
        );
        let words = format!("{factor:.2} times the modulus along the edge (0, 0, 1)");
        assert_eq!(said.contains(&words), stiffer.is_some(), "{said}");
        assert_eq!(said.contains("membrane=arap"), stiffer.is_some(), "{said}");
    }
}

/// A mat that starts within the thickness of a slope is given what contact holds there, which an explicit run has to
/// know.
#[test]
fn explicit_run_may_start_within_the_thickness() {
    let mat = "steps = 3\ngravity = [2.539, 0, -9.4757]\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\n\
               scale = [0.5, 0.5, 1]\ntranslate = [0, 0, 0.0019]\n[[obstacle]]\nshape = \"plane\"\n";
    let path = written("mat-within", mat);
    let arguments = [
        "run",
        path.to_str().unwrap(),
        "--json",
        "--method",
        "symplectic-euler",
    ];
    let output = program(&arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    let end: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let [held, given] =
        ["contact_energy_at_start", "energy_given"].map(|key| end[key].as_f64().unwrap());
    assert!(held > 1e-4 && given >= held, "{held} {given}");
    assert_eq!(end["energy_excess"], 0.0);
}

/// Any number of turns may be meant; a round number of radians that is one of degrees seldom is.
#[test]
fn turns_in_degrees_are_told() {
    for (turn, is_told) in [
        ("90", true),
        ("-45", true),
        ("12.566370614359172", false),
        ("1.5", false),
    ] {
        let pins =
            format!("[[pins]]\nselect = \"corners\"\nturn = [0, 0, {turn}]\nduration = 100\n");
        let (code, said) = told("turn", &[SHEET, &pins].concat(), &["implicit-euler"]);
        assert_eq!(code, 0, "{said}");
        assert_eq!(
            said.contains("90 degrees are 1.5708 rad"),
            is_told,
            "{said}"
        );
    }
}

/// An edge of a ten-thousandth of the others is told with its ends; one of a hundredth is fine.
#[test]
fn slivers_are_told() {
    for (short, is_told) in [(1e-4, true), (1e-2, false)] {
        let mesh = written("sliver", "").with_extension("obj");
        let text = format!(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 {short} 0\nf 1 2 4\nf 2 5 4\nf 5 3 4\n"
        );
        std::fs::write(&mesh, text).unwrap();
        let scene = format!(
            "[[mesh]]\nfile = {:?}\n[[pins]]\nvertices = [0, 3]\n",
            mesh.to_str().unwrap()
        );
        let (code, said) = told("with-sliver", &scene, &["implicit-euler"]);
        assert_eq!(code, 0, "{said}");
        assert_eq!(
            said.contains("edge between vertices 1 and 4 is"),
            is_told,
            "{said}"
        );
    }
}

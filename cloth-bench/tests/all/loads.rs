//! What loads a cloth besides its weight: xpbd takes as many substeps as leave its stretch the material's.

use crate::program::program;
use crate::scene_text::written;
use cloth_bench::method::Method;
use cloth_bench::run::from_start;
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Real;
use cloth_core::measure::center_of_mass;

/// A sheet of 1 m that hangs by its upper edge, and a force (N) that pulls on the lower one.
fn pulled(n: u32, stiffness: Real, force: Real) -> String {
    // Or wrinkles move for seconds where the sheet gets narrower.
    let rigidity = if n > 20 { 1e-2 } else { 1e-5 };
    format!(
        r#"
[[mesh]]
generator = "grid:{n}x{n}:alternating"
rotate = [1.5707963267948966, 0, 0]
[cloth]
density = 0.1
stiffness = {stiffness}
rigidity = {rigidity}
[[pins]]
select = "highest"
[[force]]
box = [[-1, -1, -0.001], [2, 1, 0.001]]
force = [0, 0, -{force}]
"#
    )
}

fn scene(name: &str, text: &str) -> Scene {
    file::build(&written(name, text), &Settings::default()).unwrap()
}

fn substeps(scene: &Scene) -> u32 {
    let auto = Settings::parse(&["substeps=auto".to_owned()]).unwrap();
    let method = Method::find("xpbd").unwrap();
    method.substeps(scene, &auto, scene.dt).unwrap()
}

/// How far (m) the centre of mass has come down after `steps` steps, on average over the second half of them.
fn fall(scene: &Scene, method: &str, settings: &[&str], steps: u32) -> Real {
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    let settings = Settings::parse(&settings).unwrap();
    let method = Method::find(method).unwrap();
    let height = |x: &[_]| center_of_mass(&scene.model.particles, x).z;
    let (mut sum, mut count) = (0.0, 0.0);
    let after = |step, state: &cloth_core::particles::State, _: &_| {
        if step > steps / 2 {
            sum += height(&scene.start.positions) - height(&state.positions);
            count += 1.0;
        }
        Ok(())
    };
    from_start(scene, method, &settings, scene.dt, steps, after).unwrap();
    sum / count
}

/// Whatever the force, the mesh and the stiffness: the sweeps add 4 % to what the material yields.
#[test]
fn steady_force_stretches_xpbd_as_the_material_says() {
    for (n, stiffness, force) in [
        (13, 2e4, 20.0),
        (13, 2e4, 200.0),
        (13, 2e4, 1000.0),
        (13, 5e3, 50.0),
        (13, 1e5, 500.0),
        (25, 2e4, 200.0),
        (7, 2e4, 200.0),
    ] {
        let scene = scene("pulled", &pulled(n, stiffness, force));
        let expected = fall(&scene, "implicit-euler", &[], 400);
        let auto = ["substeps=auto", "energy_gain=none"];
        let found = fall(&scene, "xpbd", &auto, 40);
        let error = found / expected - 1.0;
        println!(
            "{n} a side, {stiffness} N/m, {force} N: {error:+.3}, with {} substeps",
            substeps(&scene)
        );
        assert!(
            error.abs() < 0.05,
            "{n}, {stiffness} N/m, {force} N: {found} m, {expected} m"
        );
    }
}

/// The same of masses that hang on it, and of wind; what is less than its own weight changes nothing.
#[test]
fn every_load_beyond_its_weight_counts() {
    let plain = pulled(13, 2e4, 200.0);
    let (cloth, force) = plain.split_at(plain.find("[[force]]").unwrap());
    let of = |name: &str, load: &str| substeps(&scene(name, &format!("{cloth}{load}")));
    let (unloaded, pulled) = (of("unloaded", ""), of("pulled", force));
    let mass =
        |kg: Real| format!("[[mass]]\nbox = [[-1, -1, -0.001], [2, 1, 0.001]]\nmass = {kg}\n");
    assert!(pulled > 3 * unloaded, "{pulled}, {unloaded}");
    assert_eq!(of("air", "[air]\nwind = [0, 20, 0]\n"), pulled);
    assert_eq!(of("light-force", &force.replace("-200", "-0.9")), unloaded);
    assert_eq!(of("breeze", "[air]\nwind = [0, 0.5, 0]\n"), unloaded);
    // Light masses are a load like weight, which has a part of its own.
    assert!(of("mass", &mass(20.0)) > 3 * unloaded);
    assert_eq!(
        scene("light-mass", &format!("{cloth}{}", mass(0.05)))
            .lasting_tension()
            .unwrap(),
        0.0
    );
}

/// A box a hundred times as heavy as the cloth between it and the floor lies on the floor. One on a
/// cloth that is held hangs in it.
#[test]
fn floor_carries_what_lies_on_it() {
    let on_floor = r#"
[[mesh]]
generator = "grid:15x15:alternating"
scale = 0.5
translate = [-0.25, -0.25, 0.004]
[[obstacle]]
shape = "plane"
"#;
    let body = "[[obstacle]]\nshape = \"box\"\nsize = [0.1, 0.1, 0.2]\nmass = 5\nposition = [0, 0, 0.12]\n";
    let with_body = format!("{on_floor}{body}");
    let held = format!("{with_body}[[pins]]\nselect = \"corners\"\n");
    let [alone, lying, hanging] =
        [on_floor, &with_body, &held].map(|text| substeps(&scene("box-on-cloth", text)));
    assert!(lying < 3 * alone, "{lying}, {alone}");
    assert!(hanging > lying, "{hanging}, {lying}");
    // A table serves as the floor does, unless cloth begins beyond its border.
    let table = |size| {
        let table =
            format!("shape = \"box\"\nsize = [{size}, {size}, 0.1]\nposition = [0, 0, -0.05]");
        let text = with_body.replacen("shape = \"plane\"", &table, 1);
        substeps(&scene("box-on-table", &text))
    };
    assert_eq!(table(1.0), lying);
    assert!(table(0.4) > lying);
    // As many as the same force would take, however it is spread.
    let pushed = format!(
        "{on_floor}[[pins]]\nselect = \"corners\"\n[[force]]\nbox = [[-1, -1, -1], [1, 1, 1]]\nforce = [0, 0, -49.05]\n"
    );
    assert_eq!(hanging, substeps(&scene("pushed", &pushed)));
    // Then it swings as deep as by forces, with neither damped; 20 substeps let it down more than twice as far.
    for mass in [5, 50] {
        let body = body.replace("mass = 5", &format!("mass = {mass}"));
        let text =
            format!("{on_floor}position = [0, 0, -1]\n{body}[[pins]]\nselect = \"border\"\n");
        let scene = scene("swinging", &text);
        let [found, expected] = [("xpbd", &["substeps=auto"][..]), ("symplectic-euler", &[])]
            .map(|(method, settings)| fall(&scene, method, settings, 120));
        println!("{mass} kg: {found} of {expected} m");
        // How the cloth creases below the box is chance: starts 1e-7 m apart end up to a sixth apart.
        assert!(
            (found / expected - 1.0).abs() < 0.2,
            "{mass} kg: {found} of {expected} m"
        );
    }
}

/// What makes xpbd dear is said before a run, and what its sweeps may have left of a stretch after it: they are chosen
/// for gravity, and know nothing of how far pins pull.
#[test]
fn dear_substeps_and_what_too_few_leave_are_said() {
    let said = |name: &str, text: &str, more: &[&str]| {
        let path = written(name, text);
        let all = ["run", path.to_str().unwrap(), "--threads", "1", "--method"];
        let output = program(&[&all[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{name}");
        String::from_utf8(output.stderr).unwrap()
    };
    let heavy = "steps = 1\n[[mesh]]\ngenerator = \"grid:5x21:alternating\"\n[cloth]\ndensity = 0.05\nstiffness = 1e6\n\
        [[pins]]\nbox = [[-1, 0.999, -1], [2, 2, 1]]\n[[mass]]\nbox = [[-1, -1, -1], [2, 0.001, 1]]\nmass = 50\n";
    let note = "note: xpbd takes";
    assert!(said("dear", heavy, &["xpbd"]).contains(note));
    assert!(!said("dear", heavy, &["pd"]).contains(note));
    let pulled = "steps = 60\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:13x13:alternating\"\n\
        [cloth]\ndensity = 0.05\nstiffness = 1e3\n[[pins]]\nbox = [[-1, 0.999, -1], [2, 2, 1]]\n\
        [[pins]]\nbox = [[-1, -1, -1], [2, 0.001, 1]]\nmove = [0, -0.2, 0]\nduration = 0.5\n";
    let warning = "sweeps a step leave some of that";
    assert!(said("pulled-far", pulled, &["xpbd"]).contains(warning));
    assert!(!said("pulled-far", pulled, &["pd"]).contains(warning));
    let little = pulled.replace("-0.2", "-0.1");
    assert!(!said("pulled-less", &little, &["xpbd"]).contains(warning));
}

/// Cloth of small triangles is thinner than 2 mm, and that is said; a thickness beyond its edges is, too.
#[test]
fn thickness_is_at_most_half_an_edge_unless_it_is_set() {
    let cloth = |side: Real| {
        format!(
            r#"
steps = 1
[[mesh]]
generator = "grid:25x25:alternating"
scale = {side}
translate = [0, 0, 0.3]
[[obstacle]]
shape = "sphere"
radius = 0.1
"#
        )
    };
    let run = |side: Real, more: &[&str]| {
        let path = written("thickness", &cloth(side));
        let all = ["run", path.to_str().unwrap(), "--method", "implicit-euler"];
        let output = program(&[&all[..], more].concat());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8(output.stderr).unwrap()
    };
    // Edges of 1.25 mm, a third of them by √2 longer.
    let half = 0.5 * 0.03 / 24.0 * (2.0 + (2.0 as Real).sqrt()) / 3.0;
    let said = run(0.03, &[]);
    let note =
        format!("note: the thickness of contact is {half:.3e} m, half the mean edge of the cloth");
    assert!(said.contains(&note), "{said}");
    let least = 0.01 * half / 0.03 * 60.0;
    let said = run(60.0, &[]);
    let note = format!(
        "note: the thickness of contact is {least:.3e} m, a two-hundredth of the mean edge of the cloth"
    );
    assert!(said.contains(&note), "{said}");
    let said = run(0.03, &["--set", "thickness=2e-3"]);
    assert!(
        said.contains("is more than the mean edge of the cloth, 1.423e-3 m"),
        "{said}"
    );
    let path = written("thickness", &cloth(0.3));
    let all = [
        "run",
        path.to_str().unwrap(),
        "--method",
        "pd",
        "--set",
        "thickness=1e-9",
    ];
    let output = program(&all);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("it has to be at least 1.4e-8 m"), "{said}");
    assert_eq!(output.status.code(), Some(2));
    for said in [run(0.03, &["--set", "thickness=1e-3"]), run(0.3, &[])] {
        assert!(!said.contains("thickness"), "{said}");
    }
}

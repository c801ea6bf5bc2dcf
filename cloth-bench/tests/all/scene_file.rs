//! Scene files: they say the same as the scenes of the program, and what is wrong with them is said with its line.

use crate::program::program;
use crate::scene_text::written;
use cloth_bench::error::BenchError;
use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{from_start, run};
use cloth_bench::scene::{self, Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::particles::State;
use std::path::{Path, PathBuf};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name)
}

fn read(name: &str, text: &str) -> Result<Scene, BenchError> {
    file::build(&written(name, text), &Settings::default())
}

fn built_in(name: &str, settings: &[&str]) -> Scene {
    scene::build(name, None, &Settings::parse(settings).unwrap()).unwrap()
}

/// Where a scene is after some steps with a method.
fn after(scene: &Scene, method: &str, steps: u32) -> State {
    after_with(scene, method, &Settings::default(), steps)
}

fn after_with(scene: &Scene, method: &str, settings: &Settings, steps: u32) -> State {
    let method = Method::find(method).unwrap();
    let mut stepper = method.build(scene, settings, scene.dt).unwrap();
    let mut state = scene.start.clone();
    run(
        scene,
        &mut *stepper,
        &mut state,
        scene.dt,
        steps,
        |_, _, _| Ok(()),
    )
    .unwrap();
    state
}

fn bits(values: &[Vec3]) -> Vec<[u64; 3]> {
    values
        .iter()
        .map(|v| [v.x, v.y, v.z].map(f64::to_bits))
        .collect()
}

/// The same positions and velocities, bit for bit, after 20 steps with every one of a few methods.
fn same_bits(one: &Scene, other: &Scene) {
    assert_eq!(one.dt.to_bits(), other.dt.to_bits());
    assert_eq!((one.steps, one.name), (other.steps, other.name));
    for method in ["xpbd", "pd", "linear-implicit"] {
        let [a, b] = [one, other].map(|scene| after(scene, method, 20));
        assert_eq!(bits(&a.positions), bits(&b.positions), "{method}");
        assert_eq!(bits(&a.velocities), bits(&b.velocities), "{method}");
    }
}

#[test]
fn hang_from_its_file_has_the_same_bits() {
    let of_file = file::build(&sample("hang.toml"), &Settings::default()).unwrap();
    same_bits(&of_file, &built_in("hang", &[]));
}

#[test]
fn other_scenes_of_the_program_can_be_written_down() {
    let fold = "steps = 180\n[[mesh]]\ngenerator = \"grid:5x17:alternating\"\nscale = 0.25\ntranslate = [-0.125, -0.5, 0]\n\
                [[obstacle]]\nshape = \"plane\"\nposition = [0, 0, -0.504]\n[contact]\nself = true\n\
                [start]\nwave = [0, 0.01, 0]\nwave_number = [0, 0, 1.5]\n";
    let upright = fold.replace(
        "translate",
        "rotate = [1.5707963267948966, 0, 0]\ntranslate",
    );
    // The rotation is exact to rounding only, so the first steps are compared, with a tolerance.
    let fold = read(
        "fold",
        &upright.replace("[-0.125, -0.5, 0]", "[-0.125, 0, -0.5]"),
    )
    .unwrap();
    let own = built_in("fold", &["n=17"]);
    let [a, b] = [&fold, &own].map(|scene| after(scene, "xpbd", 5));
    for (a, b) in a.positions.iter().zip(&b.positions) {
        assert!((a - b).norm() < 1e-9, "{a} {b}");
    }
    let drape = "name = \"drape-box\"\nsteps = 120\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\n[contact]\nself = \"yes\"\n\
                 [[obstacle]]\nshape = \"box\"\nsize = [0.5, 0.5, 0.5]\nposition = [0.5, 0.5, -0.254]\nangular_velocity = [0, 0, 2]\n";
    same_bits(
        &read("drape", drape).unwrap(),
        &built_in("drape-box", &["n=9"]),
    );
    let cantilever = "name = \"cantilever\"\n[[mesh]]\ngenerator = \"grid:41x9:alternating\"\n[cloth]\nrigidity = 0.1\n\
                      [[pins]]\nbox = [[-1, -1, -1], [0.03, 1, 1]]\n";
    let strip = read("cantilever", cantilever).unwrap();
    let [a, b] =
        [&strip, &built_in("cantilever", &[])].map(|scene| after(scene, "implicit-euler", 3));
    for (a, b) in a.positions.iter().zip(&b.positions) {
        assert!((a - b).norm() < 1e-9, "{a} {b}");
    }
    let chain = "name = \"chain\"\n[chain]\nn = 7\nlink = 0.1\ntip_mass = 0.5\n";
    same_bits(
        &read("chain", chain).unwrap(),
        &built_in("chain", &["n=7", "link=0.1", "tip_mass=0.5"]),
    );
    let stack = "name = \"stack\"\nsteps = 120\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.5\ntranslate = [-0.25, -0.25, 0]\n\
                 [[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.5\ntranslate = [0, 0, 0.003]\n";
    assert_eq!(read("stack", stack).unwrap().start.positions.len(), 50);
}

#[test]
fn the_twist_of_the_sample_is_that_of_the_program() {
    let of_file = file::build(&sample("twist.toml"), &Settings::default()).unwrap();
    let own = built_in("twist", &["n=65"]);
    assert_eq!(
        of_file.model.particles.free_count(),
        own.model.particles.free_count()
    );
    // Its scale is exact to rounding only, and rounding decides to which side the flat towel gives way, so the first
    // steps are compared.
    let [a, b] = [&of_file, &own].map(|scene| after(scene, "xpbd", 8));
    let moved = (a.positions[0] - of_file.start.positions[0]).norm();
    assert!(moved > 0.02, "{moved}");
    for (a, b) in a.positions.iter().zip(&b.positions) {
        assert!((a - b).norm() < 1e-11, "{:e}, {a} {b}", (a - b).norm());
    }
}

#[test]
fn the_samples_run() {
    let scene = file::build(&sample("curtain.toml"), &Settings::default()).unwrap();
    assert_eq!((scene.name, scene.steps), ("curtain", 100));
    assert_eq!(scene.obstacle_surfaces(0.0).len(), 2);
    assert_eq!(
        scene.model.particles.len() - scene.model.particles.free_count(),
        25
    );
    let state = after(&scene, "xpbd", 40);
    assert!(state.first_non_finite().is_none());
    // Surfaces in pictures are those that the cloth touches.
    for ((surface, _), obstacle) in scene
        .obstacle_surfaces(state.time)
        .iter()
        .zip(scene.touch.as_ref().unwrap().obstacles())
    {
        for &x in surface {
            let distance = obstacle.signed_distance(x, state.time).value;
            assert!(distance.abs() < 1e-12, "{distance}");
        }
    }
}

#[test]
fn the_flag_of_the_sample_blows_down_the_wind() {
    let scene = file::build(&sample("flag.toml"), &Settings::default()).unwrap();
    let state = after(&scene, "xpbd", 120);
    let mesh = scene.mesh.as_ref().unwrap();
    let farthest = |x: &[Vec3]| x.iter().map(|x| x.x).fold(0.0, f64::max);
    let (before, now) = (farthest(mesh.positions()), farthest(&state.positions));
    // It hangs without wind, and lies in it with.
    assert!(before > 0.5 && now > 0.8 * before, "{before} {now}");
    let calm = Scene {
        air: None,
        ..scene.clone()
    };
    let hanging = farthest(&after(&calm, "xpbd", 120).positions);
    assert!(hanging < 0.8 * before, "{hanging}");
}

/// Friction holds the cloth on the ball: once it turns with it, the vertices on top go round as fast.
#[test]
fn the_ball_of_the_sample_takes_the_cloth_along() {
    let text = std::fs::read_to_string(sample("turning-sphere.toml")).unwrap();
    let scene = read("turning", &text.replace("41x41", "21x21")).unwrap();
    // Steps of projective dynamics are cut short, and what lies loosely may fall behind.
    for (method, most) in [("xpbd", 0.02), ("pd", 0.04)] {
        let (mut before, method) = (Vec::new(), Method::find(method).unwrap());
        let settings = Settings::default();
        let look = |step, state: &State, _: &_| {
            if step == 100 {
                before.clone_from(&state.positions);
            }
            Ok(())
        };
        let (_, end) = from_start(&scene, method, &settings, scene.dt, 130, look).unwrap();
        let (later, method) = (end.positions, method.name);
        let on_top = (0..before.len()).filter(|&v| before[v].z > 0.25);
        let turned: Vec<f64> = on_top
            .filter(|&v| before[v].xy().norm() > 0.05)
            .map(|v| {
                let [a, b] = [before[v], later[v]].map(|x| x.xy());
                (a.x * b.y - a.y * b.x).atan2(a.dot(&b))
            })
            .collect();
        assert!(turned.len() > 8, "{method}: {}", turned.len());
        // Half a second of π rad/s.
        let expected = std::f64::consts::FRAC_PI_2;
        let mean = turned.iter().sum::<f64>() / turned.len() as f64;
        assert!((mean - expected).abs() < 5e-3, "{method}: {mean} rad");
        for angle in turned {
            assert!((angle - expected).abs() < most, "{method}: {angle} rad");
        }
    }
}

#[test]
fn a_mesh_file_stands_beside_the_scene() {
    let mesh = cloth_core::mesh::generate::disk(4, 0.3).unwrap();
    let path = written(
        "beside",
        "[[mesh]]\nfile = \"disk.ply\"\n[[pins]]\nvertices = [0, 5]\nmove = [0, 0, 1]\n",
    );
    let ply = path.with_file_name("disk.ply");
    let encoding = cloth_core::mesh::ply::Encoding::Ascii;
    cloth_core::mesh::ply::write(&ply, mesh.positions(), mesh.triangles(), encoding).unwrap();
    let scene = file::build(&path, &Settings::default()).unwrap();
    let state = after(&scene, "xpbd", 30);
    let back = scene.order.as_ref().unwrap().restore(&state.positions);
    for pin in [0, 5] {
        let expected = mesh.positions()[pin] + Vec3::z() * 0.5;
        assert!((back[pin] - expected).norm() < 1e-12, "{}", back[pin]);
    }
    let missing = written("missing", "\n[[mesh]]\nfile = \"no-such.obj\"\n");
    let told = file::build(&missing, &Settings::default())
        .unwrap_err()
        .to_string();
    assert!(
        told.contains("missing.toml: line 3: ") && told.contains("no-such.obj"),
        "{told}"
    );
}

#[test]
fn settings_overrule_the_file() {
    let settings = Settings::parse(&["stiffness=2e3", "density=0.5"]).unwrap();
    let overruled = file::build(&sample("hang.toml"), &settings).unwrap();
    let own = built_in("hang", &["stiffness=2e3", "density=0.5"]);
    same_bits(&overruled, &own);
}

#[test]
fn every_mistake_names_its_line_and_key() {
    const MESH: &str = "[[mesh]]\ngenerator = \"grid:5x5:one-way\"\n";
    let cases = [
        ("dt = 0.1.2\n", "line 1: "),
        (
            "stesp = 3\n",
            "line 1: unknown key `stesp`: did you mean `steps`?",
        ),
        (
            "[[msh]]\n",
            "line 1: unknown key `msh`: did you mean `mesh`?",
        ),
        (
            "[cloth]\nstifness = 3\n",
            "line 2: unknown key of [cloth] `stifness`: did you mean `stiffness`?",
        ),
        (
            "[mesh]\ngenerator = \"disk:3\"\n",
            "line 1: this table can be there several times: write [[mesh]]",
        ),
        (
            "cloth = 3\n",
            "line 1: this has to be a table: write [cloth] above its keys",
        ),
        (
            "[[cloth]]\n",
            "line 1: this has to be a table: write [cloth] above its keys",
        ),
        ("steps = 3\n", "there is no cloth: a scene needs [[mesh]]"),
        (
            "dt = -1\n",
            "line 1: dt is `-1`, a number, but it has to be a finite number above 0",
        ),
        (
            "dt = \"fast\"\n",
            "line 1: dt is `\"fast\"`, a text, but it has to be a finite number above 0",
        ),
        (
            "\nsteps = 1.5\n",
            "line 2: steps is `1.5`, a number, but it has to be a whole number",
        ),
        (
            "gravity = [0, 1]\n",
            "line 1: gravity is `[0, 1]`, a list, but it has to be three finite numbers",
        ),
        ("[name]\n", "line 1: name is `[name]`, a table"),
        (
            "gravity = 1979-05-27\n",
            "line 1: gravity is `1979-05-27`, a date",
        ),
        (
            "[[mesh]]\n",
            "line 1: [[mesh]]: needs a file or a generator",
        ),
        (
            "[[mesh]]\nfile = \"a.obj\"\ngenerator = \"disk:3\"\n",
            "line 3: a file is given too",
        ),
        (
            "[[mesh]]\ngenerator = \"dsk:3\"\n",
            "line 2: unknown mesh generator `dsk`: did you mean `disk`?",
        ),
        (
            "[[mesh]]\ngenerator = \"a.obj\"\n",
            "line 2: `a.obj` is no generator; a file goes under the key `file`",
        ),
        (
            "[[mesh]]\ngenerator = \"disk:3\"\nscale = [1, 0, 1]\n",
            "line 3: scale is `[1, 0, 1]`, a list",
        ),
        ("+[cloth]\ndensity = -1\n", "line 4: "),
        (
            "+[cloth]\nmodulus = 1\nstiffness = 2\n",
            "line 4: modulus and stiffness both",
        ),
        (
            "+[cloth]\nmembrane = \"stvkk\"\n",
            "line 4: unknown membrane `stvkk`: did you mean `stvk`?",
        ),
        (
            "+[cloth]\nslack = [1, 2, 3]\n",
            "line 4: slack is `[1, 2, 3]`, a list",
        ),
        ("+[cloth]\ndensity = inf\n", "line 4: density is `inf`"),
        ("+[contact]\nthickness = 0\n", "line 4: thickness is `0`"),
        ("+[contact]\nself = 3\n", "line 4: unknown self `3`"),
        ("+[[pins]]\n", "line 3: [[pins]]: needs one of the keys"),
        (
            "+[[pins]]\nvertices = [25]\n",
            "line 4: there is no vertex 25, only 0 to 24",
        ),
        ("+[[pins]]\nvertices = [-1]\n", "line 4: vertices is `[-1]`"),
        (
            "+[[pins]]\nselect = \"heighest\"\n",
            "line 4: unknown selection `heighest`: did you mean `highest`?",
        ),
        (
            "+[[pins]]\nbox = [[5, 5, 5], [6, 6, 6]]\n",
            "line 4: there is no vertex in the box; they are in [0, 0, 0] to [",
        ),
        ("+[[pins]]\nbox = [1, 2]\n", "line 4: box is `[1, 2]`"),
        (
            "+[[pins]]\nvertices = [0]\nduration = 3\n",
            "line 5: duration has no meaning",
        ),
        (
            "+[[pins]]\nvertices = [0]\nmove = [0, 0, 1]\nduration = 0\n",
            "line 6: duration is `0`",
        ),
        (
            "+[start]\nwave = [0, 0, 1]\n",
            "line 3: [start]: wave and wave_number go together",
        ),
        ("+[[obstacle]]\n", "line 3: [[obstacle]]: needs a shape"),
        (
            "+[[obstacle]]\nshape = \"cube\"\n",
            "line 4: unknown shape `cube`",
        ),
        (
            "+[[obstacle]]\nshape = \"sphere\"\n",
            "line 3: [[obstacle]]: this shape needs the key radius",
        ),
        (
            "+[[obstacle]]\nshape = \"sphere\"\nradius = 1\nlength = 3\n",
            "line 6: length has no meaning for this shape",
        ),
        (
            "+[[obstacle]]\nshape = \"box\"\nsize = [1, -1, 1]\n",
            "line 5: ",
        ),
        (
            "+[air]\ndensity = -1\n",
            "line 4: the density of the air is -1, but it has to be zero or a positive finite number",
        ),
        ("+[air]\nlift = 1\ndrag = 0\n", "line 4: the lift is 1, but"),
        ("+[air]\nwind = 3\n", "line 4: wind is `3`, a number"),
        (
            "+[air]\nwnd = 3\n",
            "line 4: unknown key of [air] `wnd`: did you mean `wind`?",
        ),
        (
            "[chain]\nn = 3\n[air]\n",
            "line 3: [air]: has no meaning beside [chain]",
        ),
        (
            "+[chain]\nn = 3\n",
            "line 1: [[mesh]]: has no meaning beside [chain]",
        ),
        ("[chain]\nstiffness = -1\n", "line 2: stiffness is `-1`"),
    ];
    let mut wrong = Vec::new();
    for (number, (text, expected)) in cases.into_iter().enumerate() {
        let text = match text.strip_prefix('+') {
            Some(rest) => format!("{MESH}{rest}"),
            None => text.to_owned(),
        };
        let name = format!("wrong-{number}");
        let told = read(&name, &text).expect_err(&text).to_string();
        if !told.contains(&format!("{name}.toml: {expected}")) {
            wrong.push(format!("`{text}` says `{told}`, which lacks `{expected}`"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let missing = file::build(Path::new("no/such.toml"), &Settings::default()).unwrap_err();
    assert!(
        missing
            .to_string()
            .starts_with("no/such.toml: the scene file cannot be read: ")
    );
}

/// The table of the documentation, from the keys themselves.
#[test]
fn every_key_is_documented() {
    let readme = std::fs::read_to_string(sample("README.md")).unwrap();
    let mut table = String::new();
    for section in file::SECTIONS {
        let head = if section.head.is_empty() { "" } else { "`" };
        table += &format!("| {head}{}{head} | | | {} |\n", section.head, section.about);
        for key in section.keys.iter().copied().flatten() {
            let about = key.explained().replace('|', "\\|");
            table += &format!("| | `{}` | {} | {about} |\n", key.name, key.default);
        }
    }
    assert!(
        readme.contains(&table),
        "scenes/README.md should have this table:\n{table}"
    );
}

/// A corner held by springs rests 5 µm above a triangle of its own piece, and its weight would take it a little
/// further in the first steps.
#[test]
fn corner_close_to_its_own_cloth_crosses_it_with_no_method() {
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 2 1\nv 0.2 0.2 5e-6\nv 0.3 0.2 0.5\nf 1 2 3\nf 2 4 3\nf 4 5 6\n";
    for gravity in [9.81, 12.0] {
        let scene = format!(
            "dt = 1e-3\nsteps = 30\ngravity = [0, 0, -{gravity}]\n[[mesh]]\nfile = \"corner-close.obj\"\n\
             [[pins]]\nvertices = [0, 1, 2, 3, 5]\n\
             [contact]\nself = true\nthickness = 1e-3\n"
        );
        let path = written("corner-close", &scene);
        std::fs::write(path.with_file_name("corner-close.obj"), mesh).unwrap();
        let path = path.to_str().unwrap();
        // Forward Euler refuses every step as unstable.
        for method in METHODS.iter().filter(|m| m.name != "explicit-euler") {
            let ran = program(&["run", path, "--method", method.name, "--watch", "--json"]);
            assert!(ran.status.success(), "{}", method.name);
            let summary: serde_json::Value = serde_json::from_slice(&ran.stdout).unwrap();
            assert_eq!(summary["crossed_steps"], 0, "{}", method.name);
        }
    }
}

/// A sheet of 0.2 kg/m² that lies on a floor of κ = 10⁶ Pa/m is at h − ρ g/κ.
#[test]
fn sheet_lies_at_the_thickness_less_its_pressure() {
    let text = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[[obstacle]]\nshape = \"plane\"\nposition = [0, 0, -0.002]\n\
                [contact]\nthickness = 2e-3\n";
    let scene = read("lying", text).unwrap();
    let converged = Settings::parse(&["tolerance=1e-8"]).unwrap();
    let rest = after_with(&scene, "implicit-euler", &converged, 60);
    for x in &rest.positions {
        let clearance = x.z + 2e-3;
        assert!((clearance - 1.998_038e-3).abs() < 1e-11, "{clearance:e} m");
    }
}

/// What a run tells of triangles that go through bodies, in a scene of `text` with any method that feels contact.
fn bodies_are_felt(name: &str, text: &str, methods: &[&str]) {
    let path = written(name, text);
    let path = path.to_str().unwrap();
    for method in methods {
        let ran = program(&["run", path, "--method", method, "--watch", "--json"]);
        let told = String::from_utf8_lossy(&ran.stderr);
        assert!(ran.status.success(), "{name}, {method}: {told}");
        let summary: serde_json::Value = serde_json::from_slice(&ran.stdout).unwrap();
        assert_eq!(
            summary["most_obstacle_intersections"], 0,
            "{name}, {method}"
        );
        if text.contains("self = true") {
            assert_eq!(summary["crossed_steps"], 0, "{name}, {method}");
        }
    }
}

const FELT: [&str; 5] = ["implicit-euler", "linear-implicit", "pd", "xpbd", "pbd"];

/// A ball of 2 cm rises through a sheet whose cells are 12 cm, and a sheet falls on the corner of a box: no vertex is
/// near either.
#[test]
fn bodies_smaller_than_a_triangle_and_corners_pierce_nothing() {
    let ball = "steps = 30\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\ntranslate = [-0.5, -0.5, 0]\n\
         [[pins]]\nselect = \"corners\"\n[[pins]]\nbox = [[-0.51, 0.49, -1], [0.51, 0.51, 1]]\n\
         [contact]\nself = SELF\n\
         [[obstacle]]\nshape = \"sphere\"\nradius = 0.02\nposition = [0.05, 0.03, -0.05]\nvelocity = [0, 0, 0.4]\n";
    bodies_are_felt(
        "ball-alone",
        &ball.replace("SELF", "false"),
        &["implicit-euler", "xpbd"],
    );
    bodies_are_felt("ball", &ball.replace("SELF", "true"), &FELT);
    let corner = "steps = 40\n[[mesh]]\ngenerator = \"grid:13x13:alternating\"\ntranslate = [-0.5, -0.5, 0]\n\
         [contact]\nself = true\n\
         [[obstacle]]\nshape = \"box\"\nsize = [0.3, 0.3, 0.3]\nrotate = [0.6755, -0.6755, 0]\nposition = [0.02, 0.01, -0.27]\n";
    bodies_are_felt("corner", corner, &FELT);
}

/// An open surface that its files lift carries a sheet up, and nothing goes through it.
#[test]
fn an_animation_carries_cloth() {
    let text = "steps = 40\ngravity = [0, 0, -9.81]\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\nscale = 0.4\ntranslate = [-0.2, -0.2, 0]\n\
         [contact]\nself = true\n\
         [[obstacle]]\nshape = \"animation\"\nfolder = \"lift\"\ninterval = 0.1\nposition = [0, 0, -0.01]\n";
    let path = written("animation", text);
    let folder = path.with_file_name("lift");
    // What an earlier run has left.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    for shape in 0..7 {
        // A bowl of four triangles that rises by 2 cm from file to file, and gets deeper.
        let (height, deep) = (0.02 * f64::from(shape), 0.01 * f64::from(shape));
        let obj = format!(
            "v -0.5 -0.5 {height}\nv 0.5 -0.5 {height}\nv 0.5 0.5 {height}\nv -0.5 0.5 {height}\nv 0.01 0.02 {}\n\
             f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n",
            height - deep
        );
        std::fs::write(folder.join(format!("shape-{shape}.obj")), obj).unwrap();
    }
    bodies_are_felt("animation", text, &FELT);
    let ran = program(&[
        "run",
        path.to_str().unwrap(),
        "--method",
        "implicit-euler",
        "--json",
    ]);
    let summary: serde_json::Value = serde_json::from_slice(&ran.stdout).unwrap();
    // Lifted: 12 cm at the rim, 6 cm in the middle, 1 cm below the start.
    let drop = summary["center_of_mass_drop"].as_f64().unwrap();
    assert!((-0.11..-0.05).contains(&drop), "{drop}");
    std::fs::write(
        folder.join("shape-9.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    )
    .unwrap();
    let ran = program(&["run", path.to_str().unwrap(), "--method", "pd"]);
    let told = String::from_utf8_lossy(&ran.stderr);
    assert!(
        !ran.status.success() && told.contains("shape-9.obj has other triangles"),
        "{told}"
    );
}

#[test]
fn a_key_of_another_table_is_told_where_it_can_stand() {
    for (text, place) in [
        (
            "[[mesh]]\ngravity = [0, 0, -1]\n",
            "; it can stand before all tables",
        ),
        (
            "stiffness = 3\n[[mesh]]\ngenerator = \"disk:3\"\n",
            "in [cloth]",
        ),
        ("[cloth]\nstifness = 3\n", "`stiffness`"),
    ] {
        let error = file::build(&written("elsewhere", text), &Settings::default()).unwrap_err();
        let told = error.to_string();
        assert!(told.contains(place), "{told}");
        assert_eq!(
            told.contains("it can stand"),
            place != "`stiffness`",
            "{told}"
        );
    }
}

//! Locking as a user meets it: the command on every kind of mesh, and every remedy with every method.

use crate::scene_text::written;
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

fn told(arguments: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_cloth-bench"))
        .args(arguments)
        .arg("--json")
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {words}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// χ, E_b, the number of boundary loops and pieces, and the self-stresses of the bent shape: 3χ + E_b motions and one
/// more for each of these are left.
#[test]
fn the_command_counts_and_measures_every_kind_of_mesh() {
    for (mesh, euler, boundary, loops, pieces, stresses) in [
        ("grid:9x6:one-way", 1, 26, 1, 1, 0),
        ("grid:7x7:crossed", 1, 24, 1, 1, 0),
        ("equilateral:8x6", 1, 24, 1, 1, 0),
        ("irregular:9", 1, 32, 1, 1, 0),
        ("disk:5", 1, 30, 1, 1, 0),
        ("tube:9x5", 0, 18, 2, 1, 0),
        ("sphere:4", 2, 0, 0, 1, 0),
        ("torus:11x7", 0, 0, 0, 1, 6),
        ("moebius:12x3", 0, 24, 1, 1, 0),
        ("holes:10:2", -3, 72, 5, 1, 0),
        ("disk:3+tube:7x3+sphere:2", 3, 32, 3, 3, 0),
    ] {
        let found = told(&["locking", mesh]);
        let count = 3 * euler + boundary;
        for (key, value) in [
            ("euler", euler),
            ("boundary_edges", boundary),
            ("boundary_loops", loops),
            ("components", pieces),
            ("count_3v_e", count),
            ("count_3euler_boundary", count),
            ("self_stresses_bent", stresses),
            ("nullity_bent", count + stresses),
        ] {
            assert_eq!(found[key], value, "{mesh}: {key}");
        }
        let number = |key: &str| found[key].as_i64().unwrap();
        let coordinates = 3 * number("vertices");
        assert_eq!(coordinates - number("edges"), count, "{mesh}");
        for shape in ["flat", "bent"] {
            let rank = number(&format!("rank_{shape}"));
            assert_eq!(coordinates - rank, number(&format!("nullity_{shape}")));
            assert_eq!(
                number("edges") - rank,
                number(&format!("self_stresses_{shape}"))
            );
            assert!(
                found[format!("smallest_nonzero_singular_value_{shape}")]
                    .as_f64()
                    .unwrap()
                    > 1e-9
            );
        }
    }
}

/// A file of several pieces with holes, written and read again, is counted like the mesh it was made from.
#[test]
fn a_file_is_counted_like_the_mesh_it_holds() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("locking");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("pieces.obj");
    let spec = "holes:7:3+moebius:10x2";
    let mesh = cloth_bench::mesh_spec::load(spec).unwrap();
    cloth_core::mesh::obj::write(&path, mesh.positions(), mesh.triangles()).unwrap();
    let [mut of_file, mut of_spec] = [path.to_str().unwrap(), spec].map(|m| told(&["locking", m]));
    for found in [&mut of_file, &mut of_spec] {
        found.as_object_mut().unwrap().remove("mesh");
    }
    assert_eq!(of_file, of_spec);
}

/// Every method that takes springs takes the remedies made of them, and makes a finite sheet that hangs.
#[test]
fn every_method_takes_every_remedy() {
    for remedy in [
        &["compression=0.01"][..],
        &["slack=0.99,1.01"],
        &["edges=0.2"],
        &["edges=quads"],
        &["level=1"],
        &["level=2", "fine_fraction=0.1"],
        &["points=midpoints"],
        &["strain_limit=0.05"],
    ] {
        for method in [
            "symplectic-euler",
            "implicit-euler",
            "linear-implicit",
            "bdf2",
            "implicit-midpoint",
            "pbd",
            "xpbd",
            "xpbd-direct",
            "pd",
        ] {
            let mut arguments = vec!["run", "hang", "--method", method, "--n", "9"];
            arguments.extend(["--steps", "20", "--set", "stiffness=100"]);
            for setting in remedy {
                arguments.extend(["--set", setting]);
            }
            let found = told(&arguments);
            assert_eq!(found["finite"], true, "{method}, {remedy:?}");
            let fall = found["center_of_mass_drop"].as_f64().unwrap();
            assert!((0.1..1.5).contains(&fall), "{method}, {remedy:?}: {fall}");
        }
    }
}

/// E points instead of V, and the middles of the edges of a held vertex are held: that is half an edge more of the
/// sheet, so the sheets fall alike as the edges get short.
#[test]
fn midpoints_are_an_option_of_the_hanging_sheet() {
    let run = |method, n, settings: &[&'static str]| {
        let mut all = vec!["run", "hang", "--steps", "30", "--method", method, "--n", n];
        all.extend(["--set", "stiffness=1e3"]);
        all.extend(settings.iter().flat_map(|setting| ["--set", *setting]));
        told(&all)
    };
    let fall = |found: &Value| found["center_of_mass_drop"].as_f64().unwrap();
    let both = ["9", "17", "33"].map(|n| {
        ["points=vertices", "points=midpoints"].map(|points| run("implicit-euler", n, &[points]))
    });
    let [[plain, middles], ..] = &both;
    assert_eq!(plain["vertices"], 81);
    assert_eq!(middles["vertices"], 208);
    // Three edges end in either corner.
    assert_eq!(
        (plain["pins"].as_u64(), middles["pins"].as_u64()),
        (Some(2), Some(6))
    );
    let apart = both
        .each_ref()
        .map(|[a, b]| (fall(b) / fall(a) - 1.0).abs());
    assert!(
        apart[0] < 0.12 && apart[1] < 0.7 * apart[0] && apart[2] < 0.7 * apart[1],
        "{apart:?}"
    );
    let pd = run("pd", "9", &["points=midpoints", "iterations=400"]);
    assert!((fall(&pd) / fall(middles) - 1.0).abs() < 1e-3);
    for membrane in ["membrane=stvk", "membrane=arap"] {
        let found = run("implicit-euler", "9", &["points=midpoints", membrane]);
        assert!(
            (fall(&found) / fall(middles) - 1.0).abs() < 0.05,
            "{membrane}"
        );
    }
}

/// The figures of the page on scene files: diagonals hold the corners of a sheet on a box up, as high as Δt has it.
#[test]
fn corners_of_a_sheet_on_a_box_come_down_without_diagonals_whatever_the_step() {
    let scene = written(
        "corners",
        "[[mesh]]\ngenerator = \"grid:17x17:alternating\"\nscale = 0.8\ntranslate = [-0.4, -0.4, 0.22]\n\
         [contact]\nself = true\nthickness = 4e-3\nfriction = 0.3\n\
         [[obstacle]]\nshape = \"box\"\nsize = [0.4, 0.4, 0.4]\nposition = [0, 0, 0]\n",
    );
    let scene = scene.display().to_string();
    let falls = |edges: &str, frequency: u32| {
        let dt = (1.0 / f64::from(frequency)).to_string();
        let steps = frequency.to_string();
        let time = ["--dt", &dt, "--steps", &steps, "--threads", "1"];
        let method = ["run", &scene, "--method", "implicit-euler", "--set", edges];
        told(&[&method[..], &time].concat())["center_of_mass_drop"]
            .as_f64()
            .unwrap()
    };
    for (edges, all) in [
        ("edges=all", [0.093, 0.066]),
        ("edges=quads", [0.111; 2]),
        ("edges=0.3", [0.106; 2]),
    ] {
        for (frequency, expected) in [60, 240].into_iter().zip(all) {
            let fall = falls(edges, frequency);
            assert!(
                (fall - expected).abs() < 2e-3,
                "{edges}, {frequency}: {fall} m"
            );
        }
    }
}

#[test]
fn a_remedy_that_cannot_be_is_refused_with_its_name() {
    for (settings, words) in [
        (&["level=30"][..], "levels from 1 to"),
        (&["fine_fraction=0.5"], "fine_fraction"),
        (&["level=1", "fine_fraction=2"], "at most 1"),
        (&["level=1", "membrane=arap"], "coarse level"),
        (&["level=1", "edges=quads"], "coarse level"),
        (&["points=corners"], "midpoints"),
        (&["points=midpoints", "level=1"], "level has no meaning"),
        (&["points=midpoints", "slack=0.9,1"], "slack has no meaning"),
        (
            &["points=midpoints", "bending=cubic"],
            "bending has no meaning",
        ),
        (&["points=midpoints", "self=yes"], "gaps"),
        (&["edges=0.9"], "between 0 and"),
        (&["compression=2"], "at most 1"),
        (&["slack=1.1,1.2"], "has to hold 1"),
        (&["remedy=yes"], "`remedy`"),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_cloth-bench"));
        command.args(["run", "hang", "--method", "xpbd", "--n", "9"]);
        for setting in settings {
            command.args(["--set", setting]);
        }
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{settings:?}");
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(told.contains(words), "{settings:?}: {told}");
    }
}

/// Two sheets that touch in their vertex 4, of which the second has one of its two triangles turned over.
#[test]
fn fans_that_touch_and_sides_that_change_places_are_told() {
    let file = crate::program::folder("bow-tie").join("bow.obj");
    let mut text = String::new();
    for [x, y] in [[0, 0], [0, 1], [1, 0], [2, 2], [1, 1], [2, 1], [1, 2]] {
        text += &format!("v {x} {y} 0\n");
    }
    // Numbers of faces count from 1.
    text += "f 1 3 5\nf 1 5 2\nf 5 6 4\nf 5 7 4\n";
    std::fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    let told = told(&["locking", file]);
    assert_eq!(told["bow_tie_vertices"], 1);
    assert_eq!(told["inconsistently_oriented_edges"], 1);
    let notes = |file: &str| {
        let ran = crate::program::program(&[
            "run", "hang", "--mesh", file, "--method", "pd", "--steps", "1",
        ]);
        String::from_utf8(ran.stderr).unwrap()
    };
    let said = notes(file);
    assert!(
        said.contains("touch without a common edge at 1 of the vertices, such as 4:"),
        "{said}"
    );
    assert!(
        said.contains("at 1 of the edges, such as that from 3 to 4:"),
        "{said}"
    );
    assert!(!notes("grid:5x5:alternating").contains("note:"));
}

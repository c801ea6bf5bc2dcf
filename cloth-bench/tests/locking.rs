//! Locking as a user meets it: the command on every kind of mesh, and every remedy with every method.

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

/// χ, E_b, the number of boundary loops and pieces, and the self-stresses of the bent shape: 3χ + E_b motions and one more for each of these are left.
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
            assert!(found[format!("smallest_kept_{shape}")].as_f64().unwrap() > 1e-9);
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
        &["level=2", "fine_share=0.1"],
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

#[test]
fn a_level_that_the_mesh_has_not_is_refused_with_the_number_it_has() {
    for (settings, words) in [
        (&["level=30"][..], "levels from 1 to"),
        (&["fine_share=0.5"], "fine_share"),
        (&["level=1", "fine_share=2"], "at most 1"),
        (&["level=1", "membrane=arap"], "coarse level"),
        (&["level=1", "edges=quads"], "coarse level"),
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

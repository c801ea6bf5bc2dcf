//! What is wrong is said in a sentence of bounded length, with the file and the line where it stands.

use crate::program::{folder, program, refused};
use std::path::Path;

/// A file in the folder of this test.
fn file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_query_that_cannot_be_worked_with_is_named_by_file_and_line() {
    const ROW: &str = "1,2,-3,4,5,1,1\n";
    let folder = folder("query-places");
    let sound = file(&folder, "sound.csv", ROW.repeat(16));
    // A blank line is no row; the second query begins in line 10.
    let huge = format!("1{},1,3,4,5,1,1\n", "0".repeat(308));
    let text = format!(
        "{}\n{}{huge}{}",
        ROW.repeat(8),
        ROW.repeat(3),
        ROW.repeat(4)
    );
    let far = file(&folder, "far.csv", text);
    refused(
        &["ccd", &sound, &far, &sound, "--kind", "vf"],
        2,
        &["far.csv: line 10: ", "more than 1e300 m apart"],
    );
    let binary = file(&folder, "binary.csv", [ROW.as_bytes(), b"\xff\n"].concat());
    refused(
        &["ccd", &binary, "--kind", "ee"],
        2,
        &["binary.csv: line 2: "],
    );
}

#[test]
fn a_mesh_too_large_for_numbers_is_named_by_file_and_line() {
    let folder = folder("huge-meshes");
    for power in [80, 140, 200, 308] {
        let far = format!("1e{power}");
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 0 1\nv {far} 0 {far}\nf 1 2 3\nf 2 4 3\n");
        let mesh = file(
            &folder,
            "huge.obj",
            text.replace("v 1 0 0", &format!("v {far} 0 0")),
        );
        refused(
            &["run", "hang", "--mesh", &mesh, "--method", "xpbd"],
            2,
            &["huge.obj: line 5: "],
        );
        let scene = file(&folder, "huge.toml", "[[mesh]]\nfile = \"huge.obj\"\n");
        refused(
            &["run", &scene, "--method", "xpbd"],
            2,
            &["huge.toml: line 2: ", "huge.obj: line 5: "],
        );
    }
}

/// Of what a user writes no more than is needed is said again.
#[test]
fn messages_have_a_bounded_length() {
    let folder = folder("long-values");
    let long = "x".repeat(3000);
    let spaced = "x y ".repeat(700);
    let obj = file(&folder, "long.obj", format!("v {long} 0 0\n"));
    let csv = file(&folder, "long.csv", format!("1,2,{long},4,5,1,1\n"));
    let key = file(&folder, "key.toml", format!("{long} = 1\n"));
    let value = file(&folder, "value.toml", format!("dt = \"{spaced}\"\n"));
    let spec = file(
        &folder,
        "spec.toml",
        format!("[[mesh]]\ngenerator = \"{spaced}\"\n"),
    );
    let toml = format!("{long}.toml");
    let [pair, number] = [format!("{long}=1"), format!("n={spaced}")];
    let mesh = format!("grid:{long}");
    let run = ["run", "hang", "--method", "xpbd"];
    for more in [
        &["--set", &long][..],
        &["--set", &pair],
        &["--set", &number],
        &["--set", &format!("pins={spaced}")],
        &["--set", &format!("slack={spaced}")],
        &["--set", &format!("membrane={long}")],
        &["--set", &number, "--set", &number],
        &["--set", &number, "--n", "3"],
        &["--mesh", &long],
        &["--mesh", &mesh],
        &["--mesh", &obj],
        &["--dt", &long],
        &["--format", &long],
        &[&spaced],
        &[&format!("--{long}")],
    ] {
        bounded(&[&run[..], more].concat());
    }
    for arguments in [
        &["run", &spaced, "--method", "xpbd"][..],
        &["run", &toml, "--method", "xpbd"],
        &["run", &key, "--method", "xpbd"],
        &["run", &value, "--method", "xpbd"],
        &["run", &spec, "--method", "xpbd"],
        &["run", "hang", "--method", &spaced],
        &["study", &spaced],
        &["study", "--shard", &spaced],
        &["law", &spaced],
        &["law", "sag", "--set", &pair],
        &["locking", &long],
        &["ccd", &long, "--kind", "vf"],
        &["ccd", &csv, "--kind", "vf"],
        &["ccd", "--kind", &spaced],
        &["ccd", "--kind", "vf", "--method", &spaced],
        &["merge", &long],
        &[&spaced],
    ] {
        bounded(arguments);
    }
}

/// The longest list of known names has some 400 characters.
fn bounded(arguments: &[&str]) {
    let output = program(arguments);
    let told = String::from_utf8_lossy(&output.stderr);
    let start: String = format!("{arguments:?}").chars().take(80).collect();
    assert!(!output.status.success(), "{start}");
    let count = told.chars().count();
    assert!(count < 1000, "{start}… says {count} characters: {told}");
}

#[test]
fn a_key_set_twice_is_refused() {
    let run = ["run", "hang", "--method", "xpbd", "--steps", "1"];
    for (more, words) in [
        (&["--set", "n=5", "--set", "n=9"][..], ["`n`", "`5`", "`9`"]),
        (
            &["--set", "substeps=5", "--set", "substeps = 5"],
            ["`substeps`", "twice", "`5`"],
        ),
        (
            &["--n", "5", "--set", "n=9"],
            ["--n is 5", "--set n", "`9`"],
        ),
    ] {
        refused(&[&run[..], more].concat(), 2, &words);
    }
    refused(
        &["law", "sag", "--set", "links=3", "--set", "links=4"],
        2,
        &["`links`", "`3`", "`4`"],
    );
}

/// At their largest values the laws would take days.
#[test]
fn work_without_end_is_refused() {
    for (law, pair) in [
        ("xpbd-constraint", "iterations=4000000000"),
        ("pbd-constraint", "iterations=4000000000"),
        ("xpbd-damping", "iterations=4000000000"),
        ("support-force", "links=10000"),
        ("xpbd-compliance", "iterations=4000000000"),
        ("direct-step", "links=10000000"),
        ("sag", "links=10000"),
        ("sag", "iterations=100000000"),
        ("hanging-chain", "links=999999"),
        ("catenary", "links=4000000000"),
        ("pendulum", "steps=4000000000"),
        ("chain-swing", "links=10000"),
        ("chain-swing", "steps=4000000000"),
        ("chain-rate", "links=4000000000"),
        ("free-fall", "steps=1000000"),
        ("free-fall", "n=500"),
        ("same-minimum", "n=100"),
        ("lateral-buckling", "across=33"),
        ("bounce", "bounces=4000000000"),
    ] {
        refused(
            &["law", law, "--set", pair],
            2,
            &["operations", "smaller counts"],
        );
    }
    let run = [
        "run",
        "hang",
        "--n",
        "5",
        "--method",
        "xpbd",
        "--time-limit",
    ];
    refused(
        &[&run[..], &["1e-9"]].concat(),
        1,
        &["time limit", "after step 1 of 300"],
    );
    refused(&[&run[..], &["0"]].concat(), 2, &["--time-limit is 0 s"]);
}

#[test]
fn the_help_says_what_the_energies_hold() {
    let help = program(&["run", "--help"]);
    let text = String::from_utf8_lossy(&help.stdout);
    assert!(
        text.contains(
            "potential_energy     elastic_energy + gravity_energy + contact_energy + what"
        ),
        "{text}"
    );
}

/// Where nothing can be touched it is no worse than its energy warning.
#[test]
fn a_method_that_gains_energy_in_contact_says_so() {
    let warned = |scene: &str, method: &str| {
        let ran = program(&["run", scene, "--n", "5", "--method", method, "--steps", "1"]);
        String::from_utf8(ran.stderr)
            .unwrap()
            .contains("gains energy in contact")
    };
    assert!(warned("drape-sphere", "implicit-midpoint"));
    assert!(!warned("hang", "implicit-midpoint"));
    assert!(!warned("drape-sphere", "bdf2"));
}

/// Steps that are refined cost many times what the rule for substeps says: the run says so, and by how much.
#[test]
fn a_run_whose_steps_were_refined_says_what_that_costs() {
    let folder = folder("refined");
    let towel = "dt = 0.02\n[[mesh]]\ngenerator = \"irregular:17\"\nscale = [0.7, 0.5, 1]\n\
        rotate = [1.5707963267948966, 0, 0]\ntranslate = [-0.35, 0.03, 0]\n[cloth]\ndensity = 0.5\nstiffness = 8e3\n\
        rigidity = 1e-4\n[[pins]]\nbox = [[-0.03, -1, 0.49], [0.03, 1, 0.6]]\n[contact]\nself = true\n";
    let towel = file(&folder, "towel.toml", towel);
    let told = |gain: &str| {
        let output = program(&[
            "run", &towel, "--method", "xpbd", "--steps", "12", "--set", gain,
        ]);
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let refined = told("energy_gain=auto");
    assert!(
        refined.contains("note: half of the steps took 7 times the 123 substeps"),
        "{refined}"
    );
    assert!(!told("energy_gain=none").contains("half of the steps"));
}

/// A modulus that springs do not have on a mesh is told; where they have it, or triangles do, nothing is.
#[test]
fn a_modulus_that_springs_do_not_have_is_told() {
    let folder = folder("modulus");
    for (mesh, cloth, is_told) in [
        ("irregular:9", "modulus = 1000", true),
        ("irregular:9", "modulus = 1000\nmembrane = \"arap\"", false),
        ("irregular:9", "stiffness = 1000", false),
        ("grid:9x9:alternating", "modulus = 1000", false),
        ("equilateral:9x9", "modulus = 1000", false),
        ("tube:16x8", "modulus = 1000", false),
        ("sphere:3", "modulus = 1000", false),
    ] {
        let scene = format!("[[mesh]]\ngenerator = \"{mesh}\"\n[cloth]\n{cloth}\n");
        let scene = file(&folder, "modulus.toml", scene);
        let output = program(&["run", &scene, "--method", "implicit-euler", "--steps", "1"]);
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            told.contains("give way"),
            is_told,
            "{mesh}, {cloth}: {told}"
        );
    }
}

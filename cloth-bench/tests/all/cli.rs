//! The program as a user meets it: exit codes, JSON on standard output, one sentence for what is wrong.

use crate::program::{folder, program, refused};
use std::path::PathBuf;

fn json(arguments: &[&str]) -> serde_json::Value {
    let output = program(arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

#[test]
fn what_gave_up_in_a_run_is_told() {
    let told = |more: &[&'static str]| {
        let start = [
            "run", "hang", "--n", "9", "--steps", "3", "--json", "--method",
        ];
        let arguments: Vec<&str> = start.into_iter().chain(more.iter().copied()).collect();
        json(&arguments)["chebyshev_fallbacks"].as_u64()
    };
    // In every substep: Jacobi sweeps without averaging grow by themselves, which three of them do not show much of.
    let growing = [
        "sweep=plain-jacobi",
        "chebyshev=0.9",
        "chebyshev_delay=1",
        "iterations=3",
        "substeps=1",
    ];
    for method in ["pbd", "xpbd"] {
        let mut arguments = vec![method];
        arguments.extend(growing.iter().flat_map(|pair| ["--set", pair]));
        assert_eq!(told(&arguments), Some(3), "{method}");
    }
    assert_eq!(told(&["pbd", "--set", "chebyshev=auto"]), Some(0));
    let pd = json(&[
        "run", "hang", "--n", "9", "--steps", "3", "--json", "--method", "pd",
    ]);
    assert_eq!(pd["coarse_fallbacks"], 0);
    assert_eq!(pd["coarse_builds"], 0);
}

#[test]
fn run_chooses_the_substeps_of_xpbd_for_the_mesh() {
    let run = |n: &'static str, more: &[&'static str]| {
        let start = ["run", "hang", "--method", "xpbd", "--steps", "90", "--json"];
        let more = more.iter().flat_map(|pair| ["--set", pair]);
        let arguments: Vec<&str> = start.into_iter().chain(["--n", n]).chain(more).collect();
        let said = json(&arguments);
        let stretch = said["max_stretch"].as_f64().unwrap();
        (said["iterations_per_step"].as_u64().unwrap(), stretch)
    };
    let once = ["energy_gain=none"];
    let (coarse, fine) = (run("17", &once), run("33", &once));
    assert_eq!([coarse.0, fine.0], [33, 75]);
    assert!(coarse.1 < 0.1 && fine.1 < 0.1, "{coarse:?}, {fine:?}");
    let named = ["substeps=auto", "strain=0.1", "energy_gain=none"];
    assert_eq!(run("17", &named), coarse);
    let (substeps, stretch) = run("33", &["substeps=published"]);
    assert!(substeps == 20 && stretch > 0.1, "{stretch}");
    let less = ["strain=0.03", "energy_gain=none"];
    assert!(run("17", &less).0 > 2 * coarse.0 - 8);
}

#[test]
fn broken_meshes_are_refused_with_their_line() {
    let folder = folder("broken-meshes");
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let cases = [
        ("empty.obj", String::new(), "empty.obj"),
        ("out-of-range.obj", format!("{square}f 1 2 9\n"), "line 5"),
        (
            "degenerate.obj",
            format!("{square}f 1 2 3\nf 1 1 4\n"),
            "line 6",
        ),
        (
            "not-a-number.obj",
            format!("v 0 nan 0\n{square}f 2 3 4\n"),
            "line 1",
        ),
        ("word.obj", format!("{square}v 1 x 2\nf 1 2 3\n"), "line 5"),
        (
            "non-manifold.obj",
            format!("{square}v 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"),
            "line",
        ),
        (
            "zero-area.obj",
            "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_owned(),
            "line 4",
        ),
    ];
    for (name, text, words) in cases {
        let file = folder.join(name);
        std::fs::write(&file, text).unwrap();
        let file = file.to_str().unwrap();
        refused(
            &["run", "hang", "--method", "pd", "--mesh", file],
            2,
            &[words],
        );
        refused(&["locking", file], 2, &[words]);
    }
    refused(
        &[
            "run",
            "hang",
            "--method",
            "pd",
            "--mesh",
            "no/such/file.obj",
        ],
        2,
        &["no/such/file.obj"],
    );
}

#[test]
fn an_unstable_run_says_its_step_and_the_stable_one() {
    let arguments = [
        "run",
        "hang",
        "--n",
        "17",
        "--method",
        "symplectic-euler",
        "--set",
        "substeps=1",
    ];
    refused(&arguments, 1, &["unstable", "1.6667e-2 s", "stable"]);
    refused(
        &["run", "hang", "--n", "9", "--method", "explicit-euler"],
        1,
        &["unstable"],
    );
}

/// Without a font or the feature, plots as PNG are refused before anything is run; with both they are there.
#[test]
fn plots_as_png_are_written_or_refused_at_once() {
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("png");
    let _ = std::fs::remove_dir_all(&out);
    let arguments = ["study", "xpbd-floor", "--quick", "--png", "--out"];
    let arguments = [&arguments[..], &[out.to_str().unwrap()]].concat();
    if cfg!(feature = "plots-as-png") {
        assert!(program(&arguments).status.success());
        let plots = std::fs::read_dir(out.join("plots")).unwrap();
        let (mut svg, mut png) = (0, 0);
        for plot in plots {
            let path = plot.unwrap().path();
            svg += u32::from(path.extension().is_some_and(|e| e == "svg"));
            if path.extension().is_some_and(|e| e == "png") {
                png += 1;
                assert!(std::fs::read(path).unwrap().starts_with(b"\x89PNG\r\n"));
            }
        }
        assert!(svg > 0 && svg == png, "{svg} {png}");
    } else {
        refused(&arguments, 2, &["--features plots-as-png"]);
        assert!(!out.exists(), "something was run");
    }
}

#[test]
fn a_run_tells_in_json_what_it_did() {
    for method in ["symplectic-euler", "implicit-euler", "pbd", "xpbd", "pd"] {
        let told = json(&[
            "run",
            "hang",
            "--n",
            "9",
            "--steps",
            "5",
            "--method",
            method,
            "--json",
            "--reference",
        ]);
        for key in [
            "method",
            "vertices",
            "steps",
            "ms_per_step_median",
            "ms_per_step_max",
            "iterations",
            "max_stretch",
            "kinetic_energy",
            "gravity_energy",
            "contact_energy",
            "potential_energy",
            "center_of_mass_drop",
            "intersections",
            "min_distance",
            "finite",
            "objective_error",
            "gradient_error",
        ] {
            assert!(
                told.get(key).is_some_and(|v| !v.is_null()),
                "{method} does not tell {key}: {told}"
            );
        }
        assert_eq!(told["vertices"], 81);
        assert_eq!(told["finite"], true);
        let energy = |name: &str| told[name].as_f64().unwrap();
        assert_eq!(
            energy("potential_energy"),
            energy("elastic_energy") + energy("gravity_energy") + energy("contact_energy"),
        );
        // 0.2 kg/m² on 1 m², all of one acceleration.
        let fallen = -0.2 * 9.81 * energy("center_of_mass_drop");
        assert!((energy("gravity_energy") - fallen).abs() < 1e-12);
        // All but the two corners fall freely at first: 5 steps, half g h² n(n + 1).
        let drop = told["center_of_mass_drop"].as_f64().unwrap();
        assert!((0.02..0.042).contains(&drop), "{method} fell {drop} m");
    }
}

#[test]
fn a_mesh_file_is_held_at_its_top_and_exported_in_its_own_order() {
    let folder = folder("mesh-file");
    let file = folder.join("sheet.obj");
    let mut text = String::new();
    // Columns first and top last, so that the order in memory is another one.
    for i in 0..6 {
        for j in 0..6 {
            text += &format!(
                "v {} {} {}\n",
                0.1 * f64::from(i),
                0.1 * f64::from(j),
                0.01 * f64::from(i * j % 3)
            );
        }
    }
    for i in 0..5 {
        for j in 0..5 {
            let a = 6 * i + j + 1;
            text += &format!("f {} {} {}\nf {} {} {}\n", a, a + 6, a + 7, a, a + 7, a + 1);
        }
    }
    std::fs::write(&file, &text).unwrap();
    let out = folder.join("out");
    let told = json(&[
        "run",
        "hang",
        "--mesh",
        file.to_str().unwrap(),
        "--method",
        "xpbd",
        "--steps",
        "3",
        "--json",
        "--export",
        out.to_str().unwrap(),
    ]);
    assert_eq!(told["pins"], 6);
    let original = cloth_core::mesh::obj::parse(&text).unwrap();
    let exported = cloth_core::mesh::obj::read(&out.join("00003.obj")).unwrap();
    assert_eq!(exported.vertex_count(), 36);
    for v in 0..36 {
        let moved = (exported.positions()[v] - original.positions()[v]).norm();
        assert_eq!(v % 6 == 5, moved == 0.0, "vertex {v} moved by {moved}");
    }
    let sorted = |mesh: &cloth_core::mesh::TriMesh| {
        let mut triangles: Vec<[u32; 3]> = mesh.triangles().to_vec();
        for t in &mut triangles {
            t.sort_unstable();
        }
        triangles.sort_unstable();
        triangles
    };
    assert_eq!(sorted(&original), sorted(&exported));
}

#[test]
fn locking_counts_and_measures() {
    let told = json(&["locking", "grid:9x9:alternating", "--json"]);
    for (key, value) in [
        ("vertices", 81),
        ("edges", 208),
        ("faces", 128),
        ("boundary_edges", 32),
        ("bow_tie_vertices", 0),
        ("inconsistently_oriented_edges", 0),
        ("euler", 1),
        ("count_3v_e", 35),
        ("rank_flat", 159),
        ("nullity_flat", 84),
        ("rank_bent", 208),
        ("nullity_bent", 35),
    ] {
        assert_eq!(told[key], value, "{key}");
    }
}

#[test]
fn a_law_tells_expected_measured_and_error() {
    let told = json(&[
        "law",
        "pbd-constraint",
        "--set",
        "iterations=3",
        "--set",
        "stiffness=0.5",
        "--set",
        "dt=1",
        "--json",
    ]);
    assert_eq!(told["expected"], 7.0);
    assert!(told["error"].as_f64().unwrap() < 1e-12);
}

/// What is common to several scenes or methods is explained once, and every entry names all that it takes.
#[test]
fn list_explains_common_parameters_once_and_names_them_everywhere() {
    let told = json(&["list", "--json"]);
    let text = String::from_utf8(program(&["list"]).stdout).unwrap();
    for (kind, entries) in told.as_object().unwrap() {
        let from = text.find(&format!("{kind}:\n")).unwrap() + kind.len() + 2;
        let lines = text[from..]
            .lines()
            .take_while(|line| line.starts_with(' '));
        let lines: Vec<&str> = lines.collect();
        // An entry begins in the third column.
        let is_head = |line: &str| !line.starts_with("   ");
        let common_part: Vec<&str> = match lines.first() {
            Some(line) if line.starts_with("  (common)") => lines[1..]
                .iter()
                .copied()
                .take_while(|line| !is_head(line))
                .collect(),
            _ => Vec::new(),
        };
        let key = |line: &str| {
            line.trim_start()
                .trim_start_matches("--set ")
                .split(['=', ' '])
                .next()
                .unwrap()
                .to_owned()
        };
        let common: Vec<String> = common_part.iter().map(|line| key(line)).collect();
        for entry in entries.as_array().unwrap() {
            let [name, about] = ["name", "about"].map(|key| entry[key].as_str().unwrap());
            let head = format!("  {name:18} {about}");
            let head = lines.iter().position(|&line| line == head).unwrap();
            let own: Vec<&str> = lines[head + 1..]
                .iter()
                .copied()
                .take_while(|line| !is_head(line))
                .collect();
            for p in entry["parameters"].as_array().unwrap() {
                let [name, default, about] =
                    ["name", "default", "about"].map(|key| p[key].as_str().unwrap());
                let explained = format!(" {about}");
                let explains = |line: &&&str| {
                    let line = line.trim_start().trim_start_matches("--set ");
                    let key = line.split(['=', ' ']).next();
                    key == Some(name) && line.ends_with(&explained)
                };
                // A name that has another meaning in the common part is explained where it is used.
                let is_once = lines.iter().filter(explains).count() == 1;
                let has_other_meaning = common.iter().any(|key| key == name)
                    && !common_part.iter().any(|line| explains(&line));
                assert!(is_once || has_other_meaning, "{kind}: {name}");
                let named = own
                    .iter()
                    .filter_map(|line| line.trim().strip_prefix("(common) "));
                let named = named.flat_map(|line| line.split(", "));
                let is_named = named
                    .into_iter()
                    .any(|word| word == name || word == format!("{name}={default}"));
                assert!(
                    is_named || own.iter().any(|line| explains(&line)),
                    "{kind}: {name}"
                );
            }
        }
    }
}

#[test]
fn list_shows_every_name() {
    let told = json(&["list", "--json"]);
    for (kind, names) in [
        (
            "methods",
            &[
                "explicit-euler",
                "symplectic-euler",
                "implicit-euler",
                "pbd",
                "xpbd",
                "pd",
            ][..],
        ),
        ("scenes", &["hang", "drop", "chain", "cantilever"]),
        ("ccd-methods", &["conservative", "additive", "cubic"]),
        (
            "studies",
            &[
                "convergence",
                "stiffness",
                "locking",
                "bending",
                "xpbd-floor",
                "projective",
                "newton",
                "energy",
                "stability",
                "recovery",
                "independence",
            ],
        ),
        (
            "laws",
            &[
                "oscillator",
                "chain-rate",
                "sag",
                "patch",
                "elastica",
                "lateral-buckling",
                "bending-factor",
                "bending-spring",
            ],
        ),
    ] {
        for name in names {
            let found = told[kind]
                .as_array()
                .unwrap()
                .iter()
                .any(|entry| entry["name"] == **name);
            assert!(found, "{kind}: {name}");
        }
    }
}

#[test]
fn a_study_writes_its_report_and_its_data() {
    let folder = folder("study");
    let told = json(&[
        "study",
        "sag",
        "--quick",
        "--out",
        folder.to_str().unwrap(),
        "--json",
    ]);
    assert_eq!(told["studies"][0], "sag");
    assert_eq!(told["failed"].as_array().unwrap().len(), 0);
    for file in [
        "report.html",
        "manifest.json",
        "data/sag-chain.csv",
        "plots/sag-chain.svg",
    ] {
        assert!(
            folder.join(file).metadata().is_ok_and(|m| m.len() > 100),
            "{file}"
        );
    }
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("N(N − 1)/2"));
}

/// A vertex that falls through a triangle, and one that falls beside it; then once more, wrongly labelled.
fn queries(name: &str, truths: [u8; 2]) -> String {
    let path = folder("ccd").join(name);
    let mut text = String::new();
    for (x, truth) in [("1,4", truths[0]), ("5,4", truths[1])] {
        for height in ["1,2", "-1,2"] {
            for row in [
                &format!("{x},1,4,{height}"),
                "0,1,0,1,0,1",
                "1,1,0,1,0,1",
                "0,1,1,1,0,1",
            ] {
                text += &format!("{row},{truth}\n");
            }
        }
    }
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn labelled_queries_are_counted() {
    let good = queries("good.csv", [1, 0]);
    let told = json(&["ccd", &good, &good, "--kind", "vf", "--json"]);
    for (key, count) in [
        ("queries", 4),
        ("positives", 2),
        ("false_positives", 0),
        ("false_negatives", 0),
        ("late", 0),
    ] {
        assert_eq!(told[key], count, "{key}");
    }
    for key in ["ns_per_query", "mean_ns", "median_ns", "worst_ns"] {
        assert!(told[key].as_f64().unwrap() > 0.0, "{key}");
    }
    let tunnelled = json(&[
        "ccd", &good, "--kind", "vf", "--method", "discrete", "--json",
    ]);
    assert_eq!(tunnelled["false_negatives"], 1);
}

#[test]
fn a_broken_promise_is_a_failed_run_and_bad_files_are_refused() {
    let wrong = queries("wrong.csv", [0, 1]);
    refused(
        &["ccd", &wrong, "--kind", "vf"],
        1,
        &["conservative", "missed 1"],
    );
    let told = json(&["ccd", &wrong, "--kind", "vf", "--method", "cubic", "--json"]);
    assert_eq!(
        (&told["false_positives"], &told["false_negatives"]),
        (&1.into(), &1.into())
    );

    let bad = folder("ccd").join("bad.csv");
    std::fs::write(&bad, "0,1,0,1,0,1,1\n0,1,zero,1,0,1,1\n").unwrap();
    refused(
        &["ccd", bad.to_str().unwrap(), "--kind", "ee"],
        2,
        &["bad.csv", "line 2", "`zero`"],
    );
    refused(
        &["ccd", "no-such-file.csv", "--kind", "ee"],
        2,
        &["no-such-file.csv"],
    );
    refused(&["ccd", "--kind", "ee"], 2, &["--generate"]);
    refused(&["ccd", &wrong, "--kind", "both"], 2, &["both"]);
    refused(
        &["ccd", &wrong, "--kind", "vf", "--method", "cubik"],
        2,
        &["`cubik`", "`cubic`"],
    );
}

#[test]
fn conservative_test_misses_nothing_that_is_generated() {
    for kind in ["vf", "ee"] {
        for seed in ["1", "2"] {
            let arguments = [
                "ccd",
                "--kind",
                kind,
                "--generate",
                "4000",
                "--seed",
                seed,
                "--json",
            ];
            let told = json(&arguments);
            assert_eq!(
                (&told["queries"], &told["positives"]),
                (&4000.into(), &2000.into())
            );
            for key in ["false_negatives", "false_positives", "late"] {
                assert_eq!(told[key], 0, "{kind} {seed} {key}");
            }
        }
    }
}

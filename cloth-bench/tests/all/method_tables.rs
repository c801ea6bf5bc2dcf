//! `[method.NAME]` of scene files: settings of methods.

use crate::program::program;
use crate::scene_text::written;
use cloth_bench::error::BenchError;
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use serde_json::Value;

const HANGING: &str =
    "steps = 5\n[[mesh]]\ngenerator = \"grid:7x7:alternating\"\n[[pins]]\nselect = \"corners\"\n";

/// What a run of a scene with this text at its end tells, but for its times and its memory.
fn told(name: &str, more: &str, arguments: &[&str]) -> Value {
    let path = written(name, &format!("{HANGING}{more}"));
    let run = ["run", path.to_str().unwrap(), "--json"];
    let ran = program(&[&run, arguments].concat());
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{said}");
    let mut told: Value = serde_json::from_slice(&ran.stdout).unwrap();
    for key in [
        "scene",
        "setup_ms",
        "peak_memory",
        "ms_per_step_median",
        "ms_per_step_max",
    ] {
        told.as_object_mut().unwrap().remove(key).unwrap();
    }
    told
}

fn built(name: &str, more: &str) -> Result<Scene, BenchError> {
    let path = written(name, &format!("{HANGING}{more}"));
    file::build(&path, &Settings::default())
}

#[test]
fn a_run_reads_the_table_of_its_method() {
    let tables = "[method.pd]\niterations = 3\n[method.xpbd]\nsubsteps = 7\ndamping = 0.01\n";
    for (method, pairs) in [
        ("pd", &["iterations=3"][..]),
        ("xpbd", &["substeps=7", "damping=0.01"]),
        ("implicit-euler", &[]),
    ] {
        let mut arguments = vec!["--method", method];
        let of_file = told("tables", tables, &arguments);
        arguments.extend(pairs.iter().flat_map(|pair| ["--set", pair]));
        assert_eq!(of_file, told("none", "", &arguments), "{method}");
        // The settings matter.
        let usual = told("none", "", &["--method", method]);
        assert_eq!(of_file == usual, pairs.is_empty(), "{method}");
    }
    let both = told(
        "tables",
        tables,
        &["--method", "pd", "--set", "iterations=9"],
    );
    let over = told("none", "", &["--method", "pd", "--set", "iterations=9"]);
    assert_eq!(both, over);
}

/// A chain has no mesh, and methods all the same.
#[test]
fn a_chain_can_have_settings_of_methods() {
    let path = written("links", "[chain]\nn = 4\n[method.xpbd]\nsubsteps = 3\n");
    let scene = file::build(&path, &Settings::default()).unwrap();
    assert_eq!(scene.settings_of("xpbd").get("substeps"), Some("3"));
    assert_eq!(scene.settings_of("pd"), Settings::default());
}

/// Tables of methods that do not run are checked too.
#[test]
fn what_is_wrong_with_the_table_of_a_method_is_said_with_its_line() {
    for (name, more, line, words) in [
        (
            "key",
            "[method.pd]\niteration = 3\n",
            7,
            "did you mean `iterations`",
        ),
        (
            "other-key",
            "[method.pd]\nsubsteps = 3\n",
            7,
            "key of [method.pd]",
        ),
        (
            "name",
            "[method.pbdd]\niterations = 3\n",
            6,
            "did you mean `pbd`",
        ),
        (
            "value",
            "[method.pd]\niterations = 0.5\n",
            7,
            "a whole number",
        ),
        (
            "range",
            "[method.xpbd]\nsubsteps = 0\n",
            7,
            "substeps is `0`",
        ),
        (
            "no-table",
            "[method]\npd = 3\n",
            7,
            "this has to be a table",
        ),
    ] {
        let said = built(name, more).unwrap_err().to_string();
        let place = format!("{name}.toml: line {line}: ");
        assert!(said.contains(&place) && said.contains(words), "{said}");
    }
    let top = written("top", &format!("method = 3\n{HANGING}"));
    let said = file::build(&top, &Settings::default())
        .unwrap_err()
        .to_string();
    assert!(
        said.contains("line 1") && said.contains("[method.NAME]"),
        "{said}"
    );
}

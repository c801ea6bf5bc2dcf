//! The program started as a user starts it, for the tests of several files.

use crate::scene_text::written;
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

pub(crate) fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cloth-bench"))
        .args(arguments)
        .output()
        .expect("the program runs")
}

pub(crate) fn refused(arguments: &[&str], code: i32, words: &[&str]) {
    let output = program(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    for word in words {
        assert!(
            message.contains(word),
            "{arguments:?} says `{message}`, which lacks `{word}`"
        );
    }
}

/// A folder of this test's own.
pub(crate) fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// What a run of a scene of this text prints, with its exit code and what it says besides.
pub(crate) fn run_text(
    name: &str,
    text: &str,
    method: &str,
    more: &[&str],
) -> (Option<Value>, i32, String) {
    let path = written(name, text);
    let mut arguments = vec!["run", path.to_str().unwrap(), "--method", method, "--json"];
    arguments.extend(["--threads", "1"]);
    arguments.extend(more);
    let output = program(&arguments);
    let told = serde_json::from_slice(&output.stdout).ok();
    let said = String::from_utf8(output.stderr).unwrap();
    (told, output.status.code().unwrap(), said)
}

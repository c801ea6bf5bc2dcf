//! Scene files of a test's own, for the tests of several files.

use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use std::path::PathBuf;

/// A scene file of this text, in a folder of the test file's own.
pub(crate) fn written(name: &str, text: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_CRATE_NAME"));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).unwrap();
    path
}

/// The scene of this text.
pub(crate) fn scene(name: &str, text: &str) -> Scene {
    file::build(&written(name, text), &Settings::default()).unwrap()
}

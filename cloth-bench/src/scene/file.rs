//! Scenes of your own: a TOML file in the place of a scene's name.
//!
//! Every key, with its unit, default and range, is in [`SECTIONS`], which `cloth-bench list` shows;
//! `cloth-bench/scenes` has examples. What is wrong with a file is said with its line and key, and an unknown key is
//! answered with the nearest known one. Keys of `[cloth]`, `[contact]` and `[method.NAME]` are those of `--set`, which
//! overrules the file.

mod air;
mod build;
mod document;
mod event;
mod force;
mod gas;
mod hints;
mod keys;
mod link;
mod mass;
mod material;
mod mesh;
mod methods;
mod natural_order;
mod obstacles;
mod pins;
mod roughness;
mod seam;
mod selection;
mod start;
mod tear;

pub use build::build;
pub(crate) use build::build_text;
pub use keys::{SECTIONS, SectionInfo, overrulable};

/// Whether the scene that `name` names is a file.
#[must_use]
pub fn is_file(name: &str) -> bool {
    name.ends_with(".toml")
}

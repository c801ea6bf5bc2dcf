//! The cloth simulation methods of this workspace, measured side by side.

mod bounds;
pub mod ccd;
pub mod commands;
pub mod crumpled;
pub mod error;
pub mod export;
mod files;
pub mod hash;
pub mod journal;
pub mod laws;
pub mod memory;
pub mod mesh_spec;
pub mod method;
pub mod names;
mod program;
pub mod report;
pub mod run;
pub mod scene;
pub mod settings;
pub mod studies;
mod tangle;
pub mod yardstick;

pub use program::main_with;

/// The example of the README, compiled and run with the doc tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

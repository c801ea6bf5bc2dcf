//! The cloth simulation methods of this workspace, measured side by side.
//!
//! This is a program: what is public here is so for its tests and for methods of one's own. Whatever can fail returns
//! an [`error::BenchError`], which says what is wrong and whether the user or the program has to mend it; `# Errors`
//! stands where there is more to say.

// Of a program, nobody forgets the result of a function unnoticed; of its errors, see above.
#![allow(clippy::must_use_candidate, clippy::missing_errors_doc)]

mod bisection;
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
